//! The binary's `view`, in a real window on a display that nobody sees, driven by a mouse that nobody holds.

#![expect(
    clippy::missing_assert_message,
    reason = "these are tests, which the lint knows by an attribute only"
)]

mod display;
#[path = "../../../pbd-gpu/tests/common/gpu.rs"]
mod gpu;
mod pixels;
mod refusals;
mod seat;
mod sized;

use display::{Display, NO_XVFB, has_xvfb};
use gpu::{Needs, trial};
use libtest_mimic::{Completion, Failed, Trial};
use pixels::{is_blue, is_red, is_yellow};
use refusals::{driver_without_windows, without_display, without_driver};
use seat::Seat;
use std::process::ExitCode;
use std::time::Duration;
use x11rb::protocol::xproto::{BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, MOTION_NOTIFY_EVENT};

fn main() -> ExitCode {
    let any = Needs::AnyDevice;
    let trials = vec![
        on_display(
            "a_line_across_the_view_makes_two_pieces",
            a_line_makes_two_pieces,
        ),
        on_display(
            "a_body_on_a_device_is_cut_and_drawn_there",
            a_body_on_a_device,
        ),
        on_display(
            "a_held_blade_cuts_and_a_vertex_is_pulled",
            a_blade_and_a_vertex,
        ),
        on_display(
            "a_drag_with_the_right_button_turns_the_view",
            the_view_turns,
        ),
        on_display(
            "pieces_and_recordings_are_saved_and_replayed",
            a_replay_is_the_same,
        ),
        on_display(
            "without_the_panel_a_refusal_stands_in_the_corner",
            a_refusal,
        ),
        on_display("a_pinned_body_hangs", a_pin),
        on_display("the_paper_s_method_cuts_too", the_other_method),
        on_display(
            "a_resized_window_is_filled_and_cut_where_the_pointer_is",
            sized::a_resized_window,
        ),
        on_display(
            "all_of_the_panel_can_be_reached",
            sized::a_panel_that_is_too_high,
        ),
        trial("without_a_display_there_is_no_window", any, |_| {
            without_display()
        }),
        on_display("without_a_driver_there_is_no_window", without_driver),
        on_display_with(
            "a_driver_that_crashes_at_windows_is_not_asked",
            Needs::Strict,
            driver_without_windows,
        ),
    ];
    gpu::run(trials)
}

/// A test that needs a display, and a device that draws on it.
fn on_display(name: &str, test: fn(&Display)) -> Trial {
    on_display_with(name, Needs::AnyDevice, test)
}

fn on_display_with(name: &str, needs: Needs, test: fn(&Display)) -> Trial {
    let with_device = trial(name, needs, move |_| match Display::start() {
        Some(display) => test(&display),
        None => panic!("{NO_XVFB}"),
    });
    let required = std::env::var("INCISE_REQUIRE_GPU").unwrap_or_default();
    if has_xvfb() || !["", "0"].contains(&required.as_str()) {
        return with_device;
    }
    Trial::ignorable_test(name, || Ok::<_, Failed>(Completion::ignored_with(NO_XVFB)))
}

fn a_line_makes_two_pieces(display: &Display) {
    slice(display, &[]);
}

/// The picture is drawn from where the device has the body.
fn a_body_on_a_device(display: &Display) {
    slice(display, &["--backend", "gpu"]);
}

fn slice(display: &Display, more: &[&str]) {
    let folder = tempfile::tempdir().expect("a folder");
    let mut seat = Seat::start(display, folder.path(), more);
    let whole = seat.look();
    assert_eq!((whole.count(is_yellow), whole.count(is_red)), (0, 0));
    // From the left to the right of the ball, through its upper part, and lower on the right: the upper piece slides off.
    seat.drag(1, [20, 230], [490, 330]);
    seat.wait(|seat| {
        let cut = seat.look();
        (cut.count(is_yellow) > 1500 && cut.count(is_blue) > 1500).then_some(())
    });
    seat.wait(|seat| (seat.look().count(is_red) > 60).then_some(()));
    let cut = seat.look();
    assert!(
        cut.height(is_yellow).abs_diff(cut.height(is_blue)) > 20,
        "one lies on the other"
    );
    seat.key('z');
    seat.wait(|seat| (seat.look().count(is_yellow) == 0).then_some(()));
    seat.key('y');
    seat.wait(|seat| (seat.look().count(is_yellow) > 500).then_some(()));
    seat.quit();
}

fn a_blade_and_a_vertex(display: &Display) {
    let folder = tempfile::tempdir().expect("a folder");
    let mut seat = Seat::start(display, folder.path(), &[]);
    seat.key('3');
    let before = seat.look().height(is_blue);
    // It falls when it is let go, so it is looked at while it is held.
    seat.input(MOTION_NOTIFY_EVENT, 0, [250, 350]);
    seat.input(BUTTON_PRESS_EVENT, 1, [0, 0]);
    // The ball hangs below the vertex that is held.
    seat.input(MOTION_NOTIFY_EVENT, 0, [250, 60]);
    seat.wait(|seat| (seat.look().height(is_blue) + 60 < before).then_some(()));
    seat.input(BUTTON_RELEASE_EVENT, 1, [0, 0]);
    seat.key('r');
    seat.key('2');
    seat.drag(1, [20, 230], [490, 330]);
    seat.wait(|seat| (seat.look().count(is_yellow) > 1000).then_some(()));
    seat.quit();
}

fn the_view_turns(display: &Display) {
    let folder = tempfile::tempdir().expect("a folder");
    let mut seat = Seat::start(display, folder.path(), &[]);
    seat.key(' ');
    std::thread::sleep(Duration::from_secs(2));
    let before = seat.look();
    seat.drag(3, [200, 300], [300, 320]);
    let turned = seat.wait(|seat| {
        let now = seat.look();
        (now.differ(&before) > 3000).then_some(now)
    });
    assert_eq!(turned.count(is_yellow), 0, "nothing is cut");
    assert!(
        turned.count(is_blue) > 8000,
        "the ball is in the picture still"
    );
    // Edges of triangles are dark.
    let dark = |[r, g, b]: [u8; 3]| r < 60 && g < 70 && b < 80;
    let plain = seat.look().count(dark);
    seat.key('w');
    seat.wait(|seat| (seat.look().count(dark) > plain + 500).then_some(()));
    seat.quit();
}

fn a_replay_is_the_same(display: &Display) {
    let folder = tempfile::tempdir().expect("a folder");
    let mut seat = Seat::start(display, folder.path(), &["--backend", "cpu"]);
    seat.drag(1, [20, 230], [490, 330]);
    seat.wait(|seat| (seat.look().count(is_yellow) > 1000).then_some(()));
    seat.key(' ');
    seat.key('s');
    seat.key('o');
    let recording = folder.path().join("recording.jsonl");
    seat.wait(|_| {
        let text = std::fs::read_to_string(&recording).ok()?;
        text.lines().last()?.contains("state").then_some(())
    });
    seat.quit();
    for piece in ["piece_000.obj", "piece_001.obj"] {
        assert!(folder.path().join("pieces").join(piece).exists(), "{piece}");
    }
    let more = [
        "--backend",
        "cpu",
        "--replay",
        "recording.jsonl",
        "--record",
        "again.jsonl",
    ];
    let mut seat = Seat::start(display, folder.path(), &more);
    seat.wait(|seat| (seat.look().count(is_yellow) > 1000).then_some(()));
    // The replay stops where the recording does; what is saved then ends alike only if all bits do.
    let again = folder.path().join("again.jsonl");
    let first = std::fs::read_to_string(&recording).expect("a recording");
    seat.wait(|seat| {
        seat.key('o');
        std::thread::sleep(Duration::from_millis(500));
        (std::fs::read_to_string(&again).ok()? == first).then_some(())
    });
    seat.quit();
}

fn a_refusal(display: &Display) {
    let folder = tempfile::tempdir().expect("a folder");
    let mut seat = Seat::start(display, folder.path(), &[]);
    seat.key('h');
    // From beside the ball into it. What says so is red, as the line is while it is drawn, and as a cap would be.
    seat.drag(1, [20, 250], [400, 300]);
    let height = usize::from(seat::SIZE[1]);
    let seen = seat.wait(|seat| {
        let seen = seat.look();
        let [first, _] = seen.rows(is_red)?;
        (first + 80 > height && seen.count(is_red) > 100).then_some(seen)
    });
    // Letters have a few pixels of any warm color, a piece has thousands.
    assert!(seen.count(is_yellow) < 200, "nothing is cut");
    seat.quit();
}

fn a_pin(display: &Display) {
    let folder = tempfile::tempdir().expect("a folder");
    let mut seat = Seat::start(display, folder.path(), &[]);
    // At its first place, above the ground.
    seat.key(' ');
    seat.key('r');
    let mut last = 0;
    let first = seat.wait(|seat| {
        let now = seat.look().height(is_blue);
        (std::mem::replace(&mut last, now) == now).then_some(now)
    });
    let [top, _] = seat.look().rows(is_blue).expect("the ball is seen");
    let [x, _] = seat.look().center(is_blue);
    let at = [x, top + 6].map(|c| u16::try_from(c).expect("on the screen"));
    seat.key('4');
    seat.input(MOTION_NOTIFY_EVENT, 0, at);
    seat.input(BUTTON_PRESS_EVENT, 1, [0, 0]);
    seat.input(BUTTON_RELEASE_EVENT, 1, [0, 0]);
    seat.key(' ');
    for _ in 0..60 {
        let now = seat.look().height(is_blue);
        assert!(now.abs_diff(first) < 30, "from {first} to {now}");
        std::thread::sleep(Duration::from_millis(50));
    }
    seat.key('u');
    seat.wait(|seat| (seat.look().height(is_blue) > first + 40).then_some(()));
    seat.quit();
}

fn the_other_method(display: &Display) {
    let folder = tempfile::tempdir().expect("a folder");
    let mut seat = Seat::start(display, folder.path(), &[]);
    seat.key('m');
    seat.drag(1, [20, 230], [490, 330]);
    seat.wait(|seat| {
        let cut = seat.look();
        (cut.count(is_yellow) > 1500 && cut.count(is_blue) > 1500).then_some(())
    });
    seat.wait(|seat| (seat.look().count(is_red) > 60).then_some(()));
    seat.key('o');
    let recording = folder.path().join("recording.jsonl");
    let said = seat.wait(|_| {
        let text = std::fs::read_to_string(&recording).ok()?;
        text.lines().last()?.contains("state").then_some(text)
    });
    let at = |text: &str| {
        said.find(text)
            .unwrap_or_else(|| panic!("no {text} in {said}"))
    };
    assert!(at("\"rebuild\"") < at("\"slice\""), "{said}");
    seat.quit();
}
