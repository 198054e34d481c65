//! Which struts a body has: rays through it find the other ends, and a sweep takes what it crosses.

use incise_cut::{Bvh, Sweep};
use incise_mesh::{Surface, TopologyDelta, VertexId};
use incise_pbd_gpu::{ConstraintError, Solver};
use rayon::prelude::*;

/// So many rays are worth the way to another thread.
const RAYS: usize = 64;

/// Room to gather vertices and ends; its content matters to nobody between calls.
#[derive(Debug, Default)]
pub(crate) struct Strutting {
    lost: Vec<VertexId>,
    ends: Vec<[VertexId; 2]>,
}

impl Clone for Strutting {
    /// Scratch memory is not worth copying.
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// How many vertices of a hundred and so on are to have a strut; 0 without struts.
fn density(solver: &Solver) -> f32 {
    let struts = solver.material().struts;
    struts.map_or(0.0, |struts| struts.density)
}

/// Whether a vertex is one of so many that have a strut of their own. Spread evenly over any run of numbers, since multiples of
/// the golden ratio are (Weyl's sequence), and the same for a vertex always.
fn is_chosen(v: VertexId, density: f32) -> bool {
    let share = v.0.wrapping_mul(0x9e37_79b9) >> 8;
    (share as f32) < density * (1 << 24) as f32
}

impl Strutting {
    /// Gives every vertex that is to have a strut and has none one. The search tree must fit.
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
        let owners = (solver.struts().into_iter()).flat_map(|set| {
            let overflow = [set.overflow()];
            set.batches()
                .iter()
                .chain(overflow)
                .flat_map(|b| b.vertices())
        });
        for [owner, _] in owners {
            has[owner.index()] = true;
        }
        self.lost.clear();
        let without = surface.topology().vertices().filter(|v| !has[v.index()]);
        self.lost.extend(without);
        self.put_in(surface, solver, bvh)
    }

    /// Takes struts out that a sweep crossed, before the edit that it made is followed.
    pub(crate) fn cross(&mut self, surface: &Surface, solver: &mut Solver, sweep: &Sweep) {
        self.lost.clear();
        let at = |v: VertexId| {
            let [x, y, z, _] = surface.positions[v.index()];
            [x, y, z]
        };
        let is_crossed = |[a, b]: [VertexId; 2]| sweep.meets(at(a), at(b));
        solver.remove_struts(is_crossed, &mut self.lost);
    }

    /// Gives the vertices whose struts went, and new ones, struts in their place: caps get theirs. The search tree must
    /// fit.
    pub(crate) fn renew(
        &mut self,
        surface: &Surface,
        solver: &mut Solver,
        bvh: &Bvh,
        delta: &TopologyDelta,
    ) -> Result<(), ConstraintError> {
        self.lost.extend(solver.lost_struts());
        self.lost
            .extend(delta.vertices_added.iter().map(|added| added.vertex));
        self.lost
            .retain(|&v| !surface.topology().outgoing(v).is_null());
        self.put_in(surface, solver, bvh)
    }

    fn put_in(
        &mut self,
        surface: &Surface,
        solver: &mut Solver,
        bvh: &Bvh,
    ) -> Result<(), ConstraintError> {
        let density = density(solver);
        self.lost.sort_unstable();
        self.lost.dedup();
        self.lost.retain(|&v| is_chosen(v, density));
        self.ends.clear();
        // By all threads: a ray through a large body takes ten times as long as all else that a new strut asks for.
        let ends = self.lost.par_iter().with_min_len(RAYS);
        self.ends
            .par_extend(ends.filter_map(|&v| Some([v, bvh.across(surface, v)?])));
        if !self.ends.is_empty() {
            solver.add_struts(surface, &self.ends)?;
        }
        Ok(())
    }
}
