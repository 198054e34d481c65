//! Tests of windows of other sizes: resizing, minimizing, and scrolling a high panel.

use crate::screenshot::{Screenshot, is_blue, is_yellow};
use crate::virtual_display::Display;
use crate::window_driver::{PANEL, WindowDriver};
use std::time::Duration;
use x11rb::protocol::xproto::{BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, MOTION_NOTIFY_EVENT};

/// Returns true for the color of an empty display.
fn is_black([r, g, b]: [u8; 3]) -> bool {
    r < 10 && g < 10 && b < 10
}

/// Returns true for the background of the panel.
fn is_panel([r, g, b]: [u8; 3]) -> bool {
    r > 240 && g > 240 && b > 240
}

/// Maximum distance of a piece's rim from the slice line \[px\]: snapping moves it by a tenth of an
/// edge.
const SNAP: usize = 6;

/// Asserts that view and panel fill the window, and that a slice cuts where the line is.
fn assert_fills_and_is_cut(driver: &mut WindowDriver) {
    let y = driver.wait(|driver| {
        let (view, panel) = (driver.view(), driver.columns(driver.view_width(), PANEL));
        let [x, y] = view.center(is_blue);
        let is_drawn = view.count(is_black) + panel.corner_count(is_black) == 0;
        let has_panel = panel.count(is_panel) > panel.colors.len() / 2;
        let is_there = view.count(is_blue) > 2000;
        let is_in_the_middle = x.abs_diff(usize::from(driver.view_width()) / 2) < 12;
        (is_drawn && has_panel && is_there && is_in_the_middle).then_some(y)
    });
    let at = u16::try_from(y).expect("on the screen");
    driver.drag(1, [4, at], [driver.view_width() - 8, at]);
    let cut = driver.wait(|driver| {
        let cut = driver.view();
        (cut.count(is_yellow) > 500).then_some(cut)
    });
    // The simulation is paused, so the pieces lie along the slice line.
    let [blue, yellow] = [cut.rows(is_blue), cut.rows(is_yellow)];
    let mut rows = [blue, yellow].map(|rows| rows.expect("both pieces are seen"));
    rows.sort_unstable();
    let [[_, end], [begin, _]] = rows;
    assert!(
        end.abs_diff(y) < SNAP && begin.abs_diff(y) < SNAP,
        "{rows:?} are not cut along row {y}"
    );
    driver.key('z');
    driver.wait(|driver| (driver.view().count(is_yellow) == 0).then_some(()));
}

/// Opens a window with the ball at its initial position, paused.
fn paused(display: &Display) -> (WindowDriver, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a folder");
    let driver = WindowDriver::start(display, folder.path(), &[]);
    driver.key(' ');
    driver.key('r');
    (driver, folder)
}

pub(crate) fn a_resized_window(display: &Display) {
    let (mut driver, _folder) = paused(display);
    for size in [[1200, 850], [640, 480], [1000, 400]] {
        driver.resize(size);
        assert_fills_and_is_cut(&mut driver);
    }
    // The smallest size, then minimized.
    driver.resize([1, 1]);
    std::thread::sleep(Duration::from_millis(500));
    driver.hide();
    std::thread::sleep(Duration::from_millis(500));
    driver.show();
    driver.resize([800, 600]);
    driver.key('f');
    assert_fills_and_is_cut(&mut driver);
    driver.quit();
}

/// Turns the mouse wheel.
fn wheel(driver: &WindowDriver, at: [u16; 2], is_down: bool, notches: usize) {
    let button = if is_down { 5 } else { 4 };
    driver.input(MOTION_NOTIFY_EVENT, 0, at);
    for _ in 0..notches {
        driver.input(BUTTON_PRESS_EVENT, button, [0, 0]);
        driver.input(BUTTON_RELEASE_EVENT, button, [0, 0]);
    }
}

/// Maximum number of pixels that change with the times in the panel, which every frame updates.
const CHANGING_PIXELS: usize = 900;

/// Returns a screenshot of the panel after it has stopped scrolling.
fn panel(driver: &mut WindowDriver) -> Screenshot {
    let mut last = driver.columns(driver.view_width(), PANEL);
    driver.wait(|driver| {
        std::thread::sleep(Duration::from_millis(300));
        let now = driver.columns(driver.view_width(), PANEL);
        let before = std::mem::replace(&mut last, now);
        (last.difference(&before) < CHANGING_PIXELS).then_some(())
    });
    last
}

pub(crate) fn a_panel_that_is_too_high(display: &Display) {
    let (mut driver, _folder) = paused(display);
    let over = [driver.view_width() + PANEL / 2, 400];
    // A control beneath the pointer is explained by a tooltip, which covers others.
    let beside = [20, 20];
    driver.input(MOTION_NOTIFY_EVENT, 0, beside);
    let (first, view) = (panel(&mut driver), driver.view());
    wheel(&driver, over, true, 10);
    driver.wait(|driver| {
        let now = driver.columns(driver.view_width(), PANEL);
        (now.difference(&first) > 4 * CHANGING_PIXELS).then_some(())
    });
    // Scrolling ends at the end of the panel.
    wheel(&driver, over, true, 60);
    let last = panel(&mut driver);
    wheel(&driver, over, true, 10);
    assert!(
        panel(&mut driver).difference(&last) < CHANGING_PIXELS,
        "it scrolls beyond its end"
    );
    assert_eq!(
        driver.view().difference(&view),
        0,
        "the wheel over the panel does not change the view"
    );
    wheel(&driver, over, false, 80);
    // The wheel turns what is beneath the pointer when the window handles it.
    panel(&mut driver);
    driver.input(MOTION_NOTIFY_EVENT, 0, beside);
    driver.wait(|driver| {
        let now = driver.columns(driver.view_width(), PANEL);
        (now.difference(&first) < CHANGING_PIXELS).then_some(())
    });
    driver.quit();
}
