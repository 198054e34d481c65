//! [`CutOutcome`] and [`CutReport`]: the change of a cut, its counts and its times.

use incise_mesh::{TopologyDelta, TriangleId, Undo};
use std::ops::AddAssign;
use std::time::Duration;

/// The change of a cut, or a miss.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
#[must_use = "ask `is_miss`: a sweep that misses changes nothing"]
pub struct CutOutcome {
    /// The change; empty after a miss.
    pub delta: TopologyDelta,
    /// The triangles of caps and walls: those below the sweep, then as many above it. Empty for
    /// sheets.
    pub cap: Vec<TriangleId>,
    /// Undoes the cut; none after a miss.
    pub undo: Option<Undo>,
    /// Counts and times.
    pub report: CutReport,
}

impl CutOutcome {
    /// Returns whether the sweep missed the surface, which is then unchanged.
    #[must_use]
    pub fn is_miss(&self) -> bool {
        self.delta.is_empty()
    }
}

/// Counts and times of a cut.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct CutReport {
    /// Triangles whose bounding boxes touch the sweep.
    pub candidates: usize,
    /// Triangles that the sweep crosses.
    pub hits: usize,
    /// Curves along which the sweep crosses the surface as a whole: closed ones and, in sheets,
    /// those from boundary to boundary.
    pub loops: usize,
    /// Curves with an end where the sweep ends inside the body or the sheet: slits.
    pub slits: usize,
    /// Vertices that snapping moved into the rim.
    pub snapped_vertices: usize,
    /// Intersection points that snapping merged into others.
    pub merged_nodes: usize,
    /// Edges around the rim that remeshing flipped.
    pub flipped_edges: usize,
    /// Vertices beside the rim that remeshing collapsed onto others.
    pub collapsed_vertices: usize,
    /// Intersection points that remeshing merged into others.
    pub collapsed_nodes: usize,
    /// Upper bound of the displacement of the surface by remeshing \[m\].
    pub moved_surface: f64,
    /// Volume moved by snapping and remeshing, without sign \[m^3\].
    pub moved_volume: f64,
    /// Rim edges left shorter than [`crate::CutParams::snap`], where a merge would change the
    /// topology or move too much volume.
    pub short_rim_edges: usize,
    /// Whether every cap reached its target edge length.
    pub refined: bool,
    /// Time of the BVH query and of the intersection.
    pub detection: Duration,
    /// Time of opening the surface along the rim.
    pub split: Duration,
    /// Time of remeshing around the rim.
    pub remeshing: Duration,
    /// Time of meshing the caps.
    pub cap: Duration,
    /// Time of refining the caps.
    pub refinement: Duration,
    /// Time of numbering the pieces. Their search runs beside the caps of large bodies.
    pub separation: Duration,
    /// Time of deriving the delta and the undo, and of checking the result near walls.
    pub commit: Duration,
    /// Time of updating the BVH; zero for a cutter that defers it.
    pub bvh_update: Duration,
}

impl CutReport {
    /// Returns the sum of all times.
    #[must_use]
    pub fn total(&self) -> Duration {
        self.detection
            + self.split
            + self.remeshing
            + self.commit
            + self.cap
            + self.refinement
            + self.separation
            + self.bvh_update
    }
}

impl AddAssign for CutReport {
    /// Adds the report of another cut, such as the next step of a blade.
    ///
    /// Displacements of the surface are the larger ones. Caps are refined if those of both are; a
    /// cut that hit nothing has none.
    fn add_assign(&mut self, other: Self) {
        if other.hits > 0 {
            self.refined = other.refined && (self.refined || self.hits == 0);
        }
        self.candidates += other.candidates;
        self.hits += other.hits;
        self.loops += other.loops;
        self.slits += other.slits;
        self.snapped_vertices += other.snapped_vertices;
        self.merged_nodes += other.merged_nodes;
        self.flipped_edges += other.flipped_edges;
        self.collapsed_vertices += other.collapsed_vertices;
        self.collapsed_nodes += other.collapsed_nodes;
        self.moved_surface = self.moved_surface.max(other.moved_surface);
        self.moved_volume += other.moved_volume;
        self.short_rim_edges += other.short_rim_edges;
        self.detection += other.detection;
        self.split += other.split;
        self.remeshing += other.remeshing;
        self.cap += other.cap;
        self.refinement += other.refinement;
        self.separation += other.separation;
        self.commit += other.commit;
        self.bvh_update += other.bvh_update;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_and_times_of_steps_add_up() {
        let step = |hits, refined| CutReport {
            hits,
            refined,
            moved_surface: 0.5,
            cap: Duration::from_millis(2),
            ..CutReport::default()
        };
        let mut sum = CutReport::default();
        for (hits, refined, expected) in [(3, true, true), (0, false, true), (4, false, false)] {
            sum += step(hits, refined);
            assert_eq!(sum.refined, expected, "{sum:?}");
        }
        assert_eq!((sum.hits, sum.moved_surface), (7, 0.5));
        assert_eq!(sum.total(), Duration::from_millis(6));
    }
}
