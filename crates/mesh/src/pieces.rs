//! How many triangles every piece has, and which piece numbers were given.

/// Pieces and their triangles. Kept up to date by every edit, so that nobody has to count.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Pieces {
    /// Number and triangles, ascending; a piece without triangles is not listed.
    counts: Vec<(u32, u32)>,
    /// Above every number that was ever in use.
    bound: u32,
}

impl Pieces {
    /// How many have triangles.
    pub(crate) fn len(&self) -> usize {
        self.counts.len()
    }

    /// The triangles of `piece`.
    pub(crate) fn count(&self, piece: u32) -> u32 {
        self.find(piece).map_or(0, |at| self.counts[at].1)
    }

    /// One triangle more of `piece`.
    pub(crate) fn add(&mut self, piece: u32) {
        match self.find(piece) {
            Ok(at) => self.counts[at].1 += 1,
            Err(at) => self.counts.insert(at, (piece, 1)),
        }
        self.bound = self.bound.max(piece.saturating_add(1));
    }

    /// `count` triangles more of `piece`.
    pub(crate) fn grow(&mut self, piece: u32, count: u32) {
        if count > 0 {
            self.add(piece);
            if let Ok(at) = self.find(piece) {
                self.counts[at].1 += count - 1;
            }
        }
    }

    /// `count` triangles of `from` are now `to`'s.
    pub(crate) fn shift(&mut self, from: u32, to: u32, count: u32) {
        self.grow(to, count);
        if let Ok(at) = self.find(from) {
            self.counts[at].1 -= count;
            if self.counts[at].1 == 0 {
                self.counts.remove(at);
            }
        }
    }

    /// One triangle less of `piece`.
    pub(crate) fn remove(&mut self, piece: u32) {
        if let Ok(at) = self.find(piece) {
            self.counts[at].1 -= 1;
            if self.counts[at].1 == 0 {
                self.counts.remove(at);
            }
        }
    }

    /// One more than the largest number that was ever in use.
    pub(crate) fn bound(&self) -> u32 {
        self.bound
    }

    /// Sets the bound: one that an undone edit or another surface had.
    pub(crate) fn set_bound(&mut self, bound: u32) {
        self.bound = bound;
    }

    /// The next number, in use from now on.
    pub(crate) fn take_number(&mut self) -> u32 {
        let number = self.bound;
        self.bound = self.bound.saturating_add(1);
        number
    }

    fn find(&self, piece: u32) -> Result<usize, usize> {
        self.counts.binary_search_by_key(&piece, |entry| entry.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_counted_and_never_given_twice() {
        let mut pieces = Pieces::default();
        for piece in [3, 0, 3] {
            pieces.add(piece);
        }
        assert_eq!([0, 1, 3].map(|p| pieces.count(p)), [1, 0, 2]);
        assert_eq!(pieces.take_number(), 4);
        pieces.remove(3);
        pieces.remove(3);
        assert_eq!(pieces.counts, [(0, 1)]);
        assert_eq!(
            pieces.take_number(),
            5,
            "a number that is free again is not given again"
        );
    }
}
