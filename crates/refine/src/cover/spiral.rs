//! Spirals: triangles around a corner of a rim, each larger than the one before by the same factor and at the same
//! angle, are the best way from a short edge to a long one.
//!
//! Where the rim's edges differ by ten, no single point helps: the first one leaves a triangle with
//! the long edge that is sharper than what was there. It is worth what the complete spiral is worth.

use super::cdt::{Cdt, wall};
use super::offer::{base, sharpness, square};

/// The most triangles of a spiral: for edges that differ by fifty.
const STEPS: [f64; 5] = [1.0, 2.0, 3.0, 4.0, 5.0];

/// The spiral between two edges that leave a corner.
struct Spiral {
    corner: [f64; 2],
    /// Where the short edge ends, seen from the corner.
    short: [f64; 2],
    /// The angle from there to the long edge, and how many times longer that is.
    turn: f64,
    growth: f64,
    /// How many triangles are best.
    steps: f64,
    /// Of its triangles.
    sharpness: f64,
}

impl Spiral {
    fn between(corner: [f64; 2], long: [f64; 2], short: [f64; 2]) -> Self {
        let [u, w] = [short, long].map(|p| [p[0] - corner[0], p[1] - corner[1]]);
        let mut spiral = Self {
            corner,
            short: u,
            turn: (u[0] * w[1] - u[1] * w[0]).atan2(u[0] * w[0] + u[1] * w[1]),
            growth: (square(corner, long) / square(corner, short)).sqrt(),
            steps: 1.0,
            sharpness: f64::INFINITY,
        };
        for steps in STEPS {
            let sharpness = sharpness([corner, short, spiral.point(1.0 / steps)]);
            if sharpness < spiral.sharpness {
                (spiral.sharpness, spiral.steps) = (sharpness, steps);
            }
        }
        spiral
    }

    /// The point after this part of the way.
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

/// How sharp the triangles of a spiral would be between a rim's edge, which must stay, and the shorter of the edges
/// from its ends to `at`.
pub(super) fn sharpness_beside([p, q]: [[f64; 2]; 2], at: [f64; 2]) -> f64 {
    let (near, far) = if square(p, at) <= square(q, at) {
        (p, q)
    } else {
        (q, p)
    };
    if square(near, at) < square(near, far) {
        Spiral::between(near, far, at).sharpness
    } else {
        f64::INFINITY
    }
}

/// Where spirals from the shortest side of a triangle to a longer one on a rim go first, around either end.
pub(super) fn points(cdt: &Cdt, t: u32) -> impl Iterator<Item = [f64; 2]> {
    let p = cdt.places(t);
    let (k, _) = base(p);
    let [start, end, apex] = [0, 1, 2].map(|i| (k + i) % 3);
    // The side before the shortest leaves its start, the one after its end.
    let around = [(start, end, apex), (end, start, end)];
    let is_wall = around.map(|(.., side)| cdt.walls[3 * t as usize + side] != wall::FREE);
    let around = around.into_iter().zip(is_wall);
    around.filter_map(move |((corner, short, _), is_wall)| {
        let spiral = is_wall.then(|| Spiral::between(p[corner], p[apex], p[short]))?;
        (spiral.steps > 1.0).then(|| spiral.point(1.0 / spiral.steps))
    })
}
