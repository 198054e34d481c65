//! Interior springs: distance constraints through a body that keep its sides apart.
//!
//! A spring joins two vertices of a piece. It is projected like an edge of the surface, with its
//! own stiffness and colors. The caller searches the surface for springs; the solver removes those
//! that an edit cuts. Rest lengths are those between rest positions, so a spring that is added to a
//! loaded body does not change its rest shape.

use crate::constraints::Constraints;
use crate::constraints::edges::EdgeId;
use crate::constraints::rest;
use crate::error::ConstraintError;
use incise_mesh::{HalfEdge, Surface, VertexId};

/// Over-relaxation of the XPBD diagonal of springs, see
/// [`SolverParams::diagonal_scale`](crate::SolverParams::diagonal_scale).
///
/// Dozens of springs meet in a vertex. There a sweep that removes the whole error of each one adds
/// more energy than it removes.
pub(crate) const DIAGONAL_SCALE: f32 = 10.0;

impl Constraints {
    /// Adds springs and returns the number added.
    ///
    /// Springs between pieces, from a vertex to itself, or without rest length are skipped.
    ///
    /// # Errors
    /// [`ConstraintError::NoInteriorSprings`] if the material has none.
    pub(crate) fn add_interior_springs(
        &mut self,
        surface: &Surface,
        ends: &[[VertexId; 2]],
    ) -> Result<usize, ConstraintError> {
        let Some(springs) = &mut self.interior_springs else {
            return Err(ConstraintError::NoInteriorSprings);
        };
        let before = springs.len();
        for &[from, to] in ends {
            let length = rest::length(surface, [from.min(to), from.max(to)]);
            if from != to && length > 0.0 && is_inside(surface, [from, to]) {
                springs.insert_in(0, [from, to], length, EdgeId::NONE);
            }
        }
        Ok(springs.len() - before)
    }

    /// Removes springs by their ends and appends their first vertices to `removed_from`.
    ///
    /// Returns true if any was removed.
    pub(crate) fn remove_interior_springs(
        &mut self,
        is_removed: impl FnMut([VertexId; 2]) -> bool,
        removed_from: &mut Vec<VertexId>,
    ) -> bool {
        let before = removed_from.len();
        if let Some(springs) = &mut self.interior_springs {
            springs.remove_if(is_removed, |[from, _]| removed_from.push(from));
        }
        removed_from.len() > before
    }
}

/// Returns true if both ends are vertices of one piece.
pub(crate) fn is_inside(surface: &Surface, ends: [VertexId; 2]) -> bool {
    let [from, to] = ends.map(|v| surface.topology().outgoing(v));
    let piece = |h: HalfEdge| surface.piece(h.triangle());
    !from.is_null() && !to.is_null() && piece(from) == piece(to)
}
