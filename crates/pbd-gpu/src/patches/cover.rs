//! Patches over what other patches cut apart: vertices that constraints tie together are gathered.

use crate::patches::patching::Patching;
use incise_mesh::VertexId;

/// The vertices of a constraint that are to be in one patch; a vertex may be named twice.
pub(crate) type Tie = [VertexId; 4];

/// Puts every vertex of `ties` into a patch, tied vertices into the same one where it goes. First what
/// is tied to a patch with room joins it; what is left over gets new patches of `most` vertices.
pub(crate) fn cover(patching: &mut Patching, ties: &[Tie], most: usize) {
    for tie in ties {
        for &v in tie {
            if patching.patch_of(v).is_none() {
                let patches = tie.iter().filter_map(|&w| patching.patch_of(w));
                let mut roomy = patches.filter(|&patch| patching.room(patch) > 0);
                if let Some(patch) = roomy.next() {
                    patching.join(v, patch);
                }
            }
        }
    }
    let mut growth = Growth::new(patching, ties);
    growth.place_islands(patching, most);
    growth.grow(patching, most);
}

/// Vertices without a patch and the ties around them.
struct Growth<'a> {
    ties: &'a [Tie],
    /// Vertices with the ties that they are in, ascending.
    around: Vec<(VertexId, u32)>,
    /// Vertices that wait, first come first served.
    queue: Vec<VertexId>,
    /// The patch that grows and how many more vertices it takes.
    patch: u32,
    left: usize,
}

impl<'a> Growth<'a> {
    fn new(patching: &Patching, ties: &'a [Tie]) -> Self {
        let mut around = Vec::new();
        for (i, tie) in (0..).zip(ties) {
            for &v in tie {
                if patching.patch_of(v).is_none() {
                    around.push((v, i));
                }
            }
        }
        around.sort_unstable();
        around.dedup();
        // The newest patch is good enough for a few strays.
        let waiting = around.chunk_by(|a, b| a.0 == b.0).count();
        let newest = patching.newest().map(|patch| (patch, patching.room(patch)));
        let roomy = newest.filter(|&(_, room)| room >= waiting);
        let (patch, left) = roomy.unwrap_or((0, 0));
        Self {
            ties,
            around,
            queue: Vec::new(),
            patch,
            left,
        }
    }

    /// Puts islands, which are what hangs together by ties, into patches as a whole, where one can hold
    /// them.
    fn place_islands(&mut self, patching: &mut Patching, most: usize) {
        let mut seen = vec![false; self.around.len()];
        for start in 0..self.around.len() {
            if seen[start] || start > 0 && self.around[start - 1].0 == self.around[start].0 {
                continue;
            }
            seen[start] = true;
            self.queue.clear();
            self.queue.push(self.around[start].0);
            let mut next = 0;
            while let Some(&v) = self.queue.get(next) {
                next += 1;
                let first = self.first(v);
                for &(_, tie) in self.around[first..].iter().take_while(|&&(w, _)| w == v) {
                    for &w in &self.ties[tie as usize] {
                        let i = self.first(w);
                        let waits = patching.patch_of(w).is_none();
                        if waits && !std::mem::replace(&mut seen[i], true) {
                            self.queue.push(w);
                        }
                    }
                }
            }
            if self.queue.len() <= most {
                if self.queue.len() > self.left {
                    (self.patch, self.left) = (patching.add_patch(), most);
                }
                self.left -= self.queue.len();
                for &v in &self.queue {
                    patching.join(v, self.patch);
                }
            }
        }
    }

    /// Lets patches grow along ties through what is left, each to `most` vertices.
    fn grow(&mut self, patching: &mut Patching, most: usize) {
        let ties = self.ties;
        for &seed in ties.iter().flatten() {
            self.queue.clear();
            self.queue.push(seed);
            let mut next = 0;
            while let Some(&v) = self.queue.get(next) {
                next += 1;
                if patching.patch_of(v).is_some() {
                    continue;
                }
                if self.left == 0 {
                    // What waits borders on the full patch; the new one begins there.
                    (self.patch, self.left) = (patching.add_patch(), most);
                    self.queue.clear();
                    next = 0;
                }
                patching.join(v, self.patch);
                self.left -= 1;
                self.reach(v, patching);
            }
        }
    }

    /// Lets the vertices that are tied to `v` wait.
    fn reach(&mut self, v: VertexId, patching: &Patching) {
        let first = self.first(v);
        for &(_, i) in self.around[first..].iter().take_while(|&&(w, _)| w == v) {
            let tied = self.ties[i as usize].iter();
            self.queue
                .extend(tied.filter(|&&w| patching.patch_of(w).is_none()));
        }
    }

    /// Where the ties of `v` begin.
    fn first(&self, v: VertexId) -> usize {
        self.around.partition_point(|&(w, _)| w < v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(a: u32, b: u32) -> Tie {
        [a, b, b, b].map(VertexId)
    }

    #[test]
    fn a_chain_is_cut_as_seldom_as_can_be() {
        let ties: Vec<Tie> = (0..100).map(|i| pair(i, i + 1)).collect();
        let mut patching = Patching::new(16);
        patching.resize_vertices(101);
        cover(&mut patching, &ties, 10);
        patching.check().unwrap();
        assert_eq!(patching.len(), 11);
        let cut = ties.iter().filter(|tie| patching.shared(*tie).is_none());
        assert_eq!(cut.count(), 10, "one tie between one patch and the next");
    }

    #[test]
    fn what_comes_later_joins_its_neighbors_while_there_is_room() {
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
            "strays"
        );
        patching.check().unwrap();
    }

    #[test]
    fn islands_stay_whole() {
        let ties: Vec<Tie> = (0..10)
            .flat_map(|i| [pair(4 * i, 4 * i + 1), pair(4 * i + 1, 4 * i + 2)])
            .collect();
        let mut patching = Patching::new(8);
        patching.resize_vertices(40);
        cover(&mut patching, &ties, 8);
        patching.check().unwrap();
        assert!(ties.iter().all(|tie| patching.shared(tie).is_some()));
        assert_eq!(patching.len(), 5, "two islands of three fit into eight");
    }
}
