//! Assignment of vertices to patches of bounded size.

#[cfg(feature = "serde")]
mod load;

use incise_mesh::VertexId;

/// Neither patch nor index.
const NOWHERE: u32 = u32::MAX;

/// Index of a vertex that will be added to a patch.
const WAITING: u32 = u32::MAX - 1;

/// Patch and index of a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    /// The patch, or the number of a waiting vertex.
    pub(crate) patch: u32,
    /// Index in the patch, or [`NOWHERE`] or [`WAITING`].
    pub(crate) local: u32,
}

/// A set of disjoint patches.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Patching {
    /// Maximum number of vertices of a patch.
    capacity: u32,
    /// Vertices of every patch, then null, shape [patches, capacity].
    #[cfg_attr(feature = "serde", serde(serialize_with = "load::save_members"))]
    members: Vec<VertexId>,
    /// Number of vertices of every patch, shape \[patches\].
    sizes: Vec<u32>,
    /// Shape [vertex slots].
    #[cfg_attr(feature = "serde", serde(skip))]
    places: Vec<Place>,
    /// Patches that became empty; some may have been filled since.
    emptied: Vec<u32>,
    newest: Option<u32>,
    /// Number of changes of every patch, shape \[patches\].
    #[cfg_attr(feature = "serde", serde(skip))]
    revisions: Vec<u64>,
}

impl Patching {
    /// Creates a patching without patches.
    pub(crate) fn new(capacity: u32) -> Self {
        Self {
            capacity,
            members: Vec::new(),
            sizes: Vec::new(),
            places: Vec::new(),
            emptied: Vec::new(),
            newest: None,
            revisions: Vec::new(),
        }
    }

    /// Adds vertices without a patch, or removes the last ones.
    pub(crate) fn resize_vertices(&mut self, vertex_slots: usize) {
        let nowhere = Place {
            patch: NOWHERE,
            local: NOWHERE,
        };
        self.places.resize(vertex_slots, nowhere);
    }

    /// Returns the maximum number of vertices of a patch.
    #[cfg(feature = "serde")]
    pub(crate) fn capacity(&self) -> u32 {
        self.capacity
    }

    /// Returns the number of patches; some may be empty.
    pub(crate) fn len(&self) -> usize {
        self.sizes.len()
    }

    /// Returns the vertices of a patch, in order of their indices.
    pub(crate) fn vertices(&self, patch: u32) -> &[VertexId] {
        let start = patch as usize * self.capacity as usize;
        &self.members[start..start + self.sizes[patch as usize] as usize]
    }

    /// Returns patch and index of a vertex, if it is in a patch.
    pub(crate) fn place(&self, v: VertexId) -> Option<Place> {
        let place = self.places[v.index()];
        (place.local < WAITING).then_some(place)
    }

    /// Returns the patch of a vertex, if it is in one.
    pub(crate) fn patch_of(&self, v: VertexId) -> Option<u32> {
        self.place(v).map(|place| place.patch)
    }

    /// Returns true if the vertex is marked by [`Self::set_waiting`].
    pub(crate) fn is_waiting(&self, v: VertexId) -> bool {
        self.places[v.index()].local == WAITING
    }

    /// Marks a vertex without a patch, until it is inserted into one.
    pub(crate) fn set_waiting(&mut self, v: VertexId, is_waiting: bool) {
        self.places[v.index()].local = if is_waiting { WAITING } else { NOWHERE };
    }

    /// Marks a vertex without a patch like [`Self::set_waiting`], with a number.
    pub(crate) fn set_waiting_as(&mut self, v: VertexId, number: u32) {
        self.places[v.index()] = Place {
            patch: number,
            local: WAITING,
        };
    }

    /// Returns the number of a vertex that is marked by [`Self::set_waiting_as`].
    pub(crate) fn waiting_number(&self, v: VertexId) -> Option<u32> {
        let place = self.places[v.index()];
        (place.local == WAITING).then_some(place.patch)
    }

    /// Returns the patch that contains all `vertices`, if there is one.
    pub(crate) fn shared(&self, vertices: &[VertexId]) -> Option<u32> {
        let (&first, others) = vertices.split_first()?;
        let patch = self.patch_of(first)?;
        let same = |&v: &VertexId| self.patch_of(v) == Some(patch);
        others.iter().all(same).then_some(patch)
    }

    /// Returns the number of vertices that can be added to a patch.
    pub(crate) fn room(&self, patch: u32) -> usize {
        (self.capacity - self.sizes[patch as usize]) as usize
    }

    /// Returns the patch that was added last.
    pub(crate) fn newest(&self) -> Option<u32> {
        self.newest
    }

    /// Adds an empty patch, or reuses an empty one.
    pub(crate) fn add_patch(&mut self) -> u32 {
        let sizes = &self.sizes;
        self.emptied.retain(|&patch| sizes[patch as usize] == 0);
        let patch = self.emptied.pop().unwrap_or_else(|| {
            let end = self.members.len() + self.capacity as usize;
            self.members.resize(end, VertexId::NULL);
            self.sizes.push(0);
            self.revisions.push(0);
            VertexId::from_index(self.sizes.len() - 1).0
        });
        self.newest = Some(patch);
        self.mark_changed(patch);
        patch
    }

    /// Records that a patch gained or lost a vertex or a constraint.
    pub(crate) fn mark_changed(&mut self, patch: u32) {
        self.revisions[patch as usize] += 1;
    }

    /// Returns the number of changes of a patch, at least 1.
    pub(crate) fn revision(&self, patch: u32) -> u64 {
        self.revisions[patch as usize]
    }

    /// Adds a vertex without a patch to a patch with room.
    pub(crate) fn insert(&mut self, v: VertexId, patch: u32) {
        let size = &mut self.sizes[patch as usize];
        self.members[(patch * self.capacity + *size) as usize] = v;
        self.places[v.index()] = Place {
            patch,
            local: *size,
        };
        *size += 1;
        self.mark_changed(patch);
    }

    /// Removes a vertex from its patch; the last one of the patch takes its index.
    pub(crate) fn remove(&mut self, v: VertexId) {
        let Some(Place { patch, local }) = self.place(v) else {
            return;
        };
        let size = &mut self.sizes[patch as usize];
        *size -= 1;
        let start = patch * self.capacity;
        let last = (start + *size) as usize;
        let moved = self.members[last];
        self.members[(start + local) as usize] = moved;
        self.members[last] = VertexId::NULL;
        self.places[moved.index()].local = local;
        self.places[v.index()].local = NOWHERE;
        self.mark_changed(patch);
        if self.sizes[patch as usize] == 0 {
            self.emptied.push(patch);
        }
    }

    /// Checks the patch and index of every vertex and the size of every patch.
    pub(crate) fn check(&self) -> Result<(), &'static str> {
        let mut placed = 0;
        for patch in 0..VertexId::from_index(self.len()).0 {
            if self.sizes[patch as usize] > self.capacity {
                return Err("patches do not exceed their capacity");
            }
            for (local, &v) in (0..).zip(self.vertices(patch)) {
                placed += 1;
                if self.place(v) != Some(Place { patch, local }) {
                    return Err("vertices have the places of their patches");
                }
            }
        }
        let known = self.places.iter().filter(|p| p.local != NOWHERE).count();
        if known != placed {
            return Err("a vertex is in one patch at most");
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_vertex_takes_the_index_of_a_removed_one() {
        let mut patching = Patching::new(4);
        patching.resize_vertices(9);
        let patch = patching.add_patch();
        let [a, b, c, d] = [8, 3, 5, 0].map(VertexId);
        for v in [a, b, c, d] {
            patching.insert(v, patch);
        }
        assert_eq!(patching.room(patch), 0);
        patching.remove(b);
        patching.remove(b);
        assert_eq!(patching.vertices(patch), [a, d, c]);
        assert_eq!(patching.place(d), Some(Place { patch, local: 1 }));
        assert_eq!(patching.patch_of(b), None);
        patching.remove(c);
        patching.check().unwrap();
        assert_eq!(patching.vertices(patch), [a, d]);
        assert_eq!(patching.shared(&[a, d]), Some(patch));
        assert_eq!(patching.shared(&[a, b]), None);
    }

    #[test]
    fn empty_patches_are_reused() {
        let mut patching = Patching::new(4);
        patching.resize_vertices(9);
        let patches = [0, 1, 2].map(|i| {
            let patch = patching.add_patch();
            patching.insert(VertexId(i), patch);
            patch
        });
        // The second is emptied, refilled and emptied again; the first stays empty.
        patching.remove(VertexId(1));
        patching.insert(VertexId(1), patches[1]);
        patching.remove(VertexId(1));
        patching.remove(VertexId(0));
        let mut found = [0, 1].map(|i| {
            let patch = patching.add_patch();
            patching.insert(VertexId(3 + i), patch);
            patch
        });
        found.sort_unstable();
        assert_eq!(found, [patches[0], patches[1]]);
        assert_eq!(patching.add_patch(), 3, "no patch is empty any more");
        patching.check().unwrap();
    }
}
