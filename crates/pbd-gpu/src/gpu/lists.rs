//! Lists of a body that are sent whole: pins, tethers, contacts, colliders.

use super::arena::with_slack;
use super::body::{Arenas, DeviceBody};
use super::context::Context;
use super::error::GpuError;
use super::layout::Entry;
use super::records::{push_pin, push_tether};
use super::upload::Uploads;
use crate::colliders::Colliders;
use crate::plan::Pin;
use crate::solver::Solver;
use std::ops::Range;

impl DeviceBody {
    /// Sends the pins; tells whether there are more or fewer of them now.
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

    /// Sends the tethers of the solver's plan if they were found anew; tells whether there are more or fewer now.
    pub(super) fn update_tethers(
        &mut self,
        context: &Context,
        arenas: &mut Arenas,
        uploads: &mut Uploads,
        solver: &Solver,
    ) -> Result<bool, GpuError> {
        let (tethers, generation) = (solver.tethers(), solver.tethers.generation());
        if !tethers.is_empty() && self.tether_generation != generation {
            uploads.entries.clear();
            for tether in tethers {
                push_tether(&mut uploads.entries, tether);
            }
            send_list(&mut self.tethers, context, arenas, uploads)?;
            self.tether_generation = generation;
        }
        let count = u32::try_from(tethers.len()).unwrap_or(u32::MAX);
        Ok(std::mem::replace(&mut self.tether_count, count) != count)
    }

    /// Sends the solver's contacts if they were set anew; tells whether there is more room for them or none any more.
    pub(super) fn update_contacts(
        &mut self,
        context: &Context,
        arenas: &mut Arenas,
        uploads: &mut Uploads,
        solver: &Solver,
    ) -> Result<bool, GpuError> {
        let contacts = (self.slot, solver.contacts());
        self.contacts.update(context, arenas, uploads, contacts)
    }

    /// Sends the colliders if they were set anew; tells whether there are some now and were none, or the other way round.
    pub(super) fn update_colliders(
        &mut self,
        context: &Context,
        arenas: &mut Arenas,
        uploads: &mut Uploads,
        solver: &Solver,
    ) -> Result<bool, GpuError> {
        let Colliders {
            records,
            generation,
            ..
        } = &solver.colliders;
        if self.collider_generation == *generation {
            return Ok(false);
        }
        uploads.entries.clear();
        let entries: &[Entry] = bytemuck::cast_slice(records);
        uploads.entries.extend(entries);
        send_list(&mut self.colliders, context, arenas, uploads)?;
        self.collider_generation = *generation;
        let count = u32::try_from(records.len()).unwrap_or(u32::MAX);
        let before = std::mem::replace(&mut self.collider_count, count);
        Ok((before > 0) != (count > 0))
    }
}

/// Sends a list of entries to its rented range, which grows where they have no room in it.
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
