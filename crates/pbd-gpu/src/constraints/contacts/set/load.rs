//! Completes and validates loaded contacts, whose colors follow from them.

use super::{ContactRecord, ContactSet, NO_VERTEX, UNCOLORED};
use crate::constraints::coloring::VertexColors;
use crate::constraints::contacts::{ContactKind, SupportedSide};
use crate::error::InvalidSolver;
use incise_mesh::VertexId;

impl ContactSet {
    /// Completes contacts that were read with serde, of a body with `slots` vertex slots.
    ///
    /// # Errors
    /// [`InvalidSolver::Array`] unless `is_used` holds for all vertices, and contacts of a color
    /// share none.
    pub(crate) fn finish_load(
        &mut self,
        slots: usize,
        is_used: impl Fn(VertexId) -> bool,
    ) -> Result<(), InvalidSolver> {
        let has_colors = !self.colors.is_empty();
        let mut masks = VertexColors::new(usize::from(has_colors));
        masks.resize(slots);
        let mut own = |(color, contacts): (usize, &Vec<ContactRecord>)| {
            contacts.iter().all(|contact| {
                let (ids, count) = contact.moved();
                let ids = &ids[..count];
                contact.is_valid()
                    && ids.iter().all(|&v| is_used(v))
                    && (color == UNCOLORED || masks.claim_color(color, ids))
            })
        };
        let is_valid = self.press.is_valid()
            && (!has_colors || self.colors.len() == UNCOLORED + 1)
            && self.colors.iter().enumerate().all(&mut own);
        self.masks = masks;
        let array = "contacts";
        is_valid.then_some(()).ok_or(InvalidSolver::Array { array })
    }
}

impl ContactRecord {
    fn is_valid(&self) -> bool {
        let is_plane = self.kind == ContactKind::Plane as u16;
        let (first, others) = self.vertices.split_at(1);
        let is_distinct = |i: usize| !self.vertices[..i].contains(&self.vertices[i]);
        let has_vertices = if is_plane {
            others.iter().all(|&v| v == NO_VERTEX)
        } else {
            (1..4).all(is_distinct) && others.iter().all(|&v| v != NO_VERTEX)
        };
        let vectors = [&self.normal, &self.held_at];
        let vectors = vectors.into_iter().flatten();
        let numbers = self.weights.iter().chain(vectors).chain([
            &self.gap,
            &self.gap_rate,
            &self.friction,
            &self.thickness,
            &self.friction_bound,
        ]);
        has_vertices
            && first[0] != NO_VERTEX
            && self.kind <= ContactKind::Plane as u16
            && self.carried <= SupportedSide::Upper as u16
            && numbers.into_iter().all(|number| number.is_finite())
    }
}
