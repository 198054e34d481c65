//! Tests of `incise simulate --frames` and `--animation`.

use super::image::pixels;
use super::{incise, text};
use incise_pbd_gpu::Context;
use serde_json::Value;
use std::path::Path;

/// Pictures show the fall, the cut and the colliders; surplus files are removed.
pub(crate) fn pictures(_: Context) {
    fall_and_cut();
    shorter_run();
    colliders();
}

/// Returns the mean row of the pixels that satisfy a condition; none without any.
fn mean_row(path: &Path, is_counted: impl Fn([u8; 4]) -> bool) -> Option<f64> {
    let (width, _, pixels) = pixels(path);
    let rows = pixels.chunks_exact(width as usize).zip(0_u32..);
    let rows = rows.flat_map(|(row, y)| {
        let count = row.iter().filter(|&&pixel| is_counted(pixel)).count();
        std::iter::repeat_n(f64::from(y), count)
    });
    let (sum, count) = rows.fold((0.0, 0.0), |(sum, count), y| (sum + y, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

/// Red and green of a body whose surface is green and whose caps are red.
fn is_red([r, g, _, _]: [u8; 4]) -> bool {
    r > 60 && u16::from(r) > 2 * u16::from(g)
}

fn is_green([r, g, _, _]: [u8; 4]) -> bool {
    g > 60 && u16::from(g) > 2 * u16::from(r)
}

fn fall_and_cut() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, animation) = (folder.path().join("frames"), folder.path().join("a.png"));
    let words = "simulate Sphere80 --seconds 0.5 --plane 1,0,0.1,0 --at 0.1 --no-contacts --fps 20 \
                 --size 96x72 --color #0f0 --cap-color #f00 --background #fff --camera 0,0 --json";
    let outputs = ["--frames", text(&frames), "--animation", text(&animation)];
    let words: Vec<&str> = words.split_whitespace().chain(outputs).collect();
    let done = incise(&words);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    let report: Value = serde_json::from_slice(&done.stdout).expect("JSON");
    assert_eq!(report["pictures"], 11, "0 s to 0.5 s, both included");
    assert_eq!(report["pieces"], serde_json::json!([]), "none are written");
    let frame = |i: u32| frames.join(format!("frame_{i:04}.png"));
    assert_eq!(std::fs::read_dir(&frames).expect("frames").count(), 11);
    let rows = [0, 5, 10].map(|i| mean_row(&frame(i), is_green).expect("a body"));
    assert!(
        rows[0] + 5.0 < rows[1] && rows[1] + 10.0 < rows[2],
        "{rows:?}"
    );
    assert_eq!(
        mean_row(&frame(0), is_red),
        None,
        "it is whole at the start"
    );
    let file = std::io::BufReader::new(std::fs::File::open(&animation).expect("an animation"));
    let reader = png::Decoder::new(file).read_info().expect("a PNG");
    let control = reader.info().animation_control().expect("an animated PNG");
    assert_eq!(control.num_frames, 11);
    assert_eq!(pixels(&animation), pixels(&frame(0)), "the first frame");
}

fn shorter_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = folder.path().join("frames");
    for (seconds, count) in [("0.2", 3), ("0.1", 2)] {
        let words = ["simulate", "Sphere20", "--seconds", seconds, "--fps", "10"];
        let more = ["--size", "16x16", "--frames", text(&frames)];
        let done = incise(&[&words[..], &more].concat());
        assert_eq!(done.status.code(), Some(0), "{done:?}");
        assert_eq!(std::fs::read_dir(&frames).expect("frames").count(), count);
    }
}

/// Three solids in front of a ball, and a plane that crosses the background.
fn colliders() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("scene.toml");
    let frame = folder.path().join("frames/frame_0000.png");
    let picture = |colliders: &str| {
        let text_of_scene = format!(
            r##"
seconds = 0.02
gravity = [0, 0, 0]
[[bodies]]
mesh = "Sphere768"
{colliders}
[output]
frames = "frames"
[output.picture]
size = "201x201"
camera = "0,0"
color = "#0f0"
background = "#00f"
"##
        );
        std::fs::write(&scene, text_of_scene).expect("a scene");
        let done = incise(&["simulate", text(&scene)]);
        assert_eq!(done.status.code(), Some(0), "{done:?}");
        let (width, height, pixels) = pixels(&frame);
        assert_eq!((width, height), (201, 201));
        pixels
    };
    let is_gray = |[r, g, b, _]: [u8; 4]| r > 60 && r.abs_diff(g) < 12 && g.abs_diff(b) < 16;
    let plain = picture("");
    assert!(!plain.iter().any(|&pixel| is_gray(pixel)));
    let green = plain.iter().filter(|&&pixel| is_green(pixel)).count();
    // Shape, its height relative to its width, and the part of that rectangle that it fills.
    for (shape, slenderness, fill) in [
        ("sphere = { center = [0, 0, 1], radius = 0.2 }", 1.0, 0.79),
        (
            "capsule = { ends = [[0, -0.2, 1], [0, 0.2, 1]], radius = 0.1 }",
            3.0,
            0.93,
        ),
        (
            "box = { center = [0, 0, 1], half = [0.2, 0.1, 0.1] }",
            0.5,
            1.0,
        ),
    ] {
        let pixels = picture(&format!("[[colliders]]\n{shape}"));
        let gray = (0..).zip(&pixels).filter(|&(_, &pixel)| is_gray(pixel));
        let places: Vec<[u32; 2]> = gray.map(|(i, _)| [i % 201, i / 201]).collect();
        let [width, height] = [0, 1].map(|k| {
            let along = || places.iter().map(|place| place[k]);
            let (low, high) = (along().min().expect("gray"), along().max().expect("gray"));
            assert!(
                (196..205).contains(&(low + high)),
                "{shape}: {low} to {high}"
            );
            f64::from(high + 1 - low)
        });
        let agrees = |found: f64, expected: f64| (found / expected - 1.0).abs() < 0.15;
        assert!(
            agrees(height / width, slenderness),
            "{shape}: {width} x {height}"
        );
        let filled = places.len() as f64 / (width * height);
        assert!(agrees(filled, fill), "{shape}: {filled}");
        let visible = pixels.iter().filter(|&&pixel| is_green(pixel)).count();
        let hidden = green.saturating_sub(visible);
        assert!(
            agrees(hidden as f64, places.len() as f64),
            "{shape}: hides {hidden}"
        );
    }
    // A wall behind the ball is in front of the background alone.
    let pixels = picture("[[colliders]]\nplane = { point = [0, 0, -1], normal = [0, 0, 1] }");
    for (&pixel, &plain) in pixels.iter().zip(&plain) {
        let (is_ball, is_background) = (plain[2] == 0, plain == [0, 0, 255, 255]);
        assert!(!is_ball || pixel == plain, "{pixel:?} instead of {plain:?}");
        assert!(!is_background || pixel != plain, "no wall over {plain:?}");
    }
}
