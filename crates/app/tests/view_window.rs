//! The binary's `view`, in a real window on a display that nobody sees, driven by a mouse that nobody holds.

#![expect(
    clippy::missing_assert_message,
    reason = "these are tests, which the lint knows by an attribute only"
)]

#[path = "../../pbd-gpu/tests/common/gpu.rs"]
mod gpu;

use gpu::{Needs, trial};
use libtest_mimic::{Completion, Failed, Trial};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, ExitCode, Stdio};
use std::time::{Duration, Instant};
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, ConnectionExt, ImageFormat, InputFocus,
    KEY_PRESS_EVENT, KEY_RELEASE_EVENT, MOTION_NOTIFY_EVENT, Window,
};
use x11rb::protocol::xtest::ConnectionExt as XTest;
use x11rb::rust_connection::RustConnection;

/// The window, and how much of its right side is the panel's.
const SIZE: [u16; 2] = [800, 600];
const PANEL: u16 = 292;

/// How long anything may take: software that draws beside other tests is slow.
const PATIENCE: Duration = Duration::from_secs(120);

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
        trial("without_a_display_there_is_no_window", any, |_| {
            without_display()
        }),
        on_display("without_a_driver_there_is_no_window", without_driver),
    ];
    gpu::run(trials)
}

/// A test that needs a display, and a device that draws on it.
fn on_display(name: &str, test: fn(&Display)) -> Trial {
    let with_device = trial(name, Needs::AnyDevice, move |_| match Display::start() {
        Some(display) => test(&display),
        None => panic!("{NO_XVFB}"),
    });
    let required = std::env::var("INCISE_REQUIRE_GPU").unwrap_or_default();
    if has_xvfb() || !["", "0"].contains(&required.as_str()) {
        return with_device;
    }
    Trial::ignorable_test(name, || Ok::<_, Failed>(Completion::ignored_with(NO_XVFB)))
}

const NO_XVFB: &str = "there is no Xvfb; on Debian install xvfb";

fn has_xvfb() -> bool {
    let asked = Command::new("Xvfb")
        .arg("-version")
        .stderr(Stdio::null())
        .status();
    asked.is_ok_and(|status| status.success())
}

/// A display of its own. Ends with the test.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    /// A server that chooses a number that nobody has, and says which.
    fn start() -> Option<Self> {
        let screen = format!("{}x{}x24", SIZE[0], SIZE[1]);
        let mut server = Command::new("Xvfb")
            .args([
                "-displayfd",
                "1",
                "-screen",
                "0",
                &screen,
                "-nolisten",
                "tcp",
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

/// The program in its window, and somebody in front of it.
struct Seat {
    program: Child,
    x: RustConnection,
    root: Window,
    window: Window,
}

/// Red, green and blue of the picture beside the panel, row by row.
struct Pixels {
    width: usize,
    colors: Vec<[u8; 3]>,
}

impl Pixels {
    fn count(&self, is_counted: fn([u8; 3]) -> bool) -> usize {
        self.colors.iter().filter(|&&c| is_counted(c)).count()
    }

    /// How many pixels differ from those of another picture.
    fn differ(&self, other: &Self) -> usize {
        let pairs = self.colors.iter().zip(&other.colors);
        pairs
            .filter(|(a, b)| (0..3).any(|k| a[k].abs_diff(b[k]) > 12))
            .count()
    }

    /// The mean row of pixels that count.
    fn height(&self, is_counted: fn([u8; 3]) -> bool) -> usize {
        let rows = self.colors.chunks(self.width).enumerate();
        let of_row = |row: &[[u8; 3]]| row.iter().filter(|&&c| is_counted(c)).count();
        let (sum, count) = rows.fold((0, 0), |(sum, count), (y, row)| {
            let n = of_row(row);
            (sum + y * n, count + n)
        });
        sum / count.max(1)
    }
}

/// The first piece's color, in any light.
fn is_blue([r, g, b]: [u8; 3]) -> bool {
    b > g && g > r && b - r > 35
}

/// The second piece's.
fn is_yellow([r, g, b]: [u8; 3]) -> bool {
    r > g && g > b && r - b > 55 && u16::from(g) * 10 > u16::from(r) * 7
}

/// That of caps.
fn is_red([r, g, b]: [u8; 3]) -> bool {
    r > 60 && u16::from(r) * 10 > u16::from(g) * 18 && u16::from(r) * 10 > u16::from(b) * 18
}

impl Seat {
    fn start(display: &Display, folder: &Path, more: &[&str]) -> Self {
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
        // There is no window manager to give it the keyboard, and no key before it is mapped.
        seat.wait(|seat| {
            let focus = seat
                .x
                .set_input_focus(InputFocus::PARENT, seat.window, 0_u32);
            focus.ok()?.check().ok()
        });
        seat.wait(|seat| (seat.look().count(is_blue) > 8000).then_some(()));
        seat
    }

    /// Waits until something is so.
    fn wait<T>(&mut self, mut found: impl FnMut(&mut Self) -> Option<T>) -> T {
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

    fn input(&self, kind: u8, detail: u8, at: [u16; 2]) {
        let [x, y] = at.map(|c| i16::try_from(c).expect("on the screen"));
        let sent = self.x.xtest_fake_input(kind, detail, 0, self.root, x, y, 0);
        sent.expect("a display").check().expect("XTest");
    }

    /// Presses a button, goes there in steps as a hand does, and lets go.
    fn drag(&self, button: u8, from: [u16; 2], to: [u16; 2]) {
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
    fn key(&self, character: char) {
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

    fn look(&self) -> Pixels {
        let width = SIZE[0] - PANEL - 4;
        let image = self
            .x
            .get_image(ImageFormat::Z_PIXMAP, self.root, 0, 0, width, SIZE[1], !0);
        let image = image.expect("a display").reply().expect("a picture");
        let pixels = image.data.as_chunks::<4>().0.iter();
        let picture = Pixels {
            width: usize::from(width),
            colors: pixels.map(|&[b, g, r, _]| [r, g, b]).collect(),
        };
        assert_eq!(picture.colors.len(), picture.width * usize::from(SIZE[1]));
        picture
    }

    /// Quits by its key and expects that all was well.
    fn quit(mut self) {
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

fn without_display() {
    for said in [
        refusal(|command| command.env_remove("DISPLAY")),
        refusal(|command| command.env("DISPLAY", ":98765")),
    ] {
        assert!(said.starts_with("incise: there is no display"), "{said}");
        assert!(said.contains("DISPLAY"), "{said}");
    }
}

fn without_driver(display: &Display) {
    let said = refusal(|command| {
        let none = [
            ("VK_DRIVER_FILES", "/nowhere.json"),
            ("VK_ICD_FILENAMES", "/nowhere.json"),
        ];
        command.env("DISPLAY", &display.name).envs(none)
    });
    assert!(said.contains("mesa-vulkan-drivers"), "{said}");
}
