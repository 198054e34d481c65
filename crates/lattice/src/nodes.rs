//! Nodes: the corners of copies, shared where the parts of copies meet in a face.

use crate::cell::NONE;
use crate::change::{AddedNode, LatticeChange, NodeSource};
use crate::grid::is_upper;
use crate::lattice::Lattice;
use crate::measures::Sums;
use crate::work::Work;
use incise_mesh::index_u32;

/// A copy at a corner of cells.
#[derive(Debug, Clone, Copy)]
struct CornerCopy {
    part: u32,
    copy: u32,
    /// The number of the corner in the copy's cell.
    corner: usize,
    /// The copy's node there before the change.
    old_node: u32,
    /// The first copy of those with the same node.
    group: usize,
}

/// A new node of a copy, set once all nodes are known.
#[derive(Debug, Clone, Copy)]
struct NewCorner {
    copy: u32,
    corner: usize,
    node: u32,
}

impl Lattice {
    /// Updates the nodes at the corners of cells with other copies than before, and their volumes.
    ///
    /// Where copies no longer share a node, the first one that had it keeps it. Where copies share
    /// a node again, they take the node of the first one. An undo therefore restores the numbers.
    pub(crate) fn update_nodes(&mut self, work: &Work, change: &mut LatticeChange) {
        let mut own = Vec::new();
        let mut changed = Vec::new();
        let [nx, ny, _] = self.grid.counts().map(|count| count + 1);
        for index in self.corners_to_update(work) {
            let corner = [index % nx, index / nx % ny, index / nx / ny];
            self.collect_copies(corner, &mut own);
            for first in 0..own.len() {
                if own[first].group != first {
                    continue;
                }
                let group = || own.iter().filter(|own| own.group == first);
                let volumes =
                    group().map(|own| self.state.corner_volumes[own.copy as usize][own.corner]);
                let volume: f64 = volumes.sum();
                let is_first = |node: &u32| {
                    let holder = own.iter().find(|own| own.old_node == *node);
                    *node != NONE && holder.is_some_and(|holder| holder.group == first)
                };
                let kept = group().map(|own| own.old_node).find(is_first);
                let node = kept.unwrap_or_else(|| {
                    let members: Vec<CornerCopy> = group().copied().collect();
                    self.add_node(corner, &members, change)
                });
                if kept.is_some() && self.node_volumes[node as usize].to_bits() != volume.to_bits()
                {
                    change.nodes_changed.push(node);
                }
                self.node_volumes[node as usize] = volume;
                let others = group().filter(|own| own.old_node != node);
                changed.extend(others.map(|own| NewCorner {
                    copy: own.copy,
                    corner: own.corner,
                    node,
                }));
            }
        }
        self.set_nodes(&changed, change);
    }

    /// Returns the indices of corners of cells with other copies or moments than before, ascending.
    fn corners_to_update(&self, work: &Work) -> Vec<u32> {
        let parts = &self.state.parts;
        let cells = work.touched.members.iter().copied();
        let others = work.carriers.iter().chain(&work.moved);
        let mut cells: Vec<u32> = cells
            .chain(others.map(|&part| parts.get(part).cell))
            .collect();
        cells.sort_unstable();
        cells.dedup();
        let [nx, ny, _] = self.grid.counts().map(|count| count + 1);
        let mut corners = Vec::with_capacity(8 * cells.len());
        for cell in cells {
            let [x, y, z] = self.grid.cell(cell);
            for corner in 0..8 {
                let upper = |k: usize| u32::from(is_upper(corner, k));
                let [x, y, z] = [x + upper(0), y + upper(1), z + upper(2)];
                corners.push((z * ny + y) * nx + x);
            }
        }
        corners.sort_unstable();
        corners.dedup();
        corners
    }

    /// Collects the copies at a corner, and groups those that share a node.
    fn collect_copies(&self, at: [u32; 3], own: &mut Vec<CornerCopy>) {
        own.clear();
        let parts = &self.state.parts;
        let counts = self.grid.counts();
        // From the lowest cell on.
        for corner in (0..8).rev() {
            let mut cell = [0; 3];
            let is_cell = (0..3).all(|k| {
                cell[k] = at[k].wrapping_sub(u32::from(is_upper(corner, k)));
                cell[k] < counts[k]
            });
            if !is_cell {
                continue;
            }
            for part in parts.of_cell(self.grid.index(cell)) {
                if parts.carries_itself(part) {
                    let copy = parts.get(part).copy;
                    own.push(CornerCopy {
                        part,
                        copy,
                        corner,
                        old_node: self.nodes[copy as usize][corner],
                        group: own.len(),
                    });
                }
            }
        }
        for i in 0..own.len() {
            let CornerCopy { part, corner, .. } = own[i];
            for link in &parts.get(part).links {
                let face = link.face();
                // The other part of a face is found there as well.
                if face % 2 == 0 || !is_upper(corner, face / 2) {
                    continue;
                }
                let other = own.iter().position(|own| own.part == link.part());
                let Some(other) = other else { continue };
                let [a, b] = [own[i].group, own[other].group];
                if a != b {
                    for own in own.iter_mut().filter(|own| own.group == a.max(b)) {
                        own.group = a.min(b);
                    }
                }
            }
        }
    }

    /// Adds a node at a corner, for copies that share it. Returns it.
    fn add_node(
        &mut self,
        at: [u32; 3],
        members: &[CornerCopy],
        change: &mut LatticeChange,
    ) -> u32 {
        let position = self.grid.corner(at, 0).into();
        let node = match self.state.free_nodes.pop() {
            Some(node) => {
                self.node_positions[node as usize] = position;
                node
            }
            None => {
                self.node_positions.push(position);
                self.node_volumes.push(0.0);
                self.state.node_users.push(0);
                index_u32(self.node_positions.len() - 1)
            }
        };
        let first_source = index_u32(change.node_sources.len());
        self.add_sources(at, members, &mut change.node_sources);
        let source_count = index_u32(change.node_sources.len()) - first_source;
        change.nodes_added.push(AddedNode {
            node,
            first_source,
            source_count,
        });
        node
    }

    /// Adds the sources of a new node: old nodes at the same corner of the copies that held the
    /// parts around it, else nodes of these copies by trilinear weights.
    fn add_sources(&self, at: [u32; 3], members: &[CornerCopy], sources: &mut Vec<NodeSource>) {
        let mut exact: Vec<u32> = Vec::new();
        let mut parents: Vec<u32> = Vec::new();
        for own in members {
            if own.old_node != NONE {
                exact.push(own.old_node);
                continue;
            }
            let parent = self.state.parts.get(own.part).old_copy;
            let Some(&cell) = self.cells.get(parent as usize) else {
                continue;
            };
            let cell = self.grid.cell(cell);
            let offset = [0, 1, 2].map(|k| at[k].wrapping_sub(cell[k]));
            if offset.iter().all(|&offset| offset < 2) {
                let corner = offset[0] | offset[1] << 1 | offset[2] << 2;
                exact.push(self.nodes[parent as usize][corner as usize]);
            } else {
                parents.push(parent);
            }
        }
        for found in [&mut exact, &mut parents] {
            found.sort_unstable();
            found.dedup();
        }
        let mean = |count: usize| 1.0 / f64::from(index_u32(count));
        if !exact.is_empty() {
            let weight = mean(exact.len());
            sources.extend(exact.into_iter().map(|node| NodeSource { node, weight }));
            return;
        }
        let share = mean(parents.len().max(1));
        let place = self.grid.corner(at, 0);
        for parent in parents {
            let cell = self.grid.cell(self.cells[parent as usize]);
            let weights = self.grid.weights(cell, place);
            let nodes = self.nodes[parent as usize].iter().zip(weights);
            sources.extend(nodes.map(|(&node, weight)| NodeSource {
                node,
                weight: weight * share,
            }));
        }
    }

    /// Sets the nodes of copies, and removes nodes and copies that are no longer used.
    fn set_nodes(&mut self, changed: &[NewCorner], change: &mut LatticeChange) {
        let users = &mut self.state.node_users;
        for &NewCorner { copy, corner, node } in changed {
            let nodes = self.nodes[copy as usize];
            let old = nodes[corner];
            if let Some(count) = users.get_mut(old as usize) {
                if !nodes.contains(&NONE) {
                    change.copies_changed.push(crate::change::OldCopy {
                        copy,
                        nodes,
                        moments: self.moments[copy as usize],
                    });
                }
                *count -= 1;
                if *count == 0 {
                    change.nodes_removed.push(old);
                }
            }
            users[node as usize] += 1;
            self.nodes[copy as usize][corner] = node;
        }
        for removed in &change.copies_removed {
            for node in removed.nodes {
                let count = &mut users[node as usize];
                *count -= 1;
                if *count == 0 {
                    change.nodes_removed.push(node);
                }
            }
            self.cells[removed.copy as usize] = NONE;
            self.nodes[removed.copy as usize] = [NONE; 8];
            self.moments[removed.copy as usize] = Sums::EMPTY.moments();
            self.state.corner_volumes[removed.copy as usize] = [0.0; 8];
        }
        change.nodes_removed.sort_unstable();
        for &node in &change.nodes_removed {
            self.node_positions[node as usize] = [0.0; 3];
            self.node_volumes[node as usize] = 0.0;
        }
        // The lowest number is the next one.
        let copies = change.copies_removed.iter().rev().map(|old| old.copy);
        self.state.free_copies.extend(copies);
        let nodes = change.nodes_removed.iter().rev();
        self.state.free_nodes.extend(nodes);
        // The first entry of a copy holds its nodes and moments before the change.
        change.copies_changed.sort_by_key(|changed| changed.copy);
        change.copies_changed.dedup_by_key(|changed| changed.copy);
        change.nodes_changed.sort_unstable();
    }
}
