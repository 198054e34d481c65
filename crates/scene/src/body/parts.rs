//! A body joined from others, and the bodies of its pieces.

use super::Body;
use crate::error::SceneError;
use incise_mesh::{Surface, VertexId};
use incise_pbd_gpu::{ConstraintError, Material, PatchParams};

impl Body {
    /// Returns a body of the pieces of all `parts`, of one material, with their motion.
    ///
    /// # Errors
    /// [`SceneError::Channel`] and [`SceneError::Constraint`].
    pub(crate) fn joined(parts: &[&Self]) -> Result<Self, SceneError> {
        let mut surface = Surface::default();
        let mut pairs = Vec::with_capacity(parts.len());
        for (i, part) in parts.iter().enumerate() {
            if i == 0 {
                surface.set_origin(part.surface.origin());
            }
            let vertices = surface.append(&part.surface)?;
            let old = part.surface.topology().vertices();
            pairs.push(old.map(|v| (v, vertices[v.index()])).collect::<Vec<_>>());
        }
        let material = parts.first().map(|part| *part.solver.material());
        let mut body = Self::of_part(surface, &material.unwrap_or_default())?;
        for (part, pairs) in parts.iter().zip(&pairs) {
            body.solver
                .copy_motion(&mut body.surface, &part.solver, pairs)?;
        }
        Ok(body)
    }

    /// Returns a body for each piece, in the order of their numbers, with their motion.
    ///
    /// # Errors
    /// [`ConstraintError`] for a piece that cannot be simulated alone.
    pub(crate) fn split(&self) -> Result<Vec<Self>, ConstraintError> {
        let topology = self.surface.topology();
        let piece_of = |v: VertexId| self.surface.piece(topology.outgoing(v).triangle());
        let mut old: Vec<VertexId> = topology.vertices().collect();
        // The sort is stable: ascending within a piece, as in the extracted surface.
        old.sort_by_key(|&v| piece_of(v));
        let mut old = old.chunk_by(|&a, &b| piece_of(a) == piece_of(b));
        let pieces = self.surface.extract_pieces().map(|(_, surface)| {
            let new = surface.topology().vertices();
            let pairs = old.next().into_iter().flatten().copied().zip(new);
            let pairs: Vec<_> = pairs.collect();
            let mut body = Self::of_part(surface, self.solver.material())?;
            body.solver
                .copy_motion(&mut body.surface, &self.solver, &pairs)?;
            Ok(body)
        });
        pieces.collect()
    }

    fn of_part(surface: Surface, material: &Material) -> Result<Self, ConstraintError> {
        let patches = PatchParams::for_body(surface.topology().vertex_count());
        Self::new(surface, material, patches.as_ref())
    }
}
