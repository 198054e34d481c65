//! [`Parts`]: the connected parts of a body in each cell, and which of them meet in faces.

#[cfg(feature = "serde")]
mod compact;
#[cfg(feature = "serde")]
mod load;

use crate::cell::{Measure, NONE};
use crate::measures::Sums;
use incise_mesh::index_u32;
use smallvec::SmallVec;

/// A part that meets another one in a face of its cell.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Link(u32);

impl Link {
    fn new(part: u32, face: usize) -> Self {
        Self(part << 3 | index_u32(face))
    }

    /// Returns the other part.
    pub(crate) fn part(self) -> u32 {
        self.0 >> 3
    }

    /// Returns the face: twice its axis, plus 1 for the upper one.
    pub(crate) fn face(self) -> usize {
        (self.0 & 7) as usize
    }
}

/// A connected part of a body in a cell.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Part {
    /// Its cell; [`NONE`] for a free slot.
    pub(crate) cell: u32,
    /// Its number among the parts of the cell, which depends on the content of that alone.
    number: u32,
    /// The next part in the cell.
    #[cfg_attr(feature = "serde", serde(skip))]
    next: u32,
    /// The part whose nodes carry it: itself or, if it is small, one near it.
    pub(crate) carrier: u32,
    /// The copy of a part that carries itself.
    pub(crate) copy: u32,
    /// While the lattice follows an edit: the copy that carried the part before.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) old_copy: u32,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) is_live: bool,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) is_small: bool,
    #[cfg_attr(feature = "serde", serde(with = "compact::sums"))]
    pub(crate) sums: Sums,
    /// By face, the reach of a small part from there into its cell [cells].
    #[cfg_attr(feature = "serde", serde(with = "compact::reaches"))]
    pub(crate) reaches: [f32; 6],
    #[cfg_attr(feature = "serde", serde(with = "compact::links"))]
    pub(crate) links: SmallVec<[Link; 6]>,
}

/// The connected parts of a body in each cell.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Parts {
    pub(crate) slots: Vec<Part>,
    /// By cell, its first part.
    #[cfg_attr(feature = "serde", serde(skip))]
    first: Vec<u32>,
    free: Vec<u32>,
}

impl Part {
    /// Returns a free slot.
    fn free() -> Self {
        Self {
            cell: NONE,
            number: 0,
            next: NONE,
            carrier: NONE,
            copy: NONE,
            old_copy: NONE,
            is_live: false,
            is_small: false,
            sums: Sums::EMPTY,
            reaches: Measure::EMPTY.reaches,
            links: SmallVec::new(),
        }
    }
}

impl Parts {
    pub(crate) fn new(cell_count: usize) -> Self {
        Self {
            first: vec![NONE; cell_count],
            ..Self::default()
        }
    }

    pub(crate) fn get(&self, part: u32) -> &Part {
        &self.slots[part as usize]
    }

    pub(crate) fn get_mut(&mut self, part: u32) -> &mut Part {
        &mut self.slots[part as usize]
    }

    /// Returns the parts in a cell, by number.
    pub(crate) fn of_cell(&self, cell: u32) -> impl Iterator<Item = u32> {
        let mut next = self.first[cell as usize];
        std::iter::from_fn(move || {
            let part = next;
            next = self.slots.get(part as usize)?.next;
            Some(part)
        })
    }

    /// Returns the order of a part, which does not depend on earlier edits.
    pub(crate) fn order(&self, part: u32) -> (u32, u32) {
        let part = self.get(part);
        (part.cell, part.number)
    }

    /// Returns whether a part has a copy of its cell.
    pub(crate) fn carries_itself(&self, part: u32) -> bool {
        self.get(part).carrier == part
    }

    /// Returns the copy that carries a part.
    pub(crate) fn carrying_copy(&self, part: u32) -> u32 {
        self.get(self.get(part).carrier).copy
    }

    /// Adds the parts of a cell that has none, by number.
    pub(crate) fn add(&mut self, cell: u32, measures: &[Measure], added: &mut Vec<u32>) {
        let from = added.len();
        for (number, measure) in (0..).zip(measures) {
            let slot = self.free.pop().unwrap_or(index_u32(self.slots.len()));
            let part = Part {
                cell,
                number,
                next: NONE,
                carrier: slot,
                copy: NONE,
                old_copy: NONE,
                is_live: true,
                is_small: measure.sums.is_small(),
                sums: measure.sums,
                reaches: measure.reaches,
                links: SmallVec::new(),
            };
            match self.slots.get_mut(slot as usize) {
                Some(free) => *free = part,
                None => self.slots.push(part),
            }
            added.push(slot);
        }
        for pair in added[from..].windows(2) {
            self.slots[pair[0] as usize].next = pair[1];
        }
        self.first[cell as usize] = added.get(from).copied().unwrap_or(NONE);
    }

    /// Removes the parts of a cell. Their data stay until [`Self::free`].
    pub(crate) fn remove(&mut self, cell: u32, removed: &mut Vec<u32>) {
        let from = removed.len();
        removed.extend(self.of_cell(cell));
        self.first[cell as usize] = NONE;
        for &part in &removed[from..] {
            self.get_mut(part).is_live = false;
            for link in std::mem::take(&mut self.get_mut(part).links) {
                let others = &mut self.get_mut(link.part()).links;
                others.retain(|other| other.part() != part);
            }
        }
    }

    /// Frees the slots of removed parts.
    pub(crate) fn free(&mut self, removed: &[u32]) {
        for &part in removed {
            *self.get_mut(part) = Part::free();
        }
        self.free.extend(removed);
    }

    /// Forgets the copies that carried parts before an edit.
    pub(crate) fn forget_old_copies(&mut self, of: &[u32]) {
        for &part in of {
            self.get_mut(part).old_copy = NONE;
        }
    }

    /// Returns whether two parts are linked.
    pub(crate) fn are_linked(&self, a: u32, b: u32) -> bool {
        self.get(a).links.iter().any(|link| link.part() == b)
    }

    /// Links two parts that meet in a face of their cells, the lower one first.
    pub(crate) fn link(&mut self, low: u32, high: u32, axis: usize) {
        if !self.are_linked(low, high) {
            self.get_mut(low).links.push(Link::new(high, 2 * axis + 1));
            self.get_mut(high).links.push(Link::new(low, 2 * axis));
        }
    }
}
