//! Disjoint sets (union-find) over the numbers below n.

use crate::ids::index_u32;

/// Disjoint sets, each identified by its smallest member, which does not depend on the order of
/// joins.
#[derive(Debug)]
pub struct Partition {
    parent: Vec<u32>,
}

impl Partition {
    /// Creates a set for every number below `count`.
    #[must_use]
    pub fn new(count: usize) -> Self {
        let count = index_u32(count);
        Self {
            parent: (0..count).collect(),
        }
    }

    /// Starts again with a set for every number below `count`.
    pub fn reset(&mut self, count: usize) {
        self.parent.clear();
        self.parent.extend(0..index_u32(count));
    }

    /// Returns the number of members of all sets.
    #[must_use]
    pub fn len(&self) -> usize {
        self.parent.len()
    }

    /// Returns whether there are no members.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.parent.is_empty()
    }

    /// Returns the smallest member of the set that contains `i`.
    #[inline]
    pub fn find(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let next = self.parent[i as usize];
            self.parent[i as usize] = self.parent[next as usize];
            i = next;
        }
        i
    }

    /// Adds `i`, so far in a set of its own, to the set that the smaller `root` names.
    #[cfg(feature = "io")]
    pub(crate) fn attach(&mut self, i: u32, root: u32) {
        self.parent[i as usize] = root;
    }

    /// Merges the sets of `a` and `b`.
    #[inline]
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_named_by_their_smallest_member() {
        let mut partition = Partition::new(6);
        partition.join(5, 3);
        partition.join(3, 1);
        partition.join(4, 2);
        assert_eq!(
            [0, 1, 2, 3, 4, 5].map(|i| partition.find(i)),
            [0, 1, 2, 1, 2, 1]
        );
    }
}
