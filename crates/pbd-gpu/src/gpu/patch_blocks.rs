//! GPU storage of one layer of patches: a block of entries per patch.

use super::arena::{Arena, with_slack};
use super::context::Context;
use super::error::GpuError;
use super::layout::Entry;
use super::records::{entries_of, push_vertices};
use super::upload::Uploads;
use crate::patches::Patching;
use crate::patches::content::{PatchBatch, PatchContent};
use incise_mesh::{VertexId, index_u32};
use std::ops::Range;

/// The block of a patch.
#[derive(Debug, Default)]
struct Block {
    /// Allocated entries, slack included.
    entries: Range<u32>,
    /// Uploaded revision of the patch, 0 for none.
    revision: u64,
}

/// Blocks by patch, and the table of their offsets.
#[derive(Debug, Default)]
pub(super) struct Blocks {
    blocks: Vec<Block>,
    /// Allocated entries of the table, slack included.
    table: Range<u32>,
}

impl Blocks {
    /// Returns the number of patches.
    pub(super) fn len(&self) -> u32 {
        u32::try_from(self.blocks.len()).unwrap_or(u32::MAX)
    }

    /// Returns the first entry of the table.
    pub(super) fn table(&self) -> u32 {
        self.table.start
    }

    /// Frees all entries.
    pub(super) fn free(&mut self, arena: &mut Arena) {
        arena.free(std::mem::take(&mut self.table));
        for block in self.blocks.drain(..) {
            arena.free(block.entries);
        }
    }

    /// Uploads the patches of a layer that changed since the last call.
    ///
    /// Returns true if there are more patches or a block moved.
    pub(super) fn update(
        &mut self,
        context: &Context,
        arena: &mut Arena,
        uploads: &mut Uploads,
        patching: &Patching,
        contents: &[PatchContent],
    ) -> Result<bool, GpuError> {
        let mut moved = contents.len() != self.blocks.len();
        self.blocks.resize_with(contents.len(), Block::default);
        if self.table.len() < contents.len() {
            let (table, _) = arena.allocate(context, with_slack(contents.len()))?;
            arena.free(std::mem::replace(&mut self.table, table));
            moved = true;
        }
        for ((patch, content), block) in (0..).zip(contents).zip(&mut self.blocks) {
            if block.revision == content.revision {
                continue;
            }
            let len = entry_count(patching.vertices(patch), content);
            if block.entries.len() < len {
                let (entries, _) = arena.allocate(context, with_slack(len))?;
                arena.free(std::mem::replace(&mut block.entries, entries));
                moved = true;
            }
            uploads.entries.clear();
            let start = block.entries.start;
            push_patch(&mut uploads.entries, start, patching, patch, content);
            uploads.write(context, arena.buffer(0), u64::from(start) * 8);
            block.revision = content.revision;
        }
        if moved {
            uploads.entries.clear();
            let starts = self.blocks.iter().map(|block| [block.entries.start, 0]);
            uploads.entries.extend(starts);
            uploads.write(context, arena.buffer(0), u64::from(self.table.start) * 8);
        }
        Ok(moved)
    }
}

/// Returns the number of entries before the first constraint.
fn header_len(
    vertices: &[VertexId],
    PatchContent {
        stretch, bending, ..
    }: &PatchContent,
) -> usize {
    1 + vertices.len().div_ceil(2) + stretch.color_ends.len() + bending.color_ends.len()
}

/// Returns the number of entries of a block.
fn entry_count(vertices: &[VertexId], content: &PatchContent) -> usize {
    let stretch = content.stretch.len() * entries_of::<2>() as usize;
    let bending = content.bending.len() * entries_of::<4>() as usize;
    header_len(vertices, content) + stretch + bending
}

/// Appends the entries of a block that starts at entry `start`.
fn push_patch(
    entries: &mut Vec<Entry>,
    start: u32,
    patching: &Patching,
    patch: u32,
    content: &PatchContent,
) {
    let PatchContent {
        stretch, bending, ..
    } = content;
    let vertices = patching.vertices(patch);
    let both = stretch.color_ends.len() | bending.color_ends.len() << 16;
    entries.push([index_u32(vertices.len()), index_u32(both)]);
    let pairs = vertices.chunks(2);
    entries.extend(pairs.map(|pair| [pair[0].0, pair.get(1).map_or(0, |v| v.0)]));
    let first_constraint = start + index_u32(header_len(vertices, content));
    let first_bending = push_runs(entries, stretch, first_constraint);
    push_runs(entries, bending, first_bending);
    push_constraints(entries, stretch, patching);
    push_constraints(entries, bending, patching);
}

/// Appends one run per color; returns the first entry after the constraints.
fn push_runs<const N: usize>(entries: &mut Vec<Entry>, batch: &PatchBatch<N>, first: u32) -> u32 {
    let (mut run, mut start) = (first, 0);
    for &end in &batch.color_ends {
        let len = index_u32(end - start);
        entries.push([run, len]);
        run += len * entries_of::<N>();
        start = end;
    }
    run
}

/// Appends constraints with patch-local vertex indices.
fn push_constraints<const N: usize>(
    entries: &mut Vec<Entry>,
    batch: &PatchBatch<N>,
    patching: &Patching,
) {
    let place = |v| patching.place(v).map_or(0, |place| place.local);
    for (vertices, &rest) in batch.vertices.iter().zip(&batch.rest) {
        push_vertices(entries, vertices.map(place), rest);
    }
}
