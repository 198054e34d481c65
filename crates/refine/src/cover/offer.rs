//! Where a point would go into a triangle, and what that would be worth.
//!
//! The place is Üngör's off-center (Off-centers: a new type of Steiner points, 2009): the
//! circumcenter, or nearer to the short side where the circumcenter would leave a sharp triangle on it
//! again, or one whose other two sides are longer than the target.

use super::cdt::{Cdt, incircle_of, orient, wall};
use super::spiral;

/// How far from the middle of the short side an off-center lies at most, in lengths of that side: where
/// the side is seen under 36 and under 58 degrees.
pub(crate) const REACH: [f64; 2] = [1.54, 0.9];

/// Triangles beside a rim that are sharper than those of 32 degrees count as what a spiral makes of them.
const PLAIN: f64 = 0.72;

/// A point that would be inserted, and what it is worth.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Offer {
    pub(crate) at: [f64; 2],
    pub(crate) triangle: u32,
    /// How sharp the sharpest angles are that are there and that would be, see [`sharpness`]; those that
    /// would be beside a rim once a [`spiral`] is complete.
    pub(crate) old: f64,
    pub(crate) new: f64,
    /// As they would be at once.
    pub(crate) plain: f64,
}

/// Room to look around a point.
#[derive(Debug, Clone, Default)]
pub(crate) struct Scales {
    cavity: Vec<u32>,
    link: Vec<u32>,
    stamps: Vec<u32>,
    stamp: u32,
}

impl Scales {
    pub(crate) fn clear(&mut self) {
        self.stamps.clear();
        self.stamp = 0;
    }

    /// What a point would replace and make: the sharpest angles. `None` where a wall is in between
    /// or the point would lie on something.
    pub(crate) fn weigh(&mut self, cdt: &Cdt, from: u32, at: [f64; 2]) -> Option<Offer> {
        let triangle = reach(cdt, from, at)?;
        self.stamps.resize(cdt.region.len(), 0);
        self.stamp += 1;
        self.stamps[triangle as usize] = self.stamp;
        self.cavity.clear();
        self.cavity.push(triangle);
        self.link.clear();
        let (mut old, mut new, mut plain) = (-1.0f64, -1.0f64, -1.0f64);
        let mut i = 0;
        while i < self.cavity.len() {
            let t = self.cavity[i];
            i += 1;
            old = old.max(sharpness(cdt.places(t)));
            for h in [3 * t, 3 * t + 1, 3 * t + 2] {
                if cdt.walls[h as usize] == wall::FREE {
                    let u = cdt.twin[h as usize] / 3;
                    if self.stamps[u as usize] == self.stamp {
                        continue;
                    }
                    if incircle_of(cdt.places(u), at) > 0.0 {
                        self.stamps[u as usize] = self.stamp;
                        self.cavity.push(u);
                        continue;
                    }
                }
                self.link.push(h);
            }
        }
        for &h in &self.link {
            let [p, q] = [cdt.start(h), cdt.end(h)].map(|v| cdt.point(v));
            if orient(p, q, at) <= 0.0 {
                return None;
            }
            let sharp = sharpness([p, q, at]);
            plain = plain.max(sharp);
            new = new.max(if sharp > PLAIN && cdt.walls[h as usize] != wall::FREE {
                sharp.min(spiral::sharpness_beside([p, q], at))
            } else {
                sharp
            });
        }
        Some(Offer {
            at,
            triangle,
            old,
            new,
            plain,
        })
    }
}

/// The triangle that holds `at`, if no wall is on the way from triangle `t`.
fn reach(cdt: &Cdt, mut t: u32, at: [f64; 2]) -> Option<u32> {
    for _ in 0..32 {
        let out = [3 * t, 3 * t + 1, 3 * t + 2]
            .into_iter()
            .find(|&h| orient(cdt.point(cdt.start(h)), cdt.point(cdt.end(h)), at) < 0.0);
        match out {
            None => return Some(t),
            Some(h) if cdt.walls[h as usize] != wall::FREE => return None,
            Some(h) => t = cdt.twin[h as usize] / 3,
        }
    }
    None
}

pub(crate) fn square(p: [f64; 2], q: [f64; 2]) -> f64 {
    (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2)
}

pub(crate) fn middle(p: [f64; 2], q: [f64; 2]) -> [f64; 2] {
    [0.5 * p[0] + 0.5 * q[0], 0.5 * p[1] + 0.5 * q[1]]
}

/// The square of the cosine of a triangle's smallest angle: from 1/4 up to 1, the sharper the more.
pub(crate) fn sharpness([a, b, c]: [[f64; 2]; 3]) -> f64 {
    let sides = [square(b, c), square(c, a), square(a, b)];
    let shortest = sides[0].min(sides[1]).min(sides[2]);
    let [x, y] = if sides[0] == shortest {
        [sides[1], sides[2]]
    } else if sides[1] == shortest {
        [sides[0], sides[2]]
    } else {
        [sides[0], sides[1]]
    };
    let part = x + y - shortest;
    part * part / (4.0 * x * y)
}

/// The shortest side of a triangle: which, and its length.
pub(crate) fn base(p: [[f64; 2]; 3]) -> (usize, f64) {
    let squares = [0, 1, 2].map(|k| square(p[k], p[(k + 1) % 3]));
    let k = (0..3).fold(
        0,
        |best, k| if squares[k] < squares[best] { k } else { best },
    );
    (k, squares[k].sqrt())
}

/// The circumcenter of a triangle, or the point `reach` lengths of side `k` off its middle where that
/// is nearer.
pub(crate) fn off_center(p: [[f64; 2]; 3], k: usize, reach: f64) -> Option<[f64; 2]> {
    let [a, b, c] = [p[k], p[(k + 1) % 3], p[(k + 2) % 3]];
    let (u, w) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
    let double = u[0] * w[1] - u[1] * w[0];
    let base = u[0] * u[0] + u[1] * u[1];
    if !(double > 0.0 && base > 0.0) {
        return None;
    }
    // The circumcenter lies this many sides off the middle of the side.
    let off = (w[0] * (w[0] - u[0]) + w[1] * (w[1] - u[1])) / (2.0 * double);
    let off = off.min(reach);
    let at = [
        a[0] + 0.5 * u[0] - off * u[1],
        a[1] + 0.5 * u[1] + off * u[0],
    ];
    (at[0].is_finite() && at[1].is_finite()).then_some(at)
}
