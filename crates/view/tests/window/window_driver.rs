//! [`WindowDriver`]: runs `incise-view`, sends input events and takes screenshots.

use crate::screenshot::{Screenshot, is_blue};
use crate::virtual_display::Display;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, ConfigureWindowAux, ConnectionExt, ImageFormat,
    InputFocus, KEY_PRESS_EVENT, KEY_RELEASE_EVENT, MOTION_NOTIFY_EVENT, Window,
};
use x11rb::protocol::xtest::ConnectionExt as XTest;
use x11rb::rust_connection::RustConnection;

/// Initial size of the window, and the width of the panel at its right side \[px\].
pub(super) const SIZE: [u16; 2] = [800, 600];
pub(super) const PANEL: u16 = 292;

/// Time limit of every wait: software rendering beside other tests is slow.
pub(super) const TIMEOUT: Duration = Duration::from_secs(120);

/// A running `incise-view`, controlled through X11 events.
pub(super) struct WindowDriver {
    pub(super) program: Child,
    x: RustConnection,
    root: Window,
    window: Window,
    size: [u16; 2],
}

impl WindowDriver {
    /// Starts the program and waits until it shows the body.
    pub(super) fn start(display: &Display, folder: &Path, more: &[&str]) -> Self {
        let size = format!("{}x{}", SIZE[0], SIZE[1]);
        let program = Command::new(env!("CARGO_BIN_EXE_incise-view"))
            .args(["Sphere768", "--size", &size])
            .args(more)
            .current_dir(folder)
            .env("DISPLAY", &display.name)
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET")
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let (x, screen) = x11rb::connect(Some(&display.name)).expect("a display");
        let root = x.setup().roots[screen].root;
        let mut driver = Self {
            program,
            x,
            root,
            window: root,
            size: SIZE,
        };
        driver.window = driver.wait(|driver| {
            let children = driver
                .x
                .query_tree(driver.root)
                .ok()?
                .reply()
                .ok()?
                .children;
            children.into_iter().find(|&window| {
                let shape = driver
                    .x
                    .get_geometry(window)
                    .ok()
                    .and_then(|c| c.reply().ok());
                shape.is_some_and(|shape| [shape.width, shape.height] == SIZE)
            })
        });
        driver.focus();
        driver.wait(|driver| (driver.view().count(is_blue) > 8000).then_some(()));
        driver
    }

    /// Waits until the condition returns a value, and returns it.
    pub(super) fn wait<T>(&mut self, mut found: impl FnMut(&mut Self) -> Option<T>) -> T {
        let begin = Instant::now();
        loop {
            if let Some(found) = found(self) {
                return found;
            }
            if let Ok(Some(status)) = self.program.try_wait() {
                let mut message = String::new();
                let error = self.program.stderr.take();
                let _ = error.map(|mut e| std::io::Read::read_to_string(&mut e, &mut message));
                panic!("the program ended with {status}: {message}");
            }
            assert!(begin.elapsed() < TIMEOUT, "timeout");
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Sends an input event.
    pub(super) fn input(&self, kind: u8, detail: u8, at: [u16; 2]) {
        let [x, y] = at.map(|c| i16::try_from(c).expect("on the screen"));
        let sent = self.x.xtest_fake_input(kind, detail, 0, self.root, x, y, 0);
        sent.expect("a display").check().expect("XTest");
    }

    /// Drags with a button in ten steps.
    pub(super) fn drag(&self, button: u8, from: [u16; 2], to: [u16; 2]) {
        self.input(MOTION_NOTIFY_EVENT, 0, from);
        self.input(BUTTON_PRESS_EVENT, button, [0, 0]);
        for i in 1..=10 {
            let at = [0, 1].map(|k| (from[k] * (10 - i) + to[k] * i) / 10);
            self.input(MOTION_NOTIFY_EVENT, 0, at);
            std::thread::sleep(Duration::from_millis(30));
        }
        self.input(BUTTON_RELEASE_EVENT, button, [0, 0]);
    }

    /// Presses the key of a character that needs no Shift.
    pub(super) fn key(&self, character: char) {
        let setup = self.x.setup();
        let (low, high) = (setup.min_keycode, setup.max_keycode);
        let map = self.x.get_keyboard_mapping(low, high - low + 1);
        let map = map.expect("a display").reply().expect("a keyboard");
        let per_key = usize::from(map.keysyms_per_keycode);
        let firsts = map.keysyms.chunks(per_key).map(|symbols| symbols[0]);
        let code = (low..=high)
            .zip(firsts)
            .find(|&(_, s)| s == u32::from(character));
        let (code, _) = code.expect("the keyboard has the key");
        self.input(KEY_PRESS_EVENT, code, [0, 0]);
        self.input(KEY_RELEASE_EVENT, code, [0, 0]);
    }

    /// Resizes the window.
    pub(super) fn resize(&mut self, size: [u16; 2]) {
        let [width, height] = size.map(u32::from);
        let shape = ConfigureWindowAux::new().width(width).height(height);
        let request = self.x.configure_window(self.window, &shape);
        request.expect("a display").check().expect("a window");
        self.size = size;
    }

    /// Unmaps the window, as minimizing does.
    pub(super) fn hide(&self) {
        let request = self.x.unmap_window(self.window);
        request.expect("a display").check().expect("a window");
    }

    /// Maps the window again.
    pub(super) fn show(&mut self) {
        let request = self.x.map_window(self.window);
        request.expect("a display").check().expect("a window");
        self.focus();
    }

    /// Sets the keyboard focus, since there is no window manager, and waits until it is accepted.
    fn focus(&mut self) {
        self.wait(|driver| {
            let focus = driver
                .x
                .set_input_focus(InputFocus::PARENT, driver.window, 0_u32);
            focus.ok()?.check().ok()
        });
    }

    /// Returns the width of the view beside the panel \[px\].
    pub(super) fn view_width(&self) -> u16 {
        self.size[0] - PANEL
    }

    /// Returns a screenshot of the view beside the panel.
    pub(super) fn view(&self) -> Screenshot {
        self.columns(0, self.view_width() - 4)
    }

    /// Returns a screenshot of `width` columns of the window.
    pub(super) fn columns(&self, from: u16, width: u16) -> Screenshot {
        let (height, from) = (self.size[1], i16::try_from(from).expect("on the screen"));
        let (x, format) = (&self.x, ImageFormat::Z_PIXMAP);
        let image = x.get_image(format, self.root, from, 0, width, height, !0);
        let image = image.expect("a display").reply().expect("a screenshot");
        let pixels = image.data.as_chunks::<4>().0.iter();
        let screenshot = Screenshot {
            width: usize::from(width),
            colors: pixels.map(|&[b, g, r, _]| [r, g, b]).collect(),
        };
        assert_eq!(
            screenshot.colors.len(),
            screenshot.width * usize::from(height)
        );
        screenshot
    }

    /// Quits with the key q and asserts success.
    pub(super) fn quit(mut self) {
        self.key('q');
        let begin = Instant::now();
        loop {
            if let Some(status) = self.program.try_wait().expect("a child") {
                assert_eq!(status.code(), Some(0));
                return;
            }
            assert!(begin.elapsed() < TIMEOUT, "the program does not quit");
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

impl Drop for WindowDriver {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}
