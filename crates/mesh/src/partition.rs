//! Disjoint sets over the numbers below n.

/// Disjoint sets, each named by its smallest member, so that names do not depend on the order of
/// joins.
#[derive(Debug)]
pub(crate) struct Partition {
    parent: Vec<u32>,
}

impl Partition {
    /// Every number below `count` alone.
    pub(crate) fn new(count: usize) -> Self {
        let count = u32::try_from(count).expect("elements have 32-bit ids");
        Self {
            parent: (0..count).collect(),
        }
    }

    /// The smallest member of the set that holds `i`.
    pub(crate) fn find(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let next = self.parent[i as usize];
            self.parent[i as usize] = self.parent[next as usize];
            i = next;
        }
        i
    }

    /// Makes one set of the two that hold `a` and `b`.
    pub(crate) fn join(&mut self, a: u32, b: u32) {
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
