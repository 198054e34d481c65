//! Insertion of constraint segments into a [`Cdt`] by flips of the crossing edges.
//!
//! Sloan, "A fast algorithm for generating constrained Delaunay triangulations", 1993.

use super::{Cdt, NONE, constraint, next, prev};

/// The result of inserting a segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SegmentInsertion {
    /// The segment is this half-edge.
    Inserted(u32),
    /// Nothing changed: the segment passes through this vertex.
    PassesVertex(u32),
    /// Nothing changed: the segment crosses this constrained half-edge.
    CrossesConstraint(u32),
}

/// Scratch memory of a segment insertion.
#[derive(Debug, Default, Clone)]
pub(crate) struct SegmentScratch {
    /// Queue of edges that cross the segment.
    crossing: Vec<[u32; 2]>,
    /// Edges made by flips, to test for the Delaunay property.
    fresh: Vec<[u32; 2]>,
}

impl Cdt {
    /// Inserts the segment from `a` to `b` with the constraint `kind`.
    ///
    /// Neither vertex may be a corner of the box. Nothing changes unless the result is
    /// [`SegmentInsertion::Inserted`].
    pub(crate) fn insert_segment(
        &mut self,
        a: u32,
        b: u32,
        kind: u8,
        scratch: &mut SegmentScratch,
    ) -> SegmentInsertion {
        let mut h = match self.first_crossing(a, b) {
            Ok(h) => h,
            Err(result) => {
                if let SegmentInsertion::Inserted(h) = result {
                    self.set_constraint(h, kind);
                }
                return result;
            }
        };
        scratch.crossing.clear();
        loop {
            if self.constraints[h as usize] != constraint::FREE {
                return SegmentInsertion::CrossesConstraint(h);
            }
            scratch.crossing.push([self.start(h), self.end(h)]);
            let g = self.twin[h as usize];
            let apex = self.opposite(g);
            if apex == b {
                break;
            }
            let side = self.orientation(a, b, apex);
            if side == 0.0 {
                return SegmentInsertion::PassesVertex(apex);
            }
            h = if side > 0.0 { next(g) } else { prev(g) };
        }
        self.flip_crossing_edges(a, b, scratch);
        for &[c, d] in &scratch.fresh {
            if let Some(h) = self.find_edge(c, d) {
                self.stack.push(h);
            }
        }
        let h = self
            .find_half_edge(a, b)
            .expect("no edge crosses the segment any more");
        self.set_constraint(h, kind);
        self.legalize_all();
        // Flips renumber half-edges, also those of this edge.
        SegmentInsertion::Inserted(
            self.find_half_edge(a, b)
                .expect("a constrained edge is not flipped"),
        )
    }

    /// Returns the first half-edge that the segment from `a` to `b` crosses.
    fn first_crossing(&self, a: u32, b: u32) -> Result<u32, SegmentInsertion> {
        let first = self.outgoing[a as usize];
        let mut h = first;
        let [ax, ay] = self.point(a);
        let [bx, by] = self.point(b);
        loop {
            let x = self.end(h);
            if x == b {
                return Err(SegmentInsertion::Inserted(h));
            }
            let side = self.orientation(a, b, x);
            if side == 0.0 {
                let [px, py] = self.point(x);
                let ahead = |from: f64, to: f64, at: f64| {
                    (to > from && at > from) || (to < from && at < from)
                };
                if ahead(ax, bx, px) || ahead(ay, by, py) {
                    return Err(SegmentInsertion::PassesVertex(x));
                }
            }
            if side < 0.0 && self.orientation(a, b, self.opposite(h)) > 0.0 {
                return Ok(next(h));
            }
            h = self.twin[prev(h) as usize];
            if h == first || h == NONE {
                return Err(SegmentInsertion::PassesVertex(a));
            }
        }
    }

    /// Flips crossing edges until none is left.
    fn flip_crossing_edges(&mut self, a: u32, b: u32, scratch: &mut SegmentScratch) {
        scratch.fresh.clear();
        let mut at = 0;
        while at < scratch.crossing.len() {
            let [x, y] = scratch.crossing[at];
            at += 1;
            // Drop the consumed head of the queue now and then, so that it stays short.
            if at > 1024 && 2 * at > scratch.crossing.len() {
                scratch.crossing.drain(..at);
                at = 0;
            }
            let Some(h) = self.find_edge(x, y) else {
                continue;
            };
            let (c, d) = (self.opposite(h), self.opposite(self.twin[h as usize]));
            if !(self.orientation(d, c, self.start(h)) > 0.0
                && self.orientation(d, c, self.end(h)) < 0.0)
            {
                scratch.crossing.push([x, y]);
                continue;
            }
            self.flip(h);
            let ends = [a, b];
            let crosses = !ends.contains(&c)
                && !ends.contains(&d)
                && (self.orientation(a, b, c) > 0.0) != (self.orientation(a, b, d) > 0.0);
            if crosses {
                scratch.crossing.push([c, d]);
            } else {
                scratch.fresh.push([c, d]);
            }
        }
    }

    /// Returns the half-edge from `x` to `y`, one of which may be a corner of the box.
    fn find_edge(&self, x: u32, y: u32) -> Option<u32> {
        self.find_half_edge(x, y)
            .or_else(|| self.find_half_edge(y, x).map(|h| self.twin[h as usize]))
    }

    /// Sets the constraint of both half-edges of an edge.
    pub(crate) fn set_constraint(&mut self, h: u32, kind: u8) {
        self.constraints[h as usize] = kind;
        let g = self.twin[h as usize];
        if g != NONE {
            self.constraints[g as usize] = kind;
        }
    }
}
