//! Logarithmic spirals of triangles around a corner, from a short edge to a long one.
//!
//! Similar triangles that grow by a constant factor give the largest minimum angle between two
//! edges of different length. If they differ by ten, no single point helps: the first one leaves a
//! worse triangle at the long edge. Such a point is therefore rated by its complete spiral.

use super::off_center::{cos2_min_angle, distance_squared, shortest_side, squared_sides};
use crate::section_mesh::cdt::{Cdt, constraint};

/// Numbers of triangles to try; five suffice for edges that differ by fifty.
const STEPS: [f64; 5] = [1.0, 2.0, 3.0, 4.0, 5.0];

/// The spiral between two edges at a corner.
struct Spiral {
    corner: [f64; 2],
    /// The short edge as a vector from the corner.
    short: [f64; 2],
    /// Angle from the short to the long edge \[rad\].
    turn: f64,
    /// Length of the long edge relative to the short one.
    growth: f64,
    /// Number of triangles with the largest minimum angle.
    steps: f64,
    /// cos^2 of the minimum angle of its triangles.
    cos2: f64,
}

impl Spiral {
    /// Returns the best spiral from `short` to `long` around `corner`.
    fn between(corner: [f64; 2], long: [f64; 2], short: [f64; 2]) -> Self {
        let [u, w] = [short, long].map(|p| [p[0] - corner[0], p[1] - corner[1]]);
        let mut spiral = Self {
            corner,
            short: u,
            turn: (u[0] * w[1] - u[1] * w[0]).atan2(u[0] * w[0] + u[1] * w[1]),
            growth: (distance_squared(corner, long) / distance_squared(corner, short)).sqrt(),
            steps: 1.0,
            cos2: f64::INFINITY,
        };
        for steps in STEPS {
            let cos2 = cos2_min_angle([corner, short, spiral.point(1.0 / steps)]);
            // More triangles have a smaller angle at the corner and a ratio closer to 1.
            if cos2 >= spiral.cos2 {
                break;
            }
            (spiral.cos2, spiral.steps) = (cos2, steps);
        }
        spiral
    }

    /// Returns the point of the spiral at `part`, from 0 at the short edge to 1 at the long one.
    fn point(&self, part: f64) -> [f64; 2] {
        let (sin, cos) = (part * self.turn).sin_cos();
        let scale = self.growth.powf(part);
        let [x, y] = self.short;
        [
            self.corner[0] + scale * (cos * x - sin * y),
            self.corner[1] + scale * (sin * x + cos * y),
        ]
    }
}

/// Returns cos^2 of the minimum angle of the spiral from `at` to a rim edge that cannot be split.
///
/// The spiral starts at the shorter of the edges from the rim edge's ends to `at`.
pub(super) fn cos2_beside([p, q]: [[f64; 2]; 2], at: [f64; 2]) -> f64 {
    let (near, far) = if distance_squared(p, at) <= distance_squared(q, at) {
        (p, q)
    } else {
        (q, p)
    };
    if distance_squared(near, at) < distance_squared(near, far) {
        Spiral::between(near, far, at).cos2
    } else {
        f64::INFINITY
    }
}

/// Returns the first points of the spirals from a triangle's shortest side to its rim edges.
pub(super) fn points(cdt: &Cdt, t: u32) -> impl Iterator<Item = [f64; 2]> {
    let p = cdt.corner_points(t);
    let (k, _) = shortest_side(squared_sides(p));
    let [start, end, apex] = [0, 1, 2].map(|i| (k + i) % 3);
    // The side before the shortest leaves its start, the one after its end.
    let around = [(start, end, apex), (end, start, end)];
    let is_constrained =
        around.map(|(.., side)| cdt.constraints[3 * t as usize + side] != constraint::FREE);
    let around = around.into_iter().zip(is_constrained);
    around.filter_map(move |((corner, short, _), is_constrained)| {
        let spiral = is_constrained.then(|| Spiral::between(p[corner], p[apex], p[short]))?;
        (spiral.steps > 1.0).then(|| spiral.point(1.0 / spiral.steps))
    })
}
