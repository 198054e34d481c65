//! [`SavedSet`]: the constraints of one kind by color, for files. Color masks follow from it.

use super::{Batch, ConstraintSet, EdgeId, OVERFLOW};
use crate::constraints::coloring::MAX_COLORS;
use crate::constraints::validate::broken;
use crate::error::InvalidConstraints;
use incise_mesh::{EdgeKey, VertexId};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A [`ConstraintSet`], as it is saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SavedSet<'a> {
    batches: Vec<SavedBatch<'a>>,
    overflow: SavedBatch<'a>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
struct SavedBatch<'a> {
    /// The vertices of all constraints, one after another.
    vertices: Cow<'a, [VertexId]>,
    rest: Cow<'a, [f32]>,
    edges: Cow<'a, [EdgeId]>,
}

impl<const N: usize> ConstraintSet<N> {
    /// Returns the constraints as plain data for a file.
    pub(crate) fn to_saved(&self) -> SavedSet<'_> {
        SavedSet {
            batches: self.batches.iter().map(Batch::to_saved).collect(),
            overflow: self.overflow.to_saved(),
        }
    }

    /// Returns a saved set of a surface with `slots` vertex slots.
    ///
    /// # Errors
    /// [`InvalidConstraints`] unless all vertices exist, rest values are finite, and constraints
    /// of a color share no vertex.
    pub(crate) fn from_saved(
        saved: SavedSet<'_>,
        slots: usize,
        layers: usize,
    ) -> Result<Self, InvalidConstraints> {
        let mut set = Self::with_layers(slots, layers);
        if saved.batches.len() > layers * MAX_COLORS {
            return broken("a layer has a limited number of colors", None);
        }
        let overflow = [(OVERFLOW, saved.overflow)];
        for (color, batch) in saved.batches.into_iter().enumerate().chain(overflow) {
            let batch = batch.into_batch(slots)?;
            for vertices in batch.vertices() {
                if color != OVERFLOW && !set.colors.claim_color(color, vertices) {
                    let edge = EdgeKey::new(vertices[0], vertices[1]);
                    return broken("constraints of a color share no vertex", Some(edge));
                }
            }
            if color == OVERFLOW {
                set.overflow = batch;
            } else {
                set.batches.push(batch);
            }
        }
        Ok(set)
    }
}

impl<const N: usize> Batch<N> {
    fn to_saved(&self) -> SavedBatch<'_> {
        SavedBatch {
            vertices: self.vertices.as_flattened().into(),
            rest: (&self.rest).into(),
            edges: (&self.edges).into(),
        }
    }
}

impl SavedBatch<'_> {
    fn into_batch<const N: usize>(self, slots: usize) -> Result<Batch<N>, InvalidConstraints> {
        let (vertices, rest) = (self.vertices.as_chunks::<N>(), self.rest);
        let count = vertices.0.len();
        if !vertices.1.is_empty() || rest.len() != count || self.edges.len() != count {
            return broken("one rest value and one edge per constraint", None);
        }
        if self.vertices.iter().any(|v| v.index() >= slots) {
            return broken("constraints have vertices of the surface", None);
        }
        if !rest.iter().all(|value| value.is_finite()) {
            return broken("rest values are finite", None);
        }
        Ok(Batch {
            vertices: vertices.0.to_vec(),
            rest: rest.into_owned(),
            edges: self.edges.into_owned(),
            lambda: Vec::new(),
        })
    }
}
