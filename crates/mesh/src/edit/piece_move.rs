//! Moves of many triangles from one piece to another, logged in about one bit for each triangle.

use crate::ids::TriangleId;

/// Minimum number of triangles per word of a bit set; fewer are listed.
const MIN_PER_WORD: usize = 2;

/// Triangles that changed their piece together.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PieceMove {
    pub(super) triangles: TriangleSet,
    pub(super) from: u32,
    pub(super) to: u32,
    /// Number of single changes of pieces before this move.
    pub(super) changes_before: usize,
}

/// A set of triangles: a bit for each of a range, or a list if few of the range belong to it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TriangleSet {
    len: usize,
    /// Triangle of the first bit, a multiple of 64.
    first: usize,
    bits: Vec<u64>,
    /// Ascending; empty if there are bits.
    list: Vec<TriangleId>,
}

impl TriangleSet {
    /// Collects the triangles below slot `bound` for which `is_taken` returns true.
    ///
    /// It is called once for each of `triangles`.
    pub(super) fn new(
        triangles: impl Iterator<Item = TriangleId> + Clone,
        bound: usize,
        mut is_taken: impl FnMut(TriangleId) -> bool,
    ) -> Self {
        let (mut count, mut low, mut high) = (0, usize::MAX, 0);
        for t in triangles.clone().map(TriangleId::index) {
            let is_below = t < bound;
            count += usize::from(is_below);
            low = low.min(if is_below { t } else { usize::MAX });
            high = high.max(if is_below { t } else { 0 });
        }
        let mut set = Self {
            len: 0,
            first: low & !63,
            bits: Vec::new(),
            list: Vec::new(),
        };
        let taken = triangles.filter(|&t| is_taken(t) && t.index() < bound);
        let words = high.saturating_sub(set.first) / 64 + 1;
        if count < MIN_PER_WORD * words {
            set.list.extend(taken);
            set.list.sort_unstable();
            set.list.dedup();
            set.len = set.list.len();
        } else {
            set.bits.resize(words, 0);
            for t in taken {
                let bit = t.index() - set.first;
                set.bits[bit / 64] |= 1 << (bit % 64);
            }
            set.len = set.bits.iter().map(|word| word.count_ones() as usize).sum();
        }
        set
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Returns whether the set contains a triangle.
    pub(super) fn contains(&self, t: TriangleId) -> bool {
        if self.bits.is_empty() {
            return self.list.binary_search(&t).is_ok();
        }
        let bit = t.index().wrapping_sub(self.first);
        let word = self.bits.get(bit / 64);
        word.is_some_and(|word| word & (1 << (bit % 64)) != 0)
    }

    /// Iterates over the triangles, ascending.
    pub(super) fn iter(&self) -> impl Iterator<Item = TriangleId> + '_ {
        let words = (self.first..).step_by(64).zip(&self.bits);
        let bits = words.flat_map(|(first, &word)| {
            let mut left = word;
            std::iter::from_fn(move || {
                let bit = left.trailing_zeros() as usize;
                (left != 0).then(|| {
                    left &= left - 1;
                    TriangleId::from_index(first + bit)
                })
            })
        });
        bits.chain(self.list.iter().copied())
    }

    /// Iterates over words that differ for different sets.
    pub(super) fn words(&self) -> impl Iterator<Item = u64> + '_ {
        let list = self.list.iter().map(|t| u64::from(t.0));
        let extent = [self.first as u64, self.len as u64];
        extent
            .into_iter()
            .chain(self.bits.iter().copied())
            .chain(list)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dense_and_sparse_sets_have_their_triangles() {
        let dense: Vec<u32> = (70..400).filter(|i| i % 3 != 0).collect();
        let sparse = vec![3, 900, 64_000, 1_000_000];
        for (ids, is_dense) in [(dense, true), (sparse, false), (Vec::new(), false)] {
            let twice = ids.iter().rev().chain(&ids[..ids.len() / 2]);
            let and_others = twice.copied().chain([99, 2_000_000]).map(TriangleId);
            let triangles: Vec<TriangleId> = and_others.collect();
            let set = TriangleSet::new(triangles.iter().copied(), 1_500_000, |t| t.0 != 99);
            assert_eq!(!set.bits.is_empty(), is_dense);
            assert_eq!(set.len(), ids.len());
            assert!(set.iter().map(|t| t.0).eq(ids.iter().copied()));
            let around = ids.iter().flat_map(|&i| [i.saturating_sub(1), i, i + 1]);
            for i in around.chain([0, 65, u32::MAX - 1]) {
                assert_eq!(set.contains(TriangleId(i)), ids.contains(&i), "{i}");
            }
        }
    }
}
