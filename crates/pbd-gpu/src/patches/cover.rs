//! Builds patches along the borders of other patches, from the stencils that these cut apart.

use crate::patches::patching::Patching;
use incise_mesh::{VertexId, index_u32};

/// The vertices of a constraint, which should be in one patch; a vertex may appear twice.
pub(crate) type Stencil = [VertexId; 4];

/// Adds every vertex of `stencils` to a patch, those of one stencil to the same one if possible.
///
/// Vertices join an existing patch with room first. The others get new patches of `max` vertices,
/// connected by `neighbors`, which appends those of a vertex to a list.
pub(crate) fn cover(
    patching: &mut Patching,
    stencils: impl Iterator<Item = Stencil>,
    max: usize,
    neighbors: impl Fn(VertexId, &mut Vec<VertexId>),
) {
    let mut waiting = Vec::new();
    for stencil in stencils {
        let placed = stencil.iter().filter(|&&v| patching.patch_of(v).is_some());
        let placed = placed.count();
        if placed == stencil.len() {
            continue;
        }
        // Most new vertices are beside new vertices only.
        if placed == 0 {
            for v in stencil {
                if !patching.is_waiting(v) {
                    patching.set_waiting(v, true);
                    waiting.push(v);
                }
            }
            continue;
        }
        for v in stencil {
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
        fans: Vec::new(),
        fan_ends: Vec::new(),
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
    /// Neighbors of the vertices of a component, and the end of those of each vertex.
    fans: Vec<VertexId>,
    fan_ends: Vec<u32>,
    /// The growing patch.
    patch: u32,
    /// Number of vertices that it still takes.
    left: usize,
}

impl<F: Fn(VertexId, &mut Vec<VertexId>)> Growth<'_, F> {
    /// Adds a connected component of waiting vertices to a patch as a whole, or to several.
    fn place_component(&mut self, seed: VertexId) {
        self.queue.clear();
        self.queue.push(seed);
        self.patching.set_waiting(seed, false);
        self.fans.clear();
        self.fan_ends.clear();
        let mut next = 0;
        while let Some(&v) = self.queue.get(next) {
            next += 1;
            let first = self.fans.len();
            (self.neighbors)(v, &mut self.fans);
            self.fan_ends.push(index_u32(self.fans.len()));
            for &w in &self.fans[first..] {
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
            for (i, &v) in (0..).zip(&component) {
                self.patching.set_waiting_as(v, i);
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
            let Some(number) = self.patching.waiting_number(v) else {
                continue;
            };
            let number = number as usize;
            if self.left == 0 {
                // The new patch starts at the border of the full one.
                self.start_patch();
                self.queue.clear();
                next = 0;
            }
            self.patching.insert(v, self.patch);
            self.left -= 1;
            let start = number.checked_sub(1).map_or(0, |i| self.fan_ends[i]);
            let fan = &self.fans[start as usize..self.fan_ends[number] as usize];
            let waiting = fan.iter().filter(|&&w| self.patching.is_waiting(w));
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

    /// Appends the neighbors of a vertex of a path.
    fn path(v: VertexId, out: &mut Vec<VertexId>) {
        let near = [v.0.wrapping_sub(1), v.0 + 1].into_iter();
        out.extend(near.filter(|&w| w < 101).map(VertexId));
    }

    fn pair(a: u32, b: u32) -> Stencil {
        [a, b, b, b].map(VertexId)
    }

    #[test]
    fn a_chain_is_cut_between_full_patches_only() {
        let stencils: Vec<Stencil> = (0..100).map(|i| pair(i, i + 1)).collect();
        let mut patching = Patching::new(16);
        patching.resize_vertices(101);
        cover(&mut patching, stencils.iter().copied(), 10, path);
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
        let stencils = [pair(0, 1), pair(1, 2)];
        cover(&mut patching, stencils.into_iter(), 3, path);
        assert_eq!(patching.len(), 1);
        let stencils = [pair(2, 7), pair(7, 8), pair(8, 9)];
        cover(&mut patching, stencils.into_iter(), 3, path);
        assert_eq!(patching.patch_of(VertexId(7)), Some(0), "the room of one");
        assert_eq!(patching.shared(&[8, 9].map(VertexId)), Some(1));
        cover(&mut patching, [pair(15, 16)].into_iter(), 3, path);
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
        cover(&mut patching, stencils.iter().copied(), 8, path);
        patching.check().unwrap();
        assert!(
            stencils
                .iter()
                .all(|stencil| patching.shared(stencil).is_some())
        );
        assert_eq!(patching.len(), 5, "two components of three fit into eight");
    }
}
