//! Tests of `incise render`: colors, cuts and cameras.

use super::image::pixels;
use super::{incise, text};
use incise_mesh::{TriangleId, icosphere, write_obj};
use incise_models::{Model, build_model};
use incise_pbd_gpu::Context;
use std::path::Path;

/// Colors, cuts, cameras and inputs of images.
pub(crate) fn pictures(_: Context) {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let ball = ball(folder);
    a_cut_ball_shows_its_cap(folder, &ball);
    caps_of_files(folder, &ball);
    pieces_have_their_colors(folder, &ball);
    a_sweep_is_translucent(folder, &ball);
    edges_and_viewpoints(folder);
    a_file_goes_first(folder);
    open_meshes(folder);
}

/// RGB of all pixels, and the width of the image.
struct Pixels {
    width: usize,
    colors: Vec<[u8; 3]>,
}

impl Pixels {
    fn read(path: &Path) -> Self {
        let (width, _, pixels) = pixels(path);
        Self {
            width: width as usize,
            colors: pixels.iter().map(|&[r, g, b, _]| [r, g, b]).collect(),
        }
    }

    fn middle(&self) -> [u8; 3] {
        let rows = self.colors.len() / self.width;
        self.colors[rows / 2 * self.width + self.width / 2]
    }

    fn count(&self, is_counted: impl Fn([u8; 3]) -> bool) -> usize {
        self.colors
            .iter()
            .filter(|&&color| is_counted(color))
            .count()
    }
}

/// Returns true for a color that is mostly red.
fn is_red([r, g, b]: [u8; 3]) -> bool {
    u16::from(r) > 2 * u16::from(g) && u16::from(r) > 2 * u16::from(b)
}

fn is_green([r, g, b]: [u8; 3]) -> bool {
    u16::from(g) > 2 * u16::from(r) && u16::from(g) > 2 * u16::from(b)
}

/// Renders a small image on white.
fn render(folder: &Path, inputs: &[&str], more: &[&str]) -> (Pixels, serde_json::Value) {
    let picture = folder.join("picture.png");
    let mut arguments = vec![
        "render",
        "-o",
        text(&picture),
        "--json",
        "--size",
        "160x120",
    ];
    arguments.extend(["--background", "#fff"]);
    arguments.extend(inputs);
    arguments.extend(more);
    let output = incise(&arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{error}");
    let report = serde_json::from_slice(&output.stdout).expect("JSON");
    (Pixels::read(&picture), report)
}

/// Writes a fine ball of radius 0.5 and returns its path.
fn ball(folder: &Path) -> String {
    let path = folder.join("ball.obj");
    write_obj(&path, &icosphere(3, 0.5)).expect("a folder");
    text(&path).to_owned()
}

const CAPS: [&str; 2] = ["--cap-color", "#f00"];

const GREEN: [&str; 4] = ["--color", "#0c0", "--cap-color", "#0c0"];

fn a_cut_ball_shows_its_cap(folder: &Path, ball: &str) {
    // The upper half is hidden, and the camera looks down on the lower one.
    let half = ["--plane", "0,1,0,0.1", "--camera", "20,80"];
    let of = |piece, caps: &str| {
        let more = ["--without", piece, "--cap-color", caps, "--color", "#00f"];
        render(folder, &[ball], &[&half[..], &more].concat())
    };
    let (both, report) = render(folder, &[ball], &[&half[..], &CAPS].concat());
    assert_eq!(report["pieces"], 2);
    assert_eq!(both.count(is_red), 0, "caps that touch are not seen");
    let seen = ["0", "1"].map(|piece| of(piece, "#f00"));
    // One of the two is the lower half.
    let [caps, other] = seen.each_ref().map(|(picture, _)| picture.count(is_red));
    let (cap, none) = (caps.max(other), caps.min(other));
    assert_eq!(none, 0, "the upper half's cap looks down");
    // The cap is a disc of radius sqrt(0.25 - 0.01) in a ball of radius 0.5, viewed almost
    // from above.
    let lower = if caps > other { &seen[0].0 } else { &seen[1].0 };
    assert!(is_red(lower.middle()));
    let body = lower.count(|color| color != [255; 3]);
    assert!(2 * cap > body, "{cap} of {body}");
    for (_, report) in &seen {
        assert!(report["cap_triangles"].as_u64() > Some(0));
        assert_eq!(report["pieces"], 2, "all are counted");
    }
    let (plain, _) = of(if caps > other { "0" } else { "1" }, "#00f");
    assert_eq!(plain.count(is_red), 0, "caps have the given color");
    // With the pieces moved apart, the cap of the lower one is visible.
    let apart = [
        "--plane",
        "0,1,0,0.1",
        "--camera",
        "20,40",
        "--explode",
        "0.5",
    ];
    assert!(
        render(folder, &[ball], &[&apart[..], &CAPS].concat())
            .0
            .count(is_red)
            > 100
    );
}

fn caps_of_files(folder: &Path, ball: &str) {
    let pieces = folder.join("pieces");
    let cut = incise(&["cut", ball, "-o", text(&pieces), "--plane", "0,1,0,0.1"]);
    assert_eq!(cut.status.code(), Some(0), "{cut:?}");
    let files = ["piece_000.obj", "piece_001.obj"].map(|name| pieces.join(name));
    let from = |elevation| ["--camera", elevation];
    let red = |file: &Path, elevation| {
        render(
            folder,
            &[text(file)],
            &[&CAPS[..], &from(elevation)].concat(),
        )
        .0
        .count(is_red)
    };
    for file in &files {
        let (above, below) = (red(file, "0,80"), red(file, "0,-80"));
        assert!(
            above.min(below) == 0 && above.max(below) > 1000,
            "{above} {below}"
        );
    }
    // Two inputs are two pieces of one picture.
    let both = files.each_ref().map(|file| text(file));
    let (whole, report) = render(folder, &both, &[&CAPS[..], &from("0,30")].concat());
    assert_eq!((whole.count(is_red), &report["pieces"]), (0, &2.into()));
    let apart = [&CAPS[..], &from("0,30"), &["--explode", "1"]].concat();
    assert!(render(folder, &both, &apart).0.count(is_red) > 100);
}

fn pieces_have_their_colors(folder: &Path, ball: &str) {
    let green = |more: &[&str]| {
        let options = [
            &["--plane", "1,0,0,0", "--camera", "0,0,2"],
            &GREEN[..],
            more,
        ]
        .concat();
        render(folder, &[ball], &options).0.count(is_green)
    };
    let all = green(&[]);
    assert_eq!(green(&["--color-pieces"]), 0);
    let [left, right] = ["0", "1"].map(|piece| green(&["--without", piece]));
    assert!(
        left.abs_diff(right) <= left / 10,
        "halves are alike: {left} {right}"
    );
    assert!(all > left);
    assert_eq!(green(&["--without", "0,1"]), 0, "nothing is left");
}

fn a_sweep_is_translucent(folder: &Path, ball: &str) {
    let plane = ["--plane", "0,0.5,1,0.3"];
    let blade = ["--blade", "-1,0.2,-1,-1,0.2,1", "--to", "1,0.2,-1,1,0.2,1"];
    for (by, camera) in [(&plane[..], "0,0,2"), (&blade, "0,40,2")] {
        let options = [by, &GREEN, &["--camera", camera]].concat();
        let without = render(folder, &[ball], &options).0;
        let with = render(folder, &[ball], &[&options[..], &["--show-sweep"]].concat()).0;
        let [before, after] = [&without, &with].map(|p| p.count(|c| c != [255; 3]));
        assert!(
            after > before + 500,
            "the sheet reaches out of the ball: {before} {after}"
        );
        let pairs = without.colors.iter().zip(&with.colors);
        let tinted = pairs.filter(|(a, b)| is_green(**a) && a != b && b[1] > b[0] && b[2] > a[2]);
        assert!(tinted.count() > 500, "the ball is seen through it");
    }
}

fn edges_and_viewpoints(folder: &Path) {
    let [plain, wired] = [
        &["--color", "#fff"][..],
        &["--color", "#fff", "--wireframe"],
    ]
    .map(|more| render(folder, &["sphere80"], more).0);
    let pairs = plain.colors.iter().zip(&wired.colors);
    let darker = pairs
        .clone()
        .filter(|(a, b)| a[0] > b[0].saturating_add(20));
    assert!(darker.count() > 300, "edges are drawn");
    let mut brighter = pairs.filter(|(a, b)| b[0] > a[0].saturating_add(20));
    assert_eq!(brighter.next(), None, "they are dark");
    let size = |more: &[&str]| {
        let picture = render(folder, &["Sphere80"], more).0;
        picture.count(|color| color != [255; 3])
    };
    let [near, far] = ["0,0,2", "0,0,4"].map(|camera| size(&["--camera", camera]));
    assert!(
        (3 * far..5 * far).contains(&near),
        "twice as far is a quarter: {near} {far}"
    );
    let [front, other] = [&[][..], &["--camera", "120,0"]];
    let [front, other] = [front, other].map(|more| render(folder, &["Bunny"], more).0);
    assert_ne!(front.colors, other.colors);
    assert_eq!((other.width, other.colors.len()), (160, 160 * 120));
}

fn a_file_goes_first(folder: &Path) {
    let name = "Banana";
    write_obj(&folder.join(name), &build_model(Model::Sphere20)).expect("a folder");
    let run = |input: &str| {
        let mut command = super::program();
        let arguments = ["render", input, "-o", "out.png", "--size", "8x8", "--json"];
        let output = command.args(arguments).current_dir(folder).output();
        output.expect("it runs")
    };
    let report: serde_json::Value = serde_json::from_slice(&run("octopus").stdout).expect("JSON");
    assert_eq!(report["triangles"], Model::Octopus.triangles());
    // A file name without extension has no format, but takes precedence over the model.
    let output = run(name);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert!(error.contains(name), "{error}");
}

fn open_meshes(folder: &Path) {
    let mut sphere = icosphere(2, 0.5);
    let gone: Vec<TriangleId> = sphere.topology().triangles().take(100).collect();
    sphere.remove_triangles(&gone);
    let path = folder.join("open.obj");
    write_obj(&path, &sphere).expect("a folder");
    let (picture, report) = render(folder, &[text(&path)], &[]);
    assert_eq!(report["triangles"], 220);
    assert!(picture.count(|color| color != [255; 3]) > 1000);
    let target = folder.join("cut.png");
    let cut = ["render", text(&path), "--plane", "0,1,0,0", "-o"];
    let output = incise(&[&cut[..], &[text(&target)]].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(target.exists());
}
