//! States before edits, which an undo restores bit for bit if nothing has moved since.
//!
//! Shares of mass and forces, and the momenta of changed cells, are kept to rounding. An undo that
//! shared them again would leave another state than before the edit, and the same cut would differ.

use super::Interior;
use crate::constraints::cells::CellState;
use incise_lattice::LatticeChange;
use incise_mesh::{Surface, index_u32};

/// Maximum number of edits.
const MAX_DEPTH: usize = 64;

/// A node before an edit.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct NodeRecord {
    node: u32,
    rest: [f64; 3],
    position: [f32; 4],
    velocity: [f32; 4],
    force: [f32; 4],
    mass: f32,
}

/// A cell before an edit.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct CellRecord {
    copy: u32,
    nodes: [u32; 8],
    state: CellState,
}

/// The nodes and cells that an edit has changed, before it.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct EditRecord {
    nodes: Vec<NodeRecord>,
    cells: Vec<CellRecord>,
    /// Checksum of all nodes directly after the edit.
    after: u64,
}

/// Positions, velocities and forces of the inside of a solid, see [`Solver::solid_state`].
///
/// [`Solver::solid_state`]: crate::Solver::solid_state
#[derive(Debug, Clone)]
pub struct SolidState(EditRecord);

/// The last edits, newest last, as long as no node has moved since.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct EditRecords(Vec<EditRecord>);

impl EditRecords {
    /// Returns whether all numbers are finite.
    #[cfg(feature = "serde")]
    pub(super) fn is_valid(&self) -> bool {
        let is_finite = |numbers: &[f32]| numbers.iter().all(|c| c.is_finite());
        let is_node = |record: &NodeRecord| {
            let rows = [record.position, record.velocity, record.force];
            rows.iter().all(|row| is_finite(row)) && record.mass.is_finite() && record.mass >= 0.0
        };
        let is_cell = |record: &CellRecord| {
            let CellState {
                rotation,
                stress,
                hourglass,
            } = &record.state;
            is_finite(rotation) && is_finite(stress) && is_finite(hourglass)
        };
        let is_record = |record: &EditRecord| {
            record.nodes.iter().all(is_node) && record.cells.iter().all(is_cell)
        };
        self.0.len() <= MAX_DEPTH && self.0.iter().all(is_record)
    }

    /// Returns whether nothing has moved since the last edit, and forgets all edits if it has.
    pub(super) fn is_current(&mut self, checksum: u64) -> bool {
        let is_current = self.0.last().is_some_and(|last| last.after == checksum);
        if !is_current {
            self.0.clear();
        }
        is_current
    }

    /// Adds an edit, without its checksum.
    pub(super) fn push(&mut self, record: EditRecord) {
        if self.0.len() == MAX_DEPTH {
            self.0.remove(0);
        }
        self.0.push(record);
    }

    /// Sets the checksum of all nodes after the last edit.
    pub(super) fn finish(&mut self, checksum: u64) {
        if let Some(last) = self.0.last_mut() {
            last.after = checksum;
        }
    }

    /// Removes and returns the last edit, if it is undone.
    pub(super) fn pop_if(&mut self, is_undone: bool) -> Option<EditRecord> {
        if is_undone { self.0.pop() } else { None }
    }
}

impl Interior {
    /// Returns the nodes and cells that a change of the lattice concerns, before the solver follows
    /// it.
    pub(super) fn record_of(&self, change: &LatticeChange) -> EditRecord {
        let old = change.copies_removed.iter().chain(&change.copies_changed);
        let cells = old.map(|old| (old.copy, old.nodes));
        let leaving = change.nodes_removed.iter().chain(&change.nodes_changed);
        self.record(cells, leaving.copied())
    }

    /// Returns the state of all nodes and cells.
    pub(crate) fn state(&self) -> SolidState {
        let cells = (0..).zip(self.lattice.nodes.iter().copied());
        let cells = cells.filter(|&(copy, _)| self.lattice.is_copy(copy));
        SolidState(self.record(cells, std::iter::empty()))
    }

    /// Restores a state; returns false, and changes nothing, if the lattice has other cells.
    pub(crate) fn set_state(
        &mut self,
        surface: &mut Surface,
        velocities: &mut [[f32; 4]],
        SolidState(state): &SolidState,
    ) -> bool {
        let copies = 0..index_u32(self.lattice.nodes.len());
        let cells = copies.filter(|&copy| self.lattice.is_copy(copy)).count();
        if cells != state.cells.len() || !self.has_all_of(state) {
            return false;
        }
        self.restore(state);
        self.update_weights_of(surface, &vec![true; self.positions.len()]);
        self.restore_forces(state);
        self.embed(surface, velocities);
        self.has_new_velocities = false;
        true
    }

    /// Returns the present state of cells, of their nodes, and of others.
    fn record(
        &self,
        cells: impl Iterator<Item = (u32, [u32; 8])> + Clone,
        others: impl Iterator<Item = u32>,
    ) -> EditRecord {
        let mut nodes: Vec<u32> = (cells.clone().flat_map(|own| own.1))
            .chain(others)
            .collect();
        nodes.sort_unstable();
        nodes.dedup();
        let node = |node: u32| {
            let i = node as usize;
            NodeRecord {
                node,
                rest: self.lattice.node_positions[i],
                position: self.positions[i],
                velocity: self.velocities[i],
                force: self.node_forces[i],
                mass: self.mass[i],
            }
        };
        let cells = cells.map(|(copy, nodes)| CellRecord {
            copy,
            nodes,
            state: self.cells.state(copy),
        });
        EditRecord {
            nodes: nodes.into_iter().map(node).collect(),
            cells: cells.collect(),
            after: 0,
        }
    }

    /// Returns whether the lattice has the nodes and cells of a record again, under their numbers.
    pub(super) fn has_all_of(&self, record: &EditRecord) -> bool {
        let lattice = &self.lattice;
        let is_cell =
            |cell: &CellRecord| lattice.nodes.get(cell.copy as usize) == Some(&cell.nodes);
        let is_node = |node: &NodeRecord| {
            lattice.is_node(node.node) && node.rest == lattice.node_positions[node.node as usize]
        };
        record.cells.iter().all(is_cell) && record.nodes.iter().all(is_node)
    }

    /// Restores the nodes and cells of a record that the lattice [has](Self::has_all_of).
    pub(super) fn restore(&mut self, record: &EditRecord) {
        for cell in &record.cells {
            self.cells.set_state(cell.copy, &cell.state);
        }
        for node in &record.nodes {
            let i = node.node as usize;
            self.positions[i] = node.position;
            self.velocities[i] = node.velocity;
            self.mass[i] = node.mass;
        }
    }

    /// Restores the forces at the nodes of a record.
    pub(super) fn restore_forces(&mut self, record: &EditRecord) {
        for node in &record.nodes {
            self.node_forces[node.node as usize] = node.force;
        }
    }

    /// Returns a checksum of the nodes' masses, positions and velocities, by number.
    pub(super) fn checksum(&self) -> u64 {
        let nodes = self.positions.iter().zip(&self.velocities);
        let mut sum = 0_u64;
        for (i, (x, v)) in (0_u64..).zip(nodes) {
            // Unused nodes have no state, and a later edit may add more of them.
            if x[3] == 0.0 {
                continue;
            }
            for (k, c) in (0_u64..).zip(x.iter().chain(v)) {
                let word = u64::from(c.to_bits()) << 32 | (i << 3 | k) & 0xffff_ffff;
                let mixed = word.wrapping_mul(0xbf58_476d_1ce4_e5b9);
                sum = sum.wrapping_add(mixed ^ mixed >> 31);
            }
        }
        sum
    }
}
