//! Prints a line for each of 100 seeded cuts of the bunny, with a hash of all bits of the result.
//!
//! `tests/c/bits.c` and `unity/Tests~/Bits.cs` print the same lines through the C interface; the
//! checks compare them. `cargo run -p incise-ffi --example cut_bits`

#![expect(clippy::print_stdout, reason = "an example prints its results")]

use incise::cut::{CutError, CutMethod, CutParams, Cutter, Incision, PaperParams, Sweep};
use incise::mesh::Surface;
use incise::refine::{RefineParams, RefinementLevel};
use incise_models::{Model, build_model};

/// A linear congruential generator (Knuth's MMIX), so that all languages draw the same numbers.
struct Random(u64);

impl Random {
    /// Returns a number from -1 to 1 with 24 bits.
    fn next(&mut self) -> f64 {
        const FACTOR: u64 = 6_364_136_223_846_793_005;
        self.0 = self.0.wrapping_mul(FACTOR).wrapping_add(1);
        let bits = u32::try_from(self.0 >> 40).unwrap_or_default();
        f64::from(bits) / 8_388_608.0 - 1.0
    }
}

/// The hash FNV-1a of 32-bit words, low byte first.
struct Hash(u64);

impl Hash {
    fn words(&mut self, words: impl IntoIterator<Item = u32>) {
        for byte in words.into_iter().flat_map(u32::to_le_bytes) {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    }
}

fn cut(
    surface: &mut Surface,
    i: usize,
    random: &mut Random,
    params: &CutParams,
) -> Result<usize, CutError> {
    let mut cutter = Cutter::new(surface);
    if i % 10 == 9 {
        // A blade in three poses that stops inside or passes through.
        let [x, z, depth] = [0.1, 0.1, 0.2].map(|scale| scale * random.next());
        let mut incision = Incision::default();
        let mut hits = 0;
        for y in [0.7, 0.2, depth] {
            let pose = [[x, y, z - 1.0], [x, y, z + 1.0]].map(|p| p.map(to_f32));
            hits += cutter
                .advance(surface, &mut incision, &pose, params)?
                .report
                .hits;
        }
        return Ok(hits);
    }
    let normal = [random.next(), random.next(), random.next()];
    let plane = Sweep::from_plane(normal, 0.2 * random.next(), &surface.bounds())?;
    Ok(cutter.cut(surface, &plane, params)?.report.hits)
}

#[expect(clippy::cast_possible_truncation, reason = "coordinates have 32 bits")]
fn to_f32(x: f64) -> f32 {
    x as f32
}

/// Returns the number of pieces and the hash of vertices, triangles, pieces and caps.
fn hash(surface: &mut Surface, cap_material: u32) -> (usize, u64) {
    surface.compact();
    let topology = surface.topology();
    let triangles = || topology.triangles();
    let mut pieces: Vec<u32> = triangles().map(|t| surface.piece(t)).collect();
    pieces.sort_unstable();
    pieces.dedup();
    let index = |t| pieces.partition_point(|&piece| piece < surface.piece(t));
    let mut hash = Hash(0xcbf2_9ce4_8422_2325);
    hash.words((surface.positions().iter()).flat_map(|p| [p[0], p[1], p[2]].map(f32::to_bits)));
    hash.words(triangles().flat_map(|t| topology.triangle(t).map(|v| v.0)));
    hash.words((surface.corner_uvs().as_flattened().iter()).map(|x| x.to_bits()));
    hash.words(triangles().map(|t| u32::try_from(index(t)).unwrap_or(u32::MAX)));
    hash.words(triangles().map(|t| u32::from(surface.material(t) == cap_material)));
    (pieces.len(), hash.0)
}

fn main() {
    let body = build_model(Model::Bunny);
    let mut random = Random(20_261_125);
    for i in 0..100 {
        let method = match i % 4 {
            3 if i % 10 != 9 => CutMethod::Paper(PaperParams::default()),
            _ => CutMethod::default(),
        };
        let params = CutParams {
            method,
            refine: RefineParams {
                level: RefinementLevel::FIVE[i % 5],
                ..RefineParams::default()
            },
            ..CutParams::default()
        };
        let mut surface = body.clone();
        match cut(&mut surface, i, &mut random, &params) {
            Ok(hits) => {
                let (pieces, hash) = hash(&mut surface, params.cap_material);
                println!("{i} {pieces} {hits} {hash:016x}");
            }
            Err(_) => println!("{i} refused"),
        }
    }
}
