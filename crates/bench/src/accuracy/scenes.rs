//! The eleven scenes of the accuracy bench, of models, sheets, strips and bars.

use super::scene::Scene;
use incise_cut::Sweep;
use incise_mesh::{Surface, TopologyError, Vec3, VertexId};
use incise_models::scenes::cuboid;
use incise_models::{Model, build_model, place};
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
    let weightless = |surface| Scene {
        gravity: [0.0; 3],
        ..Scene::new(name, surface, material(1e-3, Some(1.0)))
    };
    Ok(match name {
        // A horizontal strip of 20 particles, the first two pinned.
        "chain" => Scene {
            pins: [0, 1].map(VertexId).into(),
            frames: 30,
            ..Scene::new(name, zigzag(20, 0.1)?, material(1e-8, None))
        },
        "sheet-1e2" => hung_sheet(name, 1e-2)?,
        "sheet-1e4" => hung_sheet(name, 1e-4)?,
        "sheet-1e6" => hung_sheet(name, 1e-6)?,
        "bar" => pinned_bar(name, None),
        "bar-volume" => pinned_bar(name, Some(Volume::default())),
        // A bunny stretched by a tenth.
        "bunny" => {
            let mut surface = build_model(Model::Bunny);
            move_all(&mut surface, |[x, y, z]| [1.1 * x, y, z]);
            Scene {
                frames: 10,
                ..weightless(surface)
            }
        }
        // A ball that hits the ground at 2 m/s.
        "drop" => {
            let surface = build_model(Model::Sphere768);
            Scene {
                ground: Some(surface.bounds().min[1] - 0.05),
                velocities: vec![[0.0, -2.0, 0.0]; surface.topology().vertex_count()],
                ..Scene::new(name, surface, material(1e-5, Some(1e-2)))
            }
        }
        "ribbon" => {
            let (surface, pins) = twisted_ribbon()?;
            Scene {
                pins,
                ..weightless(surface)
            }
        }
        // A bar stretched by a tenth between pinned ends and cut through.
        "cut" => {
            let mut surface = bar([16, 4, 4], 0.0625);
            move_all(&mut surface, |[x, y, z]| [1.1 * x, y, z]);
            let bounds = surface.bounds();
            Scene {
                pins: vertices_where(&surface, |[x, _, _]| x == 0.0 || x > 1.09),
                sweep: Some(Sweep::from_plane([1.0, 0.3, 0.2], 0.75, &bounds)?),
                ..weightless(surface)
            }
        }
        // An armadillo pinned at the top of its head.
        _ => {
            let surface = build_model(Model::Armadillo);
            let top = surface.bounds().max[1] - 0.05;
            Scene {
                frames: 3,
                fine: [8, 16, 32],
                max_reference_substeps: 0,
                pins: vertices_where(&surface, |[_, y, _]| y > top),
                ..Scene::new(name, surface, material(1e-4, Some(1e-1)))
            }
        }
    })
}

/// Compliances of stretch [m/N] and bending [rad/(N m)], 1 kg/m^2, without damping and friction.
fn material(stretch: f32, bending: Option<f32>) -> Material {
    Material {
        density: Density::Area(1.0),
        stretch: Stiffness::Compliance(stretch),
        bending: bending.map(Stiffness::Compliance),
        volume: None,
        interior_springs: None,
        solid: None,
        damping: 0.0,
        friction: 0.0,
    }
}

/// A horizontal sheet of 1 m, pinned at two corners.
fn hung_sheet(name: &'static str, stretch: f32) -> Result<Scene, TopologyError> {
    let n = 12;
    let surface = sheet(n, n, 1.0 / n as f32)?;
    Ok(Scene {
        pins: [0, n].map(VertexId).into(),
        ..Scene::new(name, surface, material(stretch, Some(10.0)))
    })
}

/// A bar pinned at one end, with a volume constraint or without.
fn pinned_bar(name: &'static str, volume: Option<Volume>) -> Scene {
    let surface = bar([16, 4, 4], 0.0625);
    let material = Material {
        volume,
        ..material(1e-5, Some(1e-2))
    };
    Scene {
        pins: vertices_where(&surface, |[x, _, _]| x == 0.0),
        ..Scene::new(name, surface, material)
    }
}

/// A ribbon twisted by half a turn, and the vertices of its ends.
fn twisted_ribbon() -> Result<(Surface, Vec<VertexId>), TopologyError> {
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
    let ends = vertices_where(&surface, |[x, _, _]| x == 0.0 || x > last);
    Ok((surface, ends))
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

/// A sheet of `across` by `along` squares of side `size` \[m\] in the plane of x and z; diagonals
/// alternate. Vertex `i (along + 1) + j` is at x = `i size`, z =
/// `j size`.
fn sheet(across: u32, along: u32, size: f32) -> Result<Surface, TopologyError> {
    let mut points = Vec::new();
    let mut faces = Vec::new();
    for i in 0..=across {
        for j in 0..=along {
            points.push([i as f32 * size, 0.0, j as f32 * size]);
            if i < across && j < along {
                let a = i * (along + 1) + j;
                let (b, c, d) = (a + 1, a + along + 2, a + along + 1);
                if (i + j) % 2 == 0 {
                    faces.extend([[a, b, c], [a, c, d]]);
                } else {
                    faces.extend([[a, b, d], [b, c, d]]);
                }
            }
        }
    }
    Surface::from_triangles(&points, &faces)
}

/// A zigzag strip of `points` particles, `size` \[m\] apart along x.
fn zigzag(points: u32, size: f32) -> Result<Surface, TopologyError> {
    let at = |i: u32| [0.5 * i as f32 * size, 0.0, (i % 2) as f32 * 0.866 * size];
    let faces: Vec<[u32; 3]> = (2..points)
        .map(|i| {
            if i % 2 == 0 {
                [i - 2, i - 1, i]
            } else {
                [i - 1, i - 2, i]
            }
        })
        .collect();
    Surface::from_triangles(&(0..points).map(at).collect::<Vec<_>>(), &faces)
}

/// A closed box of `n` cubes a side of `size` \[m\], a corner at the origin.
fn bar(n: [u32; 3], size: f64) -> Surface {
    let sides = n.map(|count| f64::from(count) * size);
    let mut surface = cuboid(sides, n);
    place(&mut surface, |p| p + Vec3::from(sides) / 2.0);
    surface
}
