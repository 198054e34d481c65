//! One body's ranges in the arenas, and the upload of its changes.

use super::arena::{Arena, with_slack};
use super::contacts::DeviceContacts;
use super::context::Context;
use super::error::GpuError;
use super::guard::DeviceGuard;
use super::layout::{BodyRecord, Motion, PATCH_LAYERS, RUN_COLORS, RUN_STRIDE, Run};
use super::patch_blocks::Blocks;
use super::records::{Places, body_record, inverse_mass, motion, position};
use super::runs::Runs;
use super::solid::{DeviceSolid, embedded_position};
use super::stats::Schedule;
use super::upload::{Target, Uploads};
use super::volumes::DeviceVolumes;
use crate::constraints::Constraints;
use crate::constraints::batches::{BatchId, OVERFLOW};
use crate::constraints::coloring::MAX_COLORS;
use crate::follow::changes::Changes;
use crate::kernels::volume::CHUNK;
use crate::solver::Solver;
use crate::step::constants::StepConstants;
use crate::step::guard::GuardInputs;
use crate::step::pass::ConstraintKind;
use crate::step::plan::StepPlan;
use bytemuck::Zeroable;
use incise_mesh::Surface;
use std::ops::Range;

/// The buffers that all bodies share.
#[derive(Debug)]
pub(super) struct Arenas {
    /// Positions, motions, displacements.
    pub(super) vertices: Arena,
    /// Constraints, pins and attachments, in entries of 8 bytes.
    pub(super) entries: Arena,
    /// Body records, run tables, reports.
    pub(super) bodies: Arena,
}

pub(super) const POSITIONS: usize = 0;
pub(super) const MOTIONS: usize = 1;
pub(super) const DISPLACEMENTS: usize = 2;
pub(super) const RECORDS: usize = 0;
pub(super) const RUN_TABLES: usize = 1;
pub(super) const REPORTS: usize = 2;

/// Leaves of the reduction trees of volumes.
#[expect(clippy::cast_possible_truncation, reason = "some hundred")]
const CHUNK_LANES: u32 = CHUNK as u32;

/// The CPU side of a body.
#[derive(Debug, Clone, Copy)]
pub(super) struct Host<'a> {
    pub(super) surface: &'a Surface,
    pub(super) solver: &'a Solver,
}

/// The GPU side of a body.
#[derive(Debug)]
pub(super) struct DeviceBody {
    /// Index among the bodies.
    pub(super) slot: u32,
    /// Allocated vertices, slack included.
    vertices: Range<u32>,
    pub(super) vertex_count: u32,
    guard: DeviceGuard,
    stretch: Runs,
    bending: Runs,
    interior_springs: Runs,
    /// The inside of a solid, whose nodes are the particles.
    pub(super) solid: Option<DeviceSolid>,
    /// Patches by layer; empty unless the body is divided.
    patches: [Blocks; PATCH_LAYERS],
    /// True if constraints within patches are in blocks and not in runs.
    is_divided: bool,
    /// Allocated entries, slack included.
    pub(super) pins: Range<u32>,
    pub(super) pin_count: u32,
    /// Allocated entries, slack included.
    pub(super) attachments: Range<u32>,
    pub(super) attachment_count: u32,
    /// Generation of the uploaded attachments, 0 for none.
    pub(super) attachment_generation: u64,
    pub(super) volumes: DeviceVolumes,
    pub(super) contacts: DeviceContacts,
    /// Allocated entries, slack included.
    pub(super) colliders: Range<u32>,
    pub(super) collider_count: u32,
    /// Number of colliders that are planes.
    pub(super) plane_count: u32,
    /// Generation of the uploaded colliders, 0 for none.
    pub(super) collider_generation: u64,
    /// Last uploaded record.
    record: BodyRecord,
    pub(super) schedule: Schedule,
}

impl DeviceBody {
    /// Creates an empty body in a slot.
    pub(super) fn new(slot: u32) -> Self {
        Self {
            slot,
            vertices: 0..0,
            vertex_count: 0,
            guard: DeviceGuard::default(),
            stretch: Runs::default(),
            bending: Runs::default(),
            interior_springs: Runs::default(),
            solid: None,
            patches: std::array::from_fn(|_| Blocks::default()),
            is_divided: false,
            pins: 0..0,
            pin_count: 0,
            attachments: 0..0,
            attachment_count: 0,
            attachment_generation: 0,
            volumes: DeviceVolumes::default(),
            contacts: DeviceContacts::default(),
            colliders: 0..0,
            collider_count: 0,
            plane_count: 0,
            collider_generation: 0,
            record: BodyRecord::zeroed(),
            schedule: Schedule::WholeBody,
        }
    }

    /// Returns the first particle in the arena and the number of particles: vertices, or nodes of a
    /// solid.
    pub(super) fn particles(&self) -> [u32; 2] {
        let vertices = [self.vertices.start, self.vertex_count];
        self.solid.as_ref().map_or(vertices, DeviceSolid::nodes)
    }

    /// Returns the body's first vertex in the arena.
    pub(super) fn first_vertex(&self) -> u32 {
        self.vertices.start
    }

    /// Returns the number of constraints of a batch.
    pub(super) fn batch_len(&self, kind: ConstraintKind, batch: BatchId) -> u32 {
        match batch {
            BatchId::Color(color) => self.runs(kind).len(color),
            BatchId::Overflow => self.runs(kind).overflow_len(),
        }
    }

    /// Returns the number of colors of a constraint kind.
    pub(super) fn colors(&self, kind: ConstraintKind) -> u32 {
        self.runs(kind).colors()
    }

    /// Returns the number of constraints of the largest color or overflow of a kind.
    pub(super) fn largest_run(&self, kind: ConstraintKind) -> u32 {
        let runs = self.runs(kind);
        let colors = (0..runs.colors() as usize).map(|color| runs.len(color));
        colors.max().unwrap_or(0).max(runs.overflow_len())
    }

    /// Estimates the loop iterations of an invocation per substep in the whole-body kernel.
    pub(super) fn rounds(&self, lanes: u32, plan: &StepPlan) -> u64 {
        let per_lane = |count: u32| u64::from(count.div_ceil(lanes)) + 1;
        let runs = [&self.stretch, &self.bending, &self.interior_springs];
        let colors_of = runs.map(|runs| {
            let colors = (0..runs.colors() as usize).map(|color| per_lane(runs.len(color)));
            colors.sum::<u64>() + u64::from(runs.overflow_len())
        });
        let [stretch, bending, springs] = colors_of;
        let colors = 2 * (stretch + springs + bending);
        let vertices = per_lane(self.vertex_count);
        let places = &self.volumes.places;
        // Two traversals of the fan of every vertex, its motion, and reduction trees.
        let leaves = u64::from(places.chunks + places.pieces) * 4 * per_lane(CHUNK_LANES);
        let volumes = if places.pieces > 0 {
            16 * vertices + leaves
        } else {
            0
        };
        // With volumes contacts and colliders are handled before and after them, and gradients test
        // the colliders. Contacts test planes.
        let sweeps = 1 + u64::from(places.pieces > 0);
        let planes = u64::from(1 + self.plane_count);
        let contacts = sweeps * (u64::from(self.contacts.count) * planes + 64);
        let colliders = (2 * sweeps - 1) * vertices * u64::from(1 + self.collider_count);
        let attachments = per_lane(self.attachment_count);
        let round = volumes + contacts + colliders + vertices;
        let iteration = 2 * colors + attachments + u64::from(plan.contact_rounds()) * round;
        3 * vertices + u64::from(plan.iterations()) * iteration
    }

    fn runs(&self, kind: ConstraintKind) -> &Runs {
        match kind {
            ConstraintKind::Stretch => &self.stretch,
            ConstraintKind::Bending => &self.bending,
            ConstraintKind::InteriorSpring => &self.interior_springs,
        }
    }

    /// Returns the number of patches of a layer, counted from 0.
    pub(super) fn patches(&self, layer: usize) -> u32 {
        self.patches.get(layer).map_or(0, Blocks::len)
    }

    /// Frees all ranges.
    pub(super) fn free(&mut self, arenas: &mut Arenas) {
        self.guard.free(&mut arenas.entries);
        self.stretch.free(&mut arenas.entries);
        self.bending.free(&mut arenas.entries);
        self.interior_springs.free(&mut arenas.entries);
        if let Some(mut solid) = self.solid.take() {
            solid.free(arenas);
        }
        for blocks in &mut self.patches {
            blocks.free(&mut arenas.entries);
        }
        arenas.vertices.free(std::mem::take(&mut self.vertices));
        arenas.entries.free(std::mem::take(&mut self.pins));
        arenas.entries.free(std::mem::take(&mut self.attachments));
        self.attachment_generation = 0;
        self.volumes.free(&mut arenas.entries);
        self.contacts.free(arenas);
        arenas.entries.free(std::mem::take(&mut self.colliders));
        (self.collider_count, self.plane_count) = (0, 0);
        self.collider_generation = 0;
    }

    /// Sets the schedule of a body before everything is uploaded.
    pub(super) fn set_schedule(&mut self, schedule: Schedule, has_patches: bool) {
        self.schedule = schedule;
        self.is_divided = schedule == Schedule::Patches && has_patches;
    }

    /// Switches a body that has outgrown the memory of a workgroup to patches.
    ///
    /// The next update uploads the freed runs again.
    pub(super) fn leave_workgroup(&mut self, arenas: &mut Arenas, has_patches: bool) {
        self.set_schedule(Schedule::Patches, has_patches);
        if self.is_divided {
            // Constraints within patches leave the runs.
            self.guard.free(&mut arenas.entries);
            self.stretch.free(&mut arenas.entries);
            self.bending.free(&mut arenas.entries);
        }
    }

    /// Uploads an edit of surface and solver.
    pub(super) fn update(
        &mut self,
        context: &Context,
        arenas: &mut Arenas,
        uploads: &mut Uploads,
        host: Host<'_>,
        changes: &Changes,
    ) -> Result<bool, GpuError> {
        let Host { surface, solver } = host;
        let everything = changes.everything;
        if everything {
            self.free(arenas);
        }
        let before = self.vertices.start;
        self.make_room(context, arenas, surface.positions().len(), !everything)?;
        let mut moved = everything || self.vertices.start != before;
        if everything {
            self.upload_vertices(context, arenas, uploads, surface, solver);
            if let Some(interior) = solver.interior() {
                let solid = self.solid.insert(DeviceSolid::new());
                let vertices = surface.positions().len();
                solid.upload(context, arenas, uploads, interior, vertices)?;
            }
        } else {
            for &v in &changes.vertices {
                let value = position(surface, solver, v);
                uploads.edit_vector(Target::Positions, self.vertices.start + v, value);
            }
            self.edit_masses(uploads, solver, &changes.masses);
            self.edit_motions(uploads, solver, &changes.velocities);
        }
        let entries = &mut arenas.entries;
        let colors = if self.is_divided {
            MAX_COLORS
        } else {
            OVERFLOW
        };
        let (set, changed) = (solver.stretch(), &changes.stretch);
        moved |= (self.stretch).update(context, entries, uploads, set, colors, changed)?;
        if let Some(set) = solver.bending() {
            let changed = &changes.bending;
            moved |= (self.bending).update(context, entries, uploads, set, colors, changed)?;
        }
        if let Some(set) = solver.interior_springs() {
            let (runs, changed) = (&mut self.interior_springs, &changes.interior_springs);
            moved |= runs.update(context, entries, uploads, set, colors, changed)?;
        }
        let Constraints {
            patches,
            patch_contents,
            ..
        } = solver.constraints();
        if let Some(patches) = patches
            && self.is_divided
        {
            for ((layer, patching), blocks) in patches.layers().zip(&mut self.patches) {
                let contents = patch_contents.of_layer(layer);
                moved |= blocks.update(context, entries, uploads, patching, contents)?;
            }
        }
        (self.guard).make_room(context, entries, &solver.constraints().pieces)?;
        let mut counts = self.volumes.update(context, entries, uploads, host)?;
        if moved {
            self.send_tables(context, arenas, uploads);
        }
        counts |= moved;
        Ok(counts)
    }

    /// Uploads the run tables: for each kind its colors, then the overflow.
    fn send_tables(&self, context: &Context, arenas: &Arenas, uploads: &mut Uploads) {
        let buffer = arenas.bodies.buffer(RUN_TABLES);
        let run = size_of::<Run>() as u64;
        let mut start = u64::from(self.slot) * u64::from(RUN_STRIDE) * run;
        let mut table = Vec::new();
        for runs in [&self.stretch, &self.bending, &self.interior_springs] {
            table.clear();
            runs.push_table(&mut table);
            uploads.send(context, buffer, start, bytemuck::cast_slice(&table));
            start += RUN_COLORS as u64 * run;
            let overflow = runs.overflow_run();
            uploads.send(context, buffer, start - run, bytemuck::bytes_of(&overflow));
        }
        if let Some(solid) = &self.solid {
            table.clear();
            solid.push_table(&mut table);
            uploads.send(context, buffer, start, bytemuck::cast_slice(&table));
        }
    }

    /// Uploads the pieces of the guard if they have changed.
    pub(super) fn update_guard(
        &mut self,
        context: &Context,
        arenas: &Arenas,
        uploads: &mut Uploads,
        solver: &Solver,
    ) {
        let pieces = &solver.constraints().pieces;
        (self.guard).update(context, &arenas.entries, uploads, pieces);
    }

    /// Queues velocities that were set on the CPU side, of a body that may not have been read.
    pub(super) fn edit_velocities(&self, uploads: &mut Uploads, solver: &Solver, of: &[u32]) {
        for &v in of {
            let first = 2 * (self.vertices.start + v);
            uploads.edit_vector(Target::Motions, first, motion(solver, v).velocity);
        }
    }

    /// Queues motions that were set on the CPU side.
    fn edit_motions(&self, uploads: &mut Uploads, solver: &Solver, of: &[u32]) {
        for &v in of {
            let Motion {
                velocity,
                correction,
            } = motion(solver, v);
            // Two vectors per vertex.
            let first = 2 * (self.vertices.start + v);
            uploads.edit_vector(Target::Motions, first, velocity);
            uploads.edit_vector(Target::Motions, first + 1, correction);
        }
    }

    /// Queues inverse masses that were set on the CPU side.
    pub(super) fn edit_masses(&self, uploads: &mut Uploads, solver: &Solver, of: &[u32]) {
        for &v in of {
            uploads.edit_mass(self.vertices.start + v, inverse_mass(solver, v));
        }
    }

    /// Uploads the body's record if it has changed.
    pub(super) fn update_record(
        &mut self,
        context: &Context,
        arenas: &Arenas,
        uploads: &mut Uploads,
        constants: &StepConstants,
        guard: Option<&GuardInputs>,
    ) {
        if let Some(solid) = &mut self.solid {
            solid.set_constants(constants.cells);
        }
        let [first_vertex, vertices] = self.particles();
        let solid = self.solid.as_ref();
        let places = Places {
            first_vertex,
            vertices,
            first_surface_vertex: self.vertices.start,
            surface_vertices: self.vertex_count,
            first_pin: self.pins.start,
            pins: self.pin_count,
            first_attachment: self.attachments.start,
            attachments: self.attachment_count,
            first_run: self.slot * RUN_STRIDE,
            stretch_colors: self.stretch.colors(),
            bending_colors: self.bending.colors(),
            patch_tables: self.patches.each_ref().map(Blocks::table),
            patches: self.patches.each_ref().map(Blocks::len),
            volumes: self.volumes.places,
            spring_colors: self.interior_springs.colors(),
            contacts: self.contacts.count,
            first_collider: self.colliders.start,
            colliders: self.collider_count,
            planes: self.plane_count,
            first_guard: self.guard.first(),
            guard_pieces: self.guard.pieces,
            solid: solid.map(DeviceSolid::places).unwrap_or_default(),
            sums_forces: solid.is_some_and(DeviceSolid::needs_sums),
        };
        let record = body_record(places, constants, guard);
        let (old, new) = (
            bytemuck::bytes_of(&self.record),
            bytemuck::bytes_of(&record),
        );
        if old != new {
            let offset = u64::from(self.slot) * new.len() as u64;
            uploads.send(context, arenas.bodies.buffer(RECORDS), offset, new);
            self.record = record;
        }
    }

    /// Reallocates the vertices and moves their GPU data if it is to be kept.
    fn make_room(
        &mut self,
        context: &Context,
        arenas: &mut Arenas,
        vertices: usize,
        keep: bool,
    ) -> Result<(), GpuError> {
        let room = self.vertices.end - self.vertices.start;
        let count = u32::try_from(vertices).unwrap_or(u32::MAX);
        if count > room {
            let (range, _) = arenas.vertices.allocate(context, with_slack(vertices))?;
            let before = std::mem::replace(&mut self.vertices, range.clone());
            if keep && !before.is_empty() {
                let mut encoder = super::encoder(context, "move a body");
                let used = before.start..before.start + self.vertex_count;
                arenas
                    .vertices
                    .move_range(context, &mut encoder, used, range)?;
                context.queue().submit([encoder.finish()]);
            }
            arenas.vertices.free(before);
        }
        self.vertex_count = count;
        Ok(())
    }

    fn upload_vertices(
        &self,
        context: &Context,
        arenas: &Arenas,
        uploads: &mut Uploads,
        surface: &Surface,
        solver: &Solver,
    ) {
        let offset = u64::from(self.vertices.start) * 16;
        let at = |v: u32| match solver.interior() {
            Some(interior) => embedded_position(interior, v as usize),
            None => position(surface, solver, v),
        };
        let positions: Vec<[f32; 4]> = (0..self.vertex_count).map(at).collect();
        let buffer = arenas.vertices.buffer(POSITIONS);
        uploads.send(context, buffer, offset, bytemuck::cast_slice(&positions));
        if solver.is_solid() {
            // Its nodes have the motion.
            return;
        }
        let buffer = arenas.vertices.buffer(MOTIONS);
        let motions: Vec<Motion> = (0..self.vertex_count).map(|v| motion(solver, v)).collect();
        let motions = bytemuck::cast_slice(&motions);
        uploads.send(context, buffer, 2 * offset, motions);
    }
}
