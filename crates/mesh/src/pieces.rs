//! Triangle counts of pieces, and the allocation of piece numbers.

/// The triangle count of every piece, updated by every edit.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Pieces {
    /// Piece number and count, ascending, for pieces with triangles.
    #[cfg_attr(feature = "serde", serde(skip))]
    counts: Vec<(u32, u32)>,
    /// Upper bound of all numbers ever used, exclusive.
    bound: u32,
}

impl Pieces {
    /// Returns the number of pieces with triangles.
    pub(crate) fn len(&self) -> usize {
        self.counts.len()
    }

    /// Returns the number of triangles of `piece`.
    pub(crate) fn count(&self, piece: u32) -> u32 {
        self.find(piece).map_or(0, |at| self.counts[at].1)
    }

    /// Counts one more triangle of `piece`.
    pub(crate) fn add(&mut self, piece: u32) {
        match self.find(piece) {
            Ok(at) => self.counts[at].1 += 1,
            Err(at) => self.counts.insert(at, (piece, 1)),
        }
        self.bound = self.bound.max(piece.saturating_add(1));
    }

    /// Counts `count` more triangles of `piece`.
    pub(crate) fn grow(&mut self, piece: u32, count: u32) {
        if count > 0 {
            self.add(piece);
            if let Ok(at) = self.find(piece) {
                self.counts[at].1 += count - 1;
            }
        }
    }

    /// Moves `count` triangles from piece `from` to `to`.
    pub(crate) fn shift(&mut self, from: u32, to: u32, count: u32) {
        self.grow(to, count);
        if let Ok(at) = self.find(from) {
            self.counts[at].1 -= count;
            if self.counts[at].1 == 0 {
                self.counts.remove(at);
            }
        }
    }

    /// Counts one triangle of `piece` less.
    pub(crate) fn remove(&mut self, piece: u32) {
        if let Ok(at) = self.find(piece) {
            self.counts[at].1 -= 1;
            if self.counts[at].1 == 0 {
                self.counts.remove(at);
            }
        }
    }

    /// Returns the upper bound of all numbers ever used, exclusive.
    pub(crate) fn bound(&self) -> u32 {
        self.bound
    }

    /// Sets the bound, for an undo or a copied part.
    pub(crate) fn set_bound(&mut self, bound: u32) {
        self.bound = bound;
    }

    /// Allocates the next number.
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
