//! Encodes the dispatches of each kind of pass.

use super::layout::{CONTACT_FEATURES, CONTACT_RECOVERIES, CONTACTS, PassUniform};
use super::pipelines::Kernel;
use super::program::{Compiler, Dispatch, PLAIN_PASS, Stepped};
use super::shaders::EntryPoint;
use super::solid::CELL_LOOPS;
use crate::constraints::batches::BatchId;
use crate::constraints::coloring::{LAYERS, MAX_COLORS};
use crate::step::pass::{ConstraintKind, Pass};
use incise_mesh::index_u32;

/// Maximum size of a small color.
///
/// Small colors are projected in one dispatch with one workgroup per body, which costs less than a
/// dispatch each.
const SMALL_COLOR: u32 = 256;

/// Contacts of all colors, and those without a color.
const ALL_CONTACTS: PassUniform = PassUniform {
    kind: CONTACTS,
    colors: index_u32(MAX_COLORS),
    with_overflow: 1,
    ..PLAIN_PASS
};

/// A sweep over batches of one kind, in one direction.
struct ColorSweep<'a> {
    kind: u32,
    /// The kernel of a large color, and that of several small ones.
    kernel: EntryPoint,
    tail: EntryPoint,
    is_back: bool,
    /// Maximum size of a small color.
    small: u32,
    /// Returns the number of constraints of a batch of a body.
    len: &'a dyn Fn(&Stepped<'_>, BatchId) -> u32,
}

impl Compiler<'_> {
    /// Adds a pass over vertices, pins or attachments.
    pub(super) fn vertices(&mut self, pass: Pass) -> Option<Dispatch> {
        let (kernel, by_substep) = match pass {
            Pass::Predict => (EntryPoint::Predict, true),
            Pass::Pins => (EntryPoint::Pins, true),
            Pass::LongRangeAttachments => (EntryPoint::LongRangeAttachments, false),
            Pass::CollidersBeforeVolumes | Pass::Colliders => (EntryPoint::Colliders, true),
            _ => (EntryPoint::Integrate, true),
        };
        let lanes_of = |b: &Stepped<'_>| match pass {
            Pass::Pins => b.body.pin_count,
            Pass::LongRangeAttachments => b.body.attachment_count,
            Pass::CollidersBeforeVolumes if b.body.volumes.places.pieces == 0 => 0,
            Pass::CollidersBeforeVolumes | Pass::Colliders if b.body.collider_count == 0 => 0,
            Pass::Predict | Pass::Colliders if b.body.solid.is_some() => 0,
            _ => b.body.particles()[1],
        };
        let lanes: Vec<(u32, u32)> = (self.by_passes()).map(|b| (b.slot, lanes_of(b))).collect();
        self.dispatch(Kernel::Pass(kernel), PLAIN_PASS, by_substep, &lanes)
    }

    /// Adds a pass over solids: nodes, vertices, or one workgroup each.
    pub(super) fn solids(&mut self, kernel: EntryPoint) -> Option<Dispatch> {
        let workgroup = self.workgroup;
        let lanes_of = |b: &Stepped<'_>| match kernel {
            _ if b.body.solid.is_none() => 0,
            EntryPoint::PredictNodes | EntryPoint::ClearForces => b.body.particles()[1],
            EntryPoint::Embed => b.body.vertex_count,
            EntryPoint::SolidPins => u32::from(b.body.pin_count > 0) * workgroup,
            _ => u32::from(b.body.collider_count > 0) * workgroup,
        };
        let lanes: Vec<(u32, u32)> = (self.by_passes()).map(|b| (b.slot, lanes_of(b))).collect();
        let by_substep = matches!(kernel, EntryPoint::SolidPins | EntryPoint::SolidColliders);
        self.dispatch(Kernel::Pass(kernel), PLAIN_PASS, by_substep, &lanes)
    }

    /// Adds the dispatches over batches of cells, by the passes over them.
    pub(super) fn cells(&mut self, kind: u32, run: &[Pass], out: &mut Vec<Dispatch>) {
        let batches = run.iter().filter_map(|pass| match *pass {
            Pass::Cells(batch) => Some(batch),
            _ => None,
        });
        let sweep = ColorSweep {
            kind,
            kernel: EntryPoint::Cells,
            tail: EntryPoint::CellTail,
            is_back: false,
            small: self.max_small_cells(run),
            len: &|b, batch| (b.body.solid.as_ref()).map_or(0, |solid| solid.batch_len(batch)),
        };
        self.colors(batches.collect(), &sweep, out);
    }

    /// Returns the maximum size of a small color of cells; 0 if an invocation cannot project those
    /// of all small colors.
    fn max_small_cells(&self, run: &[Pass]) -> u32 {
        let cells_of = |b: &Stepped<'_>| {
            let solid = b.body.solid.as_ref();
            let colors = run.iter().filter_map(|pass| match *pass {
                Pass::Cells(batch) if batch != BatchId::Overflow => Some(batch),
                _ => None,
            });
            let sizes = colors.map(|batch| solid.map_or(0, |solid| solid.batch_len(batch)));
            let small = sizes.filter(|size| *size <= SMALL_COLOR);
            let cells = small.map(|size| u64::from(size.div_ceil(self.lanes.tail)));
            cells.sum::<u64>()
        };
        let most = self.by_passes().map(cells_of).max().unwrap_or(0);
        if most * u64::from(CELL_LOOPS) <= self.lanes.rounds {
            SMALL_COLOR
        } else {
            0
        }
    }

    /// Adds the resets of multipliers, one dispatch per kind.
    pub(super) fn resets(&mut self, out: &mut Vec<Dispatch>) {
        for kind in ConstraintKind::ALL {
            let lanes: Vec<(u32, u32)> = (self.by_passes())
                .map(|b| (b.slot, b.body.largest_run(kind)))
                .collect();
            let pass = PassUniform {
                kind: kind as u32,
                colors: self
                    .by_passes()
                    .map(|b| b.body.colors(kind))
                    .max()
                    .unwrap_or(0),
                with_overflow: 1,
                ..PLAIN_PASS
            };
            let kernel = Kernel::Pass(EntryPoint::ResetMultipliers);
            out.extend(self.dispatch(kernel, pass, false, &lanes));
        }
        for layer in 1..LAYERS {
            out.extend(self.patches(Kernel::ResetPatches, layer, false));
        }
        let pieces: Vec<(u32, u32)> = (self.by_passes())
            .map(|b| (b.slot, b.body.volumes.places.pieces))
            .collect();
        let kernel = Kernel::Pass(EntryPoint::ResetVolumes);
        out.extend(self.dispatch(kernel, PLAIN_PASS, false, &pieces));
    }

    /// Adds a pass over the contacts of all bodies, or of bodies with volumes.
    pub(super) fn contacts(&mut self, pass: Pass, out: &mut Vec<Dispatch>) {
        let with_volumes = pass == Pass::ContactsBeforeVolumes;
        let is_included = |b: &Stepped<'_>| {
            b.body.contacts.count > 0 && (!with_volumes || b.body.volumes.places.pieces > 0)
        };
        let lanes: Vec<(u32, u32)> = (self.by_passes())
            .map(|b| (b.slot, u32::from(is_included(b)) * self.workgroup))
            .collect();
        let kernel = Kernel::Pass(EntryPoint::Tail);
        let pass = PassUniform {
            kind: match pass {
                Pass::ContactFeatures => CONTACT_FEATURES,
                Pass::ContactRecovery => CONTACT_RECOVERIES,
                _ => CONTACTS,
            },
            ..ALL_CONTACTS
        };
        out.extend(self.dispatch(kernel, pass, true, &lanes));
    }

    /// Adds the passes over volumes: sums of chunks, steps of pieces, displacements.
    pub(super) fn volumes(&mut self, out: &mut Vec<Dispatch>) {
        for entry_point in [
            EntryPoint::SumVolumes,
            EntryPoint::StepVolumes,
            EntryPoint::MoveVolumes,
        ] {
            let groups = |b: &Stepped<'_>| match entry_point {
                EntryPoint::StepVolumes => b.body.volumes.places.pieces,
                _ => b.body.volumes.places.chunks,
            };
            let lanes: Vec<(u32, u32)> = (self.by_passes())
                .map(|b| (b.slot, groups(b) * self.workgroup))
                .collect();
            let by_substep = entry_point != EntryPoint::StepVolumes;
            let kernel = Kernel::Pass(entry_point);
            // Index of the round, if the kernel does not track it.
            let pass = PassUniform {
                color: u32::from(self.is_later_round),
                ..PLAIN_PASS
            };
            out.extend(self.dispatch(kernel, pass, by_substep, &lanes));
        }
    }

    /// Adds a dispatch over the patches of a layer, one workgroup each.
    pub(super) fn patches(
        &mut self,
        kernel: Kernel,
        layer: usize,
        is_back: bool,
    ) -> Option<Dispatch> {
        let lanes: Vec<(u32, u32)> = (self.by_passes())
            .map(|b| (b.slot, b.body.patches(layer - 1) * self.workgroup))
            .collect();
        let pass = PassUniform {
            color: index_u32(layer - 1),
            is_back: u32::from(is_back),
            ..PLAIN_PASS
        };
        self.dispatch(kernel, pass, false, &lanes)
    }

    /// Adds the dispatches over the batches of one kind and layer.
    pub(super) fn batches(&mut self, kind: ConstraintKind, run: &[Pass], out: &mut Vec<Dispatch>) {
        let batches = run.iter().filter_map(|pass| pass.batch());
        let sweep = ColorSweep {
            kind: kind as u32,
            kernel: match kind {
                ConstraintKind::Bending => EntryPoint::Bending,
                ConstraintKind::Stretch | ConstraintKind::InteriorSpring => EntryPoint::Stretch,
            },
            tail: EntryPoint::Tail,
            is_back: run[0].is_back(),
            small: SMALL_COLOR,
            len: &|b, batch| b.body.batch_len(kind, batch),
        };
        self.colors(batches.collect(), &sweep, out);
    }

    /// Adds the dispatches of a sweep over batches.
    ///
    /// Each color up to the last large one has a dispatch; all later ones share one. A reverse
    /// sweep has the same dispatches in reverse order.
    fn colors(
        &mut self,
        mut batches: Vec<BatchId>,
        sweep: &ColorSweep<'_>,
        out: &mut Vec<Dispatch>,
    ) {
        let &ColorSweep {
            kind,
            kernel,
            tail,
            is_back,
            small,
            len,
        } = sweep;
        let before = out.len();
        batches.sort_unstable();
        let is_large = |batch: &BatchId| {
            *batch != BatchId::Overflow && (self.by_passes()).any(|b| len(b, *batch) > small)
        };
        let large = batches
            .iter()
            .rposition(is_large)
            .map_or(0, |last| last + 1);
        let (large, small) = batches.split_at(large);
        for &batch in large {
            let lanes: Vec<(u32, u32)> = (self.by_passes())
                .map(|b| (b.slot, len(b, batch)))
                .collect();
            let pass = PassUniform {
                kind,
                color: index_u32(batch.number()),
                ..PLAIN_PASS
            };
            out.extend(self.dispatch(Kernel::Pass(kernel), pass, false, &lanes));
        }
        let with_overflow = small.last() == Some(&BatchId::Overflow);
        let colors = &small[..small.len() - usize::from(with_overflow)];
        let first = colors.first().map_or(0, |batch| batch.number());
        let end = colors.last().map_or(0, |batch| batch.number() + 1);
        let holds = |b: &Stepped<'_>| {
            let any = (first..end).any(|color| len(b, BatchId::Color(color)) > 0);
            any || with_overflow && len(b, BatchId::Overflow) > 0
        };
        let lanes: Vec<(u32, u32)> = (self.by_passes())
            .map(|b| (b.slot, if holds(b) { self.workgroup } else { 0 }))
            .collect();
        let pass = PassUniform {
            kind,
            color: index_u32(first),
            colors: index_u32(end - first),
            with_overflow: u32::from(with_overflow),
            is_back: u32::from(is_back),
            ..PLAIN_PASS
        };
        out.extend(self.dispatch(Kernel::Pass(tail), pass, false, &lanes));
        if is_back {
            out[before..].reverse();
        }
    }
}
