//! Hands the logged changes over to the GPU backend.

use super::{ChangeLog, Log};
use crate::constraints::Constraints;
use crate::constraints::batches::{ConstraintSet, Slot};

/// Changes since they were last taken. Lists are ascending without duplicates.
#[derive(Debug, Default)]
pub(crate) struct Changes {
    /// All arrays have to be uploaded, including positions and velocities; the lists are
    /// incomplete.
    pub(crate) everything: bool,
    /// Vertices with a new position and inverse mass, including added and removed ones.
    pub(crate) vertices: Vec<u32>,
    /// Vertices with a new inverse mass only.
    pub(crate) masses: Vec<u32>,
    /// Vertices with a new velocity.
    pub(crate) velocities: Vec<u32>,
    /// Slots with another stretch constraint.
    pub(crate) stretch: Vec<Slot>,
    /// Slots with another bending constraint.
    pub(crate) bending: Vec<Slot>,
    /// Slots with another interior spring.
    pub(crate) interior_springs: Vec<Slot>,
    /// True if the length of a batch may have changed.
    pub(crate) lengths: bool,
    /// True if pins were added, removed or got other targets.
    pub(crate) pins: bool,
}

impl<T: Ord + Copy> Log<T> {
    /// Clears the log and turns it on.
    fn start(&mut self) {
        self.is_on = true;
        self.entries.clear();
    }

    /// Moves the sorted entries into `into` and reuses its memory; returns true if there are any.
    fn take(&mut self, into: &mut Vec<T>) -> bool {
        self.sort();
        into.clear();
        std::mem::swap(&mut self.entries, into);
        !into.is_empty()
    }
}

impl ChangeLog {
    /// Returns true if changes are recorded.
    #[cfg(test)]
    pub(crate) fn is_on(&self) -> bool {
        self.vertices.is_on
    }

    /// Returns the allocated size of the log of velocities.
    #[cfg(test)]
    pub(crate) fn velocity_capacity(&self) -> usize {
        self.velocities.entries.capacity()
    }

    /// Turns all logs on, with everything changed.
    fn start(&mut self, constraints: &mut Constraints) {
        (self.everything, self.pins) = (true, true);
        for log in [&mut self.vertices, &mut self.masses, &mut self.velocities] {
            log.start();
        }
        let springs = &mut constraints.interior_springs;
        for set in [Some(&mut constraints.stretch), springs.as_mut()] {
            set.into_iter().for_each(|set| set.log.start());
        }
        if let Some(bending) = &mut constraints.bending {
            bending.log.start();
        }
    }

    /// Moves the changes into `into` and reuses its memory; the first call starts the log.
    pub(crate) fn take(
        &mut self,
        constraints: &mut Constraints,
        vertex_slots: usize,
        into: &mut Changes,
    ) {
        if !self.vertices.is_on {
            self.start(constraints);
        }
        into.everything = std::mem::take(&mut self.everything);
        into.pins = std::mem::take(&mut self.pins);
        self.vertices.take(&mut into.vertices);
        self.masses.take(&mut into.masses);
        self.velocities.take(&mut into.velocities);
        // Slots that an undo removed have nothing to upload.
        for list in [&mut into.vertices, &mut into.masses, &mut into.velocities] {
            list.truncate(list.partition_point(|&v| (v as usize) < vertex_slots));
        }
        into.lengths = take_slots(&mut constraints.stretch, &mut into.stretch);
        into.bending.clear();
        if let Some(bending) = &mut constraints.bending {
            into.lengths |= take_slots(bending, &mut into.bending);
        }
        into.interior_springs.clear();
        if let Some(interior_springs) = &mut constraints.interior_springs {
            into.lengths |= take_slots(interior_springs, &mut into.interior_springs);
        }
        constraints.update_patch_contents();
    }
}

#[cfg(feature = "gpu")]
impl ChangeLog {
    /// Returns true if nothing has changed since the changes were last taken.
    pub(crate) fn is_empty(&self, constraints: &Constraints) -> bool {
        let is_small = self.masses.entries.is_empty() && self.velocities.entries.is_empty();
        is_small && !self.pins && !self.has_surface_changes(constraints)
    }

    /// Returns true if positions or constraints have changed since the changes were last taken.
    pub(crate) fn has_surface_changes(&self, constraints: &Constraints) -> bool {
        let springs = constraints.interior_springs.as_ref();
        let mut edges = [Some(&constraints.stretch), springs].into_iter().flatten();
        let mut bending = constraints.bending.iter();
        !self.vertices.is_on
            || self.everything
            || !self.vertices.entries.is_empty()
            || edges.any(|set| !set.log.entries.is_empty())
            || bending.any(|set| !set.log.entries.is_empty())
    }

    /// Returns the vertices whose velocity was set, possibly with duplicates.
    pub(crate) fn changed_velocities(&self) -> &[u32] {
        &self.velocities.entries
    }
}

/// Takes the slots of a set that still exist; returns true if constraints were added or removed.
fn take_slots<const N: usize>(set: &mut ConstraintSet<N>, into: &mut Vec<Slot>) -> bool {
    let any = set.log.take(into);
    into.retain(|slot| slot.index < set.batch(slot.color).len());
    any
}
