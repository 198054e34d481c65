//! GPU storage of pins, attachments and colliders, which are uploaded whole.

use super::arena::with_slack;
use super::body::{Arenas, DeviceBody};
use super::context::Context;
use super::error::GpuError;
use super::layout::Entry;
use super::records::{push_attachment, push_pin};
use super::upload::Uploads;
use crate::particles::Pin;
use crate::solver::Solver;
use incise_mesh::index_u32;
use std::ops::Range;

impl DeviceBody {
    /// Uploads the pins; returns true if their number has changed.
    pub(super) fn update_pins(
        &mut self,
        context: &Context,
        arenas: &mut Arenas,
        uploads: &mut Uploads,
        pins: &[Pin],
    ) -> Result<bool, GpuError> {
        uploads.entries.clear();
        for pin in pins {
            push_pin(&mut uploads.entries, pin);
        }
        send_list(&mut self.pins, context, arenas, uploads)?;
        let count = u32::try_from(pins.len()).unwrap_or(u32::MAX);
        Ok(std::mem::replace(&mut self.pin_count, count) != count)
    }

    /// Uploads new attachments; returns true if their number has changed.
    pub(super) fn update_attachments(
        &mut self,
        context: &Context,
        arenas: &mut Arenas,
        uploads: &mut Uploads,
        solver: &Solver,
    ) -> Result<bool, GpuError> {
        let (attachments, generation) = (
            solver.attachments(),
            solver.constraints().attachments.generation(),
        );
        if !attachments.is_empty() && self.attachment_generation != generation {
            uploads.entries.clear();
            for attachment in attachments {
                push_attachment(&mut uploads.entries, attachment);
            }
            send_list(&mut self.attachments, context, arenas, uploads)?;
            self.attachment_generation = generation;
        }
        let count = u32::try_from(attachments.len()).unwrap_or(u32::MAX);
        Ok(std::mem::replace(&mut self.attachment_count, count) != count)
    }

    /// Uploads new contacts; returns true if the program must be rebuilt.
    pub(super) fn update_contacts(
        &mut self,
        context: &Context,
        arenas: &mut Arenas,
        uploads: &mut Uploads,
        solver: &Solver,
    ) -> Result<bool, GpuError> {
        let (slot, contacts) = (self.slot, solver.contacts());
        (self.contacts).update(context, arenas, uploads, slot, contacts)
    }

    /// Uploads new colliders; returns true if the program must be rebuilt.
    pub(super) fn update_colliders(
        &mut self,
        context: &Context,
        arenas: &mut Arenas,
        uploads: &mut Uploads,
        solver: &Solver,
    ) -> Result<bool, GpuError> {
        let colliders = &solver.constraints().colliders;
        if self.collider_generation == colliders.generation() {
            return Ok(false);
        }
        let records = colliders.records();
        uploads.entries.clear();
        let entries: &[Entry] = bytemuck::cast_slice(records);
        uploads.entries.extend(entries);
        send_list(&mut self.colliders, context, arenas, uploads)?;
        self.collider_generation = colliders.generation();
        self.plane_count = index_u32(colliders.planes().len());
        let count = index_u32(records.len());
        let before = std::mem::replace(&mut self.collider_count, count);
        Ok((before > 0) != (count > 0))
    }
}

/// Uploads a list of entries to its range, which is reallocated if it is too small.
fn send_list(
    range: &mut Range<u32>,
    context: &Context,
    arenas: &mut Arenas,
    uploads: &mut Uploads,
) -> Result<(), GpuError> {
    let count = uploads.entries.len();
    if count > range.len() {
        let (entries, _) = arenas.entries.allocate(context, with_slack(count))?;
        arenas.entries.free(std::mem::replace(range, entries));
    }
    let offset = u64::from(range.start) * size_of::<Entry>() as u64;
    uploads.write(context, arenas.entries.buffer(0), offset);
    Ok(())
}
