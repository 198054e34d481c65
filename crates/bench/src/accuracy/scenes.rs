//! The eleven scenes of the accuracy bench.

use super::scene::Scene;
use super::shapes::{bar, sheet, zigzag};
use incise_cut::Sweep;
use incise_mesh::{Surface, VertexId};
use incise_models::{Model, build_model};
use incise_pbd_gpu::{Density, Material, Stiffness, Volume};
use std::error::Error;
use std::f32::consts::PI;

/// Names of all scenes in the order of the table.
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

/// Builds the scene of a name.
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
        _ => Ok(armadillo()),
    }
}

/// Compliances of stretch [m/N] and bending [rad/(N m)], 1 kg/m^2, without damping and friction.
fn material(stretch: f32, bending: Option<f32>) -> Material {
    Material {
        density: Density::Area(1.0),
        stretch: Stiffness::Compliance(stretch),
        bending: bending.map(Stiffness::Compliance),
        volume: None,
        interior_springs: None,
        damping: 0.0,
        friction: 0.0,
    }
}

/// A horizontal strip of 20 particles, the first two pinned.
fn chain() -> Result<Scene, Box<dyn Error>> {
    Ok(Scene {
        pins: [0, 1].map(VertexId).into(),
        frames: 30,
        ..Scene::new("chain", zigzag(20, 0.1)?, material(1e-8, None))
    })
}

/// A horizontal sheet of 1 m, pinned at two corners.
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

/// A bar pinned at one end, with a volume constraint or without.
fn pinned_bar(name: &'static str, volume: Option<Volume>) -> Result<Scene, Box<dyn Error>> {
    let surface = bar([16, 4, 4], 0.0625);
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

/// A bunny stretched by a tenth, without gravity.
fn stretched() -> Result<Scene, Box<dyn Error>> {
    let mut surface = build_model(Model::Bunny);
    move_all(&mut surface, |[x, y, z]| [1.1 * x, y, z]);
    Ok(Scene {
        gravity: [0.0; 3],
        frames: 10,
        ..Scene::new("bunny", surface, material(1e-3, Some(1.0)))
    })
}

/// A ball that hits the ground at 2 m/s.
fn drop() -> Result<Scene, Box<dyn Error>> {
    let surface = build_model(Model::Sphere768);
    let count = surface.topology().vertex_count();
    Ok(Scene {
        ground: Some(surface.bounds().min[1] - 0.05),
        velocities: vec![[0.0, -2.0, 0.0]; count],
        ..Scene::new("drop", surface, material(1e-5, Some(1e-2)))
    })
}

/// A ribbon twisted by half a turn between pinned ends, without gravity.
fn ribbon() -> Result<Scene, Box<dyn Error>> {
    let n = 40;
    let size = 0.05;
    let mut surface = sheet(n, 4, size)?;
    let length = n as f32 * size;
    move_all(&mut surface, |[x, y, z]| {
        // The middle half has all of the twist.
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

/// A bar stretched by a tenth between pinned ends and cut through.
fn cut() -> Result<Scene, Box<dyn Error>> {
    let mut surface = bar([16, 4, 4], 0.0625);
    move_all(&mut surface, |[x, y, z]| [1.1 * x, y, z]);
    let pins = vertices_where(&surface, |[x, _, _]| x == 0.0 || x > 1.09);
    let sweep = Sweep::from_plane([1.0, 0.3, 0.2], 0.75, &surface.bounds())?;
    Ok(Scene {
        gravity: [0.0; 3],
        pins,
        sweep: Some(sweep),
        ..Scene::new("cut", surface, material(1e-3, Some(1.0)))
    })
}

/// An armadillo pinned at the top of its head.
fn armadillo() -> Scene {
    Scene {
        frames: 3,
        fine: [8, 16, 32],
        max_reference_substeps: 0,
        ..hung_model("armadillo", build_model(Model::Armadillo))
    }
}

/// The bodies whose frames after a cut are measured.
pub(super) fn hung_models() -> [Scene; 2] {
    [("bunny", Model::Bunny), ("armadillo", Model::Armadillo)]
        .map(|(name, model)| hung_model(name, build_model(model)))
}

/// A stiff body pinned at its top.
pub(super) fn hung_model(name: &'static str, surface: Surface) -> Scene {
    let top = surface.bounds().max[1] - 0.05;
    let pins = vertices_where(&surface, |[_, y, _]| y > top);
    Scene {
        pins,
        ..Scene::new(name, surface, material(1e-4, Some(1e-1)))
    }
}

fn move_all(surface: &mut Surface, to: impl Fn([f32; 3]) -> [f32; 3]) {
    for p in surface.positions_mut() {
        let [x, y, z] = to([p[0], p[1], p[2]]);
        [p[0], p[1], p[2]] = [x, y, z];
    }
}

fn vertices_where(surface: &Surface, is: impl Fn([f32; 3]) -> bool) -> Vec<VertexId> {
    let at = |v: &VertexId| {
        let [x, y, z, _] = surface.positions()[v.index()];
        is([x, y, z])
    };
    surface.topology().vertices().filter(at).collect()
}
