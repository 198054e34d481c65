//! Copies of cells: one for each part that carries itself.

use crate::cell::NONE;
use crate::change::{AddedCopy, LatticeChange, OldCopy};
use crate::grid::Grid;
use crate::lattice::Lattice;
use crate::measures::Sums;
use crate::parts::Parts;
use crate::work::Work;
use incise_mesh::index_u32;
use std::collections::BTreeSet;

impl Lattice {
    /// Removes and adds copies of cells.
    ///
    /// Of the new parts that a copy held in its cell, the largest one keeps it.
    pub(crate) fn update_copies(&mut self, work: &Work, change: &mut LatticeChange) {
        let mut removed = Vec::new();
        let parts = &mut self.state.parts;
        for solved in &work.solved {
            let new_parts = &work.parts[solved.parts.clone()];
            for &old in &work.old_parts[solved.old_parts.clone()] {
                if !parts.carries_itself(old) {
                    continue;
                }
                let copy = parts.get(old).copy;
                let heirs = new_parts.iter().filter(|&&part| {
                    let is_free = parts.carries_itself(part) && parts.get(part).copy == NONE;
                    is_free && parts.get(part).old_copy == copy
                });
                let volume = |part: u32| parts.get(part).sums.length();
                if let Some(&heir) = heirs.max_by(|&&a, &&b| volume(a).total_cmp(&volume(b))) {
                    parts.get_mut(heir).copy = copy;
                } else {
                    removed.push(copy);
                }
            }
        }
        for &part in &work.moved {
            if !parts.carries_itself(part) && parts.get(part).copy != NONE {
                removed.push(parts.get(part).copy);
                parts.get_mut(part).copy = NONE;
            }
        }
        removed.sort_unstable();
        change
            .copies_removed
            .extend(removed.into_iter().map(|copy| self.old_copy(copy)));
        self.add_copies(work, change);
    }

    /// Adds copies for parts that carry themselves and have none, in the order of cells.
    fn add_copies(&mut self, work: &Work, change: &mut LatticeChange) {
        let parts = &mut self.state.parts;
        let own = work.solved.iter();
        let own = own.flat_map(|solved| &work.parts[solved.parts.clone()]);
        let needs_copy =
            |part: &&u32| parts.carries_itself(**part) && parts.get(**part).copy == NONE;
        let own = own.chain(&work.moved).filter(needs_copy);
        let mut own: Vec<u32> = own.copied().collect();
        own.sort_unstable_by_key(|&part| parts.order(part));
        own.dedup();
        for part in own {
            let cell = parts.get(part).cell;
            let copy = match self.state.free_copies.pop() {
                Some(copy) => copy,
                None => {
                    self.cells.push(NONE);
                    self.nodes.push([NONE; 8]);
                    self.moments.push(Sums::EMPTY.moments());
                    self.state.corner_volumes.push([0.0; 8]);
                    index_u32(self.cells.len() - 1)
                }
            };
            self.cells[copy as usize] = cell;
            parts.get_mut(part).copy = copy;
            let parent = parts.get(part).old_copy;
            change.copies_added.push(AddedCopy { copy, parent });
        }
    }

    /// Measures the copies that hold other parts than before.
    pub(crate) fn update_moments(&mut self, work: &Work, change: &mut LatticeChange) {
        let size = self.grid.cell_size();
        let parts = &self.state.parts;
        let mut carried = Vec::new();
        for &part in work
            .carriers
            .iter()
            .filter(|&&part| parts.carries_itself(part))
        {
            let copy = parts.get(part).copy;
            let sums = carried_sums(&self.grid, parts, part, &mut carried);
            let moments = sums.moments();
            let i = copy as usize;
            if self.nodes[i][0] != NONE && self.moments[i] != moments {
                change.copies_changed.push(self.old_copy(copy));
            }
            self.moments[i] = moments;
            self.state.corner_volumes[i] = sums.corner_volumes(size);
        }
    }

    /// Returns a copy as it is.
    pub(crate) fn old_copy(&self, copy: u32) -> OldCopy {
        OldCopy {
            copy,
            nodes: self.nodes[copy as usize],
            moments: self.moments[copy as usize],
        }
    }
}

/// Returns the moments of all parts that a part carries, from the center of its cell.
pub(crate) fn carried_sums(
    grid: &Grid,
    parts: &Parts,
    carrier: u32,
    carried: &mut Vec<u32>,
) -> Sums {
    collect_carried(parts, carrier, carried);
    let cell = grid.cell(parts.get(carrier).cell);
    let mut sums = Sums::EMPTY;
    for &own in &*carried {
        let other = grid.cell(parts.get(own).cell);
        let center = [0, 1, 2].map(|k| 2.0 * (f64::from(other[k]) - f64::from(cell[k])));
        sums.add_shifted(&parts.get(own).sums, center);
    }
    sums
}

/// Collects the parts that a part carries, in an order that does not depend on earlier edits.
fn collect_carried(parts: &Parts, carrier: u32, carried: &mut Vec<u32>) {
    carried.clear();
    carried.push(carrier);
    let mut found = BTreeSet::new();
    let mut next = 0;
    while let Some(&part) = carried.get(next) {
        next += 1;
        for link in &parts.get(part).links {
            let other = link.part();
            if parts.get(other).carrier == carrier && other != carrier && found.insert(other) {
                carried.push(other);
            }
        }
    }
    carried.sort_unstable_by_key(|&part| parts.order(part));
}
