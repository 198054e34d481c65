//! Struts: what holds the two sides of a body apart, from inside.
//!
//! A strut is an edge through the body, between two vertices of a piece that look at each other: the same constraint as an edge
//! of the surface, with a stiffness of its own and colors of its own. Where struts are is for others to say, who can search
//! the surface; the solver keeps those that still lie in one piece. Their lengths at rest are those between
//! rest positions, so a strut that is put into a body under load takes nothing of the load away.

use crate::constraints::StretchSet;
use crate::edges::EdgeId;
use crate::error::ConstraintError;
use crate::material::{Material, Struts};
use crate::rest;
use crate::solver::Solver;
use incise_mesh::{Surface, VertexId};

/// How many times its own weight a strut is projected against, see [`SolverParams::own_weight`](crate::SolverParams::own_weight):
/// as if it gave way by nine times what it does to inertia in a substep. Struts meet in vertices by the dozen, where rays
/// from all around end, and there a sweep that removes each one's whole error puts in more than it takes out. Measured on a
/// ball cut in two without bending, at rest: with 1 it throws itself apart within 10 frames, with 4 within 100, with 6 in
/// one of 30 ways to set it up, with 8 in none; bunny, octopus and what has bending are at rest with 1.
pub(crate) const OWN_WEIGHT: f32 = 10.0;

impl Solver {
    /// The struts, each from the vertex whose it is; none unless the material has them.
    #[must_use]
    pub fn struts(&self) -> Option<&StretchSet> {
        self.struts.as_ref()
    }

    /// Puts struts in, each from the vertex whose it is to one on the other side. Those that join a vertex with itself, lie
    /// between pieces or have no length at rest are passed over. Returns how many there are more.
    ///
    /// # Errors
    /// [`ConstraintError::WithoutStruts`] when the material has none, [`ConstraintError::UnknownVertex`]; nothing is
    /// changed then.
    pub fn add_struts(
        &mut self,
        surface: &Surface,
        ends: &[[VertexId; 2]],
    ) -> Result<usize, ConstraintError> {
        let unknown = ends.iter().flatten().find(|&&v| !self.is_vertex(v));
        if let Some(&vertex) = unknown {
            return Err(ConstraintError::UnknownVertex { vertex });
        }
        let Some(struts) = &mut self.struts else {
            return Err(ConstraintError::WithoutStruts);
        };
        let before = struts.len();
        for &[from, to] in ends {
            let length = rest::length(surface, [from.min(to), from.max(to)]);
            if from != to && length > 0.0 && is_inside(surface, [from, to]) {
                struts.insert_in(0, [from, to], length, EdgeId::NONE);
            }
        }
        self.plan.invalidate();
        Ok(struts.len() - before)
    }

    /// Takes struts out that a blade crossed, say. Appends the vertices whose they were to `lost`.
    pub fn remove_struts(
        &mut self,
        gone: impl FnMut([VertexId; 2]) -> bool,
        lost: &mut Vec<VertexId>,
    ) {
        if let Some(struts) = &mut self.struts {
            let before = lost.len();
            struts.remove_if(gone, |[from, _]| lost.push(from));
            if lost.len() > before {
                self.plan.invalidate();
            }
        }
    }

    /// Changes how hard struts resist from the next frame on.
    ///
    /// # Errors
    /// [`ConstraintError`] when a number is out of its range or the material has no struts; nothing is changed
    /// then.
    pub fn set_struts(&mut self, struts: Struts) -> Result<(), ConstraintError> {
        let material = Material {
            struts: Some(struts),
            ..self.material
        };
        material.check()?;
        if self.struts.is_none() {
            return Err(ConstraintError::WithoutStruts);
        }
        self.material = material;
        Ok(())
    }

    /// Takes those out that an edit left without an end or between two pieces. The vertices whose they were are listed for
    /// [`Solver::lost_struts`].
    pub(crate) fn drop_struts(&mut self, surface: &Surface) {
        let mut lost = std::mem::take(&mut self.lost_struts);
        lost.clear();
        self.remove_struts(|ends| !is_inside(surface, ends), &mut lost);
        lost.retain(|&v| !surface.topology().outgoing(v).is_null());
        self.lost_struts = lost;
    }

    /// The vertices that are still there and whose struts the last edit took, doubly if it took two.
    #[must_use]
    pub fn lost_struts(&self) -> &[VertexId] {
        &self.lost_struts
    }
}

/// Whether both ends are vertices of one piece.
pub(crate) fn is_inside(surface: &Surface, ends: [VertexId; 2]) -> bool {
    let [from, to] = ends.map(|v| surface.topology().outgoing(v));
    let piece = |h: incise_mesh::HalfEdge| surface.piece(h.triangle());
    !from.is_null() && !to.is_null() && piece(from) == piece(to)
}
