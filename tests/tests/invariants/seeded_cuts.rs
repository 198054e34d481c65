//! The list of cuts that bindings in other languages repeat: the same input gives the same bits.
//!
//! Each line of `tests/seeded_cuts.txt` has a built-in model, a method, a level, four numbers
//! `x y z d`, the number of pieces and the CRC-32 of their arrays: positions and triangles of each
//! piece, little-endian. For `scene` these are the arrays of the body as a whole. `refused` stands
//! for a refused cut. The numbers mean:
//!
//! | method | `x y z d` |
//! |---|---|
//! | `exact` | the plane with normal `x y z` at `d` |
//! | `path` | an edge along z around `x y z`, length 2, in three poses from height `y` to `d` |
//! | `scene` | 90 frames, floor at `d`, an edge at height `y` from `-z` to `z` sweeps `-x` to `x` |
//!
//! The numbers are random ones. With the environment variable `INCISE_WRITE_SEEDED_CUTS` the test
//! writes the pieces and hashes of all lines instead of comparing them.

use incise::cut::{CutError, Incision};
use incise::pbd::{Collider, Material};
use incise::prelude::*;
use incise::refine::RefineParams;
use incise_models::{Model, build_model};
use incise_test_support::bits::hash;
use std::num::NonZeroUsize;
use std::path::Path;

/// Cuts by a plane.
fn cut(surface: &mut Surface, [x, y, z, d]: [f64; 4], params: &CutParams) -> Result<(), CutError> {
    let plane = Sweep::from_plane([x, y, z], d, &surface.bounds())?;
    let _ = Cutter::new(surface).cut(surface, &plane, params)?;
    Ok(())
}

#[expect(clippy::cast_possible_truncation, reason = "coordinates have 32 bits")]
fn to_f32(x: f64) -> f32 {
    x as f32
}

/// Cuts by an edge that moves down and may stop inside.
fn cut_path(
    surface: &mut Surface,
    [x, y, z, d]: [f64; 4],
    params: &CutParams,
) -> Result<(), CutError> {
    let mut cutter = Cutter::new(surface);
    let mut incision = Incision::default();
    for height in [y, 0.5 * (y + d), d] {
        let pose = [[x, height, z - 1.0], [x, height, z + 1.0]].map(|p| p.map(to_f32));
        let _ = cutter.advance(surface, &mut incision, &pose, params)?;
    }
    Ok(())
}

/// Returns pieces and hash of a body that falls on a floor and is cut in frames 10 and 11.
fn scene(body: Surface, numbers: [f64; 4]) -> String {
    let [x, y, z, d] = numbers.map(to_f32);
    let mut params = SceneParams {
        contacts: Some(Default::default()),
        ..SceneParams::default()
    };
    params.solver.threads = NonZeroUsize::new(1);
    let mut scene = Scene::new(params);
    scene.colliders.push(Collider::ground(d));
    let material = Material::soft_body();
    let body = scene.add_body(body, &material).expect("a built-in model");
    let edge = |x| [[x, y, -z], [x, y, z]];
    let blade = scene.add_blade(edge(-x));
    for frame in 0..90 {
        let motion = match frame {
            10 => Some(0.0),
            11 => Some(x),
            _ => None,
        };
        if let Some(x) = motion {
            scene
                .move_blade(blade, edge(x))
                .expect("a blade of the scene");
        }
        let _ = scene.step().expect("a frame");
        assert!(scene.failed_cuts().is_empty(), "frame {frame}");
    }
    let body = scene.body(body).expect("a body of the scene");
    let mut surface = body.surface().clone();
    surface.compact();
    format!("{} {:08x}", surface.piece_count(), hash([&surface]))
}

/// Returns a line with the results of its cut.
fn line(listed: &str) -> String {
    let words: Vec<&str> = listed.split(' ').collect();
    let [name, method, level, x, y, z, d, ..] = words[..] else {
        panic!("no cut: {listed}");
    };
    let head = words[..7].join(" ");
    let model = Model::ALL.into_iter().find(|model| model.name() == name);
    let mut surface = build_model(model.expect("a built-in model"));
    let params = CutParams {
        refine: RefineParams {
            level: level.parse().expect("a level"),
            ..RefineParams::default()
        },
        ..CutParams::default()
    };
    let numbers: [f64; 4] = [x, y, z, d].map(|number| number.parse().expect("a number"));
    let result = match method {
        "exact" => cut(&mut surface, numbers, &params),
        "path" => cut_path(&mut surface, numbers, &params),
        "scene" => return format!("{head} {}\n", scene(surface, numbers)),
        _ => panic!("no method: {listed}"),
    };
    if result.is_err() {
        return format!("{head} refused\n");
    }
    let pieces: Vec<Surface> = surface.extract_pieces().map(|(_, piece)| piece).collect();
    let crc = hash(&pieces);
    format!("{head} {} {crc:08x}\n", pieces.len())
}

#[test]
fn seeded_cuts_have_the_listed_bits() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("seeded_cuts.txt");
    let expected = std::fs::read_to_string(&path).expect("the list can be read");
    assert_eq!(expected.lines().count(), 91, "cuts and a scene");
    let found: String = expected.lines().map(line).collect();
    if std::env::var_os("INCISE_WRITE_SEEDED_CUTS").is_some() {
        std::fs::write(&path, &found).expect("the list can be written");
        return;
    }
    for (line, expected) in found.lines().zip(expected.lines()) {
        assert_eq!(line, expected, "a cut has other bits than the list");
    }
}
