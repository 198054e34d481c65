//! Search for the interior springs of a body: where they end, and which ones a cut severs.
//!
//! [`Body`](crate::Body) fills a new body with springs and has them follow every cut. A ray through
//! the body finds the vertex at the other end of a spring.

use crate::follow_cut::follow_cut;
use incise_cut::{Cutter, Sweep};
use incise_mesh::{Bvh, Surface, TopologyDelta, VertexId};
use incise_pbd_gpu::{ConstraintError, Solver};
use rayon::prelude::*;
use std::num::NonZeroUsize;

/// Minimum number of rays per parallel task.
const MIN_RAYS_PER_TASK: usize = 64;

/// Scratch memory of the search, reused from call to call.
#[derive(Debug, Default)]
pub(crate) struct InteriorSpringSearch {
    /// Vertices that lack a spring.
    without: Vec<VertexId>,
    ends: Vec<[VertexId; 2]>,
}

impl Clone for InteriorSpringSearch {
    /// Returns empty scratch memory.
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// Returns the fraction of vertices that have a spring of their own; 0 without interior springs.
fn density(solver: &Solver) -> f32 {
    let interior_springs = solver.material().interior_springs;
    interior_springs.map_or(0.0, |interior_springs| interior_springs.density)
}

/// Returns whether a vertex is in the chosen fraction.
///
/// The choice depends on the vertex id only. Multiples of the golden ratio (Weyl's sequence) spread
/// it evenly over any range of ids.
fn is_chosen(v: VertexId, density: f32) -> bool {
    let share = v.0.wrapping_mul(0x9e37_79b9) >> 8;
    (share as f32) < density * (1 << 24) as f32
}

impl InteriorSpringSearch {
    /// Returns whether the search of a body asks the BVH.
    pub(crate) fn needs_bvh(solver: &Solver) -> bool {
        density(solver) > 0.0
    }

    /// Adds a spring to every chosen vertex that has none. The BVH must be refitted.
    pub(crate) fn fill(
        &mut self,
        surface: &Surface,
        solver: &mut Solver,
        bvh: &Bvh,
    ) -> Result<(), ConstraintError> {
        if density(solver) == 0.0 {
            return Ok(());
        }
        let mut has = vec![false; surface.topology().vertex_slots()];
        let owners = (solver.interior_springs().into_iter()).flat_map(|set| {
            let overflow = [set.overflow()];
            set.batches()
                .iter()
                .chain(overflow)
                .flat_map(|b| b.vertices())
        });
        for [owner, _] in owners {
            has[owner.index()] = true;
        }
        self.without.clear();
        let without = surface.topology().vertices().filter(|v| !has[v.index()]);
        self.without.extend(without);
        self.add_missing(surface, solver, bvh)
    }

    /// Updates BVH, solver and springs after a cut, see [`follow_cut`].
    ///
    /// Removes severed springs. Adds a spring to each new vertex and to each end of a removed one.
    /// The BVH must be refitted if [`Self::needs_bvh`].
    pub(crate) fn follow_cut(
        &mut self,
        surface: &mut Surface,
        solver: &mut Solver,
        cutter: &mut Cutter,
        sweep: &Sweep,
        delta: &TopologyDelta,
        threads: Option<NonZeroUsize>,
    ) -> Result<(), ConstraintError> {
        self.without.clear();
        let is_severed = |[a, b]: [VertexId; 2]| {
            let [a, b] = [a, b].map(|v| position(surface, v));
            sweep.intersects_segment(a, b)
        };
        solver.remove_interior_springs(is_severed, &mut self.without);
        follow_cut(cutter, solver, surface, delta, threads)?;
        self.without.extend(solver.lost_interior_springs());
        let added = delta.vertices_added.iter().map(|added| added.vertex);
        self.without.extend(added);
        self.without
            .retain(|&v| !surface.topology().outgoing(v).is_null());
        self.add_missing(surface, solver, cutter.bvh())
    }

    fn add_missing(
        &mut self,
        surface: &Surface,
        solver: &mut Solver,
        bvh: &Bvh,
    ) -> Result<(), ConstraintError> {
        let density = density(solver);
        self.without.sort_unstable();
        self.without.dedup();
        self.without.retain(|&v| is_chosen(v, density));
        self.ends.clear();
        // A ray through a large body takes ten times as long as the rest of adding a spring.
        let ends = self.without.par_iter().with_min_len(MIN_RAYS_PER_TASK);
        self.ends
            .par_extend(ends.filter_map(|&v| Some([v, bvh.opposite_vertex(surface, v)?])));
        if !self.ends.is_empty() {
            solver.add_interior_springs(surface, &self.ends)?;
        }
        Ok(())
    }
}

fn position(surface: &Surface, v: VertexId) -> [f32; 3] {
    let [x, y, z, _] = surface.positions()[v.index()];
    [x, y, z]
}
