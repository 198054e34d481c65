//! When there is no window.

use crate::display::Display;
use std::process::Command;

/// What the program says when it cannot open a window.
fn refusal(change: impl FnOnce(&mut Command) -> &mut Command) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_incise"));
    command.args(["view", "Sphere80"]);
    command
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET");
    let output = change(&mut command).output().expect("the program starts");
    assert_eq!(output.status.code(), Some(1));
    String::from_utf8_lossy(&output.stderr).into_owned()
}

pub(super) fn without_display() {
    for said in [
        refusal(|command| command.env_remove("DISPLAY")),
        refusal(|command| command.env("DISPLAY", ":98765")),
    ] {
        assert!(said.starts_with("incise: there is no display"), "{said}");
        assert!(said.contains("DISPLAY"), "{said}");
    }
}

pub(super) fn without_driver(display: &Display) {
    let said = refusal(|command| {
        let none = [
            ("VK_DRIVER_FILES", "/nowhere.json"),
            ("VK_ICD_FILENAMES", "/nowhere.json"),
        ];
        command.env("DISPLAY", &display.name).envs(none)
    });
    assert!(said.contains("mesa-vulkan-drivers"), "{said}");
}

pub(super) fn driver_without_windows(display: &Display) {
    let said = refusal(|command| {
        command
            .args(["--adapter", "SwiftShader"])
            .env("DISPLAY", &display.name)
    });
    assert!(
        said.contains("SwiftShader") && said.contains("incise devices"),
        "{said}"
    );
}
