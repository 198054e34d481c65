//! Smoothing: moves points to increase the minimum angle around them.
//!
//! A point moves to the mean of its neighbors if that helps (smart Laplacian smoothing, Freitag and
//! Ollivier-Gooch 1997). If the angle is still small, a pattern search tries positions around it.
//! Flips then restore the Delaunay property, which never decreases the minimum angle.

use super::off_center::{distance_squared, midpoint};
use super::{Refiner, outgoing_half_edges};
use crate::section_mesh::barycentric::barycentric_weights;
use crate::section_mesh::boundary_band::BoundaryBand;
use crate::section_mesh::cdt::{Cdt, constraint, next, prev};
use crate::section_mesh::lattice::Lattice;
use crate::section_mesh::loop_triangulation::LoopTriangulation;
use crate::section_mesh::target_length::AngleBounds;

/// Maximum number of sweeps over all points.
const SWEEPS: usize = 3;
/// Number of steps of the pattern search.
const SEARCH_STEPS: usize = 3;
/// First step length of the pattern search, relative to the shortest edge.
const SEARCH_START: f64 = 0.3;
/// Directions of the pattern search.
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
/// Maximum length of an edge in targets after a move.
const MAX_EDGE_RATIO: f64 = 1.7;
/// Minimum growth of sin^2 of the minimum angle for a step of the pattern search.
const MIN_SEARCH_GAIN: f64 = 1.05;
/// Triangles count as flat if twice the area is below this share of two squared sides.
const MIN_AREA: f64 = 1e-12;

impl Refiner {
    /// Smooths the band's points that are not corners of the core and whose neighborhood changed.
    pub(crate) fn smooth(
        &mut self,
        triangulation: &mut LoopTriangulation,
        lattice: &mut Lattice,
        band: &BoundaryBand,
    ) {
        let cdt = &mut triangulation.cdt;
        self.moved.clear();
        self.is_moved.resize(cdt.points.len(), false);
        for _ in 0..SWEEPS {
            let first = self.moved.len();
            for (v, &point) in (band.first..).zip(&band.lattice) {
                if !std::mem::take(&mut self.stale[v as usize])
                    || lattice.in_core.get(point as usize) == Some(&true)
                {
                    continue;
                }
                self.star.read(cdt, v, &self.targets);
                let Some(at) = self.star.better_place(cdt.point(v), self.bounds) else {
                    continue;
                };
                cdt.points[v as usize] = at;
                self.mark_stale(cdt, v);
                self.is_moved[v as usize] = true;
                self.moved.push(v);
            }
            if first == self.moved.len() {
                break;
            }
            // Flips wait for the end of the sweep, so that each edge of a moved triangle is tested
            // once: by the first of its moved ends or, without one, by the moved apex.
            for &v in &self.moved[first..] {
                let is_moved = |w: u32| self.is_moved[w as usize];
                for h in outgoing_half_edges(cdt, v) {
                    let (w, apex) = (cdt.end(h), cdt.opposite(h));
                    if !is_moved(w) || v < w {
                        self.sides.push(h);
                    }
                    if !is_moved(w) && !is_moved(apex) {
                        self.sides.push(next(h));
                    }
                }
            }
            for &v in &self.moved[first..] {
                self.is_moved[v as usize] = false;
            }
            for &h in &self.sides {
                if !cdt.is_illegal(h) {
                    continue;
                }
                cdt.stack.push(h);
                cdt.legalize_all();
            }
            self.sides.clear();
        }
        self.moved.sort_unstable();
        self.moved.dedup();
        for &v in &self.moved {
            let (at, point) = (
                cdt.point(v),
                band.lattice[(v - band.first) as usize] as usize,
            );
            self.base.last = self.hints[v as usize];
            if let Some((parents, weights)) = barycentric_weights(&mut self.base, at) {
                self.hints[v as usize] = self.base.last;
                lattice.points[point] = at;
                lattice.parents[point] = parents;
                lattice.weights[point] = weights;
            }
        }
    }

    /// Marks an inner vertex and its neighbors for smoothing.
    pub(super) fn mark_stale(&mut self, cdt: &Cdt, v: u32) {
        self.stale[v as usize] = true;
        for h in outgoing_half_edges(cdt, v) {
            self.stale[cdt.end(h) as usize] = true;
        }
    }
}

/// The side opposite to an inner vertex in one of its triangles. It ends where the next one starts.
#[derive(Debug, Clone, Copy)]
struct Side {
    start: [f64; 2],
    /// Squared length.
    square: f64,
    /// Maximum squared distance of the vertex from `start`.
    max_start: f64,
}

/// The triangles around an inner vertex.
#[derive(Debug, Clone, Default)]
pub(crate) struct Star {
    /// The sides opposite to the vertex, in cyclic order.
    sides: Vec<Side>,
    /// The side of the triangle that failed last; it is tested first.
    worst: usize,
}

impl Star {
    /// Reads the triangles around `v`, where no constraint ends.
    fn read(&mut self, cdt: &Cdt, v: u32, targets: &[f64]) {
        self.sides.clear();
        self.worst = 0;
        let (center, target) = (cdt.point(v), targets[v as usize]);
        let first = cdt.outgoing[v as usize];
        let mut h = first;
        let mut w = cdt.end(h);
        let mut start = cdt.point(w);
        loop {
            let kind = cdt.constraints[h as usize];
            debug_assert_eq!(
                kind,
                constraint::FREE,
                "points of the core are not smoothed"
            );
            let back = prev(h);
            let next = cdt.start(back);
            let end = cdt.point(next);
            let target = 0.5 * target + 0.5 * targets[w as usize];
            self.sides.push(Side {
                start,
                square: distance_squared(start, end),
                max_start: distance_squared(start, center).max((MAX_EDGE_RATIO * target).powi(2)),
            });
            h = cdt.twin[back as usize];
            if h == first {
                return;
            }
            (w, start) = (next, end);
        }
    }

    /// Returns a position with a larger minimum angle, if the search finds one.
    #[expect(clippy::cast_precision_loss, reason = "a handful of sides")]
    fn better_place(&mut self, from: [f64; 2], bounds: AngleBounds) -> Option<[f64; 2]> {
        let old = self.max_cos2(from, 1.0).unwrap_or(1.0);
        if old < bounds.smooth {
            return None;
        }
        let sum = self.sides.iter().fold([0.0; 2], |sum, side| {
            [sum[0] + side.start[0], sum[1] + side.start[1]]
        });
        let center = sum.map(|x| x / self.sides.len() as f64);
        let (mut largest, mut best) = (old, from);
        for at in [center, midpoint(center, from)] {
            if let Some(new) = self.max_cos2(at, largest) {
                (largest, best) = (new, at);
                break;
            }
        }
        if largest > bounds.search {
            let nearest = self
                .sides
                .iter()
                .map(|side| distance_squared(side.start, best));
            let mut step = SEARCH_START * nearest.fold(f64::MAX, f64::min).sqrt();
            for _ in 0..SEARCH_STEPS {
                let center = best;
                for [x, y] in DIRECTIONS {
                    let at = [center[0] + step * x, center[1] + step * y];
                    if let Some(new) = self.max_cos2(at, 1.0 - MIN_SEARCH_GAIN * (1.0 - largest)) {
                        (largest, best) = (new, at);
                    }
                }
                if best == center {
                    step *= 0.5;
                }
            }
        }
        (largest < old).then_some(best)
    }

    /// Returns cos^2 of the minimum angle with the vertex at `at`.
    ///
    /// `None` if a triangle would be inverted or reach `bound`, or an edge would be too long.
    fn max_cos2(&mut self, at: [f64; 2], bound: f64) -> Option<f64> {
        let from_place = |p: [f64; 2]| {
            let u = [p[0] - at[0], p[1] - at[1]];
            (u, u[0] * u[0] + u[1] * u[1])
        };
        // sin^2 of the minimum angle is a quotient; the smallest one is found without divisions.
        let bound = 1.0 - bound;
        let (mut least_sin2, mut divisor) = (1.0, 1.0);
        let mut i = self.worst;
        let (mut u, mut a) = from_place(self.sides[i].start);
        for _ in 0..self.sides.len() {
            let Side {
                square: c,
                max_start,
                ..
            } = self.sides[i];
            let next = if i + 1 == self.sides.len() { 0 } else { i + 1 };
            let (w, b) = from_place(self.sides[next].start);
            let double = u[0] * w[1] - u[1] * w[0];
            let sin2 = double * double * a.min(b).min(c);
            let product = a * b * c;
            let is_better = sin2 > bound * product;
            if a > max_start || double <= MIN_AREA * (a + b) || !is_better {
                self.worst = i;
                return None;
            }
            if sin2 * divisor < least_sin2 * product {
                (least_sin2, divisor) = (sin2, product);
            }
            (i, u, a) = (next, w, b);
        }
        Some(1.0 - least_sin2 / divisor)
    }
}
