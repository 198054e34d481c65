//! Windows of other sizes.

use crate::display::Display;
use crate::pixels::{Pixels, is_blue, is_yellow};
use crate::seat::{PANEL, Seat};
use std::time::Duration;
use x11rb::protocol::xproto::{BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, MOTION_NOTIFY_EVENT};

/// What a display shows where nobody has drawn.
fn is_black([r, g, b]: [u8; 3]) -> bool {
    r < 10 && g < 10 && b < 10
}

/// The panel between its letters.
fn is_panel([r, g, b]: [u8; 3]) -> bool {
    r > 240 && g > 240 && b > 240
}

/// How many rows a piece may reach over the line that cut it: snapping moves its rim by a tenth of an edge.
const SNAP: usize = 6;

/// Waits until picture and panel fill the window, and cuts the ball in two along a row that is seen.
fn fills_and_is_cut(seat: &mut Seat) {
    let y = seat.wait(|seat| {
        let (picture, panel) = (seat.look(), seat.look_at(seat.width(), PANEL));
        let [x, y] = picture.center(is_blue);
        let is_drawn = picture.count(is_black) + panel.corners(is_black) == 0;
        let has_panel = panel.count(is_panel) > panel.colors.len() / 2;
        let is_there = picture.count(is_blue) > 2000;
        let is_in_the_middle = x.abs_diff(usize::from(seat.width()) / 2) < 12;
        (is_drawn && has_panel && is_there && is_in_the_middle).then_some(y)
    });
    let at = u16::try_from(y).expect("on the screen");
    seat.drag(1, [4, at], [seat.width() - 8, at]);
    let cut = seat.wait(|seat| {
        let cut = seat.look();
        (cut.count(is_yellow) > 500).then_some(cut)
    });
    // Time stands still, so the pieces lie where they were cut: along the pointer's way.
    let [blue, yellow] = [cut.rows(is_blue), cut.rows(is_yellow)];
    let mut rows = [blue, yellow].map(|rows| rows.expect("both pieces are seen"));
    rows.sort_unstable();
    let [[_, end], [begin, _]] = rows;
    assert!(
        end.abs_diff(y) < SNAP && begin.abs_diff(y) < SNAP,
        "{rows:?} are not cut along {y}"
    );
    seat.key('z');
    seat.wait(|seat| (seat.look().count(is_yellow) == 0).then_some(()));
}

/// A window with the ball at its first place, at which time stands still.
fn still(display: &Display) -> (Seat, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a folder");
    let seat = Seat::start(display, folder.path(), &[]);
    seat.key(' ');
    seat.key('r');
    (seat, folder)
}

pub(crate) fn a_resized_window(display: &Display) {
    let (mut seat, _folder) = still(display);
    for size in [[1200, 850], [640, 480], [1000, 400]] {
        seat.resize(size);
        fills_and_is_cut(&mut seat);
    }
    // As small as windows get, and out of sight, as one that is minimized is.
    seat.resize([1, 1]);
    std::thread::sleep(Duration::from_millis(500));
    seat.hide();
    std::thread::sleep(Duration::from_millis(500));
    seat.show();
    seat.resize([800, 600]);
    seat.key('f');
    fills_and_is_cut(&mut seat);
    seat.quit();
}

/// Turns the wheel by so many notches.
fn wheel(seat: &Seat, at: [u16; 2], is_down: bool, notches: usize) {
    let button = if is_down { 5 } else { 4 };
    seat.input(MOTION_NOTIFY_EVENT, 0, at);
    for _ in 0..notches {
        seat.input(BUTTON_PRESS_EVENT, button, [0, 0]);
        seat.input(BUTTON_RELEASE_EVENT, button, [0, 0]);
    }
}

/// How many pixels of the panel the times in it may change, which every picture writes anew.
const TIMES: usize = 900;

/// The panel when it has come to rest.
fn panel(seat: &mut Seat) -> Pixels {
    let mut last = seat.look_at(seat.width(), PANEL);
    seat.wait(|seat| {
        std::thread::sleep(Duration::from_millis(300));
        let now = seat.look_at(seat.width(), PANEL);
        let before = std::mem::replace(&mut last, now);
        (last.differ(&before) < TIMES).then_some(())
    });
    last
}

pub(crate) fn a_panel_that_is_too_high(display: &Display) {
    let (mut seat, _folder) = still(display);
    let over = [seat.width() + PANEL / 2, 400];
    let (first, picture) = (panel(&mut seat), seat.look());
    wheel(&seat, over, true, 10);
    seat.wait(|seat| {
        let now = seat.look_at(seat.width(), PANEL);
        (now.differ(&first) > 4 * TIMES).then_some(())
    });
    // All of it goes by, and ends.
    wheel(&seat, over, true, 60);
    let last = panel(&mut seat);
    wheel(&seat, over, true, 10);
    assert!(panel(&mut seat).differ(&last) < TIMES, "it has no end");
    assert_eq!(
        seat.look().differ(&picture),
        0,
        "the view is none of its business"
    );
    wheel(&seat, over, false, 80);
    seat.wait(|seat| {
        let now = seat.look_at(seat.width(), PANEL);
        (now.differ(&first) < TIMES).then_some(())
    });
    seat.quit();
}
