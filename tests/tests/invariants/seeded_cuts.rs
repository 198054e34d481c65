//! The list of cuts that bindings in other languages repeat: the same input gives the same bits.
//!
//! Each line of `tests/seeded_cuts.txt` has a built-in model, a method, a level, four numbers
//! `x y z d`, the number of pieces and the CRC-32 of their arrays: positions and triangles of each
//! piece, little-endian. For `scene` these are the arrays of the body as a whole. `refused` stands
//! for a refused cut. The numbers mean:
//!
//! | method | `x y z d` |
//! |---|---|
//! | `exact`, `paper` | the plane with normal `x y z` at `d` |
//! | `path` | an edge along z around `x y z`, length 2, in three poses from height `y` to `d` |
//! | `scene` | 90 frames, floor at `d`, an edge at height `y` from `-z` to `z` sweeps `-x` to `x` |
//!
//! With the environment variable `INCISE_WRITE_SEEDED_CUTS` the test writes the list instead of
//! comparing it.

use incise::cut::{CutError, CutMethod, Incision, PaperParams};
use incise::pbd::{Collider, Material};
use incise::prelude::*;
use incise::refine::{RefineParams, RefinementLevel};
use incise_models::{Model, build_model};
use incise_test_support::random::Random;
use std::num::NonZeroUsize;
use std::path::Path;

/// Returns the CRC-32 (ISO 3309) of bytes that follow those of `crc`.
fn crc32(crc: u32, bytes: impl IntoIterator<Item = u8>) -> u32 {
    let step = |crc: u32, byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg())
        })
    };
    !bytes.into_iter().fold(!crc, step)
}

/// Returns the CRC-32 of positions and triangles of surfaces without gaps.
fn hash<'a>(surfaces: impl IntoIterator<Item = &'a Surface>) -> u32 {
    surfaces.into_iter().fold(0, |crc, surface| {
        let positions = surface.positions().iter();
        let coordinates = positions.flat_map(|&[x, y, z, _]| [x, y, z]);
        let crc = crc32(crc, coordinates.flat_map(f32::to_le_bytes));
        let topology = surface.topology();
        let corners = topology.triangles().flat_map(|t| topology.triangle(t));
        crc32(crc, corners.flat_map(|v| v.0.to_le_bytes()))
    })
}

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

/// Returns the line of a cut.
fn line(model: Model, method: &str, level: RefinementLevel, numbers: [f64; 4]) -> String {
    let ([x, y, z, d], name) = (numbers, model.name());
    let head = format!("{name} {method} {level} {x} {y} {z} {d}");
    let mut surface = build_model(model);
    let mut params = CutParams {
        refine: RefineParams {
            level,
            ..RefineParams::default()
        },
        ..CutParams::default()
    };
    let result = match method {
        "path" => cut_path(&mut surface, numbers, &params),
        "scene" => return format!("{head} {}\n", scene(surface, numbers)),
        _ => {
            if method == "paper" {
                params.method = CutMethod::Paper(PaperParams::default());
            }
            cut(&mut surface, numbers, &params)
        }
    };
    if result.is_err() {
        return format!("{head} refused\n");
    }
    let pieces: Vec<Surface> = surface.extract_pieces().map(|(_, piece)| piece).collect();
    let crc = hash(&pieces);
    format!("{head} {} {crc:08x}\n", pieces.len())
}

/// Returns the list of 100 seeded cuts and a scene.
fn list() -> String {
    let original = RefinementLevel::Original;
    let groups = [
        (Model::Sphere768, "exact", original, 20),
        (Model::Bunny, "exact", original, 40),
        (Model::Octopus, "exact", RefinementLevel::Finer2, 20),
        (Model::Bunny, "paper", original, 10),
        (Model::Bunny, "path", original, 10),
    ];
    let mut random = Random::new(25);
    let mut out = String::new();
    for (model, method, level, count) in groups {
        for _ in 0..count {
            let [x, y, z, d] = [(); 4].map(|()| 2.0 * random.unit() - 1.0);
            let numbers = match method {
                "path" => [0.1 * x, 0.7, 0.1 * z, 0.7 * d],
                _ => [x, y, z, 0.15 * d],
            };
            out += &line(model, method, level, numbers);
        }
    }
    out + &line(Model::Bunny, "scene", original, [2.0, 0.0, 2.0, -0.6])
}

#[test]
fn seeded_cuts_have_the_listed_bits() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("seeded_cuts.txt");
    let list = list();
    if std::env::var_os("INCISE_WRITE_SEEDED_CUTS").is_some() {
        std::fs::write(&path, &list).expect("the list can be written");
    }
    let expected = std::fs::read_to_string(&path).expect("the list can be read");
    assert_eq!(expected.lines().count(), 101, "cuts and a scene");
    for (line, expected) in list.lines().zip(expected.lines()) {
        assert_eq!(line, expected, "a cut has other bits than the list");
    }
}

#[test]
fn the_hash_is_crc_32() {
    assert_eq!(
        crc32(0, *b"123456789"),
        0xcbf4_3926,
        "the check value of CRC-32"
    );
    let halves = crc32(crc32(0, *b"1234"), *b"56789");
    assert_eq!(halves, 0xcbf4_3926, "hashes continue");
}
