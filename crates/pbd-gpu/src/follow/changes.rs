//! Change log of a solver, so that the GPU backend uploads only edited data.
//!
//! The CPU copy of a GPU body has the positions and velocities of the last readback. The lists
//! therefore name only data that was set on the CPU; other data must not be uploaded.

#[cfg(any(test, feature = "gpu"))]
mod take;
#[cfg(test)]
mod tests;

use incise_mesh::VertexId;
#[cfg(any(test, feature = "gpu"))]
pub(crate) use take::Changes;

/// Recorded entries in order, possibly with duplicates. Records nothing until it is started.
#[derive(Debug)]
pub(crate) struct Log<T> {
    is_on: bool,
    entries: Vec<T>,
}

impl<T> Default for Log<T> {
    fn default() -> Self {
        Self {
            is_on: false,
            entries: Vec::new(),
        }
    }
}

impl<T> Clone for Log<T> {
    /// Returns a log that is off.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl<T: Ord + Copy> Log<T> {
    /// Records an entry if the log is on.
    ///
    /// Duplicates are removed before the log grows, so it takes at most four times the memory of
    /// its distinct entries.
    #[inline]
    pub(crate) fn record(&mut self, entry: T) {
        if self.is_on {
            self.push(entry);
        }
    }

    fn push(&mut self, entry: T) {
        if self.entries.len() == self.entries.capacity() {
            self.sort();
            self.entries.reserve(self.entries.len().max(8));
        }
        self.entries.push(entry);
    }

    fn sort(&mut self) {
        self.entries.sort_unstable();
        self.entries.dedup();
    }
}

/// Log of changed vertices and pins. Constraint sets and patches have logs of their own.
#[derive(Debug, Default)]
pub(crate) struct ChangeLog {
    /// Number of the reader of the log, 0 for none.
    #[cfg(feature = "gpu")]
    pub(crate) follower: u64,
    everything: bool,
    pins: bool,
    vertices: Log<u32>,
    masses: Log<u32>,
    velocities: Log<u32>,
}

impl Clone for ChangeLog {
    /// Returns a log that is off and has no reader.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl ChangeLog {
    /// Records a vertex with a new position, mass and velocity.
    pub(crate) fn mark_vertex(&mut self, v: VertexId) {
        self.vertices.record(v.0);
        self.velocities.record(v.0);
    }

    /// Records a vertex with a new inverse mass.
    pub(crate) fn mark_mass(&mut self, v: VertexId) {
        self.masses.record(v.0);
    }

    /// Records a vertex with a new velocity.
    pub(crate) fn mark_velocity(&mut self, v: VertexId) {
        self.velocities.record(v.0);
    }

    /// Records a change of pins or their targets.
    pub(crate) fn mark_pins(&mut self) {
        self.pins = true;
    }

    /// Records that any position and velocity may have changed.
    pub(crate) fn mark_all(&mut self) {
        self.everything = true;
    }
}
