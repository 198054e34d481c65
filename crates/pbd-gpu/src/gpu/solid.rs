//! GPU storage of the inside of a solid: nodes, cells, and the nodes and weights of its vertices.
//!
//! An edit of a solid uploads all of it: a cut changes cells, masses and weights around it, and
//! colors beyond.

use super::arena::{Arena, with_slack};
use super::body::{Arenas, MOTIONS, POSITIONS};
use super::context::Context;
use super::error::GpuError;
use super::layout::{
    CELL_ENTRIES, CELL_STATE, EMBEDDING_ENTRIES, Entry, Motion, NEAR_ENTRIES, PIN_START_ENTRIES,
    Run, UNUSED,
};
use super::readback::Part;
use super::upload::Uploads;
use crate::constraints::batches::{BatchId, OVERFLOW};
use crate::constraints::cells::{CELLS_PER_BLOCK, CellBlock, CellState};
use crate::interior::Interior;
use crate::kernels::cells::CellConstants;
use crate::kernels::points::PIN_SWEEPS;
use incise_lattice::NO_COPY;
use incise_mesh::{VertexId, index_u32};
use std::ops::Range;

/// Entries of the state of a cell.
const STATE_ENTRIES: usize = CELL_ENTRIES - CELL_STATE;

/// Upper bound of the loop iterations in which an invocation projects a cell.
pub(super) const CELL_LOOPS: u32 = 96;

/// The inside of a solid.
#[derive(Debug)]
pub(super) struct DeviceSolid {
    /// Allocated particles of the vertex arena, slack included.
    nodes: Range<u32>,
    node_count: u32,
    /// Allocated entries of the cells, color by color, slack included.
    cells: Range<u32>,
    /// Number of cells of each color, the overflow last.
    counts: Vec<u32>,
    /// Allocated entries of the nodes and weights of vertices, slack included.
    embedding: Range<u32>,
    /// Allocated entries of the vertices near colliders, slack included.
    near: Range<u32>,
    /// Allocated entries of the starts of pinned vertices, slack included.
    pin_starts: Range<u32>,
    /// Uploaded starts of pinned vertices \[m\].
    known_starts: Vec<[f32; 3]>,
    /// Length of the edges of a cell \[m\].
    cell_size: f32,
    /// Coefficients for which the forces at nodes are summed, now or by the next submission.
    summed_for: CellConstants,
    /// Coefficients of the forces that were copied last.
    copied_for: CellConstants,
    /// Whether forces are summed again before the next frame.
    needs_sums: bool,
}

/// Offsets of the inside of a solid in the arenas.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct SolidPlaces {
    pub(super) cell_colors: u32,
    pub(super) first_embedding: u32,
    pub(super) first_pin_start: u32,
    pub(super) first_near: u32,
    pub(super) cell_size: f32,
}

impl DeviceSolid {
    /// Creates an empty inside.
    pub(super) fn new() -> Self {
        Self {
            nodes: 0..0,
            node_count: 0,
            cells: 0..0,
            counts: Vec::new(),
            embedding: 0..0,
            near: 0..0,
            pin_starts: 0..0,
            known_starts: Vec::new(),
            cell_size: 0.0,
            summed_for: CellConstants::NONE,
            copied_for: CellConstants::NONE,
            needs_sums: false,
        }
    }

    /// Frees all ranges.
    pub(super) fn free(&mut self, arenas: &mut Arenas) {
        arenas.vertices.free(std::mem::take(&mut self.nodes));
        for range in [
            &mut self.cells,
            &mut self.embedding,
            &mut self.near,
            &mut self.pin_starts,
        ] {
            arenas.entries.free(std::mem::take(range));
        }
        *self = Self::new();
    }

    /// Returns the first node in the vertex arena, and the number of nodes.
    pub(super) fn nodes(&self) -> [u32; 2] {
        [self.nodes.start, self.node_count]
    }

    /// Returns the number of cells of a batch.
    pub(super) fn batch_len(&self, batch: BatchId) -> u32 {
        match batch {
            BatchId::Color(color) if color + 1 < self.counts.len() => self.counts[color],
            BatchId::Color(_) => 0,
            BatchId::Overflow => self.counts.last().copied().unwrap_or(0),
        }
    }

    /// Returns the number of colors.
    pub(super) fn colors(&self) -> u32 {
        index_u32(self.counts.len().saturating_sub(1))
    }

    /// Returns an upper bound of the loop iterations of an invocation that works alone: on the
    /// cells without a color, on pins, and on vertices near colliders.
    pub(super) fn serial_loops(&self, vertices: u32, pins: usize, colliders: usize) -> u64 {
        let vertices = u64::from(vertices);
        let cells = u64::from(self.batch_len(BatchId::Overflow)) * u64::from(CELL_LOOPS);
        let pins = 2 * (PIN_SWEEPS * pins) as u64;
        // The list is made of all vertices, and each collider passes it twice.
        let near = vertices * (2 * colliders as u64 + 1);
        cells.max(pins).max(near)
    }

    /// Returns the offsets that kernels read.
    pub(super) fn places(&self) -> SolidPlaces {
        SolidPlaces {
            cell_colors: self.colors(),
            first_embedding: self.embedding.start,
            first_pin_start: self.pin_starts.start,
            first_near: self.near.start,
            cell_size: self.cell_size,
        }
    }

    /// Sets the coefficients of the next frame, for which forces may have to be summed again.
    pub(super) fn set_constants(&mut self, constants: CellConstants) {
        self.needs_sums |= std::mem::replace(&mut self.summed_for, constants) != constants;
    }

    /// Returns whether forces are summed again before the next frame.
    pub(super) fn needs_sums(&self) -> bool {
        self.needs_sums
    }

    /// Records that the frame was submitted.
    pub(super) fn submitted(&mut self) {
        self.needs_sums = false;
    }

    /// Uploads the whole inside of a solid with `vertices` vertex slots.
    pub(super) fn upload(
        &mut self,
        context: &Context,
        arenas: &mut Arenas,
        uploads: &mut Uploads,
        interior: &Interior,
        vertices: usize,
    ) -> Result<(), GpuError> {
        let nodes = interior.positions.len();
        let cells = interior.cells.len();
        (self.nodes, _) = arenas.vertices.allocate(context, with_slack(nodes))?;
        let entries = &mut arenas.entries;
        for (range, count) in [
            (&mut self.cells, CELL_ENTRIES * cells),
            (&mut self.embedding, EMBEDDING_ENTRIES * vertices),
            (&mut self.near, 1 + NEAR_ENTRIES * vertices),
        ] {
            (*range, _) = entries.allocate(context, with_slack(count))?;
        }
        self.node_count = index_u32(nodes);
        self.counts.clear();
        (self.counts).extend((interior.cells.all()).map(|batch| index_u32(batch.len())));
        self.summed_for = interior.constants();
        self.cell_size = interior.cell_size();
        let offset = u64::from(self.nodes.start) * size_of::<[f32; 4]>() as u64;
        let positions = bytemuck::cast_slice(&interior.positions);
        uploads.send(
            context,
            arenas.vertices.buffer(POSITIONS),
            offset,
            positions,
        );
        let motions = interior.velocities.iter().zip(&interior.node_forces);
        let motions: Vec<Motion> = motions
            .map(|(&velocity, &correction)| Motion {
                velocity,
                correction,
            })
            .collect();
        let motions = bytemuck::cast_slice(&motions);
        uploads.send(
            context,
            arenas.vertices.buffer(MOTIONS),
            2 * offset,
            motions,
        );
        uploads.entries.clear();
        for (block, lane) in interior.cells.iter() {
            push_cell(&mut uploads.entries, block, lane);
        }
        write(context, uploads, &arenas.entries, &self.cells);
        uploads.entries.clear();
        for slot in 0..vertices {
            push_embedding(&mut uploads.entries, interior, slot);
        }
        write(context, uploads, &arenas.entries, &self.embedding);
        Ok(())
    }

    /// Appends the runs of the colors to a part of the body's table.
    pub(super) fn push_table(&self, table: &mut Vec<Run>) {
        let mut first = self.cells.start;
        for &len in &self.counts {
            table.push(Run { first, len });
            first += len * index_u32(CELL_ENTRIES);
        }
        if let Some(overflow) = table.pop() {
            table.resize(OVERFLOW, Run::default());
            table.push(overflow);
        }
    }

    /// Uploads the starts of pinned vertices if they have changed.
    pub(super) fn update_pin_starts(
        &mut self,
        context: &Context,
        arenas: &mut Arenas,
        uploads: &mut Uploads,
        starts: &[[f32; 3]],
    ) -> Result<(), GpuError> {
        if self.known_starts == starts {
            return Ok(());
        }
        let count = PIN_START_ENTRIES * starts.len();
        if count > self.pin_starts.len() {
            let (entries, _) = arenas.entries.allocate(context, with_slack(count))?;
            let before = std::mem::replace(&mut self.pin_starts, entries);
            arenas.entries.free(before);
        }
        uploads.entries.clear();
        for start in starts {
            let [x, y, z] = start.map(f32::to_bits);
            uploads.entries.extend([[x, y], [z, 0]]);
        }
        write(context, uploads, &arenas.entries, &self.pin_starts);
        self.known_starts.clear();
        self.known_starts.extend_from_slice(starts);
        Ok(())
    }

    /// Returns nodes, their motions and the cells in their buffers, to be copied.
    pub(super) fn begin_copy<'a>(&mut self, arenas: &'a Arenas) -> [Part<'a>; 3] {
        self.copied_for = self.summed_for;
        let vector = size_of::<[f32; 4]>() as u64;
        let (start, bytes) = (
            u64::from(self.nodes.start) * vector,
            u64::from(self.node_count) * vector,
        );
        let entry = size_of::<Entry>() as u64;
        let cells: u32 = self.counts.iter().sum();
        let cells = u64::from(cells) * CELL_ENTRIES as u64 * entry;
        [
            (arenas.vertices.buffer(POSITIONS), start, bytes),
            (arenas.vertices.buffer(MOTIONS), 2 * start, 2 * bytes),
            (
                arenas.entries.buffer(0),
                u64::from(self.cells.start) * entry,
                cells,
            ),
        ]
    }

    /// Copies downloaded [parts](Self::begin_copy) to the inside of the solver.
    ///
    /// A late copy may have the forces of other coefficients than those of the last frame.
    pub(super) fn end_copy(&self, bytes: &[u8], interior: &mut Interior) {
        let size = size_of_val(&interior.positions[..]);
        let (positions, rest) = bytes.split_at(size.min(bytes.len()));
        let (motions, cells) = rest.split_at((2 * size).min(rest.len()));
        let vector = |bytes: &[u8]| bytemuck::pod_read_unaligned::<[f32; 4]>(bytes);
        for (to, from) in (interior.positions.iter_mut()).zip(positions.chunks_exact(16)) {
            let [x, y, z, _] = vector(from);
            *to = [x, y, z, to[3]];
        }
        let to = (interior.velocities.iter_mut()).zip(&mut interior.node_forces);
        for ((velocity, force), from) in to.zip(motions.chunks_exact(32)) {
            (*velocity, *force) = (vector(&from[..16]), vector(&from[16..]));
        }
        let entry = size_of::<Entry>();
        let states = cells.chunks_exact(CELL_ENTRIES * entry).map(|cell| {
            let state = &cell[CELL_STATE * entry..];
            let numbers = bytemuck::pod_read_unaligned::<[f32; 2 * STATE_ENTRIES]>(state);
            state_of(&numbers)
        });
        interior.cells.set_states(states);
        interior.set_constants(self.copied_for);
    }
}

/// Returns the first vertex that downloaded nodes place where a coordinate is not finite, or null.
pub(super) fn first_non_finite(
    bytes: &[u8],
    interior: &Interior,
    mut slots: Range<usize>,
) -> VertexId {
    let is_bad = |node: u32| {
        let start = node as usize * size_of::<[f32; 4]>();
        let row = bytes.get(start..start + size_of::<[f32; 4]>());
        row.is_some_and(|row| {
            let row = bytemuck::pod_read_unaligned::<[f32; 4]>(row);
            !row.iter().all(|c| c.is_finite())
        })
    };
    let is_placed = |&slot: &usize| {
        let nodes = interior.nodes_of(slot);
        nodes.is_some_and(|nodes| nodes.iter().any(|&node| is_bad(node)))
    };
    slots
        .find(is_placed)
        .map_or(VertexId::NULL, VertexId::from_index)
}

/// Uploads the gathered entries to the start of a range.
fn write(context: &Context, uploads: &mut Uploads, arena: &Arena, to: &Range<u32>) {
    let offset = u64::from(to.start) * size_of::<Entry>() as u64;
    uploads.write(context, arena.buffer(0), offset);
}

/// Appends the entries of a cell.
fn push_cell(entries: &mut Vec<Entry>, block: &CellBlock, lane: usize) {
    let nodes = block.nodes[lane].map(|node| node.0);
    entries.extend(nodes.chunks(2).map(|pair| [pair[0], pair[1]]));
    let zero = [0.0; CELLS_PER_BLOCK];
    let numbers = (block.center.iter())
        .chain([&block.fraction])
        .chain(&block.bending)
        .chain(&block.mode_weights)
        .chain([&block.strain_weight, &zero])
        .chain(&block.rotation)
        .chain(&block.stress)
        .chain(&block.hourglass);
    let mut first = None;
    for number in numbers.map(|row| row[lane].to_bits()) {
        match first.take() {
            Some(first) => entries.push([first, number]),
            None => first = Some(number),
        }
    }
}

/// Returns the state of a cell from its numbers.
fn state_of(numbers: &[f32; 2 * STATE_ENTRIES]) -> CellState {
    let mut state = CellState::default();
    let all = (state.rotation.iter_mut())
        .chain(&mut state.stress)
        .chain(&mut state.hourglass);
    for (to, from) in all.zip(numbers) {
        *to = *from;
    }
    state
}

/// Appends the nodes and the weights of a vertex slot.
fn push_embedding(entries: &mut Vec<Entry>, interior: &Interior, slot: usize) {
    let nodes = interior.nodes_of(slot).copied().unwrap_or([NO_COPY; 8]);
    entries.extend(nodes.chunks(2).map(|pair| [pair[0], pair[1]]));
    let weights = interior.lattice.vertex_weights.get(slot);
    let weights = weights.copied().unwrap_or_default().map(f32::to_bits);
    entries.extend(weights.chunks(2).map(|pair| [pair[0], pair[1]]));
}

/// Returns position and inverse mass of a vertex of a solid as stored on the GPU.
pub(super) fn embedded_position(interior: &Interior, slot: usize) -> [f32; 4] {
    match interior.position(slot) {
        Some([x, y, z]) => [x, y, z, interior.inverse_masses[slot]],
        None => [0.0, 0.0, 0.0, UNUSED],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;

    #[test]
    fn a_cell_has_its_state_at_the_end_of_its_entries() {
        let mut block = CellBlock::zeroed();
        let lane = CELLS_PER_BLOCK - 1;
        let rows = (block.rotation.iter_mut())
            .chain(&mut block.stress)
            .chain(&mut block.hourglass);
        for (i, row) in (1_u8..).zip(rows) {
            row[lane] = f32::from(i);
        }
        let mut entries = Vec::new();
        push_cell(&mut entries, &block, lane);
        assert_eq!(entries.len(), CELL_ENTRIES);
        let words = entries[CELL_STATE..].as_flattened();
        let numbers: Vec<f32> = words.iter().map(|&bits| f32::from_bits(bits)).collect();
        let state = state_of(&numbers.try_into().unwrap());
        assert_eq!(state.rotation, [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(state.stress, [5.0, 6.0, 7.0, 8.0, 9.0, 10.0]);
        assert_eq!(state.hourglass[11], 22.0);
    }
}
