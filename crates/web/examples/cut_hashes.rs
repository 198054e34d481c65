//! Prints a hash of each of 100 seeded cuts and of a scene, which the module in a browser repeats.
//!
//! `tests/same_bits.mjs` has the same list in JavaScript.

#![expect(clippy::print_stdout, reason = "an example shows what it computes")]

use incise::cut::{CutMethod, CutParams, Cutter, PaperParams, Sweep};
use incise::mesh::{Surface, write_obj_to};
use incise::pbd::Material;
use incise::prelude::{Scene, SceneParams};
use incise::refine::RefinementLevel;
use incise_models::{Model, build_model};
use std::error::Error;

/// The 32-bit generator of Marsaglia ("Xorshift RNGs", 2003).
struct Random(u32);

impl Random {
    /// Returns a number from -1 to 1, exactly the same in JavaScript.
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        f64::from(self.0) / f64::from(1u32 << 31) - 1.0
    }
}

/// Returns the FNV-1a hash of the surface as OBJ, which has every bit.
fn hash(surface: &Surface) -> Result<String, Box<dyn Error>> {
    let mut bytes = Vec::new();
    write_obj_to(&mut bytes, surface)?;
    let step = |hash: u32, byte: &u8| (hash ^ u32::from(*byte)).wrapping_mul(0x0100_0193);
    let hash = bytes.iter().fold(0x811c_9dc5, step);
    Ok(format!("{hash:08x} {}", bytes.len()))
}

fn cut(i: usize, random: &mut Random) -> Result<String, Box<dyn Error>> {
    let models = [
        Model::Sphere80,
        Model::Sphere768,
        Model::Bunny,
        Model::Banana,
    ];
    let mut surface = build_model(models[i % 4]);
    let normal = [random.next(), random.next(), random.next()];
    let plane = Sweep::from_plane(normal, 0.2 * random.next(), &surface.bounds())?;
    let mut params = CutParams::default();
    params.refine.level = RefinementLevel::FIVE[i % 5];
    if i % 7 == 6 {
        params.method = CutMethod::Paper(PaperParams::default());
    }
    match Cutter::new(&surface).cut(&mut surface, &plane, &params) {
        Ok(_) => hash(&surface),
        Err(error) => Ok(error.to_string()),
    }
}

/// Cuts a body that falls on a floor, for 90 frames.
fn scene() -> Result<String, Box<dyn Error>> {
    let mut params = SceneParams {
        contacts: Some(Default::default()),
        ..SceneParams::default()
    };
    params.solver.ground = Some(-0.6);
    let mut scene = Scene::new(params);
    let body = scene.add_body(build_model(Model::Bunny), &Material::soft_body())?;
    let blade = scene.add_blade([[-2.0, 0.0, -2.0], [-2.0, 0.0, 2.0]]);
    for frame in 0..90 {
        if frame == 10 {
            scene.move_blade(blade, [[0.0, 0.1, -2.0], [0.0, 0.1, 2.0]])?;
        } else if frame == 11 {
            scene.move_blade(blade, [[2.0, 0.0, -2.0], [2.0, 0.0, 2.0]])?;
        }
        scene.step()?;
    }
    hash(scene.body(body)?.surface())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut random = Random(20_261_125);
    for i in 0..100 {
        println!("{i} {}", cut(i, &mut random)?);
    }
    println!("scene {}", scene()?);
    Ok(())
}
