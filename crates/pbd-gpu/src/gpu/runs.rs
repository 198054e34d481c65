//! GPU storage of one constraint kind: a run of the constraint arena for each color.

use super::arena::{Arena, with_slack};
use super::context::Context;
use super::error::GpuError;
use super::layout::Run;
use super::records::{entries_of, push_constraint};
use super::upload::Uploads;
use crate::constraints::batches::{Batch, ConstraintSet, OVERFLOW, Slot};
use std::ops::Range;

/// An allocated run.
#[derive(Debug, Clone, Default)]
struct Rented {
    /// Allocated entries of the constraint arena, slack included.
    entries: Range<u32>,
    /// Number of constraints.
    len: u32,
}

impl Rented {
    fn run(&self) -> Run {
        Run {
            first: self.entries.start,
            len: self.len,
        }
    }
}

/// The runs of one kind, by color, the overflow last.
#[derive(Debug, Default)]
pub(super) struct Runs {
    rented: Vec<Rented>,
    overflow: Rented,
}

impl Runs {
    /// Returns the number of constraints of a color.
    pub(super) fn len(&self, color: usize) -> u32 {
        self.rented.get(color).map_or(0, |run| run.len)
    }

    /// Returns the number of overflow constraints.
    pub(super) fn overflow_len(&self) -> u32 {
        self.overflow.len
    }

    /// Returns the number of colors; some may be empty.
    pub(super) fn colors(&self) -> u32 {
        u32::try_from(self.rented.len()).unwrap_or(u32::MAX)
    }

    /// Appends the runs of the colors to a part of the body's table.
    pub(super) fn push_table(&self, table: &mut Vec<Run>) {
        table.extend(self.rented.iter().map(Rented::run));
    }

    /// Returns the run of the overflow.
    pub(super) fn overflow_run(&self) -> Run {
        self.overflow.run()
    }

    /// Frees all runs.
    pub(super) fn free(&mut self, arena: &mut Arena) {
        let overflow = std::mem::take(&mut self.overflow);
        for rented in self.rented.drain(..).chain([overflow]) {
            arena.free(rented.entries);
        }
    }

    /// Uploads the changed slots (ascending) of the first `colors` colors and of the overflow.
    ///
    /// Returns true if a run moved or changed its length.
    pub(super) fn update<const N: usize>(
        &mut self,
        context: &Context,
        arena: &mut Arena,
        uploads: &mut Uploads,
        set: &ConstraintSet<N>,
        colors: usize,
        changed: &[Slot],
    ) -> Result<bool, GpuError> {
        let count = set.batches().len().min(colors);
        self.rented.resize(count, Rented::default());
        let mut moved = false;
        let here = |color: usize| color < colors || color == OVERFLOW;
        for (color, batch) in set.numbered().filter(|(color, _)| here(*color)) {
            let rented = self.rented.get_mut(color).unwrap_or(&mut self.overflow);
            moved |= rented.len as usize != batch.len();
            rented.len = u32::try_from(batch.len()).unwrap_or(u32::MAX);
            let room = (rented.entries.end - rented.entries.start) / entries_of::<N>();
            if rented.len > room {
                rent::<N>(context, arena, rented, batch)?;
                upload(arena, uploads, rented, batch, context);
                moved = true;
                continue;
            }
            let start = changed.partition_point(|slot| slot.color < color);
            let of_color = changed[start..].iter().take_while(|s| s.color == color);
            for slot in of_color.filter(|slot| slot.index < batch.len()) {
                let index = u32::try_from(slot.index).unwrap_or(u32::MAX);
                uploads.constraint(
                    rented.entries.start + index * entries_of::<N>(),
                    batch,
                    slot.index,
                );
            }
        }
        Ok(moved)
    }
}

/// Reallocates a run with slack.
fn rent<const N: usize>(
    context: &Context,
    arena: &mut Arena,
    rented: &mut Rented,
    batch: &Batch<N>,
) -> Result<(), GpuError> {
    let (entries, _) = arena.allocate(context, with_slack(batch.len()) * entries_of::<N>())?;
    let before = std::mem::replace(&mut rented.entries, entries);
    arena.free(before);
    Ok(())
}

/// Uploads a whole batch.
fn upload<const N: usize>(
    arena: &Arena,
    uploads: &mut Uploads,
    rented: &Rented,
    batch: &Batch<N>,
    context: &Context,
) {
    uploads.entries.clear();
    for i in 0..batch.len() {
        push_constraint(&mut uploads.entries, batch, i);
    }
    uploads.write(
        context,
        arena.buffer(0),
        u64::from(rented.entries.start) * 8,
    );
}
