//! The program in its window, and somebody in front of it.

use crate::display::Display;
use crate::pixels::{Pixels, is_blue};
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

/// The window at first, and how much of its right side is the panel's.
pub(super) const SIZE: [u16; 2] = [800, 600];
pub(super) const PANEL: u16 = 292;

/// How long anything may take: software that draws beside other tests is slow.
pub(super) const PATIENCE: Duration = Duration::from_secs(120);

/// The program in its window, and somebody in front of it.
pub(super) struct Seat {
    pub(super) program: Child,
    x: RustConnection,
    root: Window,
    window: Window,
    size: [u16; 2],
}

impl Seat {
    pub(super) fn start(display: &Display, folder: &Path, more: &[&str]) -> Self {
        let size = format!("{}x{}", SIZE[0], SIZE[1]);
        let program = Command::new(env!("CARGO_BIN_EXE_incise"))
            .args(["view", "Sphere768", "--size", &size])
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
        let mut seat = Self {
            program,
            x,
            root,
            window: root,
            size: SIZE,
        };
        seat.window = seat.wait(|seat| {
            let children = seat.x.query_tree(seat.root).ok()?.reply().ok()?.children;
            children.into_iter().find(|&window| {
                let shape = seat
                    .x
                    .get_geometry(window)
                    .ok()
                    .and_then(|c| c.reply().ok());
                shape.is_some_and(|shape| [shape.width, shape.height] == SIZE)
            })
        });
        seat.focus();
        seat.wait(|seat| (seat.look().count(is_blue) > 8000).then_some(()));
        seat
    }

    /// Waits until something is so.
    pub(super) fn wait<T>(&mut self, mut found: impl FnMut(&mut Self) -> Option<T>) -> T {
        let begin = Instant::now();
        loop {
            if let Some(found) = found(self) {
                return found;
            }
            if let Ok(Some(status)) = self.program.try_wait() {
                let mut said = String::new();
                let error = self.program.stderr.take();
                let _ = error.map(|mut e| std::io::Read::read_to_string(&mut e, &mut said));
                panic!("the program ended with {status}: {said}");
            }
            assert!(begin.elapsed() < PATIENCE, "it does not come");
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    pub(super) fn input(&self, kind: u8, detail: u8, at: [u16; 2]) {
        let [x, y] = at.map(|c| i16::try_from(c).expect("on the screen"));
        let sent = self.x.xtest_fake_input(kind, detail, 0, self.root, x, y, 0);
        sent.expect("a display").check().expect("XTest");
    }

    /// Presses a button, goes there in steps as a hand does, and lets go.
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

    /// Presses the key that gives this character without Shift.
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

    /// Gives the window another size, as somebody who pulls at its corner does.
    pub(super) fn resize(&mut self, size: [u16; 2]) {
        let [width, height] = size.map(u32::from);
        let shape = ConfigureWindowAux::new().width(width).height(height);
        let asked = self.x.configure_window(self.window, &shape);
        asked.expect("a display").check().expect("a window");
        self.size = size;
    }

    /// Takes the window out of sight.
    pub(super) fn hide(&self) {
        let asked = self.x.unmap_window(self.window);
        asked.expect("a display").check().expect("a window");
    }

    /// Brings it back.
    pub(super) fn show(&mut self) {
        let asked = self.x.map_window(self.window);
        asked.expect("a display").check().expect("a window");
        self.focus();
    }

    /// Gives it the keyboard: there is no window manager to do so. It takes no key before it is mapped.
    fn focus(&mut self) {
        self.wait(|seat| {
            let focus = seat
                .x
                .set_input_focus(InputFocus::PARENT, seat.window, 0_u32);
            focus.ok()?.check().ok()
        });
    }

    /// How wide the picture beside the panel is.
    pub(super) fn width(&self) -> u16 {
        self.size[0] - PANEL
    }

    /// The picture beside the panel.
    pub(super) fn look(&self) -> Pixels {
        self.look_at(0, self.width() - 4)
    }

    /// All rows of the window from a column on.
    pub(super) fn look_at(&self, from: u16, width: u16) -> Pixels {
        let (height, from) = (self.size[1], i16::try_from(from).expect("on the screen"));
        let (x, format) = (&self.x, ImageFormat::Z_PIXMAP);
        let image = x.get_image(format, self.root, from, 0, width, height, !0);
        let image = image.expect("a display").reply().expect("a picture");
        let pixels = image.data.as_chunks::<4>().0.iter();
        let picture = Pixels {
            width: usize::from(width),
            colors: pixels.map(|&[b, g, r, _]| [r, g, b]).collect(),
        };
        assert_eq!(picture.colors.len(), picture.width * usize::from(height));
        picture
    }

    /// Quits by its key and expects that all was well.
    pub(super) fn quit(mut self) {
        self.key('q');
        let begin = Instant::now();
        loop {
            if let Some(status) = self.program.try_wait().expect("a child") {
                assert_eq!(status.code(), Some(0));
                return;
            }
            assert!(begin.elapsed() < PATIENCE, "it does not quit");
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}
