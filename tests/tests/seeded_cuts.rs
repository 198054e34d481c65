//! The list of cuts that bindings in other languages repeat: the same input gives the same bits.
//!
//! Each line of `tests/seeded_cuts.txt` has a built-in model, a method, a level, the plane
//! `nx x + ny y + nz z = d`, the number of pieces and the CRC-32 of their arrays: positions and
//! triangles of each piece, little-endian. `refused` stands for a refused cut. With the environment
//! variable `INCISE_WRITE_SEEDED_CUTS` the test writes the list instead of comparing it.

use incise::cut::{CutError, CutMethod, PaperParams};
use incise::prelude::*;
use incise::refine::{RefineParams, RefinementLevel};
use incise_models::{Model, build_model};
use incise_test_support::random::split_mix;
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

/// Returns the number of pieces of a cut and the hash of their arrays.
fn cut(
    body: &Surface,
    normal: [f64; 3],
    d: f64,
    params: &CutParams,
) -> Result<(usize, u32), CutError> {
    let mut surface = body.clone();
    let plane = Sweep::from_plane(normal, d, &surface.bounds())?;
    let _ = Cutter::new(&surface).cut(&mut surface, &plane, params)?;
    let (mut pieces, mut crc) = (0, 0);
    for (_, piece) in surface.extract_pieces() {
        pieces += 1;
        let positions = piece.positions().iter().flat_map(|&[x, y, z, _]| [x, y, z]);
        crc = crc32(crc, positions.flat_map(f32::to_le_bytes));
        let topology = piece.topology();
        let corners = topology.triangles().flat_map(|t| topology.triangle(t));
        crc = crc32(crc, corners.flat_map(|v| v.0.to_le_bytes()));
    }
    Ok((pieces, crc))
}

/// Returns the list of 100 seeded cuts.
fn list() -> String {
    let exact = CutMethod::default();
    let paper = CutMethod::Paper(PaperParams::default());
    let original = RefinementLevel::Original;
    let groups = [
        (Model::Sphere768, "exact", exact, original, 20),
        (Model::Bunny, "exact", exact, original, 40),
        (Model::Octopus, "exact", exact, RefinementLevel::Finer2, 20),
        (Model::Bunny, "paper", paper, original, 20),
    ];
    let mut seed = 25;
    let mut out = String::new();
    for (model, name, method, level, count) in groups {
        let body = build_model(model);
        for _ in 0..count {
            let [x, y, z, d] = [(); 4].map(|()| 2.0 * split_mix(&mut seed) - 1.0);
            let (normal, d) = ([x, y, z], 0.15 * d);
            let params = CutParams {
                method,
                refine: RefineParams {
                    level,
                    ..RefineParams::default()
                },
                ..CutParams::default()
            };
            let result = match cut(&body, normal, d, &params) {
                Ok((pieces, crc)) => format!("{pieces} {crc:08x}"),
                Err(_) => String::from("refused"),
            };
            let model = model.name();
            out += &format!("{model} {name} {level} {x} {y} {z} {d} {result}\n");
        }
    }
    out
}

#[test]
fn seeded_cuts_have_the_listed_bits() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("seeded_cuts.txt");
    let list = list();
    if std::env::var_os("INCISE_WRITE_SEEDED_CUTS").is_some() {
        std::fs::write(&path, &list).expect("the list can be written");
    }
    let expected = std::fs::read_to_string(&path).expect("the list can be read");
    assert_eq!(expected.lines().count(), 100, "cuts in the list");
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
