//! The scenes.

use super::scene::Scene;
use super::shapes::{bar, sheet, zigzag};
use incise_cut::Sweep;
use incise_mesh::{Model, Surface, VertexId, build_model};
use incise_pbd_gpu::{Density, Material, Stiffness, Volume};
use std::error::Error;
use std::f32::consts::PI;

/// The names of all scenes, in the order of the table.
pub(super) const NAMES: [&str; 11] = [
    "chain",
    "sheet-1e2",
    "sheet-1e4",
    "sheet-1e6",
    "bar",
    "bar-volume",
    "bunny",
    "drop",
    "ribbon",
    "cut",
    "armadillo",
];

/// The scene of a name.
pub(super) fn scene(name: &'static str) -> Result<Scene, Box<dyn Error>> {
    match name {
        "chain" => chain(),
        "sheet-1e2" => hung(name, 1e-2),
        "sheet-1e4" => hung(name, 1e-4),
        "sheet-1e6" => hung(name, 1e-6),
        "bar" => pinned_bar(name, None),
        "bar-volume" => pinned_bar(name, Some(Volume::default())),
        "bunny" => stretched(),
        "drop" => drop(),
        "ribbon" => ribbon(),
        "cut" => cut(),
        _ => armadillo(),
    }
}

/// Compliances of stretch [m/N] and of bending [rad/(N m)], 1 kg/m^2, no friction: that belongs to no energy.
fn material(stretch: f32, bending: Option<f32>) -> Material {
    Material {
        density: Density::Area(1.0),
        stretch: Stiffness::Compliance(stretch),
        bending: bending.map(Stiffness::Compliance),
        volume: None,
        struts: None,
        damping: 0.0,
        friction: 0.0,
    }
}

/// 20 particles in a strip, the first two held, level at the start.
fn chain() -> Result<Scene, Box<dyn Error>> {
    Ok(Scene {
        pins: [0, 1].map(VertexId).into(),
        frames: 30,
        ..Scene::new("chain", zigzag(20, 0.1)?, material(1e-8, None))
    })
}

/// A sheet of 1 m, held at two corners, level at the start.
fn hung(name: &'static str, stretch: f32) -> Result<Scene, Box<dyn Error>> {
    let n = 12;
    Ok(Scene {
        pins: [0, n].map(VertexId).into(),
        ..Scene::new(
            name,
            sheet(n, n, 1.0 / n as f32)?,
            material(stretch, Some(10.0)),
        )
    })
}

/// A bar that is held at one end, with an inside or without.
fn pinned_bar(name: &'static str, volume: Option<Volume>) -> Result<Scene, Box<dyn Error>> {
    let surface = bar([16, 4, 4], 0.0625)?;
    let pins = vertices_where(&surface, |[x, _, _]| x == 0.0);
    Ok(Scene {
        pins,
        ..Scene::new(
            name,
            surface,
            Material {
                volume,
                ..material(1e-5, Some(1e-2))
            },
        )
    })
}

/// A bunny, drawn out by a tenth and let go, without gravity.
fn stretched() -> Result<Scene, Box<dyn Error>> {
    let mut surface = build_model(Model::Bunny);
    move_all(&mut surface, |[x, y, z]| [1.1 * x, y, z]);
    Ok(Scene {
        gravity: [0.0; 3],
        frames: 10,
        ..Scene::new("bunny", surface, material(1e-3, Some(1.0)))
    })
}

/// A ball that meets the ground with 2 m/s.
fn drop() -> Result<Scene, Box<dyn Error>> {
    let surface = build_model(Model::Sphere768);
    let count = surface.topology().vertex_count();
    Ok(Scene {
        ground: Some(surface.bounds().min[1] - 0.05),
        velocities: vec![[0.0, -2.0, 0.0]; count],
        ..Scene::new("drop", surface, material(1e-5, Some(1e-2)))
    })
}

/// A ribbon with half a turn, its ends held, without gravity.
fn ribbon() -> Result<Scene, Box<dyn Error>> {
    let n = 40;
    let size = 0.05;
    let mut surface = sheet(n, 4, size)?;
    let length = n as f32 * size;
    move_all(&mut surface, |[x, y, z]| {
        // All of the turn in the middle half.
        let part = ((x / length - 0.25) / 0.5).clamp(0.0, 1.0);
        let (sin, cos) = (PI * part).sin_cos();
        let z = z - 2.0 * size;
        [x, cos * y + sin * z, cos * z - sin * y]
    });
    let last = length - 0.5 * size;
    let pins = vertices_where(&surface, |[x, _, _]| x == 0.0 || x > last);
    Ok(Scene {
        gravity: [0.0; 3],
        pins,
        ..Scene::new("ribbon", surface, material(1e-3, Some(1.0)))
    })
}

/// A bar, drawn out by a tenth between its held ends, and cut through.
fn cut() -> Result<Scene, Box<dyn Error>> {
    let mut surface = bar([16, 4, 4], 0.0625)?;
    move_all(&mut surface, |[x, y, z]| [1.1 * x, y, z]);
    let pins = vertices_where(&surface, |[x, _, _]| x == 0.0 || x > 1.09);
    let sweep = Sweep::across_box([1.0, 0.3, 0.2], 0.75, &surface.bounds())?;
    Ok(Scene {
        gravity: [0.0; 3],
        pins,
        sweep: Some(sweep),
        ..Scene::new("cut", surface, material(1e-3, Some(1.0)))
    })
}

/// An armadillo that is held at the top of its head, let go.
fn armadillo() -> Result<Scene, Box<dyn Error>> {
    let surface = build_model(Model::Armadillo);
    let top = surface.bounds().max[1] - 0.05;
    let pins = vertices_where(&surface, |[_, y, _]| y > top);
    Ok(Scene {
        pins,
        frames: 3,
        fine: [8, 16, 32],
        most_rungs: 0,
        ..Scene::new("armadillo", surface, material(1e-4, Some(1e-1)))
    })
}

fn move_all(surface: &mut Surface, to: impl Fn([f32; 3]) -> [f32; 3]) {
    for p in &mut surface.positions {
        let [x, y, z] = to([p[0], p[1], p[2]]);
        [p[0], p[1], p[2]] = [x, y, z];
    }
}

fn vertices_where(surface: &Surface, is: impl Fn([f32; 3]) -> bool) -> Vec<VertexId> {
    let at = |v: &VertexId| {
        let [x, y, z, _] = surface.positions[v.index()];
        is([x, y, z])
    };
    surface.topology().vertices().filter(at).collect()
}
