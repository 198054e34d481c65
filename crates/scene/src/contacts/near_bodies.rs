//! Pairs of bodies whose boxes may overlap within the frame.
//!
//! Called by [`super::ContactDetection`] before anything looks at pieces, so that a body far from
//! all others costs one pass over its vertices, and a sleeping one nothing.

use super::{ContactFrame, SPEED_MARGIN};
use crate::body::Body;
use incise_mesh::{Aabb, index_u32};

/// The box of a body, grown by its motion.
#[derive(Debug, Clone, Copy)]
struct BodyBox {
    body: u32,
    bounds: Aabb,
    is_asleep: bool,
}

/// The pairs of near bodies, in memory reused between frames.
#[derive(Debug, Clone, Default)]
pub(super) struct NearBodies {
    boxes: Vec<BodyBox>,
    /// By body index: whether it is near another one, and one of both is awake.
    is_near: Vec<bool>,
}

impl NearBodies {
    /// Removes all boxes; there are `bodies` bodies.
    pub(super) fn clear(&mut self, bodies: usize) {
        self.boxes.clear();
        self.is_near.clear();
        self.is_near.resize(bodies, false);
    }

    /// Adds the box of a body, which includes its motion in the frame.
    pub(super) fn push(&mut self, body: usize, bounds: Aabb, is_asleep: bool) {
        self.boxes.push(BodyBox {
            body: index_u32(body),
            bounds,
            is_asleep,
        });
    }

    /// Finds the near bodies by a sweep along the x axis.
    pub(super) fn find(&mut self) {
        let x = |b: &BodyBox| b.bounds.min[0];
        (self.boxes).sort_unstable_by(|a, b| x(a).total_cmp(&x(b)).then(a.body.cmp(&b.body)));
        for (i, a) in self.boxes.iter().enumerate() {
            let later = self.boxes[i + 1..].iter();
            for b in later.take_while(|b| x(b) <= a.bounds.max[0]) {
                if !(a.is_asleep && b.is_asleep) && a.bounds.overlaps(&b.bounds) {
                    self.is_near[a.body as usize] = true;
                    self.is_near[b.body as usize] = true;
                }
            }
        }
    }

    /// Returns whether a body may collide with another one.
    pub(super) fn is_near(&self, body: usize) -> bool {
        self.is_near.get(body).is_some_and(|&is_near| is_near)
    }
}

/// Returns a box that a body does not leave in a frame unless its speed grows by the margin.
///
/// It includes the minimum distance between surfaces.
pub(super) fn reachable_bounds(body: &Body, frame: &ContactFrame<'_>) -> Aabb {
    let surface = body.surface();
    let mut bounds = surface.bounds();
    let velocities = body.solver().velocities().iter().map(|v| v.map(f64::from));
    let square = velocities
        .map(|[x, y, z, _]| x * x + y * y + z * z)
        .fold(0.0, f64::max);
    for pin in body.solver().pins() {
        for (k, c) in pin.target.into_iter().enumerate() {
            bounds.min[k] = bounds.min[k].min(c);
            bounds.max[k] = bounds.max[k].max(c);
        }
    }
    let displacement = (SPEED_MARGIN * square.sqrt() + frame.speed_gain) * frame.dt;
    grow(&mut bounds, frame.thickness(body) + displacement);
    bounds
}

/// Grows a box on all sides by `margin` \[m\].
#[expect(
    clippy::cast_possible_truncation,
    reason = "the box is grown by much more than the rounding of its corners"
)]
pub(super) fn grow(bounds: &mut Aabb, margin: f64) {
    for k in 0..3 {
        bounds.min[k] = (f64::from(bounds.min[k]) - margin) as f32;
        bounds.max[k] = (f64::from(bounds.max[k]) + margin) as f32;
    }
}
