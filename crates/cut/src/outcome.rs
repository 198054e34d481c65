//! [`CutOutcome`] and [`CutReport`]: the change of a cut, its counts and its times.

use incise_mesh::{TopologyDelta, TriangleId, Undo};
use std::ops::AddAssign;

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

incise_params::report! {
    /// Counts and times of a cut.
    #[derive(Debug, Clone, Copy, PartialEq, Default)]
    #[non_exhaustive]
    pub struct CutReport {
        /// Triangles whose bounding boxes touch the sweep.
        candidates: usize;
        /// Triangles that the sweep crosses.
        hits: usize;
        /// Curves along which the sweep crosses the surface as a whole: closed ones and, in sheets,
        /// those from boundary to boundary.
        loops: usize;
        /// Curves with an end where the sweep ends inside the body or the sheet: slits.
        slits: usize;
        /// Vertices that snapping moved into the rim.
        snapped_vertices: usize;
        /// Intersection points that snapping merged into others.
        merged_points: usize;
        /// Edges around the rim that remeshing flipped.
        flipped_edges: usize;
        /// Vertices beside the rim that remeshing collapsed onto others.
        collapsed_vertices: usize;
        /// Intersection points that remeshing merged into others.
        collapsed_points: usize;
        /// Upper bound of the displacement of the surface by remeshing.
        moved_surface: f64, unit: "m";
        /// Volume moved by snapping and remeshing, without sign.
        moved_volume: f64, unit: "m^3";
        /// Rim edges left shorter than [`crate::CutParams::snap`], where a merge would change
        /// the topology or move too much volume.
        short_rim_edges: usize;
        /// Whether every cap reached its target edge length.
        refined: bool;
    }
    seconds {
        /// Time of the BVH query and of the intersection.
        detection;
        /// Time of opening the surface along the rim.
        split;
        /// Time of remeshing around the rim.
        remeshing;
        /// Time of meshing the caps.
        cap;
        /// Time of refining the caps.
        refinement;
        /// Time of numbering the pieces. Their search runs beside the caps of large bodies.
        separation;
        /// Time of deriving the delta and the undo, and of checking the result near walls.
        commit;
        /// Time of updating the BVH; zero for a cutter that defers it.
        bvh_update;
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
        self.merged_points += other.merged_points;
        self.flipped_edges += other.flipped_edges;
        self.collapsed_vertices += other.collapsed_vertices;
        self.collapsed_points += other.collapsed_points;
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
    use std::time::Duration;

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
