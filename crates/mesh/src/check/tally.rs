//! Flaws, counted.

use crate::ids::TriangleId;

/// The first triangle with a flaw, and how many have it.
#[derive(Default)]
pub(super) struct Tally {
    first: u32,
    count: usize,
}

impl Tally {
    /// Counts triangle `t` when it has the flaw; returns whether it has.
    pub(super) fn note(&mut self, flaw: bool, t: u32) -> bool {
        if flaw && self.count == 0 {
            self.first = t;
        }
        self.count += usize::from(flaw);
        flaw
    }

    /// The first and how many, if there are any.
    pub(super) fn found(&self) -> Option<(TriangleId, usize)> {
        (self.count > 0).then_some((TriangleId(self.first), self.count))
    }
}
