//! Counter of defects with the first triangle.

use crate::ids::TriangleId;

/// The number of triangles with a defect, and the first of them.
#[derive(Default)]
pub(super) struct Tally {
    first: u32,
    count: usize,
}

impl Tally {
    /// Counts triangle `t` if it has the defect, and returns whether it has.
    pub(super) fn note(&mut self, flaw: bool, t: u32) -> bool {
        if flaw && self.count == 0 {
            self.first = t;
        }
        self.count += usize::from(flaw);
        flaw
    }

    /// Returns the first triangle and the number, if there are any.
    pub(super) fn found(&self) -> Option<(TriangleId, usize)> {
        (self.count > 0).then_some((TriangleId(self.first), self.count))
    }
}
