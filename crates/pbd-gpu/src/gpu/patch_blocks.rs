//! GPU storage of one layer of patches: a block of entries per patch.

use super::arena::{Arena, with_slack};
use super::body::Host;
use super::context::Context;
use super::error::GpuError;
use super::layout::Entry;
use super::records::{entries_of, push_vertices};
use super::upload::Uploads;
use crate::constraints::batches::{ConstraintSet, Slot};
use crate::patches::Patching;
use incise_mesh::index_u32;
use std::ops::Range;

/// Blocks by patch, and the table of their offsets.
#[derive(Debug, Default)]
pub(super) struct Blocks {
    /// Allocated entries of every block, slack included.
    blocks: Vec<Range<u32>>,
    /// Allocated entries of the table, slack included.
    table: Range<u32>,
    /// Scratch memory for the constraints of a patch.
    stretch: Vec<Slot>,
    bending: Vec<Slot>,
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
            arena.free(block);
        }
    }

    /// Uploads the changed patches of `layer`, or all patches the first time.
    ///
    /// Returns true if there are more patches or the table moved.
    pub(super) fn update(
        &mut self,
        context: &Context,
        arena: &mut Arena,
        uploads: &mut Uploads,
        host: Host<'_>,
        (layer, patching): (usize, &Patching),
        changed: &[u32],
    ) -> Result<bool, GpuError> {
        let before = self.len();
        let count = u32::try_from(patching.len()).unwrap_or(u32::MAX);
        self.blocks.resize(patching.len(), 0..0);
        let mut moved = count != before;
        if self.table.end - self.table.start < count {
            let (table, _) = arena.allocate(context, with_slack(patching.len()))?;
            arena.free(std::mem::replace(&mut self.table, table));
            moved = true;
        }
        let known = changed.iter().copied().filter(|&patch| patch < before);
        for patch in known.chain(before..count) {
            moved |= self.send(context, arena, uploads, host, (layer, patching), patch)?;
        }
        if moved {
            uploads.entries.clear();
            let starts = self.blocks.iter().map(|block| [block.start, 0]);
            uploads.entries.extend(starts);
            uploads.write(context, arena.buffer(0), u64::from(self.table.start) * 8);
        }
        Ok(moved)
    }

    /// Uploads the block of a patch; returns true if the block moved.
    fn send(
        &mut self,
        context: &Context,
        arena: &mut Arena,
        uploads: &mut Uploads,
        host: Host<'_>,
        (layer, patching): (usize, &Patching),
        patch: u32,
    ) -> Result<bool, GpuError> {
        let (solver, surface) = (host.solver, host.surface);
        let Self {
            stretch, bending, ..
        } = self;
        solver
            .constraints()
            .of_patch(surface, layer, patch, stretch, bending);
        let vertices = patching.vertices(patch);
        let (stretch_colors, bending_colors) = (colors(stretch), colors(bending));
        let constraints =
            stretch.len() * entries_of::<2>() as usize + bending.len() * entries_of::<4>() as usize;
        let first_constraint = 1 + vertices.len().div_ceil(2) + stretch_colors + bending_colors;
        let len = first_constraint + constraints;
        let block = &mut self.blocks[patch as usize];
        let moved = ((block.end - block.start) as usize) < len;
        if moved {
            let (entries, _) = arena.allocate(context, with_slack(len))?;
            arena.free(std::mem::replace(block, entries));
        }
        let mut run = block.start + index_u32(first_constraint);
        let entries = &mut uploads.entries;
        entries.clear();
        let both = stretch_colors | bending_colors << 16;
        entries.push([index_u32(vertices.len()), index_u32(both)]);
        let pairs = vertices.chunks(2);
        entries.extend(pairs.map(|pair| [pair[0].0, pair.get(1).map_or(0, |v| v.0)]));
        push_runs::<2>(entries, stretch, &mut run);
        push_runs::<4>(entries, bending, &mut run);
        push_constraints(entries, stretch, solver.stretch(), patching);
        if let Some(set) = solver.bending() {
            push_constraints(entries, bending, set, patching);
        }
        uploads.write(context, arena.buffer(0), u64::from(block.start) * 8);
        Ok(moved)
    }
}

/// Returns the number of colors of ascending slots.
fn colors(slots: &[Slot]) -> usize {
    slots.chunk_by(|a, b| a.color == b.color).count()
}

/// Appends one run per color; `run` advances from the first constraint to that of the next kind.
fn push_runs<const N: usize>(entries: &mut Vec<Entry>, slots: &[Slot], run: &mut u32) {
    for color in slots.chunk_by(|a, b| a.color == b.color) {
        entries.push([*run, index_u32(color.len())]);
        *run += index_u32(color.len()) * entries_of::<N>();
    }
}

/// Appends constraints with patch-local vertex indices.
fn push_constraints<const N: usize>(
    entries: &mut Vec<Entry>,
    slots: &[Slot],
    set: &ConstraintSet<N>,
    patching: &Patching,
) {
    for &slot in slots {
        let (vertices, rest) = set.at(slot);
        let place = |v| patching.place(v).map_or(0, |place| place.local);
        push_vertices(entries, vertices.map(place), rest);
    }
}
