//! Builds patches along the borders of other patches, from the stencils that these cut apart.

use crate::patches::patching::Patching;
use incise_mesh::VertexId;

/// The vertices of a constraint, which should be in one patch; a vertex may appear twice.
pub(crate) type Stencil = [VertexId; 4];

/// Adds every vertex of `stencils` to a patch, those of one stencil to the same one if possible.
///
/// Vertices join an existing patch with room first. The others get new patches of `max` vertices,
/// connected by `neighbors`.
pub(crate) fn cover<I: Iterator<Item = VertexId>>(
    patching: &mut Patching,
    stencils: &[Stencil],
    max: usize,
    neighbors: impl Fn(VertexId) -> I,
) {
    let mut waiting = Vec::new();
    for stencil in stencils {
        for &v in stencil {
            if patching.patch_of(v).is_none() {
                let patches = stencil.iter().filter_map(|&w| patching.patch_of(w));
                let mut patches = patches.filter(|&patch| patching.room(patch) > 0);
                if let Some(patch) = patches.next() {
                    patching.insert(v, patch);
                } else if !patching.is_waiting(v) {
                    patching.set_waiting(v, true);
                    waiting.push(v);
                }
            }
        }
    }
    // Some have joined a patch since.
    waiting.retain(|&v| patching.is_waiting(v));
    // A few vertices share the newest patch.
    let newest = patching.newest().map(|patch| (patch, patching.room(patch)));
    let with_room = newest.filter(|&(_, room)| room >= waiting.len());
    let (patch, left) = with_room.unwrap_or((0, 0));
    let mut growth = Growth {
        patching,
        neighbors,
        max,
        queue: Vec::new(),
        patch,
        left,
    };
    for v in waiting {
        if growth.patching.is_waiting(v) {
            growth.place_component(v);
        }
    }
}

/// Breadth-first growth of patches over waiting vertices.
struct Growth<'a, F> {
    patching: &'a mut Patching,
    neighbors: F,
    /// Number of vertices of a new patch.
    max: usize,
    /// Breadth-first queue of vertices.
    queue: Vec<VertexId>,
    /// The growing patch.
    patch: u32,
    /// Number of vertices that it still takes.
    left: usize,
}

impl<I: Iterator<Item = VertexId>, F: Fn(VertexId) -> I> Growth<'_, F> {
    /// Adds a connected component of waiting vertices to a patch as a whole, or to several.
    fn place_component(&mut self, seed: VertexId) {
        self.queue.clear();
        self.queue.push(seed);
        self.patching.set_waiting(seed, false);
        let mut next = 0;
        while let Some(&v) = self.queue.get(next) {
            next += 1;
            for w in (self.neighbors)(v) {
                if self.patching.is_waiting(w) {
                    self.patching.set_waiting(w, false);
                    self.queue.push(w);
                }
            }
        }
        let component = std::mem::take(&mut self.queue);
        if component.len() <= self.max {
            if component.len() > self.left {
                self.start_patch();
            }
            self.left -= component.len();
            for &v in &component {
                self.patching.insert(v, self.patch);
            }
        } else {
            for &v in &component {
                self.patching.set_waiting(v, true);
            }
            for &v in &component {
                self.grow(v);
            }
        }
    }

    /// Grows patches over the waiting vertices around `seed`, until one is full.
    fn grow(&mut self, seed: VertexId) {
        self.queue.clear();
        self.queue.push(seed);
        let mut next = 0;
        while let Some(&v) = self.queue.get(next) {
            next += 1;
            if !self.patching.is_waiting(v) {
                continue;
            }
            if self.left == 0 {
                // The new patch starts at the border of the full one.
                self.start_patch();
                self.queue.clear();
                next = 0;
            }
            self.patching.insert(v, self.patch);
            self.left -= 1;
            let waiting = (self.neighbors)(v).filter(|&w| self.patching.is_waiting(w));
            self.queue.extend(waiting);
        }
    }

    fn start_patch(&mut self) {
        (self.patch, self.left) = (self.patching.add_patch(), self.max);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the neighbors of a vertex of a path.
    fn path(v: VertexId) -> impl Iterator<Item = VertexId> {
        [v.0.wrapping_sub(1), v.0 + 1]
            .into_iter()
            .map(VertexId)
            .filter(|w| w.0 < 101)
    }

    fn pair(a: u32, b: u32) -> Stencil {
        [a, b, b, b].map(VertexId)
    }

    #[test]
    fn a_chain_is_cut_between_full_patches_only() {
        let stencils: Vec<Stencil> = (0..100).map(|i| pair(i, i + 1)).collect();
        let mut patching = Patching::new(16);
        patching.resize_vertices(101);
        cover(&mut patching, &stencils, 10, path);
        patching.check().unwrap();
        assert_eq!(patching.len(), 11);
        let cut = stencils
            .iter()
            .filter(|stencil| patching.shared(*stencil).is_none());
        assert_eq!(cut.count(), 10, "one stencil between consecutive patches");
    }

    #[test]
    fn new_vertices_join_their_neighbors_while_there_is_room() {
        let mut patching = Patching::new(4);
        patching.resize_vertices(101);
        cover(&mut patching, &[pair(0, 1), pair(1, 2)], 3, path);
        assert_eq!(patching.len(), 1);
        cover(
            &mut patching,
            &[pair(2, 7), pair(7, 8), pair(8, 9)],
            3,
            path,
        );
        assert_eq!(patching.patch_of(VertexId(7)), Some(0), "the room of one");
        assert_eq!(patching.shared(&[8, 9].map(VertexId)), Some(1));
        cover(&mut patching, &[pair(15, 16)], 3, path);
        assert_eq!(
            patching.shared(&[8, 15, 16].map(VertexId)),
            Some(1),
            "the newest patch"
        );
        patching.check().unwrap();
    }

    #[test]
    fn components_stay_whole() {
        let stencils: Vec<Stencil> = (0..10)
            .flat_map(|i| [pair(4 * i, 4 * i + 1), pair(4 * i + 1, 4 * i + 2)])
            .collect();
        let mut patching = Patching::new(8);
        patching.resize_vertices(101);
        cover(&mut patching, &stencils, 8, path);
        patching.check().unwrap();
        assert!(
            stencils
                .iter()
                .all(|stencil| patching.shared(stencil).is_some())
        );
        assert_eq!(patching.len(), 5, "two components of three fit into eight");
    }
}
