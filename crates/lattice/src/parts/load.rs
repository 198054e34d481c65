//! Completes and validates loaded [`Parts`].
//!
//! Lists of cells and flags follow from the saved fields. Edits index with parts, follow links in
//! both directions and chains of carriers to their ends.

use super::{Part, Parts};
use crate::cell::NONE;
use crate::error::InvalidLattice;
use crate::grid::Grid;
use incise_mesh::index_u32;

/// Maximum number of part slots, exclusive: links use three bits for faces.
const MAX_SLOTS: usize = 1 << 29;

/// Returns an error of the parts unless a condition holds.
fn check(array: &'static str, holds: bool) -> Result<(), InvalidLattice> {
    if holds {
        Ok(())
    } else {
        Err(InvalidLattice::Array { array })
    }
}

impl Parts {
    /// Completes parts that were read with serde. Returns the used ones, in order.
    pub(crate) fn finish_load(&mut self, grid: &Grid) -> Result<Vec<u32>, InvalidLattice> {
        check("parts", self.slots.len() < MAX_SLOTS)?;
        let cell_count = grid.cell_count();
        for part in &mut self.slots {
            if part.cell == NONE {
                *part = Part::free();
                continue;
            }
            let is_number = part.reaches.iter().all(|reach| !reach.is_nan());
            let is_valid = (part.cell as usize) < cell_count && part.sums.is_finite() && is_number;
            check("parts", is_valid)?;
            part.next = NONE;
            part.old_copy = NONE;
            part.is_live = true;
            part.is_small = part.sums.is_small();
        }
        self.check_free()?;
        let order = self.list(cell_count)?;
        self.check_carriers(&order)?;
        self.check_links(grid, &order)?;
        Ok(order)
    }

    /// Checks that each free slot is in the list of these once.
    fn check_free(&self) -> Result<(), InvalidLattice> {
        let mut is_used: Vec<bool> = self.slots.iter().map(|part| part.is_live).collect();
        for &slot in &self.free {
            let is_used = is_used.get_mut(slot as usize);
            let is_free = is_used.is_some_and(|is_used| !std::mem::replace(is_used, true));
            check("free parts", is_free)?;
        }
        check("free parts", is_used.iter().all(|&is_used| is_used))
    }

    /// Makes the lists of cells. Returns all parts in order.
    fn list(&mut self, cell_count: usize) -> Result<Vec<u32>, InvalidLattice> {
        let mut order: Vec<u32> = (0..index_u32(self.slots.len())).collect();
        order.retain(|&part| self.get(part).is_live);
        order.sort_unstable_by_key(|&part| self.order(part));
        self.first.clear();
        self.first.resize(cell_count, NONE);
        for own in
            order.chunk_by(|&a, &b| self.slots[a as usize].cell == self.slots[b as usize].cell)
        {
            let mut numbers = (0..).zip(own);
            let are_counted = numbers.all(|(number, &part)| self.get(part).number == number);
            check("numbers of parts", are_counted)?;
        }
        for pair in order.windows(2) {
            let [low, high] = [pair[0], pair[1]];
            if self.get(low).cell == self.get(high).cell {
                self.get_mut(low).next = high;
            }
        }
        for &part in order.iter().rev() {
            let cell = self.get(part).cell;
            self.first[cell as usize] = part;
        }
        Ok(order)
    }

    /// Checks that parts are carried by parts that carry themselves, as all large ones do.
    fn check_carriers(&self, order: &[u32]) -> Result<(), InvalidLattice> {
        for &part in order {
            let own = self.get(part);
            let is_valid = if own.carrier == part {
                own.copy != NONE
            } else {
                let carrier = self.slots.get(own.carrier as usize);
                let carries = carrier.is_some_and(|c| c.is_live && c.carrier == own.carrier);
                own.is_small && own.copy == NONE && carries
            };
            check("carriers of parts", is_valid)?;
        }
        Ok(())
    }

    /// Checks that links lead to parts beside their own and back.
    fn check_links(&self, grid: &Grid, order: &[u32]) -> Result<(), InvalidLattice> {
        let [mut upward, mut downward] = [Vec::new(), Vec::new()];
        for &part in order {
            let own = self.get(part);
            for link in &own.links {
                let (other, face) = (link.part(), link.face());
                let beside = if face < 6 {
                    grid.beside(own.cell, face)
                } else {
                    None
                };
                // The cell of a free slot is none.
                let cell = self.slots.get(other as usize).map(|other| other.cell);
                check("links of parts", beside.is_some() && cell == beside)?;
                if face % 2 == 1 {
                    upward.push((part, other));
                } else {
                    downward.push((other, part));
                }
            }
        }
        upward.sort_unstable();
        downward.sort_unstable();
        let are_different = upward.windows(2).all(|pair| pair[0] != pair[1]);
        check("links of parts", are_different && upward == downward)
    }

    /// Returns whether a cell has a part.
    pub(crate) fn is_in_cell(&self, part: u32, cell: u32) -> bool {
        let own = self.slots.get(part as usize);
        own.is_some_and(|own| own.is_live && own.cell == cell)
    }
}
