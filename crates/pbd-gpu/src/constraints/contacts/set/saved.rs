//! Saving of contacts, whose colors follow from them.

use super::{ContactRecord, ContactSet, NO_VERTEX, UNCOLORED};
use crate::constraints::coloring::VertexColors;
use crate::constraints::contacts::{Carried, ContactKind, Press};
use incise_mesh::VertexId;

impl ContactSet {
    /// Returns the contacts by color, for a file; none without contacts.
    pub(crate) fn to_saved(&self) -> &[Vec<ContactRecord>] {
        if self.is_empty() { &[] } else { &self.colors }
    }

    /// Returns saved contacts with the maxima of their [`Press`], if those of a color share no
    /// vertex and `is_used` holds for all.
    pub(crate) fn from_saved(
        (colors, press): (Vec<Vec<ContactRecord>>, Press),
        (slots, is_used): (usize, impl Fn(VertexId) -> bool),
    ) -> Option<Self> {
        if !press.is_valid() {
            return None;
        }
        if colors.is_empty() {
            return Some(Self::default());
        }
        let mut masks = VertexColors::new(1);
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
        let is_valid = colors.len() == UNCOLORED + 1 && colors.iter().enumerate().all(&mut own);
        is_valid.then_some(Self {
            colors,
            masks,
            press,
            generation: 0,
        })
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
            && self.carried <= Carried::Upper as u16
            && numbers.into_iter().all(|number| number.is_finite())
    }
}
