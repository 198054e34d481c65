//! A few of many slots, looked up and forgotten in O(1).

/// Slots that are marked, in the order in which they were. Places of earlier marks stay in memory and are
/// told by their slot not to be meant, so nothing is ever cleared.
#[derive(Debug, Clone, Default)]
pub(super) struct Few {
    places: Vec<u32>,
    slots: Vec<u32>,
}

impl Few {
    /// Forgets all marks; slots are below `count`.
    pub(super) fn begin(&mut self, count: usize) {
        self.slots.clear();
        self.places.resize(count.max(self.places.len()), 0);
    }

    /// Marks a slot. Returns its place, and whether it is new there.
    pub(super) fn mark(&mut self, slot: u32) -> (usize, bool) {
        if let Some(place) = self.find(slot) {
            return (place, false);
        }
        let place = self.slots.len();
        self.places[slot as usize] = u32::try_from(place).expect("there are fewer than slots");
        self.slots.push(slot);
        (place, true)
    }

    /// The place of a slot, if it is marked.
    pub(super) fn find(&self, slot: u32) -> Option<usize> {
        let place = *self.places.get(slot as usize)? as usize;
        (self.slots.get(place) == Some(&slot)).then_some(place)
    }
}
