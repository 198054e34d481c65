//! Edges that must be there: Sloan's way, by flips of the edges that cross them.

use super::cdt::{Cdt, NONE, next, prev, wall};

/// What became of an edge that was asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Laid {
    /// It is there now: this half-edge.
    Done(u32),
    /// It runs through this vertex.
    Touches(u32),
    /// It crosses this wall.
    Crosses(u32),
}

/// Room for the edges on the way.
#[derive(Debug, Default, Clone)]
pub(crate) struct WallScratch {
    crossing: Vec<[u32; 2]>,
    fresh: Vec<[u32; 2]>,
}

impl Cdt {
    /// Makes the straight edge from `a` to `b`, two vertices that are not corners of the box, and
    /// marks it as `kind`. Nothing changes where that cannot be.
    pub(crate) fn lay(&mut self, a: u32, b: u32, kind: u8, scratch: &mut WallScratch) -> Laid {
        let mut h = match self.leave(a, b) {
            Ok(h) => h,
            Err(laid) => {
                if let Laid::Done(h) = laid {
                    self.mark(h, kind);
                }
                return laid;
            }
        };
        scratch.crossing.clear();
        loop {
            if self.walls[h as usize] != wall::FREE {
                return Laid::Crosses(h);
            }
            scratch.crossing.push([self.start(h), self.end(h)]);
            let g = self.twin[h as usize];
            let apex = self.apex(g);
            if apex == b {
                break;
            }
            let side = self.side(a, b, apex);
            if side == 0.0 {
                return Laid::Touches(apex);
            }
            h = if side > 0.0 { next(g) } else { prev(g) };
        }
        self.turn(a, b, scratch);
        for &[c, d] in &scratch.fresh {
            if let Some(h) = self.find_any(c, d) {
                self.stack.push(h);
            }
        }
        let h = self
            .find(a, b)
            .expect("no edge crosses the line between two neighbors any more");
        self.mark(h, kind);
        self.legalize_all();
        // Flips move half-edges, this edge's too.
        Laid::Done(
            self.find(a, b)
                .expect("an edge that is marked is not flipped"),
        )
    }

    /// The triangle of `a` through which the way to `b` starts, where it does not run along an edge.
    pub(crate) fn toward(&self, a: u32, b: u32) -> Option<u32> {
        self.leave(a, b).ok().map(|h| h / 3)
    }

    /// The side across from `a` through which the way to `b` leaves a triangle of `a`.
    fn leave(&self, a: u32, b: u32) -> Result<u32, Laid> {
        let first = self.outgoing[a as usize];
        let mut h = first;
        let [ax, ay] = self.point(a);
        let [bx, by] = self.point(b);
        loop {
            let x = self.end(h);
            if x == b {
                return Err(Laid::Done(h));
            }
            let side = self.side(a, b, x);
            if side == 0.0 {
                let [px, py] = self.point(x);
                let ahead = |from: f64, to: f64, at: f64| {
                    (to > from && at > from) || (to < from && at < from)
                };
                if ahead(ax, bx, px) || ahead(ay, by, py) {
                    return Err(Laid::Touches(x));
                }
            }
            if side < 0.0 && self.side(a, b, self.apex(h)) > 0.0 {
                return Ok(next(h));
            }
            h = self.twin[prev(h) as usize];
            if h == first || h == NONE {
                return Err(Laid::Touches(a));
            }
        }
    }

    /// Flips the crossing edges until none is left.
    fn turn(&mut self, a: u32, b: u32, scratch: &mut WallScratch) {
        scratch.fresh.clear();
        let mut at = 0;
        while at < scratch.crossing.len() {
            let [x, y] = scratch.crossing[at];
            at += 1;
            // The list is a queue; what is behind its head is thrown away now and then.
            if at > 1024 && 2 * at > scratch.crossing.len() {
                scratch.crossing.drain(..at);
                at = 0;
            }
            let Some(h) = self.find_any(x, y) else {
                continue;
            };
            let (c, d) = (self.apex(h), self.apex(self.twin[h as usize]));
            if !(self.side(d, c, self.start(h)) > 0.0 && self.side(d, c, self.end(h)) < 0.0) {
                scratch.crossing.push([x, y]);
                continue;
            }
            self.flip(h);
            let ends = [a, b];
            let crosses = !ends.contains(&c)
                && !ends.contains(&d)
                && (self.side(a, b, c) > 0.0) != (self.side(a, b, d) > 0.0);
            if crosses {
                scratch.crossing.push([c, d]);
            } else {
                scratch.fresh.push([c, d]);
            }
        }
    }

    /// The edge between `x` and `y`, one of which may be a corner of the box.
    fn find_any(&self, x: u32, y: u32) -> Option<u32> {
        self.find(x, y)
            .or_else(|| self.find(y, x).map(|h| self.twin[h as usize]))
    }

    pub(crate) fn mark(&mut self, h: u32, kind: u8) {
        self.walls[h as usize] = kind;
        let g = self.twin[h as usize];
        if g != NONE {
            self.walls[g as usize] = kind;
        }
    }
}
