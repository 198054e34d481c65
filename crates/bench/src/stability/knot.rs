//! A rope with a knot that is pulled tight.

use super::case::{Case, larger};
use super::error::StressError;
use super::group::{Group, Grouping, touching};
use super::measured::{Measured, Quantities, worst_of};
use super::runner::Runner;
use super::solids::rope;
use incise_mesh::geometry::to_f32;
use incise_mesh::{Vec3, VertexId};
use incise_pbd_gpu::Material;
use incise_scene::{BackendRequest, ContactParams, SceneParams};

pub(super) const CASES: [Case; 1] = [Case {
    id: "knot",
    stress: "a weightless rope with an open trefoil knot, pulled at both ends",
    invariant: "missing distance between parts of the rope that are not neighbors, in diameters",
    bound: 0.5,
    run: |runner| worst_of(runner, 0, pull),
}];

/// Radius of the rope \[m\].
const RADIUS: f64 = 0.012;
/// Vertices of a ring.
const SIDES: u32 = 6;
/// Length of rope in which parts are neighbors \[m\]: half a turn of a tight knot.
const NEIGHBORS: f64 = 6.0 * RADIUS;
/// Distance that each end is pulled \[m\], and the speed [m/s].
const PULL: [f64; 2] = [0.7, 0.5];

/// Returns points of Shastri's polynomial trefoil `(t^3 - 3 t, t^4 - 4 t^2, t^5 - 10 t)`, flattened
/// and of about 2.7 m, at equal distances.
fn trefoil(points: u32) -> Vec<Vec3> {
    let at = |t: f64| {
        let flat = 0.2 * (t.powi(5) - 10.0 * t);
        Vec3::new(t.powi(3) - 3.0 * t, t.powi(4) - 4.0 * t * t, flat) * 0.1
    };
    let fine: Vec<Vec3> = (-2000..=2000)
        .map(|i| at(2.05 * f64::from(i) / 2000.0))
        .collect();
    let steps = || fine.windows(2).map(|ends| (ends[1] - ends[0]).norm());
    let spacing = steps().sum::<f64>() / f64::from(points - 1);
    let (mut curve, mut since) = (vec![fine[0]], 0.0);
    for (step, &p) in steps().zip(&fine[1..]) {
        since += step;
        if since >= spacing {
            curve.push(p);
            since -= spacing;
        }
    }
    curve
}

fn pull(runner: &Runner) -> Result<Vec<Measured>, StressError> {
    let points = runner.pick(110, 220);
    Ok(runner.each(&[points], |backend, &points| Measured {
        at: format!("{points} rings"),
        quantities: tighten(backend, points),
    }))
}

fn tighten(backend: &BackendRequest, points: u32) -> Result<Quantities, StressError> {
    let curve = trefoil(points);
    let surface = rope(&curve, RADIUS, SIDES)?;
    let params = SceneParams {
        contacts: Some(ContactParams {
            self_collision: true,
            ..ContactParams::default()
        }),
        ..touching(0.0, None)
    };
    let parts = (&[surface][..], Grouping::Bodies);
    let mut group = Group::new(backend, params, parts, &Material::soft_body())?;
    let (first, last) = (curve[0], curve[curve.len() - 1]);
    let spacing = (curve[1] - curve[0]).norm();
    let along = (last - first).normalize();
    let mut ends: Vec<(VertexId, Vec3, Vec3)> = Vec::new();
    for (end, way) in [(first, -along), (last, along)] {
        for v in group.pin(0, |p| (p - end).norm() < 1.1 * RADIUS)? {
            ends.push((v, group.surface_of(0)?.position(v), way));
        }
    }
    let [distance, speed] = PULL;
    let mut missing = 0.0;
    for frame in 1..=120_u32 {
        let pulled = (speed * f64::from(frame) / 60.0).min(distance);
        for &(v, from, way) in &ends {
            group.drag(0, v, to_f32(from + way * pulled))?;
        }
        group.step()?;
        let centers = centers(&group, curve.len())?;
        missing = larger(missing, 1.0 - nearest(&centers, spacing) / (2.0 * RADIUS));
    }
    Ok(vec![Some(missing)])
}

/// Returns the centers of the rope's rings.
fn centers(group: &Group, rings: usize) -> Result<Vec<Vec3>, StressError> {
    let surface = group.surface_of(0)?;
    let sides = SIDES as usize;
    let center = |ring: usize| {
        let own = (ring * sides..(ring + 1) * sides).map(VertexId::from_index);
        own.map(|v| surface.position(v)).sum::<Vec3>() / f64::from(SIDES)
    };
    Ok((0..rings).map(center).collect())
}

/// Returns the smallest distance between rings that are not neighbors along the rope \[m\].
fn nearest(centers: &[Vec3], spacing: f64) -> f64 {
    let mut nearest = f64::INFINITY;
    for (i, p) in centers.iter().enumerate() {
        for (j, q) in centers.iter().enumerate().skip(i + 1) {
            if (j - i) as f64 * spacing > NEIGHBORS {
                nearest = nearest.min((p - q).norm());
            }
        }
    }
    nearest
}
