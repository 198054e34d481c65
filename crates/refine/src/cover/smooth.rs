//! Points moved to where the sharpest angle around them is less sharp.
//!
//! A point goes to the middle of its neighbors where that helps (smart Laplacian smoothing, Freitag and
//! Ollivier-Gooch 1997); where what is left is sharp, it looks around for a better place, near and nearer.
//! Then the triangulation is made Delaunay around it again, which never makes the smallest angle
//! smaller.

use super::band::Band;
use super::cdt::{Cdt, next, prev, wall};
use super::improve::{Improver, fan};
use super::lattice::Lattice;
use super::mean::mean_in;
use super::offer::{middle, square};
use super::sheet::Sheet;
use super::size::Bounds;

/// How often every point is looked at, at most.
const SWEEPS: usize = 3;
/// How often they look,
const LOOKS: usize = 4;
/// how far at first, in lengths of the shortest edge there,
const FAR: f64 = 0.3;
/// and where to.
const DIRECTIONS: [[f64; 2]; 8] = {
    const D: f64 = std::f64::consts::FRAC_1_SQRT_2;
    [
        [1.0, 0.0],
        [D, D],
        [0.0, 1.0],
        [-D, D],
        [-1.0, 0.0],
        [-D, -D],
        [0.0, -1.0],
        [D, -D],
    ]
};
/// No edge becomes longer than this many targets.
const LONG: f64 = 1.7;
/// By what factor the square of the sine of the smallest angle must grow for a look to be worth it.
const GAIN: f64 = 1.05;
/// Twice the area of a triangle over the squares of two of its sides, below which it counts as flat.
const FLAT: f64 = 1e-12;

impl Improver {
    /// Moves the band's points that no triangle of the core is at, if something around them has changed since
    /// they were looked at.
    pub(crate) fn smooth(&mut self, sheet: &mut Sheet, lattice: &mut Lattice, band: &Band) {
        let cdt = &mut sheet.cdt;
        for _ in 0..SWEEPS {
            let mut moved = false;
            for (v, &point) in (band.first..).zip(&band.lattice) {
                if !std::mem::take(&mut self.stale[v as usize])
                    || lattice.has_cell.get(point as usize) == Some(&true)
                    || !self.star.read(cdt, v, &self.targets)
                {
                    continue;
                }
                let Some(at) = self.star.better_place(cdt.point(v), self.bounds) else {
                    continue;
                };
                self.base.last = self.hints[v as usize];
                let Some((parents, weights)) = mean_in(&mut self.base, at) else {
                    continue;
                };
                self.hints[v as usize] = self.base.last;
                lattice.points[point as usize] = at;
                lattice.parents[point as usize] = parents;
                lattice.weights[point as usize] = weights;
                cdt.points[v as usize] = at;
                for h in fan(cdt, v) {
                    self.stale[cdt.end(h) as usize] = true;
                    self.sides.extend([h, next(h)]);
                }
                cdt.stack.append(&mut self.sides);
                cdt.legalize_all();
                self.touch(cdt, v);
                moved = true;
            }
            if !moved {
                break;
            }
        }
    }

    /// Notes that the triangles around an inner vertex are new.
    pub(super) fn touch(&mut self, cdt: &Cdt, v: u32) {
        self.stale[v as usize] = true;
        for h in fan(cdt, v) {
            self.stale[cdt.end(h) as usize] = true;
        }
    }
}

/// The side of a triangle across from an inner vertex.
#[derive(Debug, Clone, Copy)]
struct Side {
    start: [f64; 2],
    end: [f64; 2],
    /// The square of its length.
    square: f64,
    /// What the square of the distance from the vertex to the start may be.
    most: f64,
}

/// The triangles around an inner vertex.
#[derive(Debug, Clone, Default)]
pub(crate) struct Star {
    /// The sides across from it.
    sides: Vec<Side>,
    /// The side that was the worst last.
    worst: usize,
}

impl Star {
    /// Looks at the triangles around `v`. Returns false where a wall ends there.
    fn read(&mut self, cdt: &Cdt, v: u32, targets: &[f64]) -> bool {
        self.sides.clear();
        self.worst = 0;
        for h in fan(cdt, v) {
            if cdt.walls[h as usize] != wall::FREE {
                return false;
            }
            let (w, start) = (cdt.end(h), cdt.point(cdt.end(h)));
            let end = cdt.point(cdt.start(prev(h)));
            let target = 0.5 * targets[v as usize] + 0.5 * targets[w as usize];
            self.sides.push(Side {
                start,
                end,
                square: square(start, end),
                most: square(start, cdt.point(v)).max((LONG * target).powi(2)),
            });
        }
        true
    }

    /// Where the vertex has a larger smallest angle around it than where it is.
    #[expect(clippy::cast_precision_loss, reason = "a handful of sides")]
    fn better_place(&mut self, from: [f64; 2], bounds: Bounds) -> Option<[f64; 2]> {
        let old = self.sharpest(from, 1.0).unwrap_or(1.0);
        if old < bounds.moved {
            return None;
        }
        let sum = self.sides.iter().fold([0.0; 2], |sum, side| {
            [sum[0] + side.start[0], sum[1] + side.start[1]]
        });
        let center = sum.map(|x| x / self.sides.len() as f64);
        let (mut sharpest, mut best) = (old, from);
        for at in [center, middle(center, from)] {
            if let Some(new) = self.sharpest(at, sharpest) {
                (sharpest, best) = (new, at);
                break;
            }
        }
        if sharpest > bounds.searched {
            let nearest = self.sides.iter().map(|side| square(side.start, best));
            let mut step = FAR * nearest.fold(f64::MAX, f64::min).sqrt();
            for _ in 0..LOOKS {
                let center = best;
                for [x, y] in DIRECTIONS {
                    let at = [center[0] + step * x, center[1] + step * y];
                    if let Some(new) = self.sharpest(at, 1.0 - GAIN * (1.0 - sharpest)) {
                        (sharpest, best) = (new, at);
                    }
                }
                if best == center {
                    step *= 0.5;
                }
            }
        }
        (sharpest < old).then_some(best)
    }

    /// How sharp the sharpest angle would be with the vertex at `at`; none where a triangle would turn over or be
    /// as sharp as `most`, or an edge too long.
    fn sharpest(&mut self, at: [f64; 2], most: f64) -> Option<f64> {
        let (ahead, behind) = self.sides.split_at(self.worst);
        let mut sharpest = 0.0f64;
        for (i, side) in behind.iter().chain(ahead).enumerate() {
            let (p, q, c) = (side.start, side.end, side.square);
            let (u, w) = ([p[0] - at[0], p[1] - at[1]], [q[0] - at[0], q[1] - at[1]]);
            let (a, b) = (u[0] * u[0] + u[1] * u[1], w[0] * w[0] + w[1] * w[1]);
            let double = u[0] * w[1] - u[1] * w[0];
            let least = a.min(b).min(c);
            let part = a + b + c - 2.0 * least;
            let sharp = part * part * least / (4.0 * a * b * c);
            if a > side.most || double <= FLAT * (a + b) || sharp.is_nan() || sharp >= most {
                self.worst = (self.worst + i) % self.sides.len();
                return None;
            }
            sharpest = sharpest.max(sharp);
        }
        Some(sharpest)
    }
}
