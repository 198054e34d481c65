//! A virtual X display (Xvfb) for the window tests.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

/// Size of the screen \[px\], larger than the initial window.
pub(super) const SCREEN: [u16; 2] = [1280, 900];

/// Reason for an ignored or failed test.
pub(super) const NO_XVFB: &str = "Xvfb is not installed; on Debian install xvfb";

/// Returns true if Xvfb is installed.
pub(super) fn has_xvfb() -> bool {
    let version = Command::new("Xvfb")
        .arg("-help")
        .stderr(Stdio::null())
        .status();
    version.is_ok_and(|status| status.success())
}

/// A running Xvfb server, which ends with the test.
pub(super) struct Display {
    server: Child,
    pub(super) name: String,
}

impl Display {
    /// Starts a server on a free display number.
    pub(super) fn start() -> Option<Self> {
        let screen = format!("{}x{}x24", SCREEN[0], SCREEN[1]);
        let mut server = Command::new("Xvfb")
            .args([
                "-displayfd",
                "1",
                "-screen",
                "0",
                &screen,
                "-nolisten",
                "tcp",
                // Otherwise the server resets when its last client disconnects, and refuses new
                // clients meanwhile.
                "-noreset",
            ])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .ok()?;
        let mut number = String::new();
        let output = server.stdout.take().map(BufReader::new);
        output?.read_line(&mut number).ok()?;
        let name = format!(":{}", number.trim());
        Some(Self { server, name })
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}
