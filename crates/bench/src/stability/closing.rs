//! Colliders that close on a body, and open again.

use super::case::{Case, larger};
use super::error::StressError;
use super::group::{Group, Grouping, touching};
use super::measured::{Measured, Quantities, worst_of};
use super::runner::Runner;
use super::subjects::Subject;
use incise_mesh::Vec3;
use incise_pbd_gpu::{Collider, Material, Stiffness};
use incise_scene::BackendRequest;

const STRESS: &str = "two plates close on a weightless model to half its size, wait and open again";

pub(super) const CASES: [Case; 3] = [
    Case {
        id: "closing",
        stress: STRESS,
        invariant: "distance of a vertex in a plate at the end of a frame, in sizes",
        bound: 1e-3,
        run: |runner| worst_of(runner, 0, press),
    },
    Case {
        id: "closing",
        stress: STRESS,
        invariant: "speed of a vertex, relative to that of a plate",
        bound: 10.0,
        run: |runner| worst_of(runner, 1, press),
    },
    Case {
        id: "closing",
        stress: STRESS,
        invariant: "relative volume error, a second after the plates left",
        bound: 0.01,
        run: |runner| worst_of(runner, 2, press),
    },
];

/// Speed of each plate [m/s].
const SPEED: f64 = 0.25;
/// Distance of a plate's face from the middle at the start, and when closed \[m\].
const DISTANCES: [f64; 2] = [0.55, 0.25];
/// Time for which the plates stay closed, and time after they opened \[s\].
const WAITS: [f64; 2] = [0.5, 1.0];
/// Largest model of a full run.
const TRIANGLES: usize = 6000;

fn press(runner: &Runner) -> Result<Vec<Measured>, StressError> {
    let limit = runner.pick(100, TRIANGLES);
    let subjects = runner.setting.subjects.iter();
    let small = |subject: &&Subject| {
        let topology = subject.surface.topology();
        topology.triangle_count() <= limit && topology.is_closed()
    };
    let mut runs = Vec::new();
    for subject in subjects.filter(small) {
        for (name, stretch) in [("firm", 0.0), ("soft", 1e-4)] {
            runs.extend([0, 1].map(|axis| (subject, name, stretch, axis)));
        }
    }
    Ok(
        runner.each(&runs, |backend, &(subject, name, stretch, axis)| {
            let material = Material {
                stretch: Stiffness::Compliance(stretch),
                ..Material::soft_body()
            };
            Measured {
                at: format!("{}, {name}, axis {axis}", subject.name),
                quantities: press_one(backend, subject, &material, axis),
            }
        }),
    )
}

/// Returns the distance of the plates from the middle \[m\].
fn distance(time: f64) -> f64 {
    let [open, closed] = DISTANCES;
    let duration = (open - closed) / SPEED;
    let since_opening = time - duration - WAITS[0];
    (open - SPEED * time).max(closed) + (SPEED * since_opening).clamp(0.0, open - closed)
}

fn press_one(
    backend: &BackendRequest,
    subject: &Subject,
    material: &Material,
    axis: usize,
) -> Result<Quantities, StressError> {
    let surface = subject.surface.clone();
    let bounds = surface.bounds();
    let middle = bounds.center();
    let half = f64::from(bounds.max[axis] - bounds.min[axis]) / 2.0;
    let parts = (&[surface][..], Grouping::Bodies);
    let mut group = Group::new(backend, touching(0.0, None), parts, material)?;
    let opening = 2.0 * (DISTANCES[0] - DISTANCES[1]) / SPEED + WAITS[0];
    let (mut depth, mut speed) = (0.0, 0.0);
    let mut frame = 0_u32;
    while f64::from(frame) / 60.0 < opening + WAITS[1] {
        frame += 1;
        // The model's half extent along the axis counts as half a meter.
        let away = 2.0 * half * distance(f64::from(frame) / 60.0);
        group.scene.colliders = [-1.0, 1.0]
            .map(|side| plate(middle, axis, side * away))
            .into();
        group.step()?;
        for p in group.positions(0)? {
            depth = larger(depth, (p[axis] - middle[axis]).abs() - away);
        }
        speed = larger(speed, group.speed()?);
    }
    let relative = speed / (2.0 * half * SPEED);
    Ok(vec![
        Some(depth),
        Some(relative),
        Some(group.volume_error()?),
    ])
}

/// Returns a plate with its face at a signed distance from the middle along an axis \[m\].
fn plate(middle: Vec3, axis: usize, at: f64) -> Collider {
    let mut point = middle;
    point[axis] += at;
    let mut normal = [0.0; 3];
    normal[axis] = if at > 0.0 { -1.0 } else { 1.0 };
    Collider::Plane {
        point: incise_mesh::geometry::to_f32(point),
        normal,
    }
}
