//! Constraints of one kind, in batches of one color.

use crate::changes::Log;
use crate::coloring::{LAYERS, MAX_COLORS, VertexColors};
use crate::edges::EdgeId;
use incise_mesh::VertexId;

/// Stretch constraints: the two ends of an edge, the smaller id first, and its rest length \[m\].
pub type StretchSet = ConstraintSet<2>;

/// Bending constraints: the two ends of an edge, the smaller id first, then the vertex across it in the
/// triangle that runs from the first to the second, then the vertex on the other side; and the rest
/// angle \[rad\].
pub type BendingSet = ConstraintSet<4>;

/// Constraints that are projected together, as a structure of arrays.
#[derive(Debug, Clone)]
pub struct Batch<const N: usize> {
    pub(crate) vertices: Vec<[VertexId; N]>,
    pub(crate) rest: Vec<f32>,
    /// Whose constraint each is, shape \[constraints\].
    pub(crate) edges: Vec<EdgeId>,
    /// Multipliers of the substep, shape \[constraints\]; empty while nothing needs them.
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
    /// The vertices of every constraint, shape \[constraints\].
    #[must_use]
    pub fn vertices(&self) -> &[[VertexId; N]] {
        &self.vertices
    }

    /// The rest value of every constraint, shape \[constraints\].
    #[must_use]
    pub fn rest(&self) -> &[f32] {
        &self.rest
    }

    /// The multipliers that the processor's last substep ended with, shape \[constraints\]: how hard each constraint pulls
    /// times the square of the substep [kg m] of edges, [kg m^2] of angles, positive where it is too short. Empty where
    /// substeps keep none, since their constraints are rigid or projected once only; older ones where an earlier one kept
    /// them.
    #[must_use]
    pub fn multipliers(&self) -> &[f32] {
        &self.lambda
    }

    /// How many constraints there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.vertices.len()
    }

    /// Whether there is no constraint.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// Sets all multipliers to zero; allocates only after the batch has grown.
    pub(crate) fn reset_multipliers(&mut self) {
        self.lambda.clear();
        self.lambda.resize(self.vertices.len(), 0.0);
    }

    /// The whole batch.
    pub(crate) fn part(&mut self, keeps_multipliers: bool) -> Part<'_, N> {
        Part {
            vertices: &self.vertices,
            rest: &self.rest,
            lambda: if keeps_multipliers {
                &mut self.lambda
            } else {
                &mut []
            },
        }
    }

    /// Whose constraint each is, shape \[constraints\].
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

/// A run of constraints of one batch.
#[derive(Debug)]
pub(crate) struct Part<'a, const N: usize> {
    pub(crate) vertices: &'a [[VertexId; N]],
    pub(crate) rest: &'a [f32],
    /// Multipliers, empty if they are not kept.
    pub(crate) lambda: &'a mut [f32],
}

impl<'a, const N: usize> Part<'a, N> {
    pub(crate) fn split_at(self, middle: usize) -> (Self, Self) {
        let (vertices, more_vertices) = self.vertices.split_at(middle);
        let (rest, more_rest) = self.rest.split_at(middle);
        let (lambda, more_lambda) = self.lambda.split_at_mut(middle.min(self.lambda.len()));
        let left = Self {
            vertices,
            rest,
            lambda,
        };
        let right = Self {
            vertices: more_vertices,
            rest: more_rest,
            lambda: more_lambda,
        };
        (left, right)
    }
}

/// The number of the overflow among the colors.
pub(crate) const OVERFLOW: usize = LAYERS * MAX_COLORS;

/// Where a constraint stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Slot {
    /// The batch; [`OVERFLOW`] is the overflow.
    pub(crate) color: usize,
    /// The place in the batch.
    pub(crate) index: usize,
}

impl Slot {
    /// The layer of the constraint; the overflow is part of layer 0.
    pub(crate) fn layer(self) -> usize {
        if self.color == OVERFLOW {
            0
        } else {
            self.color / MAX_COLORS
        }
    }
}

/// How many more there should be room for beside so many, so that the first edits of a large body need not
/// move its arrays.
pub(crate) fn room_beside(len: usize) -> usize {
    len / 8 + 256
}

/// All constraints of one kind over `N` vertices each.
#[derive(Debug, Clone)]
pub struct ConstraintSet<const N: usize> {
    pub(crate) batches: Vec<Batch<N>>,
    pub(crate) overflow: Batch<N>,
    colors: VertexColors,
    /// Places where constraints came, went or moved to.
    pub(crate) log: Log<Slot>,
}

impl<const N: usize> ConstraintSet<N> {
    /// A set with one layer.
    #[cfg(test)]
    pub(crate) fn new(vertex_slots: usize) -> Self {
        Self::with_layers(vertex_slots, 1)
    }

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

    /// The batches, one a color; some may be empty. Constraints of one batch share no vertex. Layers
    /// follow one another, with [`MAX_COLORS`] batches each but the last.
    #[must_use]
    pub fn batches(&self) -> &[Batch<N>] {
        &self.batches
    }

    /// The constraints that found no free color, to be projected one by one after the others of layer 0.
    #[must_use]
    pub fn overflow(&self) -> &Batch<N> {
        &self.overflow
    }

    /// How many constraints there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.all().map(Batch::len).sum()
    }

    /// Whether there is no constraint.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All batches, the overflow last.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Batch<N>> {
        self.batches.iter().chain([&self.overflow])
    }

    /// All batches with their numbers, the overflow last.
    pub(crate) fn numbered(&self) -> impl Iterator<Item = (usize, &Batch<N>)> {
        let overflow = (OVERFLOW, &self.overflow);
        self.batches.iter().enumerate().chain([overflow])
    }

    pub(crate) fn all_mut(&mut self) -> impl Iterator<Item = &mut Batch<N>> {
        self.batches.iter_mut().chain([&mut self.overflow])
    }

    pub(crate) fn capacity(&self) -> usize {
        self.all().map(Batch::capacity).sum()
    }

    /// The colors in use around every vertex, shape [layers, vertex slots].
    pub(crate) fn color_masks(&self) -> &[Vec<u64>] {
        self.colors.masks()
    }

    pub(crate) fn resize_vertices(&mut self, vertex_slots: usize) {
        self.colors.resize(vertex_slots);
    }

    /// Makes room for edits: so many more vertices, and an eighth more constraints of every color.
    pub(crate) fn reserve(&mut self, vertices: usize) {
        self.colors.reserve(vertices);
        for batch in self.batches.iter_mut() {
            let more = room_beside(batch.len());
            batch.vertices.reserve(more);
            batch.rest.reserve(more);
            batch.edges.reserve(more);
        }
    }

    pub(crate) fn at(&self, slot: Slot) -> ([VertexId; N], f32) {
        let batch = self.batch(slot.color);
        (batch.vertices[slot.index], batch.rest[slot.index])
    }

    /// Inserts a constraint into layer 0.
    #[cfg(test)]
    pub(crate) fn insert(&mut self, vertices: [VertexId; N], rest: f32) -> Slot {
        self.insert_in(0, vertices, rest, EdgeId::TEST)
    }

    /// Inserts a constraint into a layer, or into layer 0 if that has no color left for it.
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
        self.log.note(slot);
        slot
    }

    /// A color of layer 0 for what finds none in its own, or the overflow.
    #[cold]
    fn claim_elsewhere(&mut self, layer: usize, vertices: &[VertexId; N]) -> usize {
        let color = (layer > 0).then(|| self.colors.claim(0, vertices));
        color.flatten().unwrap_or(OVERFLOW)
    }

    /// Removes a constraint. Returns the edge of the one that now stands in its place, if any does.
    pub(crate) fn remove(&mut self, slot: Slot) -> Option<EdgeId> {
        self.log.note(slot);
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

    /// Removes the constraints that are `gone`; tells whose they were. O(n).
    pub(crate) fn remove_if(
        &mut self,
        mut gone: impl FnMut([VertexId; N]) -> bool,
        mut tell: impl FnMut([VertexId; N]),
    ) {
        for color in (0..self.batches.len()).chain([OVERFLOW]) {
            // From the last one on: one that takes another's place has been looked at.
            for index in (0..self.batch(color).len()).rev() {
                let vertices = self.batch(color).vertices[index];
                if gone(vertices) {
                    self.remove(Slot { color, index });
                    tell(vertices);
                }
            }
        }
    }

    pub(crate) fn batch(&self, color: usize) -> &Batch<N> {
        if color != OVERFLOW {
            &self.batches[color]
        } else {
            &self.overflow
        }
    }

    fn batch_mut(&mut self, color: usize) -> &mut Batch<N> {
        if color != OVERFLOW {
            &mut self.batches[color]
        } else {
            &mut self.overflow
        }
    }
}
