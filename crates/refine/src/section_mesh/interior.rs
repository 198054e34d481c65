//! Steiner points of a valid group of loops: lattice core, then refinement of the band.
//!
//! Core points are fixed. In a section that is a few triangles wide they prevent better angles
//! around them. There all lattice points go to the band, where smoothing may move them.

use super::SectionMesh;
use super::boundary_band::BoundaryBand;
use super::lattice::Lattice;
use super::loop_triangulation::{INSIDE, LoopTriangulation};
use super::loops::SectionLoops;
use super::refinement::Refiner;
use super::target_length::{Spacing, TargetLengths};
use crate::error::RefineError;
use incise_mesh::index_u32;

/// Edge length, in targets, of equilateral triangles that bound the triangle count from below.
const BOUND_EDGE: f64 = 2.0;

/// Lattices of at most this many points have no core.
const MAX_POINTS_WITHOUT_CORE: usize = 16;

/// The input of filling a group of loops with Steiner points.
pub(crate) struct Interior<'a> {
    pub(crate) loops: &'a SectionLoops,
    pub(crate) targets: &'a TargetLengths,
    /// The group's loops.
    pub(crate) group: &'a [u32],
    pub(crate) mirrored: bool,
    /// Maximum number of triangles.
    pub(crate) limit: usize,
}

impl Interior<'_> {
    /// Adds the core's triangles to the mesh and the band's points to the triangulation.
    pub(crate) fn fill(
        &self,
        triangulation: &mut LoopTriangulation,
        lattice: &mut Lattice,
        band: &mut BoundaryBand,
        refiner: &mut Refiner,
        mesh: &mut SectionMesh,
    ) -> Result<(), RefineError> {
        let (targets, limit) = (self.targets, self.limit);
        if self.is_too_fine(triangulation) {
            return Err(RefineError::TooManyTriangles { limit });
        }
        refiner.save_base(triangulation);
        refiner.read_rim(triangulation, targets);
        let spacing = targets.spacing(&triangulation.corner_of, lattice.scratch());
        let mark = mesh.triangles.len();
        // Every point adds two triangles.
        let mut budget = limit / 2 + 1;
        match spacing {
            Some(Spacing::Uniform(length)) => {
                let most = limit + triangulation.corner_of.len();
                if !lattice.fill(triangulation, length, most) {
                    return Err(RefineError::TooManyTriangles { limit });
                }
                if lattice.points.len() > MAX_POINTS_WITHOUT_CORE {
                    let offset = index_u32(self.loops.point_ids.len() + mesh.steiner_points.len());
                    lattice.triangles(offset, &mut mesh.triangles);
                } else {
                    lattice.assign_to_band();
                }
            }
            Some(Spacing::Graded(length)) => {
                lattice.fill_graded(triangulation, targets, &refiner.rim_targets, length);
                if 2 * lattice.points.len() > limit + triangulation.corner_of.len() {
                    return Err(RefineError::TooManyTriangles { limit });
                }
            }
            None => {}
        }
        if !lattice.points.is_empty() {
            if band.connect(triangulation, lattice) {
                if !lattice.boundary.is_empty() {
                    budget = 2 * triangulation.corner_of.len() + 64;
                }
            } else {
                mesh.triangles.truncate(mark);
                self.restart(triangulation, lattice, band);
            }
        }
        let core = mesh.triangles.len() - mark;
        refiner.run(triangulation, lattice, band, targets, budget, core);
        Ok(())
    }

    /// Rebuilds the triangulation of the loops, without a lattice.
    fn restart(
        &self,
        triangulation: &mut LoopTriangulation,
        lattice: &mut Lattice,
        band: &mut BoundaryBand,
    ) {
        triangulation.build(self.loops, self.group, self.mirrored);
        lattice.clear();
        band.clear(triangulation);
    }

    /// Returns whether a lower bound of the triangle count exceeds the limit.
    ///
    /// The bound assumes equilateral triangles with sides of [`BOUND_EDGE`] targets.
    #[expect(clippy::cast_precision_loss, reason = "a bound, far from both sides")]
    fn is_too_fine(&self, triangulation: &LoopTriangulation) -> bool {
        let (cdt, targets) = (&triangulation.cdt, self.targets);
        let inside = (0..cdt.triangles()).filter(|&t| cdt.region[t as usize] == INSIDE);
        let least: f64 = inside
            .map(|t| {
                // The mean of targets in a triangle. No point is farther than 2 from the loops, in
                // their scale.
                let [a, b, c] = cdt.corners(t).map(|v| triangulation.corner_of[v as usize]);
                let mean = (targets.at(a) + targets.at(b) + targets.at(c)) / 3.0;
                let side = BOUND_EDGE * (mean + 2.0 * targets.grading);
                let [p, q, r] = cdt.corner_points(t);
                let twice = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
                twice / (0.75f64.sqrt() * side * side)
            })
            .sum();
        least > self.limit as f64
    }
}
