//! [`Crossings`]: where scanlines cross the surface, stored by line.

use crate::body::Body;
use crate::lines::Lines;
use crate::projection::Passage;
use incise_mesh::{TriangleId, index_u32};
use std::cmp::Ordering;

/// No crossing.
const NONE: u32 = u32::MAX;

/// A crossing of a scanline with the surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Crossing {
    /// Coordinate along the axis \[m\].
    pub(crate) at: f64,
    /// Twice the triangle, plus 1 where the line enters the body.
    code: u32,
    /// The next crossing of the line.
    next: u32,
}

impl Crossing {
    pub(crate) fn triangle(&self) -> TriangleId {
        TriangleId(self.code >> 1)
    }

    fn enters(&self) -> bool {
        self.code & 1 == 1
    }

    fn new(triangle: TriangleId, passage: Passage) -> Self {
        Self {
            at: passage.at,
            code: triangle.0 << 1 | u32::from(!passage.leaves),
            next: NONE,
        }
    }

    fn order(&self, other: &Self) -> Ordering {
        // At one place exits come first, so that coincident walls end and begin spans.
        let order = self.at.total_cmp(&other.at);
        let order = order.then(self.enters().cmp(&other.enters()));
        order.then(self.code.cmp(&other.code))
    }
}

/// The inside of a body along a scanline, between an entry and an exit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Interval {
    pub(crate) entry: Crossing,
    pub(crate) exit: Crossing,
}

/// The crossings of all scanlines, ascending in a linked list for each.
///
/// Their order in the pool depends on earlier edits, and equal lists may differ in it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Crossings {
    /// By axis and line, its first crossing.
    first: [Vec<u32>; 3],
    pool: Vec<Crossing>,
    /// First free crossing of the pool.
    free: u32,
    /// Axes and lines along which pieces are not apart, ascending.
    irregular: Vec<(usize, u32)>,
}

impl PartialEq for Crossings {
    fn eq(&self, other: &Self) -> bool {
        let is_equal = |axis: usize| {
            let [own, others] = [self, other].map(|crossings| crossings.first[axis].len());
            let values = |crossing: &Crossing| (crossing.at.to_bits(), crossing.code);
            own == others
                && (0..index_u32(own)).all(|line| {
                    let own = self.of(axis, line).map(values);
                    own.eq(other.of(axis, line).map(values))
                })
        };
        self.irregular == other.irregular && (0..3).all(is_equal)
    }
}

impl Crossings {
    pub(crate) fn new(lines: &[Lines; 3]) -> Self {
        Self {
            first: [0, 1, 2].map(|axis| vec![NONE; lines[axis].count()]),
            pool: Vec::new(),
            free: NONE,
            irregular: Vec::new(),
        }
    }

    /// Returns the crossings of a line.
    pub(crate) fn of(&self, axis: usize, line: u32) -> impl Iterator<Item = &Crossing> {
        let mut next = self.first[axis][line as usize];
        std::iter::from_fn(move || {
            let crossing = self.pool.get(next as usize)?;
            next = crossing.next;
            Some(crossing)
        })
    }

    /// Adds a crossing to a line.
    pub(crate) fn insert(
        &mut self,
        axis: usize,
        line: u32,
        triangle: TriangleId,
        passage: Passage,
    ) {
        let mut added = Crossing::new(triangle, passage);
        let (mut before, mut next) = (NONE, self.first[axis][line as usize]);
        while let Some(crossing) = self.pool.get(next as usize) {
            if crossing.order(&added).is_ge() {
                break;
            }
            (before, next) = (next, crossing.next);
        }
        added.next = next;
        let slot = self.free;
        let slot = if let Some(free) = self.pool.get_mut(slot as usize) {
            self.free = free.next;
            *free = added;
            slot
        } else {
            self.pool.push(added);
            index_u32(self.pool.len() - 1)
        };
        match self.pool.get_mut(before as usize) {
            Some(before) => before.next = slot,
            None => self.first[axis][line as usize] = slot,
        }
    }

    /// Removes the crossings of a line with triangles; calls `removed` with their coordinates.
    pub(crate) fn remove(
        &mut self,
        axis: usize,
        line: u32,
        is_removed: impl Fn(TriangleId) -> bool,
        mut removed: impl FnMut(f64),
    ) {
        let (mut before, mut slot) = (NONE, self.first[axis][line as usize]);
        while let Some(&crossing) = self.pool.get(slot as usize) {
            if is_removed(crossing.triangle()) {
                removed(crossing.at);
                match self.pool.get_mut(before as usize) {
                    Some(before) => before.next = crossing.next,
                    None => self.first[axis][line as usize] = crossing.next,
                }
                self.pool[slot as usize].next = self.free;
                self.free = slot;
            } else {
                before = slot;
            }
            slot = crossing.next;
        }
    }

    /// Tests whether pieces are apart along a line, whose crossings or their pieces changed.
    ///
    /// Returns whether they were not, before or now: any cell along the line may be concerned.
    pub(crate) fn update_regularity(&mut self, body: &Body<'_>, axis: usize, line: u32) -> bool {
        let is_regular = self.is_regular(body, axis, line);
        match self.irregular.binary_search(&(axis, line)) {
            Ok(i) => {
                if is_regular {
                    self.irregular.remove(i);
                }
                true
            }
            Err(i) => {
                if !is_regular {
                    self.irregular.insert(i, (axis, line));
                }
                !is_regular
            }
        }
    }

    /// Tests whether pieces are apart along all lines. Collects the lines along which they are not,
    /// before or now.
    pub(crate) fn update_pieces(&mut self, body: &Body<'_>, irregular: &mut Vec<(usize, u32)>) {
        for axis in 0..3 {
            for line in 0..index_u32(self.first[axis].len()) {
                if self.first[axis][line as usize] != NONE
                    && self.update_regularity(body, axis, line)
                {
                    irregular.push((axis, line));
                }
            }
        }
    }

    /// Returns whether each entry along a line is followed by an exit of the same piece.
    fn is_regular(&self, body: &Body<'_>, axis: usize, line: u32) -> bool {
        let mut slot = self.first[axis][line as usize];
        while let Some(entry) = self.pool.get(slot as usize) {
            let Some(exit) = self.pool.get(entry.next as usize) else {
                return false;
            };
            let is_pair = entry.enters() && !exit.enters();
            if !is_pair || body.piece(entry.triangle()) != body.piece(exit.triangle()) {
                return false;
            }
            slot = exit.next;
        }
        true
    }

    /// Collects the intervals of a line that reach into a range of coordinates.
    ///
    /// Where pieces overlap, the intervals of each are found alone, so that nothing joins them.
    pub(crate) fn intervals(
        &self,
        body: &Body<'_>,
        axis: usize,
        line: u32,
        [low, high]: [f64; 2],
        found: &mut Vec<Interval>,
    ) {
        found.clear();
        let first = self.first[axis][line as usize];
        if first == NONE {
            return;
        }
        if !self.irregular.is_empty() && self.irregular.binary_search(&(axis, line)).is_ok() {
            self.intervals_by_piece(body, axis, line, found);
            found.retain(|interval| interval.exit.at >= low && interval.entry.at <= high);
            return;
        }
        let mut slot = first;
        while let Some(entry) = self.pool.get(slot as usize) {
            if entry.at > high {
                return;
            }
            let Some(exit) = self.pool.get(entry.next as usize) else {
                return;
            };
            if exit.at >= low {
                let (entry, exit) = (*entry, *exit);
                found.push(Interval { entry, exit });
            }
            slot = exit.next;
        }
    }

    /// Collects the intervals of each piece along a line, by place.
    fn intervals_by_piece(
        &self,
        body: &Body<'_>,
        axis: usize,
        line: u32,
        found: &mut Vec<Interval>,
    ) {
        let piece = |crossing: &Crossing| body.piece(crossing.triangle());
        let mut pieces: Vec<u32> = self.of(axis, line).map(piece).collect();
        pieces.sort_unstable();
        pieces.dedup();
        for own in pieces {
            let mut winding = 0;
            let mut entry = None;
            for crossing in self
                .of(axis, line)
                .filter(|crossing| piece(crossing) == own)
            {
                if crossing.enters() {
                    winding += 1;
                    if winding == 1 {
                        entry = Some(*crossing);
                    }
                    continue;
                }
                winding -= 1;
                if let (0, Some(entry)) = (winding, entry) {
                    let exit = *crossing;
                    found.push(Interval { entry, exit });
                }
            }
        }
        let place = |crossing: &Crossing| (crossing.at, crossing.code);
        found.sort_by(|a, b| {
            let [(a, i), (b, j)] = [place(&a.entry), place(&b.entry)];
            a.total_cmp(&b).then(i.cmp(&j))
        });
    }
}

/// A crossing that is not in its list yet.
#[cfg(feature = "serde")]
#[derive(Debug, Clone, Copy)]
pub(crate) struct FoundCrossing {
    axis: usize,
    line: u32,
    crossing: Crossing,
}

#[cfg(feature = "serde")]
impl FoundCrossing {
    pub(crate) fn new(axis: usize, line: u32, triangle: TriangleId, passage: Passage) -> Self {
        let crossing = Crossing::new(triangle, passage);
        Self {
            axis,
            line,
            crossing,
        }
    }
}

#[cfg(feature = "serde")]
impl Crossings {
    /// Makes the lists of all scanlines at once, in the order of [`Self::insert`].
    pub(crate) fn from_found(body: &Body<'_>, mut found: Vec<FoundCrossing>) -> Self {
        found.sort_unstable_by(|a, b| {
            let order = (a.axis, a.line).cmp(&(b.axis, b.line));
            order.then_with(|| a.crossing.order(&b.crossing))
        });
        let mut crossings = Self::new(&body.lines);
        for own in found.chunk_by(|a, b| (a.axis, a.line) == (b.axis, b.line)) {
            let (axis, line) = (own[0].axis, own[0].line);
            crossings.first[axis][line as usize] = index_u32(crossings.pool.len());
            crossings
                .pool
                .extend(own.iter().map(|found| found.crossing));
            let from = crossings.pool.len() - own.len();
            for slot in from + 1..crossings.pool.len() {
                crossings.pool[slot - 1].next = index_u32(slot);
            }
            crossings.update_regularity(body, axis, line);
        }
        crossings
    }
}
