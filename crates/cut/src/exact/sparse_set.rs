//! Sparse sets of slots.

use incise_mesh::index_u32;

/// A sparse set of slots (Briggs and Torczon 1993): O(1) insertion, lookup and clearing.
#[derive(Debug, Clone, Default)]
pub(super) struct SparseSet {
    places: Vec<u32>,
    slots: Vec<u32>,
}

impl SparseSet {
    /// Removes all slots; new ones are below `count`.
    pub(super) fn clear(&mut self, count: usize) {
        self.slots.clear();
        self.places.resize(count.max(self.places.len()), 0);
    }

    /// Inserts a slot. Returns its place and whether it is new.
    pub(super) fn insert(&mut self, slot: u32) -> (usize, bool) {
        if let Some(place) = self.find(slot) {
            return (place, false);
        }
        let place = self.slots.len();
        if slot as usize >= self.places.len() {
            self.places.resize(slot as usize + 1, 0);
        }
        self.places[slot as usize] = index_u32(place);
        self.slots.push(slot);
        (place, true)
    }

    /// Returns the place of a slot, if it is in the set.
    pub(super) fn find(&self, slot: u32) -> Option<usize> {
        let place = *self.places.get(slot as usize)? as usize;
        (self.slots.get(place) == Some(&slot)).then_some(place)
    }
}
