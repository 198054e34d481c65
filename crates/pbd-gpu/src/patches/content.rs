//! The constraints of every patch, in the order in which they are projected.
//!
//! A `ConstraintSet` stores constraints by color, which suits edits. Patches are projected one
//! after another, so that particles stay in the fastest memory. Both backends therefore read copies
//! by patch, then color. After an edit the changed patches are copied again.

use super::{Patches, Patching};
use crate::constraints::batches::{Batch, BendingSet, Part, StretchSet};
use crate::constraints::coloring::LAYERS;
use incise_mesh::VertexId;
use std::cell::Cell;

/// Constraints per full block, a multiple of the lanes of every instruction set.
const BLOCK: usize = 8;

/// The constraints of one kind within a patch, by color.
#[derive(Debug, Clone)]
pub(crate) struct PatchBatch<const N: usize> {
    pub(crate) vertices: Vec<[VertexId; N]>,
    pub(crate) rest: Vec<f32>,
    /// Multipliers of the substep; empty if they are not accumulated.
    lambda: Vec<f32>,
    /// Number of constraints up to the end of every color, ascending.
    pub(crate) color_ends: Vec<usize>,
    /// Number of constraints up to the end of every run, ascending.
    ///
    /// The blocks of a run are full, except the last one. Constraints of a block share no vertex.
    run_ends: Vec<usize>,
}

impl<const N: usize> Default for PatchBatch<N> {
    fn default() -> Self {
        Self {
            vertices: Vec::new(),
            rest: Vec::new(),
            lambda: Vec::new(),
            color_ends: Vec::new(),
            run_ends: Vec::new(),
        }
    }
}

impl<const N: usize> PatchBatch<N> {
    fn clear(&mut self) {
        self.vertices.clear();
        self.rest.clear();
        self.lambda.clear();
        self.color_ends.clear();
        self.run_ends.clear();
    }

    /// Returns the number of constraints.
    pub(crate) fn len(&self) -> usize {
        self.vertices.len()
    }

    fn end_color(&mut self) {
        if self.color_ends.last().map_or(0, |&end| end) < self.len() {
            self.color_ends.push(self.len());
        }
    }

    /// Orders constraints within their colors so that few blocks are partial.
    ///
    /// The last block of a color is filled from the next color with constraints that share no
    /// vertex with it. So constraints that share a vertex keep their order, and results their bits.
    fn fill_blocks(&mut self) {
        let (mut start, mut color) = (0, 0);
        while start < self.len() {
            while self.color_ends[color] <= start {
                color += 1;
            }
            start += (self.color_ends[color] - start) / BLOCK * BLOCK;
            let mut end = self.color_ends[color].min(start + BLOCK);
            for &color_end in &self.color_ends[color + 1..] {
                if start == end || end - start == BLOCK {
                    break;
                }
                let first = end;
                for i in first..color_end {
                    if end - start == BLOCK {
                        break;
                    }
                    if !self.shares_vertex(start..first, i) {
                        self.vertices.swap(i, end);
                        self.rest.swap(i, end);
                        end += 1;
                    }
                }
                // The others of this color come before those of the next one.
                if end < color_end {
                    break;
                }
            }
            if end - start < BLOCK && start < end {
                self.run_ends.push(end);
            }
            start = end;
        }
        if self.run_ends.last() != Some(&self.len()) {
            self.run_ends.push(self.len());
        }
    }

    /// Returns true if constraint `i` shares a vertex with a constraint of `block`.
    fn shares_vertex(&self, block: std::ops::Range<usize>, i: usize) -> bool {
        let mut vertices = self.vertices[block].iter().flatten();
        vertices.any(|v| self.vertices[i].contains(v))
    }

    /// Sets all multipliers to zero; allocates only after the batch has grown.
    fn reset_multipliers(&mut self) {
        self.lambda.clear();
        self.lambda.resize(self.vertices.len(), 0.0);
    }

    /// Returns the runs for a projection, with multipliers if they accumulate.
    #[inline(always)]
    pub(crate) fn runs(
        &mut self,
        accumulates_lambda: bool,
    ) -> impl DoubleEndedIterator<Item = Part<'_, N>> {
        let lambda: &mut [f32] = if accumulates_lambda {
            &mut self.lambda
        } else {
            &mut []
        };
        let all = Part {
            vertices: &self.vertices,
            rest: &self.rest,
            lambda: Cell::from_mut(lambda).as_slice_of_cells(),
        };
        let ends = &self.run_ends;
        (0..ends.len()).map(move |i| {
            let start = i.checked_sub(1).map_or(0, |before| ends[before]);
            all.slice(start..ends[i])
        })
    }

    fn capacity(&self) -> usize {
        self.vertices.capacity()
            + self.rest.capacity()
            + self.lambda.capacity()
            + self.color_ends.capacity()
            + self.run_ends.capacity()
    }
}

/// The constraints of one patch.
#[derive(Debug, Clone, Default)]
pub(crate) struct PatchContent {
    /// Revision of the patch that was copied, 0 for none.
    pub(crate) revision: u64,
    /// True while the patch is copied.
    is_open: bool,
    pub(crate) stretch: PatchBatch<2>,
    pub(crate) bending: PatchBatch<4>,
}

/// The constraints of all patches.
#[derive(Debug, Clone, Default)]
pub(crate) struct PatchContents {
    /// Shape [patchings][patches].
    layers: [Vec<PatchContent>; LAYERS - 1],
}

impl PatchContents {
    /// Returns the patches of a layer; there are none in layer 0.
    #[cfg(any(test, feature = "gpu"))]
    pub(crate) fn of_layer(&self, layer: usize) -> &[PatchContent] {
        let layer = layer.checked_sub(1).and_then(|i| self.layers.get(i));
        layer.map_or(&[], Vec::as_slice)
    }

    /// Returns the patches of a layer; there are none in layer 0.
    pub(crate) fn of_layer_mut(&mut self, layer: usize) -> &mut [PatchContent] {
        let layer = layer.checked_sub(1).and_then(|i| self.layers.get_mut(i));
        layer.map_or(&mut [], Vec::as_mut_slice)
    }

    /// Returns true if several threads can project the patches of a layer.
    pub(crate) fn are_shared(&self) -> bool {
        self.layers.iter().any(|patches| patches.len() > 1)
    }

    /// Copies the constraints of patches that have changed. O(n) for n constraints if any have.
    pub(crate) fn update(
        &mut self,
        patches: &Patches,
        stretch: &StretchSet,
        bending: Option<&BendingSet>,
    ) {
        for ((layer, patching), contents) in patches.layers().zip(&mut self.layers) {
            contents.resize_with(patching.len(), PatchContent::default);
            let mut any = false;
            for (patch, content) in (0..).zip(&mut *contents) {
                let revision = patching.revision(patch);
                content.is_open = std::mem::replace(&mut content.revision, revision) != revision;
                if content.is_open {
                    content.stretch.clear();
                    content.bending.clear();
                    any = true;
                }
            }
            if !any {
                continue;
            }
            copy(contents, patching, stretch.layer(layer), |content| {
                &mut content.stretch
            });
            if let Some(bending) = bending {
                copy(contents, patching, bending.layer(layer), |content| {
                    &mut content.bending
                });
            }
            for content in contents.iter_mut().filter(|content| content.is_open) {
                content.stretch.fill_blocks();
                content.bending.fill_blocks();
            }
        }
    }

    /// Sets the multipliers of stretch, or of bending, to zero.
    pub(crate) fn reset_multipliers(&mut self, stretch: bool, bending: bool) {
        for patch in self.layers.iter_mut().flatten() {
            if stretch {
                patch.stretch.reset_multipliers();
            }
            if bending {
                patch.bending.reset_multipliers();
            }
        }
    }

    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        let patches = self.layers.iter().flatten();
        patches
            .map(|p| p.stretch.capacity() + p.bending.capacity())
            .sum()
    }
}

/// Copies the constraints of one kind from the colors of a layer to its open patches.
fn copy<const N: usize>(
    contents: &mut [PatchContent],
    patching: &Patching,
    colors: &[Batch<N>],
    batch_of: impl Fn(&mut PatchContent) -> &mut PatchBatch<N>,
) {
    for color in colors.iter().filter(|color| !color.is_empty()) {
        for (&vertices, &rest) in color.vertices().iter().zip(color.rest()) {
            if let Some(patch) = patching.patch_of(vertices[0]) {
                let content = &mut contents[patch as usize];
                if content.is_open {
                    let batch = batch_of(content);
                    batch.vertices.push(vertices);
                    batch.rest.push(rest);
                }
            }
        }
        for content in contents.iter_mut().filter(|content| content.is_open) {
            batch_of(content).end_color();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    impl<const N: usize> PatchBatch<N> {
        /// Checks that blocks share no vertex and that constraints with a common vertex are in
        /// order of their numbers, which are their rest values.
        fn check(&self) {
            assert_eq!(self.run_ends.last(), Some(&self.len()));
            assert!(self.run_ends.is_sorted_by(|a, b| a < b));
            let mut start = 0;
            for &end in &self.run_ends {
                for block in self.vertices[start..end].chunks(BLOCK) {
                    let mut vertices = block.concat();
                    vertices.sort_unstable();
                    vertices.dedup();
                    assert_eq!(vertices.len(), N * block.len(), "a vertex twice in a block");
                }
                start = end;
            }
            for i in 0..self.len() {
                for j in (0..i).filter(|&j| self.shares_vertex(j..j + 1, i)) {
                    assert!(self.rest[j] < self.rest[i], "constraint {i} before {j}");
                }
            }
        }
    }

    /// Returns constraints of a path of `n` edges, which has two colors, and a fan of `m`.
    fn path_and_fan(n: u32, m: u32) -> PatchBatch<2> {
        let mut batch = PatchBatch::default();
        let edge = |i: u32| [VertexId(i), VertexId(i + 1)];
        for parity in 0..2 {
            batch.vertices.extend((parity..n).step_by(2).map(edge));
            batch.end_color();
        }
        for i in 0..m {
            batch.vertices.push([VertexId(0), VertexId(1000 + i)]);
            batch.end_color();
        }
        batch.rest = (0_u16..).map(f32::from).take(batch.len()).collect();
        batch.fill_blocks();
        batch
    }

    #[test]
    fn a_tail_is_filled_from_the_next_color() {
        let batch = path_and_fan(26, 0);
        batch.check();
        // 13 and 13 constraints: three full blocks instead of two of 8 and two of 5.
        assert_eq!(batch.run_ends, [26]);
    }

    proptest! {
        #[test]
        fn blocks_share_no_vertex_and_keep_the_order(n in 1_u32..80, m in 0_u32..6) {
            path_and_fan(n, m).check();
        }
    }
}
