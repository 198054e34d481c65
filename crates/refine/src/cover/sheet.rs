//! Rings that belong together: their constrained Delaunay triangulation, and what lies inside.

use super::cdt::{Cdt, NONE, id, wall};
use super::order::insertion_order;
use super::section::Rims;
use super::wall::{Laid, WallScratch};

/// Region of a triangle that was not reached.
const UNKNOWN: u8 = u8::MAX;
/// Region of what is outside.
pub(crate) const OUTSIDE: u8 = 0;
/// Region of what is to be covered.
pub(crate) const INSIDE: u8 = 1;

/// What a group of rings turned out to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Disjoint simple rings with a winding of 0 or 1 everywhere.
    Clean,
    /// Some rings touch, cross or wind the wrong way: those that [`Sheet::bad`] names.
    Bad,
}

/// A place where rings are not disjoint. Edges are named by the vertex that they start from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Trouble {
    /// Two vertices at the same place.
    Meet(u32, u32),
    /// An edge goes through a vertex.
    Through(u32, u32),
    /// Two edges cross.
    Cross(u32, u32),
}

impl Trouble {
    /// The vertices of what meets.
    pub(crate) fn vertices(self, sheet: &Sheet) -> [u32; 4] {
        let after = |v: u32| sheet.next[v as usize];
        match self {
            Self::Meet(v, w) => [v, w, v, w],
            Self::Through(v, w) => [v, after(v), w, w],
            Self::Cross(v, w) => [v, after(v), w, after(w)],
        }
    }
}

/// Rings, triangulated. Vertex v below `corner.len()` is a corner of a ring; four corners of a box
/// follow, then whatever is inserted.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sheet {
    pub(crate) cdt: Cdt,
    /// The corner (of [`Rims`]) of each vertex.
    pub(crate) corner: Vec<u32>,
    /// The next vertex of the ring.
    pub(crate) next: Vec<u32>,
    /// Which of the group's rings a vertex is on.
    pub(crate) ring: Vec<u32>,
    /// By ring of the group: whether it touches or crosses anything.
    pub(crate) bad: Vec<bool>,
    /// Why.
    pub(crate) trouble: Vec<Trouble>,
    /// By ring of the group: whether it winds the wrong way for the place where it is.
    pub(crate) backward: Vec<bool>,
    /// Bounds of the points.
    pub(crate) low: [f64; 2],
    pub(crate) high: [f64; 2],
    /// Some ring crosses the crease, and some does so without a vertex there.
    pub(crate) creased: bool,
    pub(crate) torn: bool,
    pub(crate) walls: WallScratch,
    order: Vec<(u64, u32)>,
    queue: Vec<u32>,
    on_crease: Vec<u32>,
    seen: Vec<bool>,
}

impl Sheet {
    /// Triangulates rings. A mirrored sheet has x negated, which turns backward rings.
    pub(crate) fn build(
        &mut self,
        rims: &Rims,
        rings: &[u32],
        mirrored: bool,
        crease: bool,
    ) -> Verdict {
        self.load(rims, rings, mirrored);
        let m = self.corner.len();
        insertion_order(&self.cdt.points[..m], self.low, self.high, &mut self.order);
        self.cdt.enclose(self.low, self.high);
        for i in 0..m {
            let v = self.order[i].1;
            // A neighbor on the ring is a better start than whatever came before.
            for near in [self.next[v as usize], v.saturating_sub(1)] {
                let h = self.cdt.outgoing[near as usize];
                if h != NONE {
                    self.cdt.last = h / 3;
                }
            }
            if let Err(other) = self.cdt.insert(v) {
                self.blame(Trouble::Meet(v, other));
            }
        }
        for v in 0..id(m) {
            let w = self.next[v as usize];
            if self.cdt.outgoing[v as usize] == NONE || self.cdt.outgoing[w as usize] == NONE {
                continue;
            }
            match self.cdt.lay(v, w, wall::RIM, &mut self.walls) {
                Laid::Done(_) => {}
                Laid::Touches(other) => self.blame(Trouble::Through(v, other)),
                Laid::Crosses(h) => {
                    let (a, b) = (self.cdt.start(h), self.cdt.end(h));
                    let start = if self.next[a as usize] == b { a } else { b };
                    self.blame(Trouble::Cross(v, start));
                }
            }
        }
        if self.bad.contains(&true) {
            return Verdict::Bad;
        }
        self.wind(id(m));
        if self.backward.contains(&true) {
            return Verdict::Bad;
        }
        self.creased = crease && self.low[1] < 0.0 && self.high[1] > 0.0;
        if self.creased {
            self.torn = (0..m).any(|v| {
                let (y, z) = (self.cdt.points[v][1], self.cdt.point(self.next[v])[1]);
                (y < 0.0 && z > 0.0) || (y > 0.0 && z < 0.0)
            });
            self.follow_crease();
        }
        Verdict::Clean
    }

    fn load(&mut self, rims: &Rims, rings: &[u32], mirrored: bool) {
        self.cdt.points.clear();
        self.corner.clear();
        self.next.clear();
        self.ring.clear();
        self.bad.clear();
        self.bad.resize(rings.len(), false);
        self.trouble.clear();
        self.backward.clear();
        self.backward.resize(rings.len(), false);
        for (i, &r) in (0u32..).zip(rings) {
            let first = id(self.corner.len());
            let corners = rims.ring(r as usize);
            let n = id(corners.len());
            self.corner.extend_from_slice(corners);
            self.ring.extend(corners.iter().map(|_| i));
            self.next.extend((0..n).map(|k| first + (k + 1) % n));
        }
        self.low = [f64::INFINITY; 2];
        self.high = [f64::NEG_INFINITY; 2];
        for &c in &self.corner {
            let mut p = rims.points[c as usize];
            if mirrored {
                p[0] = -p[0];
            }
            self.cdt.points.push(p);
            for (k, x) in p.into_iter().enumerate() {
                self.low[k] = self.low[k].min(x);
                self.high[k] = self.high[k].max(x);
            }
        }
    }

    fn blame(&mut self, trouble: Trouble) {
        let (Trouble::Meet(v, w) | Trouble::Through(v, w) | Trouble::Cross(v, w)) = trouble;
        for v in [v, w] {
            let ring = self.ring[v as usize] as usize;
            self.bad[ring] = true;
        }
        if v != w {
            self.trouble.push(trouble);
        }
    }

    /// The first vertex of a vertex's ring.
    pub(crate) fn first_of_ring(&self, v: u32) -> u32 {
        id(self
            .ring
            .partition_point(|&ring| ring < self.ring[v as usize]))
    }

    /// The vertex before `v` on its ring.
    pub(crate) fn before(&self, v: u32) -> u32 {
        let end = self
            .ring
            .partition_point(|&ring| ring <= self.ring[v as usize]);
        if v == self.first_of_ring(v) {
            id(end - 1)
        } else {
            v - 1
        }
    }

    /// Finds what is inside, from the box inward. A ring that would not take the winding from 0 to
    /// 1 or from 1 to 0 where it is first met, from outside of it, is noted and passed through.
    fn wind(&mut self, box_corner: u32) {
        let cdt = &mut self.cdt;
        cdt.region.fill(UNKNOWN);
        self.seen.clear();
        self.seen.resize(self.bad.len(), false);
        self.queue.clear();
        let first = cdt.outgoing[box_corner as usize] / 3;
        cdt.region[first as usize] = OUTSIDE;
        self.queue.push(first);
        while let Some(t) = self.queue.pop() {
            let here = cdt.region[t as usize];
            for h in [3 * t, 3 * t + 1, 3 * t + 2] {
                let g = cdt.twin[h as usize];
                if g == NONE || cdt.region[(g / 3) as usize] != UNKNOWN {
                    continue;
                }
                let mut there = here;
                if cdt.walls[h as usize] == wall::RIM {
                    let (v, w) = (cdt.start(h), cdt.end(h));
                    let forward = self.next[v as usize] == w;
                    let ring = self.ring[v as usize] as usize;
                    // Left of a ring's edge the winding is one more than right of it.
                    let fits = if forward {
                        here == INSIDE
                    } else {
                        here == OUTSIDE
                    };
                    if !self.seen[ring] {
                        self.seen[ring] = true;
                        self.backward[ring] = !fits;
                    }
                    if !self.backward[ring] {
                        there = 1 - here;
                    }
                }
                cdt.region[(g / 3) as usize] = there;
                self.queue.push(g / 3);
            }
        }
    }

    /// Makes edges between neighbors on the line y = 0, vertices of the rings and of the lattice,
    /// where the line between them lies inside.
    pub(crate) fn follow_crease(&mut self) {
        let cdt = &mut self.cdt;
        self.on_crease.clear();
        self.on_crease.extend(
            (0..id(cdt.points.len()))
                .filter(|&v| cdt.points[v as usize][1] == 0.0 && cdt.outgoing[v as usize] != NONE),
        );
        let m = id(self.corner.len());
        self.on_crease.retain(|v| !(m..m + 4).contains(v));
        self.on_crease
            .sort_unstable_by(|&v, &w| cdt.point(v)[0].total_cmp(&cdt.point(w)[0]));
        for pair in self.on_crease.windows(2) {
            let [v, w] = [pair[0], pair[1]];
            if let Some(h) = cdt.find(v, w) {
                if cdt.walls[h as usize] == wall::FREE && cdt.region[(h / 3) as usize] == INSIDE {
                    cdt.mark(h, wall::CREASE);
                }
            } else if cdt
                .toward(v, w)
                .is_some_and(|t| cdt.region[t as usize] == INSIDE)
            {
                // A ring in between is crossed where it has no vertex: then the crease ends here.
                cdt.lay(v, w, wall::CREASE, &mut self.walls);
            }
        }
    }
}
