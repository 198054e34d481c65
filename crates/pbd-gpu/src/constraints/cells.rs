//! [`CellSet`]: the elastic cells of a solid, in blocks of eight by color.

#[cfg(feature = "serde")]
mod load;

use crate::constraints::batches::{OVERFLOW, Slot};
use crate::constraints::coloring::VertexColors;
use crate::kernels::cells::{CellConstants, add_forces};
use bytemuck::{Pod, Zeroable};
use incise_lattice::Moments;
use incise_mesh::VertexId;
use nalgebra::{Matrix3, Quaternion, UnitQuaternion};

/// A particle of a solid: a node of its lattice.
pub(crate) type NodeId = VertexId;

/// Cells per block: the lanes of the widest instructions.
pub(crate) const CELLS_PER_BLOCK: usize = 8;

/// Least stiffness of a part, and of each of its hourglass modes, relative to a full cell.
///
/// Masses of nodes have a floor too, and nodes at which a sliver had hardly any stiffness would
/// swing freely for seconds, and keep the body awake.
pub(crate) const MIN_FRACTION: f64 = 0.03;

/// A number of each cell of a block.
pub(crate) type Row = [f32; CELLS_PER_BLOCK];

/// Eight cells of one color, as a structure of arrays.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct CellBlock {
    /// Nodes of each cell, in the order of corners: bit k is set at the upper face of axis k.
    pub(crate) nodes: [[NodeId; 8]; CELLS_PER_BLOCK],
    /// Centroid of the part from the cell's center \[half cells\].
    pub(crate) center: [Row; 3],
    /// Volume of the part \[cells\], at least [`MIN_FRACTION`].
    pub(crate) fraction: Row,
    /// Second moments by volume that resist each hourglass mode, relative to a full cell. Their
    /// product with the fraction is at least [`MIN_FRACTION`].
    pub(crate) bending: [Row; 4],
    /// Bound of the inverse mass of a row of the strain [1/(kg m²)].
    pub(crate) strain_weight: Row,
    /// Modes of the inverse masses of the nodes by eight [1/kg].
    pub(crate) mode_weights: [Row; 8],
    /// Rotation of each cell, a unit quaternion.
    pub(crate) rotation: [Row; 4],
    /// Stress times volume in the frame of the cell by xx, yy, zz, xy, yz and zx \[N m\].
    pub(crate) stress: [Row; 6],
    /// Forces of the hourglass modes in the frame of the cell \[N\].
    pub(crate) hourglass: [Row; 12],
    /// Numbers of the lattice's copies.
    pub(crate) copies: [u32; CELLS_PER_BLOCK],
}

/// The state of a cell, which lasts from substep to substep.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct CellState {
    pub(crate) rotation: [f32; 4],
    pub(crate) stress: [f32; 6],
    pub(crate) hourglass: [f32; 12],
}

impl Default for CellState {
    /// Returns the state of a cell at rest.
    fn default() -> Self {
        Self {
            rotation: [1.0, 0.0, 0.0, 0.0],
            stress: [0.0; 6],
            hourglass: [0.0; 12],
        }
    }
}

impl CellState {
    /// Returns the state of a part, given its volume and that of the whole \[cells\].
    #[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
    pub(crate) fn of_part(mut self, volumes: [f64; 2]) -> Self {
        let [part, whole] = volumes.map(|volume| volume.clamp(MIN_FRACTION, 1.0));
        let share = (part / whole).min(1.0) as f32;
        for force in self.stress.iter_mut().chain(&mut self.hourglass) {
            *force *= share;
        }
        self
    }

    /// Returns the state of a turned cell.
    #[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
    fn turned(&self, by: &Matrix3<f64>) -> Self {
        let [w, x, y, z] = self.rotation.map(f64::from);
        let own = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
        let turn = UnitQuaternion::from_matrix(by);
        let turned = turn * own;
        let [x, y, z, w] = <[f64; 4]>::from(turned.coords);
        Self {
            rotation: [w, x, y, z].map(|c| c as f32),
            ..*self
        }
    }
}

/// The cells of one color, or those without a free color.
#[derive(Debug, Clone, Default)]
pub(crate) struct CellBatch {
    pub(crate) blocks: Vec<CellBlock>,
    len: usize,
}

/// All cells of a solid. Cells of one color share no node.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(from = "load::SavedCells", into = "load::SavedCells")
)]
pub(crate) struct CellSet {
    batches: Vec<CellBatch>,
    overflow: CellBatch,
    colors: VertexColors,
    /// By copy of the lattice; unused copies have any slot.
    slots: Vec<Slot>,
}

impl CellBatch {
    /// Returns the number of cells.
    pub(crate) fn len(&self) -> usize {
        self.len
    }
}

impl CellSet {
    /// Creates a set without cells.
    pub(crate) fn new() -> Self {
        Self {
            batches: Vec::new(),
            overflow: CellBatch::default(),
            colors: VertexColors::new(1),
            slots: Vec::new(),
        }
    }

    /// Returns the number of cells.
    pub(crate) fn len(&self) -> usize {
        self.all().map(|batch| batch.len).sum()
    }

    /// Returns the cells by color.
    pub(crate) fn batches(&self) -> &[CellBatch] {
        &self.batches
    }

    /// Returns a batch to project; [`OVERFLOW`] for the cells without a color.
    pub(crate) fn batch_mut(&mut self, color: usize) -> &mut CellBatch {
        if color == OVERFLOW {
            &mut self.overflow
        } else {
            &mut self.batches[color]
        }
    }

    /// Returns the numbers of the batches that have cells, the overflow last.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = usize> {
        let batches = self.batches.iter().enumerate();
        let filled = batches.chain([(OVERFLOW, &self.overflow)]);
        filled.filter_map(|(number, batch)| (batch.len > 0).then_some(number))
    }

    /// Returns all batches, the overflow last.
    pub(crate) fn all(&self) -> impl Iterator<Item = &CellBatch> {
        self.batches.iter().chain([&self.overflow])
    }

    /// Returns the block and the lane of every cell, in the order of a sweep.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (&CellBlock, usize)> {
        self.all().flat_map(|batch| {
            (0..batch.len).map(|index| {
                (
                    &batch.blocks[index / CELLS_PER_BLOCK],
                    index % CELLS_PER_BLOCK,
                )
            })
        })
    }

    /// Adds nodes without cells, or removes the last ones.
    pub(crate) fn resize_nodes(&mut self, nodes: usize) {
        self.colors.resize(nodes);
    }

    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        let blocks: usize = self.all().map(|batch| batch.blocks.capacity()).sum();
        blocks + self.slots.capacity()
    }

    /// Inserts the cell of a copy. Its weights must be [set](Self::set_weights) before a step.
    pub(crate) fn insert(
        &mut self,
        copy: u32,
        nodes: [NodeId; 8],
        moments: &Moments,
        state: &CellState,
    ) {
        let color = self.colors.claim(0, &nodes).unwrap_or(OVERFLOW);
        if color != OVERFLOW && self.batches.len() <= color {
            self.batches.resize_with(color + 1, CellBatch::default);
        }
        let batch = self.batch_mut(color);
        let index = batch.len;
        if index.is_multiple_of(CELLS_PER_BLOCK) {
            batch.blocks.push(unused_block());
        }
        batch.len += 1;
        let (block, lane) = at(batch, index);
        block.nodes[lane] = nodes;
        block.copies[lane] = copy;
        set_shape(block, lane, moments);
        set_state(block, lane, state);
        let slots = copy as usize + 1;
        if self.slots.len() < slots {
            self.slots.resize(slots, Slot { color: 0, index: 0 });
        }
        self.slots[copy as usize] = Slot { color, index };
    }

    /// Removes the cell of a copy and returns its state.
    pub(crate) fn remove(&mut self, copy: u32) -> CellState {
        let Slot { color, index } = self.slots[copy as usize];
        let batch = self.batch_mut(color);
        let (block, lane) = at(batch, index);
        let (nodes, state) = (block.nodes[lane], state(block, lane));
        let last = batch.len - 1;
        let moved = (index < last).then(|| {
            let (from, lane) = (batch.blocks[last / CELLS_PER_BLOCK], last % CELLS_PER_BLOCK);
            let (to, to_lane) = at(batch, index);
            copy_cell(&from, lane, to, to_lane);
            to.copies[to_lane]
        });
        batch.len = last;
        if last.is_multiple_of(CELLS_PER_BLOCK) {
            batch.blocks.pop();
        }
        if color != OVERFLOW {
            self.colors.release(&nodes, color);
        }
        if let Some(moved) = moved {
            self.slots[moved as usize] = Slot { color, index };
        }
        state
    }

    /// Turns a copy's cell with its forces.
    pub(crate) fn turn(&mut self, copy: u32, by: &Matrix3<f64>) {
        let Slot { color, index } = self.slots[copy as usize];
        let (block, lane) = at(self.batch_mut(color), index);
        let state = state(block, lane).turned(by);
        set_state(block, lane, &state);
    }

    /// Sets the state of a copy's cell.
    pub(crate) fn set_state(&mut self, copy: u32, state: &CellState) {
        let Slot { color, index } = self.slots[copy as usize];
        let (block, lane) = at(self.batch_mut(color), index);
        set_state(block, lane, state);
    }

    /// Returns the state of a copy's cell.
    pub(crate) fn state(&self, copy: u32) -> CellState {
        let Slot { color, index } = self.slots[copy as usize];
        let batch = if color == OVERFLOW {
            &self.overflow
        } else {
            &self.batches[color]
        };
        state(
            &batch.blocks[index / CELLS_PER_BLOCK],
            index % CELLS_PER_BLOCK,
        )
    }

    /// Sets the states of all cells, in the order of [`Self::iter`].
    #[cfg(feature = "gpu")]
    pub(crate) fn set_states(&mut self, mut states: impl Iterator<Item = CellState>) {
        for batch in self.batches.iter_mut().chain([&mut self.overflow]) {
            for index in 0..batch.len {
                let Some(state) = states.next() else { return };
                let (block, lane) = at(batch, index);
                set_state(block, lane, &state);
            }
        }
    }

    /// Sets the forces of cells on changed nodes that the next prediction repeats \[N\].
    pub(crate) fn sum_forces(
        &self,
        node_forces: &mut [[f32; 4]],
        constants: &CellConstants,
        is_changed: impl Fn(NodeId) -> bool,
    ) {
        for (i, force) in node_forces.iter_mut().enumerate() {
            if is_changed(NodeId::from_index(i)) {
                *force = [0.0; 4];
            }
        }
        for (block, lane) in self.iter() {
            if block.nodes[lane].iter().any(|&node| is_changed(node)) {
                add_forces(node_forces, block, lane, constants, &is_changed);
            }
        }
    }

    /// Sets the inverse masses of the rows of cells with a changed node, from those of nodes
    /// [1/kg].
    ///
    /// Returns the mean product of a cell's inverse mass and its fraction by volume [1/(kg m²)].
    pub(crate) fn set_weights(
        &mut self,
        inverse_mass: impl Fn(NodeId) -> f32,
        is_changed: impl Fn(NodeId) -> bool,
        cell_size: f64,
    ) -> f64 {
        let (mut sum, mut volume) = (0.0, 0.0);
        let batches = self.batches.iter_mut().chain([&mut self.overflow]);
        for batch in batches {
            for index in 0..batch.len {
                let (block, lane) = at(batch, index);
                if block.nodes[lane].iter().any(|&node| is_changed(node)) {
                    let masses = block.nodes[lane].map(|node| f64::from(inverse_mass(node)));
                    set_weights(block, lane, masses, cell_size);
                }
                let fraction = f64::from(block.fraction[lane]);
                sum += f64::from(block.strain_weight[lane]) * fraction * fraction;
                volume += fraction;
            }
        }
        if volume > 0.0 { sum / volume } else { 0.0 }
    }
}

/// Returns a block whose lanes hold no cell, and converge like cells at rest.
fn unused_block() -> CellBlock {
    CellBlock {
        rotation: [
            [1.0; CELLS_PER_BLOCK],
            [0.0; CELLS_PER_BLOCK],
            [0.0; CELLS_PER_BLOCK],
            [0.0; CELLS_PER_BLOCK],
        ],
        ..CellBlock::zeroed()
    }
}

/// Returns the block and the lane of a cell.
fn at(batch: &mut CellBatch, index: usize) -> (&mut CellBlock, usize) {
    (
        &mut batch.blocks[index / CELLS_PER_BLOCK],
        index % CELLS_PER_BLOCK,
    )
}

fn set_row<const N: usize>(rows: &mut [Row; N], lane: usize, to: [f32; N]) {
    for (row, to) in rows.iter_mut().zip(to) {
        row[lane] = to;
    }
}

fn row<const N: usize>(rows: &[Row; N], lane: usize) -> [f32; N] {
    rows.each_ref().map(|row| row[lane])
}

fn state(block: &CellBlock, lane: usize) -> CellState {
    CellState {
        rotation: row(&block.rotation, lane),
        stress: row(&block.stress, lane),
        hourglass: row(&block.hourglass, lane),
    }
}

fn set_state(block: &mut CellBlock, lane: usize, state: &CellState) {
    set_row(&mut block.rotation, lane, state.rotation);
    set_row(&mut block.stress, lane, state.stress);
    set_row(&mut block.hourglass, lane, state.hourglass);
}

fn copy_cell(from: &CellBlock, lane: usize, to: &mut CellBlock, to_lane: usize) {
    to.nodes[to_lane] = from.nodes[lane];
    to.copies[to_lane] = from.copies[lane];
    to.fraction[to_lane] = from.fraction[lane];
    to.strain_weight[to_lane] = from.strain_weight[lane];
    set_row(&mut to.center, to_lane, row(&from.center, lane));
    set_row(&mut to.bending, to_lane, row(&from.bending, lane));
    set_row(&mut to.mode_weights, to_lane, row(&from.mode_weights, lane));
    set_state(to, to_lane, &state(from, lane));
}

/// Sets what follows from the moments of the part in a cell.
#[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
fn set_shape(block: &mut CellBlock, lane: usize, moments: &Moments) {
    let [x, y, z] = moments.spread;
    // Mode xy bends along x and y, mode xyz along all axes.
    let bending = [
        (x + y) / 2.0,
        (y + z) / 2.0,
        (z + x) / 2.0,
        (x + y + z) / 3.0,
    ];
    let fraction = moments.fraction.clamp(MIN_FRACTION, 1.0);
    block.fraction[lane] = fraction as f32;
    set_row(&mut block.center, lane, moments.center.map(|c| c as f32));
    let bending = bending.map(|b| b.max(MIN_FRACTION / fraction) as f32);
    set_row(&mut block.bending, lane, bending);
}

/// Sets the inverse masses of the rows of a cell.
#[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
fn set_weights(block: &mut CellBlock, lane: usize, inverse_masses: [f64; 8], size: f64) {
    let sign = |mode: usize, node: usize| {
        let below = (mode & !node).count_ones();
        if below.is_multiple_of(2) { 1.0 } else { -1.0 }
    };
    let modes: [f64; 8] = std::array::from_fn(|mode| {
        let terms = inverse_masses.iter().enumerate();
        terms.map(|(node, w)| sign(mode, node) * w).sum::<f64>() / 8.0
    });
    set_row(&mut block.mode_weights, lane, modes.map(|w| w as f32));
    // By axis, the modes with a derivative along it, and these at the centroid [1/m].
    let [x, y, z] = row(&block.center, lane).map(f64::from);
    let derivatives: [[(usize, f64); 4]; 3] = [
        [(1, 1.0), (3, y), (5, z), (7, y * z)],
        [(2, 1.0), (3, x), (6, z), (7, x * z)],
        [(4, 1.0), (5, x), (6, y), (7, x * y)],
    ];
    let scale = 2.0 / size;
    let product = |a: usize, b: usize| {
        let mut sum = 0.0;
        for (m, of_m) in derivatives[a] {
            for (n, of_n) in derivatives[b] {
                sum += of_m * of_n * modes[m ^ n];
            }
        }
        sum * scale * scale / 8.0
    };
    let bound = |a: usize| (0..3).map(|b| product(a, b).abs()).sum::<f64>();
    let weight = bound(0).max(bound(1)).max(bound(2));
    block.strain_weight[lane] = weight as f32;
}
