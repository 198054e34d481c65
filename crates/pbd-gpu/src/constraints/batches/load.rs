//! Completes and validates a loaded [`ConstraintSet`].

use super::{Batch, ConstraintSet, OVERFLOW};
use crate::constraints::coloring::{MAX_COLORS, VertexColors};
use crate::constraints::validate::broken;
use crate::error::InvalidConstraints;
use incise_mesh::EdgeKey;

impl<const N: usize> ConstraintSet<N> {
    /// Completes a set that was read with serde, of a surface with `slots` vertex slots.
    ///
    /// # Errors
    /// [`InvalidConstraints`] unless all vertices exist, rest values are finite, and constraints
    /// of a color share no vertex.
    pub(crate) fn finish_load(
        &mut self,
        slots: usize,
        layers: usize,
    ) -> Result<(), InvalidConstraints> {
        if self.batches.len() > layers * MAX_COLORS {
            return broken("a layer has a limited number of colors", None);
        }
        let mut colors = VertexColors::new(layers);
        colors.resize(slots);
        for (color, batch) in self.numbered() {
            batch.check(slots)?;
            for vertices in batch.vertices() {
                if color != OVERFLOW && !colors.claim_color(color, vertices) {
                    let edge = EdgeKey::new(vertices[0], vertices[1]);
                    return broken("constraints of a color share no vertex", Some(edge));
                }
            }
        }
        self.colors = colors;
        Ok(())
    }
}

impl<const N: usize> Batch<N> {
    fn check(&self, slots: usize) -> Result<(), InvalidConstraints> {
        let count = self.vertices.len();
        if self.rest.len() != count || self.edges.len() != count {
            return broken("one rest value and one edge per constraint", None);
        }
        if (self.vertices.as_flattened().iter()).any(|v| v.index() >= slots) {
            return broken("constraints have vertices of the surface", None);
        }
        if !self.rest.iter().all(|value| value.is_finite()) {
            return broken("rest values are finite", None);
        }
        Ok(())
    }
}

/// Saves the vertices of all constraints one after another: serde has no arrays of length `N`.
pub(super) mod vertices {
    use incise_mesh::VertexId;
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(crate) fn serialize<const N: usize, S: Serializer>(
        vertices: &[[VertexId; N]],
        to: S,
    ) -> Result<S::Ok, S::Error> {
        vertices.as_flattened().serialize(to)
    }

    pub(crate) fn deserialize<'de, const N: usize, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Vec<[VertexId; N]>, D::Error> {
        let flat = Vec::<VertexId>::deserialize(from)?;
        match flat.as_chunks() {
            (vertices, []) => Ok(vertices.to_vec()),
            _ => Err(D::Error::custom("a constraint has too few vertices")),
        }
    }
}
