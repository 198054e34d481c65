//! Completes and validates a loaded [`Patching`]. The places of vertices follow from its patches.

use super::{Patching, Place};
use incise_mesh::{VertexId, index_u32};
use serde::{Serialize, Serializer};

/// Patches that a small body may have in addition to two per vertex slot.
///
/// An empty patch takes one byte in a file and a kilobyte in memory.
const EXTRA_PATCHES: usize = 256;

/// Saves the vertices of all patches one after another, without null.
pub(super) fn save_members<S: Serializer>(members: &[VertexId], to: S) -> Result<S::Ok, S::Error> {
    let members = members.iter().filter(|v| !v.is_null());
    members.collect::<Vec<_>>().serialize(to)
}

impl Patching {
    /// Completes patches that were read with serde, of a body with `slots` vertex slots.
    ///
    /// The capacity must be valid. Returns `None` unless patches are disjoint.
    pub(crate) fn finish_load(&mut self, capacity: u32, slots: usize) -> Option<()> {
        let count = self.sizes.len();
        let is_patch = |&patch: &u32| (patch as usize) < count;
        if self.capacity != capacity
            || count > 2 * slots + EXTRA_PATCHES
            || !self.emptied.iter().chain(&self.newest).all(is_patch)
            || self.sizes.iter().any(|&size| size > capacity)
        {
            return None;
        }
        self.revisions = vec![1; count];
        self.resize_vertices(slots);
        let padded = vec![VertexId::NULL; count * capacity as usize];
        let mut members = std::mem::replace(&mut self.members, padded).into_iter();
        for patch in 0..index_u32(count) {
            for local in 0..self.sizes[patch as usize] {
                let v = members.next()?;
                if v.index() >= slots || self.place(v).is_some() {
                    return None;
                }
                self.members[(patch * capacity + local) as usize] = v;
                self.places[v.index()] = Place { patch, local };
            }
        }
        members.next().is_none().then_some(())
    }
}
