//! Vertices in patches of bounded size, each at a place of its own.

use crate::changes::Log;
use incise_mesh::VertexId;

const NOWHERE: u32 = u32::MAX;

/// Where a vertex stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    /// The patch. It is remembered of a vertex that has left, for those that come in its stead.
    pub(crate) patch: u32,
    /// The place in the patch's list.
    pub(crate) local: u32,
}

/// Patches of vertices; a vertex is in one of them or in none.
#[derive(Debug, Clone)]
pub(crate) struct Patching {
    capacity: u32,
    /// The vertices of every patch, shape [patches, capacity]; null after the last one.
    members: Vec<VertexId>,
    /// How many vertices a patch has, shape \[patches\].
    sizes: Vec<u32>,
    /// Shape [vertex slots].
    places: Vec<Place>,
    /// Patches that became empty; some may have got vertices since.
    emptied: Vec<u32>,
    newest: Option<u32>,
    /// Patches that got or lost a vertex or a constraint.
    pub(crate) log: Log<u32>,
}

impl Patching {
    /// No patches yet; they will have room for `capacity` vertices each.
    pub(crate) fn new(capacity: u32) -> Self {
        Self {
            capacity,
            members: Vec::new(),
            sizes: Vec::new(),
            places: Vec::new(),
            emptied: Vec::new(),
            newest: None,
            log: Log::default(),
        }
    }

    /// Makes room for vertices that are in no patch, or gives up slots of such.
    pub(crate) fn resize_vertices(&mut self, vertex_slots: usize) {
        let nowhere = Place {
            patch: NOWHERE,
            local: NOWHERE,
        };
        self.places.resize(vertex_slots, nowhere);
    }

    /// How many patches there are; some may be empty.
    pub(crate) fn len(&self) -> usize {
        self.sizes.len()
    }

    /// The vertices of a patch, in the order of their places.
    pub(crate) fn vertices(&self, patch: u32) -> &[VertexId] {
        let start = patch as usize * self.capacity as usize;
        &self.members[start..start + self.sizes[patch as usize] as usize]
    }

    /// Where a vertex stands, if it is in a patch.
    pub(crate) fn place(&self, v: VertexId) -> Option<Place> {
        let place = self.places[v.index()];
        (place.local != NOWHERE).then_some(place)
    }

    /// The patch of a vertex, if it is in one.
    pub(crate) fn patch_of(&self, v: VertexId) -> Option<u32> {
        self.place(v).map(|place| place.patch)
    }

    /// The patch of a vertex, or the one that it was in when it left.
    pub(crate) fn last_patch(&self, v: VertexId) -> Option<u32> {
        let place = self.places[v.index()];
        (place.patch != NOWHERE).then_some(place.patch)
    }

    /// The patch that all of `vertices` are in, if there is one.
    pub(crate) fn shared(&self, vertices: &[VertexId]) -> Option<u32> {
        let (&first, others) = vertices.split_first()?;
        let patch = self.patch_of(first)?;
        let same = |&v: &VertexId| self.patch_of(v) == Some(patch);
        others.iter().all(same).then_some(patch)
    }

    /// How many more vertices fit into a patch.
    pub(crate) fn room(&self, patch: u32) -> usize {
        (self.capacity - self.sizes[patch as usize]) as usize
    }

    /// The patch that was made last, to which strays are added.
    pub(crate) fn newest(&self) -> Option<u32> {
        self.newest
    }

    /// Makes an empty patch or finds one that became empty.
    pub(crate) fn add_patch(&mut self) -> u32 {
        let sizes = &self.sizes;
        self.emptied.retain(|&patch| sizes[patch as usize] == 0);
        let patch = self.emptied.pop().unwrap_or_else(|| {
            let end = self.members.len() + self.capacity as usize;
            self.members.resize(end, VertexId::NULL);
            self.sizes.push(0);
            VertexId::from_index(self.sizes.len() - 1).0
        });
        self.newest = Some(patch);
        self.log.note(patch);
        patch
    }

    /// Adds a vertex that is nowhere to a patch that has room.
    pub(crate) fn join(&mut self, v: VertexId, patch: u32) {
        let size = &mut self.sizes[patch as usize];
        self.members[(patch * self.capacity + *size) as usize] = v;
        self.places[v.index()] = Place {
            patch,
            local: *size,
        };
        *size += 1;
        self.log.note(patch);
    }

    /// Takes a vertex out of its patch; the last one of the patch gets its place.
    pub(crate) fn leave(&mut self, v: VertexId) {
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
        self.log.note(patch);
        if self.sizes[patch as usize] == 0 {
            self.emptied.push(patch);
        }
    }

    /// Says which rule is broken: every place is that of its vertex and no patch is too large.
    pub(crate) fn check(&self) -> Result<(), &'static str> {
        let mut placed = 0;
        for patch in 0..VertexId::from_index(self.len()).0 {
            if self.sizes[patch as usize] > self.capacity {
                return Err("a patch has at most so many vertices");
            }
            for (local, &v) in (0..).zip(self.vertices(patch)) {
                placed += 1;
                if self.place(v) != Some(Place { patch, local }) {
                    return Err("vertices know their places in patches");
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
    fn the_last_vertex_takes_the_place_of_one_that_leaves() {
        let mut patching = Patching::new(4);
        patching.resize_vertices(9);
        let patch = patching.add_patch();
        let [a, b, c, d] = [8, 3, 5, 0].map(VertexId);
        for v in [a, b, c, d] {
            patching.join(v, patch);
        }
        assert_eq!(patching.room(patch), 0);
        patching.leave(b);
        patching.leave(b);
        assert_eq!(patching.vertices(patch), [a, d, c]);
        assert_eq!(patching.place(d), Some(Place { patch, local: 1 }));
        assert_eq!(
            (patching.patch_of(b), patching.last_patch(b)),
            (None, Some(patch))
        );
        patching.leave(c);
        patching.check().unwrap();
        assert_eq!(patching.vertices(patch), [a, d]);
        assert_eq!(patching.shared(&[a, d]), Some(patch));
        assert_eq!(patching.shared(&[a, b]), None);
    }

    #[test]
    fn emptied_patches_are_used_again_and_full_ones_are_not() {
        let mut patching = Patching::new(4);
        patching.resize_vertices(9);
        let patches = [0, 1, 2].map(|i| {
            let patch = patching.add_patch();
            patching.join(VertexId(i), patch);
            patch
        });
        // The second becomes empty twice and is full again in between, the first stays empty.
        patching.leave(VertexId(1));
        patching.join(VertexId(1), patches[1]);
        patching.leave(VertexId(1));
        patching.leave(VertexId(0));
        let mut found = [0, 1].map(|i| {
            let patch = patching.add_patch();
            patching.join(VertexId(3 + i), patch);
            patch
        });
        found.sort_unstable();
        assert_eq!(found, [patches[0], patches[1]]);
        assert_eq!(patching.add_patch(), 3, "no patch is empty any more");
        patching.check().unwrap();
    }
}
