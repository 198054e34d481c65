//! A display that nobody sees.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

/// How large the screen is: larger than windows are at first.
pub(super) const SCREEN: [u16; 2] = [1280, 900];

pub(super) const NO_XVFB: &str = "there is no Xvfb; on Debian install xvfb";

pub(super) fn has_xvfb() -> bool {
    let asked = Command::new("Xvfb")
        .arg("-version")
        .stderr(Stdio::null())
        .status();
    asked.is_ok_and(|status| status.success())
}

/// A display of its own. Ends with the test.
pub(super) struct Display {
    server: Child,
    pub(super) name: String,
}

impl Display {
    /// A server that chooses a number that nobody has, and says which.
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
                // Else it begins anew when its last client goes, and refuses those that come meanwhile.
                "-noreset",
            ])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .ok()?;
        let mut number = String::new();
        let said = server.stdout.take().map(BufReader::new);
        said?.read_line(&mut number).ok()?;
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
