//! GPU storage of the contacts of a body.

use super::arena::with_slack;
use super::body::{Arenas, RUN_TABLES};
use super::context::Context;
use super::error::GpuError;
use super::layout::{CONTACT_ENTRIES, CONTACTS, Entry, RUN_COLORS, RUN_STRIDE, Run};
use super::readback::Part;
use super::upload::Uploads;
use crate::constraints::batches::OVERFLOW;
use crate::constraints::contacts::{ContactRecord, ContactSet, UNCOLORED};
use incise_mesh::index_u32;
use std::ops::Range;

/// The contacts by color, packed, since they are replaced every frame.
#[derive(Debug, Default)]
pub(super) struct DeviceContacts {
    /// Allocated entries, slack included.
    list: Range<u32>,
    /// Generation of the uploaded contacts, 0 for none.
    generation: u64,
    /// Generation of the contacts that were copied last.
    copied: u64,
    pub(super) count: u32,
}

impl DeviceContacts {
    /// Returns the capacity in contacts.
    pub(super) fn room(&self) -> u32 {
        (self.list.end - self.list.start) / entries(1)
    }

    /// Frees all entries.
    pub(super) fn free(&mut self, arenas: &mut Arenas) {
        arenas.entries.free(std::mem::take(&mut self.list));
        *self = Self::default();
    }

    /// Returns the list in its buffer, to be copied.
    pub(super) fn begin_copy<'a>(&mut self, arenas: &'a Arenas) -> Part<'a> {
        self.copied = self.generation;
        let entry = size_of::<Entry>() as u64;
        let bytes = u64::from(entries(self.count)) * entry;
        let start = u64::from(self.list.start) * entry;
        (arenas.entries.buffer(0), start, bytes)
    }

    /// Copies a downloaded list to the solver's contacts, unless these were set since.
    pub(super) fn end_copy(&self, bytes: &[u8], set: &mut ContactSet) {
        let size = size_of::<ContactRecord>();
        if set.generation() == self.copied && bytes.len() == set.len() * size {
            let contacts = set.colors.iter_mut().flatten();
            for (contact, bytes) in contacts.zip(bytes.chunks_exact(size)) {
                *contact = bytemuck::pod_read_unaligned(bytes);
            }
        }
    }

    /// Uploads the solver's contacts of the body in `slot` if they have changed.
    ///
    /// Returns true if the program must be rebuilt.
    pub(super) fn update(
        &mut self,
        context: &Context,
        arenas: &mut Arenas,
        uploads: &mut Uploads,
        slot: u32,
        set: &ContactSet,
    ) -> Result<bool, GpuError> {
        if set.generation() == self.generation {
            return Ok(false);
        }
        let (before, had) = (self.room(), self.count > 0);
        let count = set.len();
        if count > self.room() as usize {
            let wanted = with_slack(count) * entries(1);
            let (list, _) = arenas.entries.allocate(context, wanted)?;
            arenas.entries.free(std::mem::replace(&mut self.list, list));
        }
        uploads.entries.clear();
        let mut table = [Run::default(); RUN_COLORS];
        for (color, contacts) in set.colors.iter().enumerate() {
            let run = Run {
                first: self.list.start + index_u32(uploads.entries.len()),
                len: index_u32(contacts.len()),
            };
            table[if color == UNCOLORED { OVERFLOW } else { color }] = run;
            let words: &[Entry] = bytemuck::cast_slice(contacts);
            uploads.entries.extend(words);
        }
        let offset = u64::from(self.list.start) * size_of::<Entry>() as u64;
        uploads.write(context, arenas.entries.buffer(0), offset);
        let first = u64::from(slot * RUN_STRIDE) + u64::from(CONTACTS) * RUN_COLORS as u64;
        let table_at = first * size_of::<Run>() as u64;
        let buffer = arenas.bodies.buffer(RUN_TABLES);
        uploads.send(context, buffer, table_at, bytemuck::cast_slice(&table));
        self.count = index_u32(count);
        self.generation = set.generation();
        Ok(self.room() != before || (count > 0) != had)
    }
}

/// Returns the number of entries of `count` contacts.
fn entries(count: u32) -> u32 {
    count * index_u32(CONTACT_ENTRIES)
}
