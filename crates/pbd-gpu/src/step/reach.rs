//! Bodies that no collider can reach within a frame, which skip the passes over them.

use crate::solver::Solver;
use crate::step::island::IslandBody;
use incise_mesh::{Aabb, Surface};

/// Assumed motion of a vertex, relative to the maximum over all bodies by velocity and gravity.
///
/// A heavy body throws a light one at twice its own speed.
const MARGIN: f64 = 2.0;

/// Returns the maximum motion of a vertex of bodies with colliders within `dt` \[s\] by velocities,
/// pins and gravity \[m\].
pub(crate) fn max_motion(bodies: &[IslandBody<'_>], dt: f32, gravity: [f32; 3]) -> f64 {
    if bodies
        .iter()
        .all(|(solver, _)| solver.colliders().is_empty())
    {
        return 0.0;
    }
    let dt = f64::from(dt);
    let of_body = |(solver, surface): &IslandBody<'_>| {
        let velocities = solver.velocities().iter();
        let speed = velocities.map(|v| square(*v)).fold(0.0, f64::max).sqrt();
        // A surface of another solver is refused later.
        let pins = solver.pins().iter().filter_map(|pin| {
            let [x, y, z, _] = *surface.positions().get(pin.vertex.index())?;
            let [tx, ty, tz] = pin.target;
            Some(square([tx - x, ty - y, tz - z, 0.0]).sqrt())
        });
        pins.fold(speed * dt, f64::max)
    };
    let [gx, gy, gz] = gravity;
    let fall = square([gx, gy, gz, 0.0]).sqrt() * dt * dt;
    bodies.iter().map(of_body).fold(0.0, f64::max) + fall
}

/// Returns whether a collider may reach a body within `dt` \[s\], in which vertices move by
/// `motion` \[m\].
///
/// The body may move by its diagonal more, since springs may throw it. O(vertices) with colliders.
pub(crate) fn reaches_colliders(solver: &Solver, surface: &Surface, motion: f64, dt: f32) -> bool {
    let colliders = solver.colliders();
    if colliders.is_empty() {
        return false;
    }
    let rest = surface.rest_positions().iter();
    let size = Aabb::around(rest.map(|&[x, y, z, ..]| [x, y, z])).diagonal();
    let mut bounds = surface.bounds();
    for pin in solver.pins() {
        bounds.grow(pin.target);
    }
    let margin = MARGIN * motion + size.max(bounds.diagonal());
    colliders
        .iter()
        .any(|collider| collider.reaches(&bounds, margin, dt))
}

fn square(v: [f32; 4]) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|k| f64::from(v[k]));
    x * x + y * y + z * z
}
