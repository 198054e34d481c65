//! GPU storage of the guard of a body: its pieces, then their vertices.

use super::arena::{Arena, with_slack};
use super::context::Context;
use super::error::GpuError;
use super::layout::{Entry, GUARD_ENTRIES};
use super::upload::Uploads;
use crate::constraints::pieces::PieceVertices;
use incise_mesh::{VertexId, index_u32};
use std::ops::Range;

/// The pieces of a body, with two vertices in every entry of their list.
#[derive(Debug, Default)]
pub(super) struct DeviceGuard {
    /// Allocated entries, slack included.
    list: Range<u32>,
    /// Generation of the uploaded pieces, 0 for none.
    generation: u64,
    pub(super) pieces: u32,
}

impl DeviceGuard {
    /// Returns the first entry.
    pub(super) fn first(&self) -> u32 {
        self.list.start
    }

    /// Frees all entries.
    pub(super) fn free(&mut self, arena: &mut Arena) {
        arena.free(std::mem::take(&mut self.list));
        *self = Self::default();
    }

    /// Makes room for pieces.
    pub(super) fn make_room(
        &mut self,
        context: &Context,
        arena: &mut Arena,
        pieces: &PieceVertices,
    ) -> Result<(), GpuError> {
        let count = GUARD_ENTRIES * pieces.len() + pieces.iter().map(entries_of).sum::<usize>();
        if count > self.list.len() {
            let (list, _) = arena.allocate(context, with_slack(count))?;
            arena.free(std::mem::replace(&mut self.list, list));
            self.generation = 0;
        }
        Ok(())
    }

    /// Uploads pieces that have changed since, for which there is room.
    pub(super) fn update(
        &mut self,
        context: &Context,
        arena: &Arena,
        uploads: &mut Uploads,
        pieces: &PieceVertices,
    ) {
        if pieces.generation() == self.generation {
            return;
        }
        uploads.entries.clear();
        let mut first = self.list.start + index_u32(GUARD_ENTRIES * pieces.len());
        for list in pieces.iter() {
            uploads.entries.push([first, index_u32(list.len())]);
            let numbers: [Entry; GUARD_ENTRIES - 1] = [[0, 0]; GUARD_ENTRIES - 1];
            uploads.entries.extend(numbers);
            first += index_u32(entries_of(list));
        }
        for list in pieces.iter() {
            let pairs = list.chunks(2);
            (uploads.entries).extend(pairs.map(|pair| [pair[0].0, pair[pair.len() - 1].0]));
        }
        uploads.write(context, arena.buffer(0), u64::from(self.list.start) * 8);
        self.pieces = index_u32(pieces.len());
        self.generation = pieces.generation();
    }
}

/// Returns the entries of the list of a piece, which begins with a whole one.
fn entries_of(list: &[VertexId]) -> usize {
    list.len().div_ceil(2)
}
