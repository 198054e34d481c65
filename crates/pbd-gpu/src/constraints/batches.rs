//! Constraint sets: the constraints of one kind, in batches by color.

#[cfg(feature = "serde")]
mod load;

use crate::constraints::coloring::{LAYERS, MAX_COLORS, VertexColors};
use crate::constraints::edges::EdgeId;
use crate::follow::changes::Log;
use incise_mesh::VertexId;
use std::cell::Cell;
use std::fmt;
use std::ops::Range;

/// Stretch constraints: the ends of an edge, the smaller id first, and its rest length \[m\].
pub type StretchSet = ConstraintSet<2>;

/// Bending constraints: ends and opposite vertices of an interior edge, and its rest angle \[rad\].
///
/// The end with the smaller id comes first. The third vertex belongs to the triangle that has the
/// edge from the first to the second end, the fourth to the other triangle.
pub type BendingSet = ConstraintSet<4>;

/// Constraints that are projected in parallel, as a structure of arrays.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Batch<const N: usize> {
    #[cfg_attr(feature = "serde", serde(with = "load::vertices"))]
    pub(crate) vertices: Vec<[VertexId; N]>,
    pub(crate) rest: Vec<f32>,
    /// Edge of every constraint, shape \[constraints\].
    pub(crate) edges: Vec<EdgeId>,
    /// Multipliers of the substep, shape \[constraints\]; empty if they are not accumulated.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) lambda: Vec<f32>,
}

impl<const N: usize> Default for Batch<N> {
    fn default() -> Self {
        Self {
            vertices: Vec::new(),
            rest: Vec::new(),
            edges: Vec::new(),
            lambda: Vec::new(),
        }
    }
}

impl<const N: usize> Batch<N> {
    /// Returns the vertices of every constraint, shape \[constraints\].
    #[must_use]
    pub fn vertices(&self) -> &[[VertexId; N]] {
        &self.vertices
    }

    /// Returns the rest value of every constraint, shape \[constraints\].
    #[must_use]
    pub fn rest(&self) -> &[f32] {
        &self.rest
    }

    /// Returns the number of constraints.
    #[must_use]
    pub fn len(&self) -> usize {
        self.vertices.len()
    }

    /// Returns true if there are no constraints.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// Sets all multipliers to zero; allocates only after the batch has grown.
    pub(crate) fn reset_multipliers(&mut self) {
        self.lambda.clear();
        self.lambda.resize(self.vertices.len(), 0.0);
    }

    /// Returns the constraints for a projection, with multipliers if they accumulate.
    pub(crate) fn part(&mut self, accumulates_lambda: bool) -> Part<'_, N> {
        let lambda: &mut [f32] = if accumulates_lambda {
            &mut self.lambda
        } else {
            &mut []
        };
        Part {
            vertices: &self.vertices,
            rest: &self.rest,
            lambda: Cell::from_mut(lambda).as_slice_of_cells(),
        }
    }

    /// Returns the edge of every constraint, shape \[constraints\].
    pub(crate) fn edges(&self) -> &[EdgeId] {
        &self.edges
    }

    #[inline]
    fn push(&mut self, vertices: [VertexId; N], rest: f32, edge: EdgeId) -> usize {
        self.vertices.push(vertices);
        self.rest.push(rest);
        self.edges.push(edge);
        self.vertices.len() - 1
    }

    fn capacity(&self) -> usize {
        self.vertices.capacity()
            + self.rest.capacity()
            + self.edges.capacity()
            + self.lambda.capacity()
    }
}

/// A contiguous part of a batch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part<'a, const N: usize> {
    pub(crate) vertices: &'a [[VertexId; N]],
    pub(crate) rest: &'a [f32],
    /// Multipliers; empty if they do not accumulate.
    pub(crate) lambda: &'a [Cell<f32>],
}

impl<const N: usize> Part<'_, N> {
    /// Returns a range of the constraints.
    #[inline(always)]
    pub(crate) fn slice(self, range: Range<usize>) -> Self {
        Self {
            vertices: &self.vertices[range.clone()],
            rest: &self.rest[range.clone()],
            lambda: self.lambda.get(range).unwrap_or_default(),
        }
    }
}

/// Number of the overflow batch, after all colors.
pub(crate) const OVERFLOW: usize = LAYERS * MAX_COLORS;

/// A batch of a [`ConstraintSet`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum BatchId {
    /// The constraints of one color; [`MAX_COLORS`] colors make a layer.
    Color(usize),
    /// The constraints that found no free color.
    Overflow,
}

impl BatchId {
    /// Returns the layer of the batch; the overflow is part of layer 0.
    #[must_use]
    pub fn layer(self) -> usize {
        match self {
            Self::Color(color) => color / MAX_COLORS,
            Self::Overflow => 0,
        }
    }

    /// Returns the color, or [`OVERFLOW`].
    pub(crate) fn number(self) -> usize {
        match self {
            Self::Color(color) => color,
            Self::Overflow => OVERFLOW,
        }
    }

    /// Returns the batch of a color, or the overflow for [`OVERFLOW`].
    pub(crate) fn from_number(color: usize) -> Self {
        if color == OVERFLOW {
            Self::Overflow
        } else {
            Self::Color(color)
        }
    }
}

impl fmt::Display for BatchId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Color(color) => write!(f, "color {color}"),
            Self::Overflow => f.write_str("overflow"),
        }
    }
}

/// Location of a constraint in its set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Slot {
    /// Color, or [`OVERFLOW`].
    pub(crate) color: usize,
    /// Index in the batch.
    pub(crate) index: usize,
}

impl Slot {
    /// Returns the layer of the constraint; the overflow is part of layer 0.
    pub(crate) fn layer(self) -> usize {
        BatchId::from_number(self.color).layer()
    }
}

/// Returns the number of elements to reserve, so that first edits do not reallocate large arrays.
pub(crate) fn edit_reserve(len: usize) -> usize {
    len / 8 + 256
}

/// All constraints of one kind, over `N` vertices each.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ConstraintSet<const N: usize> {
    pub(crate) batches: Vec<Batch<N>>,
    pub(crate) overflow: Batch<N>,
    #[cfg_attr(feature = "serde", serde(skip))]
    colors: VertexColors,
    /// Slots whose constraint was added, removed or replaced.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) log: Log<Slot>,
}

impl<const N: usize> ConstraintSet<N> {
    /// Creates an empty set with one layer.
    #[cfg(test)]
    pub(crate) fn new(vertex_slots: usize) -> Self {
        Self::with_layers(vertex_slots, 1)
    }

    /// Creates an empty set.
    pub(crate) fn with_layers(vertex_slots: usize, layers: usize) -> Self {
        let mut set = Self {
            batches: Vec::new(),
            overflow: Batch::default(),
            colors: VertexColors::new(layers),
            log: Log::default(),
        };
        set.resize_vertices(vertex_slots);
        set
    }

    /// Returns one batch per color; some may be empty. Constraints of one batch share no vertex.
    ///
    /// Each layer but the last has [`MAX_COLORS`] batches.
    #[must_use]
    pub fn batches(&self) -> &[Batch<N>] {
        &self.batches
    }

    /// Returns the batches of a layer.
    pub(crate) fn layer(&self, layer: usize) -> &[Batch<N>] {
        let [start, end] = [layer, layer + 1].map(|l| self.batches.len().min(l * MAX_COLORS));
        &self.batches[start..end]
    }

    /// Returns the constraints without a color, which are projected serially at the end of layer 0.
    #[must_use]
    pub fn overflow(&self) -> &Batch<N> {
        &self.overflow
    }

    /// Returns the number of constraints.
    #[must_use]
    pub fn len(&self) -> usize {
        self.all().map(Batch::len).sum()
    }

    /// Returns true if there are no constraints.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.all().all(Batch::is_empty)
    }

    /// Returns all batches, the overflow last.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Batch<N>> {
        self.batches.iter().chain([&self.overflow])
    }

    /// Returns all batches with their numbers, the overflow last.
    pub(crate) fn numbered(&self) -> impl Iterator<Item = (usize, &Batch<N>)> {
        let overflow = (OVERFLOW, &self.overflow);
        self.batches.iter().enumerate().chain([overflow])
    }

    /// Returns all batches, the overflow last.
    pub(crate) fn all_mut(&mut self) -> impl Iterator<Item = &mut Batch<N>> {
        self.batches.iter_mut().chain([&mut self.overflow])
    }

    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        self.all().map(Batch::capacity).sum()
    }

    /// Returns the mask of colors in use at every vertex, shape [layers, vertex slots].
    pub(crate) fn color_masks(&self) -> &[Vec<u64>] {
        self.colors.masks()
    }

    /// Adds vertices without constraints, or removes the last ones.
    pub(crate) fn resize_vertices(&mut self, vertex_slots: usize) {
        self.colors.resize(vertex_slots);
    }

    /// Allocates room for more vertices, and for more constraints of every color.
    pub(crate) fn reserve(&mut self, vertices: usize) {
        self.colors.reserve(vertices);
        for batch in self.batches.iter_mut() {
            let more = edit_reserve(batch.len());
            batch.vertices.reserve(more);
            batch.rest.reserve(more);
            batch.edges.reserve(more);
        }
    }

    /// Returns vertices and rest value of a constraint.
    pub(crate) fn at(&self, slot: Slot) -> ([VertexId; N], f32) {
        let batch = self.batch(slot.color);
        (batch.vertices[slot.index], batch.rest[slot.index])
    }

    /// Inserts a constraint into layer 0.
    #[cfg(test)]
    pub(crate) fn insert(&mut self, vertices: [VertexId; N], rest: f32) -> Slot {
        self.insert_in(0, vertices, rest, EdgeId::TEST)
    }

    /// Inserts a constraint into a layer, or into layer 0 if the layer has no free color for it.
    #[inline]
    pub(crate) fn insert_in(
        &mut self,
        layer: usize,
        vertices: [VertexId; N],
        rest: f32,
        edge: EdgeId,
    ) -> Slot {
        let color = match self.colors.claim(layer, &vertices) {
            Some(color) => color,
            None => self.claim_elsewhere(layer, &vertices),
        };
        if self.batches.len() <= color && color != OVERFLOW {
            self.batches.resize_with(color + 1, Batch::default);
        }
        let index = self.batch_mut(color).push(vertices, rest, edge);
        let slot = Slot { color, index };
        self.log.record(slot);
        slot
    }

    /// Returns a color of layer 0, or the overflow.
    #[cold]
    fn claim_elsewhere(&mut self, layer: usize, vertices: &[VertexId; N]) -> usize {
        let color = (layer > 0).then(|| self.colors.claim(0, vertices));
        color.flatten().unwrap_or(OVERFLOW)
    }

    /// Removes a constraint; returns the edge of the constraint that was moved to its slot, if any.
    pub(crate) fn remove(&mut self, slot: Slot) -> Option<EdgeId> {
        self.log.record(slot);
        let batch = self.batch_mut(slot.color);
        let vertices = batch.vertices.swap_remove(slot.index);
        batch.rest.swap_remove(slot.index);
        batch.edges.swap_remove(slot.index);
        let moved = batch.edges.get(slot.index).copied();
        if slot.color != OVERFLOW {
            self.colors.release(&vertices, slot.color);
        }
        moved
    }

    /// Removes the constraints for which `is_removed` holds and passes them to `removed`. O(n).
    pub(crate) fn remove_if(
        &mut self,
        mut is_removed: impl FnMut([VertexId; N]) -> bool,
        mut removed: impl FnMut([VertexId; N]),
    ) {
        for color in (0..self.batches.len()).chain([OVERFLOW]) {
            // Backward, since a removal moves the last constraint to the free slot.
            for index in (0..self.batch(color).len()).rev() {
                let vertices = self.batch(color).vertices[index];
                if is_removed(vertices) {
                    self.remove(Slot { color, index });
                    removed(vertices);
                }
            }
        }
    }

    /// Returns the batch of a color or of [`OVERFLOW`].
    pub(crate) fn batch(&self, color: usize) -> &Batch<N> {
        if color != OVERFLOW {
            &self.batches[color]
        } else {
            &self.overflow
        }
    }

    /// Returns the batch of a color or of [`OVERFLOW`].
    pub(crate) fn batch_mut(&mut self, color: usize) -> &mut Batch<N> {
        if color != OVERFLOW {
            &mut self.batches[color]
        } else {
            &mut self.overflow
        }
    }
}
