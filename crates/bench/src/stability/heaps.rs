//! Heaps of bodies that come to rest: small ones in a bowl, and models on each other.

use super::case::Case;
use super::error::StressError;
use super::group::{Group, Grouping, touching};
use super::measured::{Measured, Quantities, worst_of};
use super::runner::Runner;
use super::scenes::place;
use super::subjects::Subject;
use crate::directions::Directions;
use incise_mesh::{Surface, Vec3, icosphere};
use incise_pbd_gpu::{Collider, Material};
use incise_scene::BackendRequest;
use std::f64::consts::TAU;

const BOWL: &str = "a thousand balls of 20 triangles poured into a bowl of planes";
const STACK: &str = "ten models fall on each other";

pub(super) const CASES: [Case; 6] = [
    Case {
        id: "bowl",
        stress: BOWL,
        invariant: "time until they sleep [s]",
        bound: 30.0,
        run: |runner| worst_of(runner, 0, bowl),
    },
    Case {
        id: "bowl",
        stress: BOWL,
        invariant: "depth of a vertex in another ball at the end, in radii",
        bound: 0.1,
        run: |runner| worst_of(runner, 1, bowl),
    },
    Case {
        id: "bowl",
        stress: BOWL,
        invariant: "distance of a vertex outside of the bowl at the end, in radii",
        bound: 0.1,
        run: |runner| worst_of(runner, 2, bowl),
    },
    Case {
        id: "stack",
        stress: STACK,
        invariant: "time until they sleep [s]",
        bound: 30.0,
        run: |runner| worst_of(runner, 0, stack),
    },
    Case {
        id: "stack",
        stress: STACK,
        invariant: "depth of a vertex in another model at the end, in sizes",
        bound: 0.01,
        run: |runner| worst_of(runner, 1, stack),
    },
    Case {
        id: "stack",
        stress: STACK,
        invariant: "relative volume error at the end",
        bound: 0.01,
        run: |runner| worst_of(runner, 2, stack),
    },
];

/// Longest wait for a heap to sleep \[s\]: a second beyond the bound.
const LONGEST: f64 = 31.0;
/// Radius of a poured ball \[m\].
const RADIUS: f64 = 0.05;
/// Radius of the bowl's floor \[m\]; its walls rise by 45 degrees.
const FLOOR: f64 = 0.4;
/// Number of the bowl's walls.
const WALLS: u32 = 8;
/// Size of a stacked model \[m\].
const SIZE: f64 = 0.5;

/// Returns the inward normal of a wall of the bowl.
fn wall(number: u32) -> Vec3 {
    let angle = TAU * f64::from(number) / f64::from(WALLS);
    Vec3::new(-angle.cos(), 1.0, -angle.sin()).normalize()
}

/// Returns the distance of a point outside of the bowl \[m\].
fn outside(p: &Vec3) -> f64 {
    let walls = (0..WALLS).map(|number| {
        let normal = wall(number);
        let foot = Vec3::new(-normal.x, 0.0, -normal.z).normalize() * FLOOR;
        -normal.dot(&(p - foot))
    });
    walls.fold(-p.y, f64::max).max(0.0)
}

/// Balls in layers above the bowl, each a little beside its place.
fn poured(count: u32) -> Vec<Surface> {
    let mut directions = Directions(5);
    let ball = |number: u32| {
        let [x, z, y] = [number % 8, number / 8 % 8, number / 64].map(f64::from);
        let beside = Vec3::new(directions.next(), 0.0, directions.next()) * 0.005;
        let at = Vec3::new(x - 3.5, y + 1.0, z - 3.5) * (2.4 * RADIUS) + beside;
        let mut ball = icosphere(0, RADIUS);
        place(&mut ball, |p| p + at + Vec3::new(0.0, 3.0 * RADIUS, 0.0));
        ball
    };
    (0..count).map(ball).collect()
}

fn bowl(runner: &Runner) -> Result<Vec<Measured>, StressError> {
    let count = runner.pick(60, 1000);
    Ok(runner.each(&[count], |backend, &count| Measured {
        at: format!("{count} balls"),
        quantities: pour(backend, count),
    }))
}

fn pour(backend: &BackendRequest, count: u32) -> Result<Quantities, StressError> {
    let parts = (&poured(count)[..], Grouping::Bodies);
    let params = touching(9.81, Some(0.0));
    let mut group = Group::new(backend, params, parts, &Material::soft_body())?;
    let plane = |number| {
        let normal = wall(number);
        let foot = Vec3::new(-normal.x, 0.0, -normal.z).normalize() * FLOOR;
        Collider::Plane {
            point: incise_mesh::geometry::to_f32(foot),
            normal: incise_mesh::geometry::to_f32(normal),
        }
    };
    group.scene.colliders = (0..WALLS).map(plane).collect();
    let seconds = group.settle(LONGEST)?;
    let mut left = 0.0_f64;
    for part in 0..count as usize {
        left = group
            .positions(part)?
            .iter()
            .map(outside)
            .fold(left, f64::max);
    }
    let depth = group.depth()?;
    Ok(vec![
        Some(seconds),
        Some(depth / RADIUS),
        Some(left / RADIUS),
    ])
}

fn stack(runner: &Runner) -> Result<Vec<Measured>, StressError> {
    let count = runner.pick(3, 10);
    let limit = runner.pick(100, 3000);
    let subjects = runner.setting.subjects.iter();
    let small = |subject: &&Subject| {
        let topology = subject.surface.topology();
        topology.triangle_count() <= limit && topology.is_closed()
    };
    let models: Vec<&Subject> = subjects.filter(small).collect();
    let mut directions = Directions(7);
    let above = |(k, subject): (u32, &&Subject)| {
        let mut surface = subject.surface.clone();
        let beside = Vec3::new(directions.next(), 0.0, directions.next()) * (0.1 * SIZE);
        let at = beside + Vec3::new(0.0, f64::from(k) * 1.1 * SIZE, 0.0);
        place(&mut surface, |p| p * SIZE + at);
        surface
    };
    let surfaces: Vec<Surface> = (0..count).zip(models.iter().cycle()).map(above).collect();
    Ok(
        runner.each(&Grouping::ALL, |backend, &(name, grouping)| Measured {
            at: name.to_owned(),
            quantities: pile(backend, &surfaces, grouping),
        }),
    )
}

fn pile(
    backend: &BackendRequest,
    surfaces: &[Surface],
    grouping: Grouping,
) -> Result<Quantities, StressError> {
    let params = touching(9.81, Some(0.0));
    let material = Material::soft_body();
    let mut group = Group::new(backend, params, (surfaces, grouping), &material)?;
    let seconds = group.settle(LONGEST)?;
    let depth = group.depth()? / SIZE;
    Ok(vec![
        Some(seconds),
        Some(depth),
        Some(group.volume_error()?),
    ])
}
