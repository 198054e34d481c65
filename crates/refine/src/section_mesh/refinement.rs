//! Frontal Delaunay refinement of the boundary band, or of a whole section without a lattice.
//!
//! Loops have edges much shorter and longer than the target, side by side, and none may be split,
//! so the guarantees of Delaunay refinement do not hold. A point is inserted only if its triangles
//! have a larger minimum angle than those that it replaces, or if their angles are good anyway.
//! Between a short and a long edge of the rim, points form a [`spiral`].
//!
//! Triangles wait in a queue, so points form layers from the rim inward, at the target distance
//! (Engwirda and Ivers 2016). [`smoothing`] then moves points, and refinement runs once more.
//!
//! Angles are compared as cos^2 of the minimum angle of a triangle, see
//! [`cos2_min_angle`](off_center::cos2_min_angle).

pub(crate) mod off_center;
mod smoothing;
mod spiral;

use super::barycentric::barycentric_weights;
use super::boundary_band::BoundaryBand;
use super::cdt::{Cdt, constraint, prev};
use super::lattice::Lattice;
use super::loop_triangulation::{INSIDE, LoopTriangulation};
use super::target_length::{AngleBounds, TargetLengths};
use incise_mesh::index_u32;
use off_center::{
    Candidate, CavityScratch, OFF_CENTER_REACH, cos2_min_angle, cos2_of_sides, distance_squared,
    midpoint, off_center, shortest_side, squared_sides,
};
use smoothing::Star;

/// Maximum length of an inner edge in targets; a longer one gets a point.
const MAX_EDGE_RATIO: f64 = 1.5;
/// cos^2 of 30 degrees: a point for a long edge must not make a smaller angle.
const COS2_30: f64 = 0.75;
/// cos^2 of 20 degrees: the same bound for a point at the midpoint of the edge.
const COS2_20: f64 = 0.88;
/// Minimum growth of sin^2 of the minimum angle for a point to be inserted.
const MIN_GAIN: f64 = 1.1;
/// The same factor for triangles with an angle below 20 degrees: any improvement counts.
const MIN_GAIN_BELOW_20: f64 = 1.0;
/// The same factor for triangles below [`COS2_10`] with edges that are too long.
const MIN_GAIN_NEEDLES: f64 = 0.5;
/// cos^2 of 10 degrees.
const COS2_10: f64 = 0.97;
/// Number of rounds of insertion and smoothing.
const ROUNDS: usize = 2;
/// One in this many triangles may miss the minimum angle.
const BAD_SHARE: usize = 20;
/// Meshes with more triangles get no additional round.
///
/// The bad triangles at a few places are a small share of theirs.
const MAX_EXTRA_ROUND_TRIANGLES: usize = 1024;

/// State and scratch memory of the refinement.
#[derive(Debug, Clone, Default)]
pub(crate) struct Refiner {
    /// The triangulation of the loops alone, in which the parents of points are found.
    pub(super) base: Cdt,
    /// Targets of the corners, limited by the edges of the rim.
    pub(super) rim_targets: Vec<f64>,
    /// Target length at each vertex.
    pub(super) targets: Vec<f64>,
    /// Angle bounds of the current round.
    pub(super) bounds: AngleBounds,
    /// Triangles to refine, with their corners at the time of queueing.
    queue: Vec<(u32, [u32; 3])>,
    pub(super) sides: Vec<u32>,
    /// A triangle of `base` near each vertex.
    pub(super) hints: Vec<u32>,
    /// Whether the neighborhood of each vertex has changed since its last smoothing.
    pub(super) stale: Vec<bool>,
    /// Whether each vertex has moved in the current sweep of smoothing.
    pub(super) is_moved: Vec<bool>,
    /// Vertices that smoothing has moved.
    pub(super) moved: Vec<u32>,
    pub(super) star: Star,
    cavity: CavityScratch,
}

impl Refiner {
    /// Saves the triangulation of the loops before lattice points are inserted.
    pub(crate) fn save_base(&mut self, triangulation: &LoopTriangulation) {
        self.base.copy_triangles(&triangulation.cdt);
    }

    /// Reads the targets along the rim.
    pub(crate) fn read_rim(&mut self, triangulation: &LoopTriangulation, targets: &TargetLengths) {
        self.rim_targets.clear();
        targets.along_rim(triangulation, &mut self.rim_targets);
    }

    /// Inserts at most `budget` points into the band and smooths them, in rounds.
    ///
    /// `core` is the number of lattice triangles, which are not part of the triangulation.
    pub(crate) fn run(
        &mut self,
        triangulation: &mut LoopTriangulation,
        lattice: &mut Lattice,
        band: &mut BoundaryBand,
        targets: &TargetLengths,
        budget: usize,
        core: usize,
    ) {
        self.start(triangulation, lattice, band, targets);
        let mut left = budget;
        for _ in 0..ROUNDS {
            left -= self.insert(triangulation, lattice, band, targets, left);
            self.smooth(triangulation, lattice, band);
            // Smoothing may have made room where no point could be inserted.
            self.bounds.insert = self.bounds.insert_after_smoothing;
        }
        let bound = self.bounds.insert_after_smoothing;
        let is_improvable = |t: u32| cos2_min_angle(triangulation.cdt.corner_points(t)) <= bound;
        if has_many_bad_triangles(triangulation, core, targets.bounds.insert, is_improvable) {
            self.bounds.insert = self.bounds.search;
            self.insert(triangulation, lattice, band, targets, left);
            self.smooth(triangulation, lattice, band);
        }
    }

    /// Initializes the state for a triangulation.
    fn start(
        &mut self,
        triangulation: &LoopTriangulation,
        lattice: &Lattice,
        band: &BoundaryBand,
        targets: &TargetLengths,
    ) {
        self.cavity.clear();
        self.bounds = targets.bounds;
        self.targets.clone_from(&self.rim_targets);
        // The target of lattice points; the corners of the box do not use theirs.
        self.targets
            .resize(triangulation.cdt.points.len(), lattice.length);
        if lattice.targets.len() == band.lattice.len() {
            self.targets[band.first as usize..].copy_from_slice(&lattice.targets);
        } else if lattice.boundary.is_empty() {
            // Without a core, lattice points take the rim's target, grown by their distance.
            for v in band.first..index_u32(triangulation.cdt.points.len()) {
                self.targets[v as usize] =
                    self.graded_target(&triangulation.cdt, v, lattice.length, targets);
            }
        }
        self.stale.clear();
        self.stale.resize(triangulation.cdt.points.len(), true);
        self.hints.clear();
        let base = self.base.outgoing.iter().map(|h| h / 3);
        self.hints.extend(base);
        for &point in &band.lattice {
            // A corner of the triangle that contains the point.
            let corner = lattice.parents[point as usize][0];
            self.hints.push(self.hints[corner as usize]);
        }
    }

    /// Inserts points until the queue is empty and returns their number.
    fn insert(
        &mut self,
        triangulation: &mut LoopTriangulation,
        lattice: &mut Lattice,
        band: &mut BoundaryBand,
        targets: &TargetLengths,
        budget: usize,
    ) -> usize {
        let cdt = &mut triangulation.cdt;
        self.queue.clear();
        for t in 0..cdt.triangles() {
            self.queue_if_bad(cdt, t);
        }
        let (mut at, mut inserted) = (0, 0);
        while at < self.queue.len() && inserted < budget {
            let (t, corners) = self.queue[at];
            at += 1;
            if cdt.corners(t) != corners {
                continue;
            }
            let Some(candidate) = self.find_candidate(cdt, t) else {
                continue;
            };
            let near = cdt.corners(candidate.triangle)[0];
            self.base.last = self.hints[near as usize];
            // A point without parents in the triangulation of the loops is not inserted.
            let Some((parents, weights)) = barycentric_weights(&mut self.base, candidate.at) else {
                continue;
            };
            let v = cdt.push_point(candidate.at);
            self.cavity.insert(cdt, v, &candidate);
            inserted += 1;
            self.hints.push(self.base.last);
            band.lattice.push(index_u32(lattice.points.len()));
            lattice.points.push(candidate.at);
            lattice.parents.push(parents);
            lattice.weights.push(weights);
            let far =
                |i: usize| weights[i] * targets.at(triangulation.corner_of[parents[i] as usize]);
            let far = far(0) + far(1) + far(2);
            self.targets.push(self.graded_target(cdt, v, far, targets));
            self.stale.push(true);
            self.mark_stale(cdt, v);
            for h in outgoing_half_edges(cdt, v) {
                self.queue_if_bad(cdt, h / 3);
            }
        }
        inserted
    }

    /// Returns the target at `v`: the smallest of its neighbors' targets, grown by distance.
    ///
    /// `far` is the target far from the rim.
    fn graded_target(&self, cdt: &Cdt, v: u32, far: f64, targets: &TargetLengths) -> f64 {
        let from = |w: u32| {
            let distance = distance_squared(cdt.point(v), cdt.point(w)).sqrt();
            targets.graded(self.targets[w as usize], far, distance)
        };
        outgoing_half_edges(cdt, v)
            .map(|h| from(cdt.end(h)))
            .fold(f64::MAX, f64::min)
    }

    /// Queues a triangle that misses the minimum angle or has a long edge.
    fn queue_if_bad(&mut self, cdt: &Cdt, t: u32) {
        if cdt.region[t as usize] != INSIDE {
            return;
        }
        let squares = squared_sides(cdt.corner_points(t));
        if cos2_of_sides(squares) > self.bounds.insert || self.has_long_edge(cdt, t, squares) {
            self.queue.push((t, cdt.corners(t)));
        }
    }

    /// Returns the best point to insert for triangle `t`, if one is worth it.
    fn find_candidate(&mut self, cdt: &Cdt, t: u32) -> Option<Candidate> {
        let p = cdt.corner_points(t);
        let squares = squared_sides(p);
        let (k, side) = shortest_side(squares);
        let cos2 = cos2_of_sides(squares);
        if cos2 > self.bounds.insert {
            // Among needles from rim to rim no single point helps, but rows of points do.
            let is_needle = cos2 > COS2_10 && self.has_long_edge(cdt, t, squares);
            let gain = if is_needle {
                MIN_GAIN_NEEDLES
            } else if cos2 > COS2_20 {
                MIN_GAIN_BELOW_20
            } else {
                MIN_GAIN
            };
            let bound = |old: f64| 1.0 - gain * (1.0 - old);
            let mut evaluate = |at: [f64; 2]| self.cavity.evaluate(cdt, t, at, bound, true);
            // Sharper triangles are few, so they may try closer to the short side as well.
            let reaches = if cos2 > COS2_20 { 2 } else { 1 };
            let mut best = (OFF_CENTER_REACH.into_iter().take(reaches))
                .find_map(|reach| evaluate(off_center(p, k, reach)?));
            for at in spiral::points(cdt, t) {
                let candidate = evaluate(at);
                let is_better = |candidate: &Candidate| {
                    best.is_none_or(|best| candidate.new_cos2 < best.new_cos2)
                };
                best = candidate.filter(is_better).or(best);
            }
            return best;
        }
        if !self.has_long_edge(cdt, t, squares) {
            return None;
        }
        // The distance at which the other two sides are as long as the target.
        let target = self.target(cdt, 3 * t + index_u32(k));
        let far = ((target / side).powi(2) - 0.25)
            .max(OFF_CENTER_REACH[1].powi(2))
            .sqrt();
        let places = [far.min(OFF_CENTER_REACH[0]), f64::INFINITY].into_iter();
        let best = places
            .filter_map(|reach| off_center(p, k, reach))
            .find_map(|at| {
                let bound = |old: f64| old.max(COS2_30);
                self.cavity.evaluate(cdt, t, at, bound, false)
            });
        best.or_else(|| {
            let sides = [3 * t, 3 * t + 1, 3 * t + 2].into_iter();
            let free = sides.filter(|&h| cdt.constraints[h as usize] == constraint::FREE);
            let length = |h: u32| distance_squared(cdt.point(cdt.start(h)), cdt.point(cdt.end(h)));
            let h = free.max_by(|&g, &h| length(g).total_cmp(&length(h)))?;
            let at = midpoint(cdt.point(cdt.start(h)), cdt.point(cdt.end(h)));
            let bound = |old: f64| old.max(COS2_20);
            self.cavity.evaluate(cdt, t, at, bound, false)
        })
    }

    /// Returns the target of an edge: the mean of its ends'.
    fn target(&self, cdt: &Cdt, h: u32) -> f64 {
        let of = |v: u32| self.targets[v as usize];
        0.5 * of(cdt.start(h)) + 0.5 * of(cdt.end(h))
    }

    /// Returns whether an edge without a constraint is too long, by the squared sides.
    fn has_long_edge(&self, cdt: &Cdt, t: u32, squares: [f64; 3]) -> bool {
        let targets = cdt.corners(t).map(|v| self.targets[v as usize]);
        (0..3).any(|i| {
            let j = (i + 1) % 3;
            let longest = MAX_EDGE_RATIO * (0.5 * targets[i] + 0.5 * targets[j]);
            squares[i] > longest * longest
                && cdt.constraints[3 * t as usize + i] == constraint::FREE
        })
    }
}

/// Returns whether too many triangles of a small mesh exceed `asked` and `helps` could mend it.
///
/// Too many is more than one in [`BAD_SHARE`]. `helps` names the triangles that a measure improves;
/// the others must not be too many. `core` is the number of additional good triangles.
fn has_many_bad_triangles(
    triangulation: &LoopTriangulation,
    core: usize,
    asked: f64,
    helps: impl Fn(u32) -> bool,
) -> bool {
    let cdt = &triangulation.cdt;
    if cdt.triangles() as usize + core > MAX_EXTRA_ROUND_TRIANGLES {
        return false;
    }
    let (mut all, mut sharp, mut others) = (core, 0, 0);
    for t in (0..cdt.triangles()).filter(|&t| cdt.region[t as usize] == INSIDE) {
        all += 1;
        if cos2_min_angle(cdt.corner_points(t)) > asked {
            sharp += 1;
            others += usize::from(!helps(t));
        }
    }
    BAD_SHARE * sharp > all && BAD_SHARE * others <= all
}

/// Returns the outgoing half-edges of an inner vertex.
pub(super) fn outgoing_half_edges(cdt: &Cdt, v: u32) -> impl Iterator<Item = u32> + '_ {
    let first = cdt.outgoing[v as usize];
    std::iter::successors(Some(first), move |&h| {
        Some(cdt.twin[prev(h) as usize]).filter(|&h| h != first)
    })
}
