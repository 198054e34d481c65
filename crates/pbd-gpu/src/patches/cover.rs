//! Builds patches along the borders of other patches, from the stencils that these cut apart.

use crate::patches::patching::Patching;
use incise_mesh::VertexId;

/// The vertices of a constraint, which should be in one patch; a vertex may appear twice.
pub(crate) type Stencil = [VertexId; 4];

/// Adds every vertex of `stencils` to a patch, those of one stencil to the same one if possible.
///
/// Vertices join an existing patch with room first. The others get new patches of `max` vertices.
pub(crate) fn cover(patching: &mut Patching, stencils: &[Stencil], max: usize) {
    for stencil in stencils {
        for &v in stencil {
            if patching.patch_of(v).is_none() {
                let patches = stencil.iter().filter_map(|&w| patching.patch_of(w));
                let mut patches = patches.filter(|&patch| patching.room(patch) > 0);
                if let Some(patch) = patches.next() {
                    patching.insert(v, patch);
                }
            }
        }
    }
    let mut growth = Growth::new(patching, stencils);
    growth.place_components(patching, max);
    growth.grow(patching, max);
}

/// Breadth-first growth of patches over vertices without a patch.
struct Growth<'a> {
    stencils: &'a [Stencil],
    /// Pairs of vertex and stencil, ascending.
    stencils_of: Vec<(VertexId, u32)>,
    /// Breadth-first queue of vertices.
    queue: Vec<VertexId>,
    /// The growing patch.
    patch: u32,
    /// Number of vertices that it still takes.
    left: usize,
}

impl<'a> Growth<'a> {
    fn new(patching: &Patching, stencils: &'a [Stencil]) -> Self {
        let mut stencils_of = Vec::new();
        for (i, stencil) in (0..).zip(stencils) {
            for &v in stencil {
                if patching.patch_of(v).is_none() {
                    stencils_of.push((v, i));
                }
            }
        }
        stencils_of.sort_unstable();
        stencils_of.dedup();
        // A few vertices share the newest patch.
        let waiting = stencils_of.chunk_by(|a, b| a.0 == b.0).count();
        let newest = patching.newest().map(|patch| (patch, patching.room(patch)));
        let with_room = newest.filter(|&(_, room)| room >= waiting);
        let (patch, left) = with_room.unwrap_or((0, 0));
        Self {
            stencils,
            stencils_of,
            queue: Vec::new(),
            patch,
            left,
        }
    }

    /// Adds connected components of at most `max` vertices to patches as a whole.
    fn place_components(&mut self, patching: &mut Patching, max: usize) {
        let mut seen = vec![false; self.stencils_of.len()];
        for start in 0..self.stencils_of.len() {
            if seen[start]
                || start > 0 && self.stencils_of[start - 1].0 == self.stencils_of[start].0
            {
                continue;
            }
            seen[start] = true;
            self.queue.clear();
            self.queue.push(self.stencils_of[start].0);
            let mut next = 0;
            while let Some(&v) = self.queue.get(next) {
                next += 1;
                let first = self.first(v);
                for &(_, stencil) in self.stencils_of[first..]
                    .iter()
                    .take_while(|&&(w, _)| w == v)
                {
                    for &w in &self.stencils[stencil as usize] {
                        let i = self.first(w);
                        let is_unplaced = patching.patch_of(w).is_none();
                        if is_unplaced && !std::mem::replace(&mut seen[i], true) {
                            self.queue.push(w);
                        }
                    }
                }
            }
            if self.queue.len() <= max {
                if self.queue.len() > self.left {
                    (self.patch, self.left) = (patching.add_patch(), max);
                }
                self.left -= self.queue.len();
                for &v in &self.queue {
                    patching.insert(v, self.patch);
                }
            }
        }
    }

    /// Grows patches of `max` vertices over the remaining vertices.
    fn grow(&mut self, patching: &mut Patching, max: usize) {
        let stencils = self.stencils;
        for &seed in stencils.iter().flatten() {
            self.queue.clear();
            self.queue.push(seed);
            let mut next = 0;
            while let Some(&v) = self.queue.get(next) {
                next += 1;
                if patching.patch_of(v).is_some() {
                    continue;
                }
                if self.left == 0 {
                    // The new patch starts at the border of the full one.
                    (self.patch, self.left) = (patching.add_patch(), max);
                    self.queue.clear();
                    next = 0;
                }
                patching.insert(v, self.patch);
                self.left -= 1;
                self.queue_neighbors(v, patching);
            }
        }
    }

    /// Queues the unplaced vertices that share a stencil with `v`.
    fn queue_neighbors(&mut self, v: VertexId, patching: &Patching) {
        let first = self.first(v);
        for &(_, i) in self.stencils_of[first..]
            .iter()
            .take_while(|&&(w, _)| w == v)
        {
            let neighbors = self.stencils[i as usize].iter();
            self.queue
                .extend(neighbors.filter(|&&w| patching.patch_of(w).is_none()));
        }
    }

    /// Returns the index of the first pair of `v`.
    fn first(&self, v: VertexId) -> usize {
        self.stencils_of.partition_point(|&(w, _)| w < v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(a: u32, b: u32) -> Stencil {
        [a, b, b, b].map(VertexId)
    }

    #[test]
    fn a_chain_is_cut_between_full_patches_only() {
        let stencils: Vec<Stencil> = (0..100).map(|i| pair(i, i + 1)).collect();
        let mut patching = Patching::new(16);
        patching.resize_vertices(101);
        cover(&mut patching, &stencils, 10);
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
        patching.resize_vertices(20);
        cover(&mut patching, &[pair(0, 1), pair(1, 2)], 3);
        assert_eq!(patching.len(), 1);
        cover(&mut patching, &[pair(2, 7), pair(7, 8), pair(8, 9)], 3);
        assert_eq!(patching.patch_of(VertexId(7)), Some(0), "the room of one");
        assert_eq!(patching.shared(&[8, 9].map(VertexId)), Some(1));
        cover(&mut patching, &[pair(15, 16)], 3);
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
        patching.resize_vertices(40);
        cover(&mut patching, &stencils, 8);
        patching.check().unwrap();
        assert!(
            stencils
                .iter()
                .all(|stencil| patching.shared(stencil).is_some())
        );
        assert_eq!(patching.len(), 5, "two components of three fit into eight");
    }
}
