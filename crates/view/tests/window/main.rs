//! Tests of `incise-view` in a window on a virtual display, with simulated mouse and keyboard.

#![expect(
    clippy::missing_assert_message,
    reason = "these are tests, which the lint knows by an attribute only"
)]

mod resizing;
mod screenshot;
mod startup_errors;
mod virtual_display;
mod window_driver;

use incise_test_support::gpu::{Needs, trial};
use libtest_mimic::{Completion, Failed, Trial};
use screenshot::{is_blue, is_red, is_yellow};
use startup_errors::{driver_without_windows, without_display, without_driver};
use std::process::ExitCode;
use std::time::Duration;
use virtual_display::{Display, NO_XVFB, has_xvfb};
use window_driver::WindowDriver;
use x11rb::protocol::xproto::{BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, MOTION_NOTIFY_EVENT};

fn main() -> ExitCode {
    let any = Needs::AnyDevice;
    let trials = vec![
        on_display(
            "a_line_across_the_view_makes_two_pieces",
            a_line_makes_two_pieces,
        ),
        long(on_display(
            "a_gpu_body_is_cut_and_drawn_without_readback",
            a_body_on_a_device,
        )),
        on_display(
            "a_held_blade_cuts_and_a_vertex_is_pulled",
            a_blade_and_a_vertex,
        ),
        on_display(
            "a_drag_with_the_right_button_rotates_the_view",
            the_view_turns,
        ),
        on_display(
            "pieces_and_recordings_are_saved_and_replayed",
            a_replay_is_the_same,
        ),
        on_display("without_the_panel_a_message_is_in_the_corner", an_error),
        long(on_display("a_pinned_body_hangs", a_pin)),
        on_display(
            "a_resized_window_is_filled_and_cut_where_the_pointer_is",
            resizing::a_resized_window,
        ),
        on_display("a_high_panel_scrolls", resizing::a_panel_that_is_too_high),
        trial("without_a_display_there_is_no_window", any, |_| {
            without_display()
        }),
        on_display("without_a_driver_there_is_no_window", without_driver),
        on_display_with(
            "an_adapter_that_cannot_present_is_not_opened",
            Needs::Strict,
            driver_without_windows,
        ),
    ];
    incise_test_support::gpu::run(trials)
}

/// Marks a long test, which `.ci/full` runs.
fn long(trial: Trial) -> Trial {
    trial.with_kind("long").with_ignored_flag(true)
}

/// Creates a test that needs a display and a GPU that can present to it.
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

/// The view is drawn from the solver's GPU buffers, without readback.
fn a_body_on_a_device(display: &Display) {
    slice(display, &["--backend", "gpu"]);
}

fn slice(display: &Display, more: &[&str]) {
    let folder = tempfile::tempdir().expect("a folder");
    let mut driver = WindowDriver::start(display, folder.path(), more);
    let whole = driver.view();
    assert_eq!((whole.count(is_yellow), whole.count(is_red)), (0, 0));
    // The line descends to the right through the upper part of the ball, so that the upper piece
    // slides off.
    driver.drag(1, [20, 230], [490, 330]);
    driver.wait(|driver| {
        let cut = driver.view();
        (cut.count(is_yellow) > 1500 && cut.count(is_blue) > 1500).then_some(())
    });
    driver.wait(|driver| (driver.view().count(is_red) > 60).then_some(()));
    let cut = driver.view();
    assert!(
        cut.mean_row(is_yellow).abs_diff(cut.mean_row(is_blue)) > 20,
        "one piece is above the other"
    );
    driver.key('z');
    driver.wait(|driver| (driver.view().count(is_yellow) == 0).then_some(()));
    driver.key('y');
    driver.wait(|driver| (driver.view().count(is_yellow) > 500).then_some(()));
    driver.quit();
}

fn a_blade_and_a_vertex(display: &Display) {
    let folder = tempfile::tempdir().expect("a folder");
    let mut driver = WindowDriver::start(display, folder.path(), &[]);
    driver.key('3');
    let before = driver.view();
    // The ball falls when it is released, so it is observed during the drag.
    driver.input(MOTION_NOTIFY_EVENT, 0, [250, 350]);
    driver.input(BUTTON_PRESS_EVENT, 1, [0, 0]);
    // The soft ball hangs below the dragged vertex, which pulls its skin up.
    driver.input(MOTION_NOTIFY_EVENT, 0, [250, 60]);
    driver.wait(|driver| {
        let now = driver.view();
        let is_higher = now.mean_row(is_blue) < before.mean_row(is_blue);
        (is_higher && now.difference(&before) > 1000).then_some(())
    });
    driver.input(BUTTON_RELEASE_EVENT, 1, [0, 0]);
    driver.key('r');
    driver.key('2');
    driver.drag(1, [20, 230], [490, 330]);
    driver.wait(|driver| (driver.view().count(is_yellow) > 1000).then_some(()));
    driver.quit();
}

fn the_view_turns(display: &Display) {
    let folder = tempfile::tempdir().expect("a folder");
    let mut driver = WindowDriver::start(display, folder.path(), &[]);
    driver.key(' ');
    std::thread::sleep(Duration::from_secs(2));
    let before = driver.view();
    driver.drag(3, [200, 300], [300, 320]);
    let turned = driver.wait(|driver| {
        let now = driver.view();
        (now.difference(&before) > 3000).then_some(now)
    });
    assert_eq!(turned.count(is_yellow), 0, "nothing is cut");
    assert!(turned.count(is_blue) > 8000, "the ball is still visible");
    // Edges of triangles are dark.
    let dark = |[r, g, b]: [u8; 3]| r < 60 && g < 70 && b < 80;
    let plain = driver.view().count(dark);
    driver.key('w');
    driver.wait(|driver| (driver.view().count(dark) > plain + 500).then_some(()));
    driver.quit();
}

fn a_replay_is_the_same(display: &Display) {
    let folder = tempfile::tempdir().expect("a folder");
    let mut driver = WindowDriver::start(display, folder.path(), &["--backend", "cpu"]);
    driver.drag(1, [20, 230], [490, 330]);
    driver.wait(|driver| (driver.view().count(is_yellow) > 1000).then_some(()));
    driver.key(' ');
    driver.key('s');
    driver.key('o');
    let recording = folder.path().join("recording.jsonl");
    driver.wait(|_| {
        let text = std::fs::read_to_string(&recording).ok()?;
        text.lines().last()?.contains("state").then_some(())
    });
    driver.quit();
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
    let mut driver = WindowDriver::start(display, folder.path(), &more);
    driver.wait(|driver| (driver.view().count(is_yellow) > 1000).then_some(()));
    // The replay stops at the end of the recording. Its own recording is equal only if all bits of
    // the final state are.
    let again = folder.path().join("again.jsonl");
    let first = std::fs::read_to_string(&recording).expect("a recording");
    driver.wait(|driver| {
        driver.key('o');
        std::thread::sleep(Duration::from_millis(500));
        (std::fs::read_to_string(&again).ok()? == first).then_some(())
    });
    driver.quit();
}

fn an_error(display: &Display) {
    let folder = tempfile::tempdir().expect("a folder");
    // The recording cannot be saved.
    std::fs::create_dir(folder.path().join("recording.jsonl")).expect("a folder");
    let mut driver = WindowDriver::start(display, folder.path(), &[]);
    driver.key('h');
    driver.key('o');
    let height = usize::from(window_driver::SIZE[1]);
    driver.wait(|driver| {
        let seen = driver.view();
        let [first, _] = seen.rows(is_red)?;
        (first + 80 > height && seen.count(is_red) > 100).then_some(())
    });
    driver.quit();
}

fn a_pin(display: &Display) {
    let folder = tempfile::tempdir().expect("a folder");
    let mut driver = WindowDriver::start(display, folder.path(), &[]);
    // The initial position, above the ground.
    driver.key(' ');
    driver.key('r');
    let mut last = 0;
    let first = driver.wait(|driver| {
        let now = driver.view().mean_row(is_blue);
        (std::mem::replace(&mut last, now) == now).then_some(now)
    });
    let [top, _] = driver.view().rows(is_blue).expect("the ball is seen");
    let [x, _] = driver.view().center(is_blue);
    let at = [x, top + 6].map(|c| u16::try_from(c).expect("on the screen"));
    driver.key('4');
    driver.input(MOTION_NOTIFY_EVENT, 0, at);
    driver.input(BUTTON_PRESS_EVENT, 1, [0, 0]);
    driver.input(BUTTON_RELEASE_EVENT, 1, [0, 0]);
    driver.key(' ');
    for _ in 0..60 {
        let now = driver.view().mean_row(is_blue);
        assert!(now.abs_diff(first) < 30, "from {first} to {now}");
        std::thread::sleep(Duration::from_millis(50));
    }
    driver.key('u');
    driver.wait(|driver| (driver.view().mean_row(is_blue) > first + 40).then_some(()));
    driver.quit();
}
