//! The dispatches of every kind of pass.

use super::layout::{BENDING, CONTACTS, PassUniform, STRETCH, STRUTS};
use super::pipelines::Kernel;
use super::program::{Compiler, Dispatch, NOTHING, Stepped, color_of, narrow};
use super::shaders::EntryPoint;
use crate::coloring::{LAYERS, MAX_COLORS};
use crate::plan::Pass;

/// A color of at most so many constraints in every body is small: looping over it costs a workgroup
/// less than a dispatch of its own.
const SMALL_COLOR: u32 = 256;

/// Contacts of all colors and those without one.
const ALL_CONTACTS: PassUniform = PassUniform {
    kind: CONTACTS,
    colors: narrow(MAX_COLORS),
    with_overflow: 1,
    ..NOTHING
};

impl Compiler<'_> {
    /// A pass over vertices, pins or tethers.
    pub(super) fn vertices(&mut self, pass: Pass) -> Option<Dispatch> {
        let (kernel, by_substep) = match pass {
            Pass::Predict => (EntryPoint::Predict, true),
            Pass::Pins => (EntryPoint::Pins, true),
            Pass::Tethers => (EntryPoint::Tethers, false),
            Pass::Colliders => (EntryPoint::Colliders, false),
            Pass::Ground => (EntryPoint::Ground, true),
            _ => (EntryPoint::Integrate, true),
        };
        let lanes_of = |b: &Stepped<'_>| match pass {
            Pass::Pins => b.body.pin_count,
            Pass::Tethers => b.body.tether_count,
            Pass::Colliders if b.body.collider_count == 0 => 0,
            _ => b.body.vertex_count,
        };
        let lanes: Vec<(u32, u32)> = (self.by_passes()).map(|b| (b.slot, lanes_of(b))).collect();
        self.dispatch(Kernel::Pass(kernel), NOTHING, by_substep, &lanes)
    }

    /// All multipliers of one kind at once.
    pub(super) fn resets(&mut self, out: &mut Vec<Dispatch>) {
        for kind in [STRETCH, BENDING, STRUTS] {
            let lanes: Vec<(u32, u32)> = (self.by_passes())
                .map(|b| (b.slot, b.body.largest_run(kind)))
                .collect();
            let pass = PassUniform {
                kind,
                colors: self
                    .by_passes()
                    .map(|b| b.body.colors(kind))
                    .max()
                    .unwrap_or(0),
                with_overflow: 1,
                ..NOTHING
            };
            let kernel = Kernel::Pass(EntryPoint::ResetMultipliers);
            out.extend(self.dispatch(kernel, pass, false, &lanes));
        }
        for layer in 1..LAYERS {
            out.extend(self.patches(Kernel::ResetPatches, layer));
        }
        let contacts: Vec<(u32, u32)> = (self.by_passes())
            .map(|b| {
                (
                    b.slot,
                    b.body.contacts.count.min(1) * b.body.contacts.room(),
                )
            })
            .collect();
        let kernel = Kernel::Pass(EntryPoint::ResetMultipliers);
        out.extend(self.dispatch(kernel, ALL_CONTACTS, false, &contacts));
        let pieces: Vec<(u32, u32)> = (self.by_passes())
            .map(|b| (b.slot, b.body.volumes.places.pieces))
            .collect();
        let kernel = Kernel::Pass(EntryPoint::ResetVolumes);
        out.extend(self.dispatch(kernel, NOTHING, false, &pieces));
    }

    /// The contacts of all colors, of which each has few: of all bodies, or of those that have volumes.
    pub(super) fn contacts(&mut self, with_volumes: bool, out: &mut Vec<Dispatch>) {
        let is_meant = |b: &Stepped<'_>| {
            b.body.contacts.count > 0 && (!with_volumes || b.body.volumes.places.pieces > 0)
        };
        let lanes: Vec<(u32, u32)> = (self.by_passes())
            .map(|b| (b.slot, u32::from(is_meant(b)) * self.workgroup))
            .collect();
        let kernel = Kernel::Pass(EntryPoint::Tail);
        out.extend(self.dispatch(kernel, ALL_CONTACTS, true, &lanes));
    }

    /// The sums of chunks, what follows from them for pieces, and the way of every vertex.
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
            out.extend(self.dispatch(Kernel::Pass(entry_point), NOTHING, false, &lanes));
        }
    }

    /// A workgroup a patch of a layer.
    pub(super) fn patches(&mut self, kernel: Kernel, layer: usize) -> Option<Dispatch> {
        let lanes: Vec<(u32, u32)> = (self.by_passes())
            .map(|b| (b.slot, b.body.patches(layer - 1) * self.workgroup))
            .collect();
        let pass = PassUniform {
            color: narrow(layer - 1),
            ..NOTHING
        };
        self.dispatch(kernel, pass, false, &lanes)
    }

    /// Passes over the colors of one kind and layer: large ones get a dispatch each, what follows the
    /// last large one shares one.
    pub(super) fn colors(&mut self, kind: u32, run: &[Pass], out: &mut Vec<Dispatch>) {
        let is_large = |pass: &Pass| match color_of(*pass) {
            Some(color) => (self.by_passes()).any(|b| b.body.run_len(kind, color) > SMALL_COLOR),
            None => false,
        };
        let large = run.iter().rposition(is_large).map_or(0, |last| last + 1);
        let (large, small) = run.split_at(large);
        for color in large.iter().filter_map(|&pass| color_of(pass)) {
            let lanes: Vec<(u32, u32)> = (self.by_passes())
                .map(|b| (b.slot, b.body.run_len(kind, color)))
                .collect();
            let kernel = match kind {
                BENDING => EntryPoint::Bending,
                _ => EntryPoint::Stretch,
            };
            let pass = PassUniform {
                kind,
                color: narrow(color),
                ..NOTHING
            };
            out.extend(self.dispatch(Kernel::Pass(kernel), pass, false, &lanes));
        }
        let colors: Vec<usize> = small.iter().filter_map(|&pass| color_of(pass)).collect();
        let with_overflow = small.iter().any(|&pass| color_of(pass).is_none());
        let first = colors.first().copied().unwrap_or(0);
        let end = colors.last().map_or(0, |&last| last + 1);
        let holds = |b: &Stepped<'_>| {
            let any = (first..end).any(|color| b.body.run_len(kind, color) > 0);
            any || with_overflow && b.body.overflow_len(kind) > 0
        };
        let lanes: Vec<(u32, u32)> = (self.by_passes())
            .map(|b| (b.slot, if holds(b) { self.workgroup } else { 0 }))
            .collect();
        let pass = PassUniform {
            kind,
            color: narrow(first),
            colors: narrow(end - first),
            with_overflow: u32::from(with_overflow),
            ..NOTHING
        };
        out.extend(self.dispatch(Kernel::Pass(EntryPoint::Tail), pass, false, &lanes));
    }
}
