//! Tests of the errors of `incise-view` without a display or a suitable GPU driver.

use crate::virtual_display::Display;
use std::process::Command;

/// Returns the error of a run that cannot open a window.
fn error_of(change: impl FnOnce(&mut Command) -> &mut Command) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_incise-view"));
    command.args(["Sphere80"]);
    command
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET");
    let output = change(&mut command).output().expect("the program starts");
    assert_eq!(output.status.code(), Some(1));
    String::from_utf8_lossy(&output.stderr).into_owned()
}

pub(super) fn without_display() {
    for error in [
        error_of(|command| command.env_remove("DISPLAY")),
        error_of(|command| command.env("DISPLAY", ":98765")),
    ] {
        assert!(
            error.starts_with("incise-view: no display found"),
            "{error}"
        );
        assert!(error.contains("DISPLAY"), "{error}");
    }
}

pub(super) fn without_driver(display: &Display) {
    let error = error_of(|command| {
        let none = [
            ("VK_DRIVER_FILES", "/nowhere.json"),
            ("VK_ICD_FILENAMES", "/nowhere.json"),
        ];
        command.env("DISPLAY", &display.name).envs(none)
    });
    assert!(error.contains("mesa-vulkan-drivers"), "{error}");
}

pub(super) fn driver_without_windows(display: &Display) {
    let error = error_of(|command| {
        command
            .args(["--adapter", "SwiftShader"])
            .env("DISPLAY", &display.name)
    });
    assert!(
        error.contains("SwiftShader") && error.contains("incise devices"),
        "{error}"
    );
}
