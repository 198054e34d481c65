//! A constrained Delaunay triangulation that grows point by point, over flat arrays.
//!
//! Half-edge 3t + i runs from corner i of triangle t to corner i + 1, as in the surface itself.
//! Everything lies in a box of two triangles that is larger than what will be inserted, so there
//! is no hull to care for. Every decision is a sign of `robust`'s exact predicates.

use robust::{Coord, incircle, orient2d};

/// No half-edge, no vertex.
pub(crate) const NONE: u32 = u32::MAX;

/// What a half-edge is to the section.
pub(crate) mod wall {
    /// An edge that may be flipped.
    pub(crate) const FREE: u8 = 0;
    /// An edge of a loop.
    pub(crate) const RIM: u8 = 1;
    /// An edge on the crease.
    pub(crate) const CREASE: u8 = 2;
    /// An edge between the band and the lattice.
    pub(crate) const CORE: u8 = 3;
}

/// Where a point lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    /// Inside a triangle.
    Face(u32),
    /// Inside a half-edge.
    Edge(u32),
    /// On a vertex.
    Vertex(u32),
}

/// The triangulation.
#[derive(Debug, Default, Clone)]
pub(crate) struct Cdt {
    /// Vertices; the box's corners are somewhere among them.
    pub(crate) points: Vec<[f64; 2]>,
    /// Start vertex of each half-edge.
    pub(crate) origin: Vec<u32>,
    /// The same edge in the next triangle, [`NONE`] at the box.
    pub(crate) twin: Vec<u32>,
    /// One of [`wall`] a half-edge, the same on both sides.
    pub(crate) walls: Vec<u8>,
    /// A half-edge that starts at each vertex, [`NONE`] for one that is not inserted.
    pub(crate) outgoing: Vec<u32>,
    /// A number a triangle that its parts inherit.
    pub(crate) region: Vec<u8>,
    pub(crate) stack: Vec<u32>,
    /// The triangle from which the next search starts.
    pub(crate) last: u32,
}

/// The side after `h` in its triangle.
pub(crate) const fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// The side before `h` in its triangle.
pub(crate) const fn prev(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

#[inline]
fn coord([x, y]: [f64; 2]) -> Coord<f64> {
    Coord { x, y }
}

/// Positive where `c` is left of the line from `a` to `b`. The sign is exact.
#[inline]
pub(crate) fn orient(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    orient2d(coord(a), coord(b), coord(c))
}

/// Positive where `p` lies inside the circle through a counterclockwise triangle. The sign is exact.
#[inline]
pub(crate) fn incircle_of([a, b, c]: [[f64; 2]; 3], p: [f64; 2]) -> f64 {
    incircle(coord(a), coord(b), coord(c), coord(p))
}

impl Cdt {
    /// Forgets everything and puts up the box around `low` and `high`. The points are the caller's
    /// to push before and after; the four corners are pushed here and the first one's id returned.
    pub(crate) fn enclose(&mut self, low: [f64; 2], high: [f64; 2]) -> u32 {
        for list in [&mut self.origin, &mut self.twin, &mut self.outgoing] {
            list.clear();
        }
        self.walls.clear();
        self.region.clear();
        self.last = 0;
        let first = id(self.points.len());
        let margin = (high[0] - low[0]).max(high[1] - low[1]).max(f64::EPSILON);
        let (x0, y0) = (low[0] - margin, low[1] - margin);
        let (x1, y1) = (high[0] + margin, high[1] + margin);
        self.points.extend([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]);
        self.outgoing.resize(self.points.len(), NONE);
        let (t, u) = (self.push(0), self.push(0));
        self.set(t, [first, first + 1, first + 2]);
        self.set(u, [first, first + 2, first + 3]);
        self.link(3 * t + 2, 3 * u, wall::FREE);
        first
    }

    /// A point that can be inserted next.
    pub(crate) fn push_point(&mut self, p: [f64; 2]) -> u32 {
        self.points.push(p);
        self.outgoing.push(NONE);
        id(self.points.len() - 1)
    }

    /// Takes back the last point, which is not inserted.
    pub(crate) fn pop_point(&mut self) {
        self.points.pop();
        self.outgoing.pop();
    }

    /// Becomes a copy of what `other` looks like, for searches.
    pub(crate) fn copy_shape(&mut self, other: &Self) {
        self.points.clone_from(&other.points);
        self.origin.clone_from(&other.origin);
        self.twin.clone_from(&other.twin);
        self.region.clone_from(&other.region);
        self.outgoing.clone_from(&other.outgoing);
        self.last = 0;
    }

    pub(crate) fn triangles(&self) -> u32 {
        id(self.region.len())
    }

    #[inline]
    pub(crate) fn corners(&self, t: u32) -> [u32; 3] {
        let t = 3 * t as usize;
        [self.origin[t], self.origin[t + 1], self.origin[t + 2]]
    }

    /// Where a triangle's corners are.
    #[inline]
    pub(crate) fn places(&self, t: u32) -> [[f64; 2]; 3] {
        let [a, b, c] = self.corners(t);
        [self.point(a), self.point(b), self.point(c)]
    }

    #[inline]
    pub(crate) fn start(&self, h: u32) -> u32 {
        self.origin[h as usize]
    }

    #[inline]
    pub(crate) fn end(&self, h: u32) -> u32 {
        self.origin[next(h) as usize]
    }

    /// The corner across from `h`.
    #[inline]
    pub(crate) fn apex(&self, h: u32) -> u32 {
        self.origin[prev(h) as usize]
    }

    #[inline]
    pub(crate) fn point(&self, v: u32) -> [f64; 2] {
        self.points[v as usize]
    }

    #[inline]
    pub(crate) fn side(&self, a: u32, b: u32, c: u32) -> f64 {
        orient(self.point(a), self.point(b), self.point(c))
    }

    /// The half-edge from `a` to `b`. `a` must not be a corner of the box.
    pub(crate) fn find(&self, a: u32, b: u32) -> Option<u32> {
        let first = self.outgoing[a as usize];
        let mut h = first;
        while h != NONE {
            if self.end(h) == b {
                return Some(h);
            }
            h = self.twin[prev(h) as usize];
            if h == first {
                break;
            }
        }
        None
    }

    /// Inserts vertex `v` and makes the triangulation Delaunay around it. Where another vertex has
    /// the same coordinates that one is returned and nothing changes.
    pub(crate) fn insert(&mut self, v: u32) -> Result<(), u32> {
        match self.locate(self.point(v), self.last) {
            Place::Vertex(other) => return Err(other),
            Place::Face(t) => self.split_face(t, v),
            Place::Edge(h) => self.split_edge(h, v),
        }
        self.last = self.outgoing[v as usize] / 3;
        self.legalize();
        Ok(())
    }

    /// Walks from triangle `start` toward `p`, which must lie in the box.
    pub(crate) fn locate(&self, p: [f64; 2], start: u32) -> Place {
        let (mut t, mut from) = (start, NONE);
        // With walls a walk can turn in circles; then every triangle is looked at.
        let limit = 64 + self.region.len();
        'walk: for step in 0u32.. {
            if step as usize > limit {
                break;
            }
            let (mut zeros, mut zero) = (0, NONE);
            let places = self.places(t);
            for i in 0..3 {
                let k = (i + step) % 3;
                let h = 3 * t + k;
                if h == from {
                    continue;
                }
                let side = orient(places[k as usize], places[(k as usize + 1) % 3], p);
                if side < 0.0 {
                    from = self.twin[h as usize];
                    t = from / 3;
                    continue 'walk;
                }
                if side == 0.0 {
                    zeros += 1;
                    zero = h;
                }
            }
            return self.place(t, zeros, zero, p);
        }
        for t in 0..self.triangles() {
            let sides = [3 * t, 3 * t + 1, 3 * t + 2].map(|h| {
                (
                    orient(self.point(self.start(h)), self.point(self.end(h)), p),
                    h,
                )
            });
            if sides.iter().all(|&(side, _)| side >= 0.0) {
                let zeros = sides.iter().filter(|s| s.0 == 0.0);
                let zero = zeros.clone().next().map_or(NONE, |s| s.1);
                return self.place(t, zeros.count(), zero, p);
            }
        }
        Place::Face(start)
    }

    fn place(&self, t: u32, zeros: usize, zero: u32, p: [f64; 2]) -> Place {
        match zeros {
            0 => Place::Face(t),
            1 => Place::Edge(zero),
            _ => self
                .corners(t)
                .into_iter()
                .find(|&v| self.point(v) == p)
                .map_or(Place::Edge(zero), Place::Vertex),
        }
    }

    fn push(&mut self, region: u8) -> u32 {
        let t = self.triangles();
        self.origin.extend_from_slice(&[NONE; 3]);
        self.twin.extend_from_slice(&[NONE; 3]);
        self.walls.extend_from_slice(&[wall::FREE; 3]);
        self.region.push(region);
        t
    }

    fn set(&mut self, t: u32, corners: [u32; 3]) {
        for (h, v) in (3 * t..).zip(corners) {
            self.origin[h as usize] = v;
            self.outgoing[v as usize] = h;
        }
    }

    fn link(&mut self, h: u32, g: u32, wall: u8) {
        self.twin[h as usize] = g;
        self.walls[h as usize] = wall;
        if g != NONE {
            self.twin[g as usize] = h;
            self.walls[g as usize] = wall;
        }
    }

    /// What lies across `h`: its twin and its wall.
    fn across(&self, h: u32) -> (u32, u8) {
        (self.twin[h as usize], self.walls[h as usize])
    }

    fn split_face(&mut self, t: u32, v: u32) {
        let [a, b, c] = self.corners(t);
        let outer = [3 * t, 3 * t + 1, 3 * t + 2].map(|h| self.across(h));
        let region = self.region[t as usize];
        let parts = [t, self.push(region), self.push(region)];
        for (part, ends) in parts.into_iter().zip([[a, b, v], [b, c, v], [c, a, v]]) {
            self.set(part, ends);
        }
        for i in 0..3 {
            self.link(3 * parts[i], outer[i].0, outer[i].1);
            self.link(3 * parts[i] + 1, 3 * parts[(i + 1) % 3] + 2, wall::FREE);
        }
        self.stack
            .extend_from_slice(&[3 * parts[0], 3 * parts[1], 3 * parts[2]]);
    }

    /// Puts `v` between the ends of `h`, which is not on the box. Both halves stay what `h` was.
    pub(crate) fn split_edge(&mut self, h: u32, v: u32) {
        let g = self.twin[h as usize];
        let (a, b, c, d) = (self.start(h), self.end(h), self.apex(h), self.apex(g));
        let kind = self.walls[h as usize];
        let outer = [prev(h), next(h), prev(g), next(g)].map(|h| self.across(h));
        let (above, below) = (h / 3, g / 3);
        let (over, under) = (self.region[above as usize], self.region[below as usize]);
        let parts = [above, self.push(over), below, self.push(under)];
        let ends = [[c, a, v], [b, c, v], [d, b, v], [a, d, v]];
        for i in 0..4 {
            self.set(parts[i], ends[i]);
            self.link(3 * parts[i], outer[i].0, outer[i].1);
        }
        let [t, t1, u, u1] = parts.map(|part| 3 * part);
        self.link(t + 1, u1 + 2, kind);
        self.link(t1 + 2, u + 1, kind);
        self.link(t + 2, t1 + 1, wall::FREE);
        self.link(u + 2, u1 + 1, wall::FREE);
        self.stack.extend_from_slice(&[t, t1, u, u1]);
    }

    /// Turns the edge `h` to the other diagonal of its two triangles, which must form a strictly
    /// convex quadrilateral. Returns the four sides: first the two that `h`'s apex sees.
    pub(crate) fn flip(&mut self, h: u32) -> [u32; 4] {
        let g = self.twin[h as usize];
        let (a, b, c, d) = (self.start(h), self.end(h), self.apex(h), self.apex(g));
        let outer = [next(g), prev(g), next(h), prev(h)].map(|h| self.across(h));
        let (t, u) = (h / 3, g / 3);
        self.set(t, [a, d, c]);
        self.set(u, [d, b, c]);
        let sides = [3 * t, 3 * u, 3 * u + 1, 3 * t + 2];
        for (side, (twin, wall)) in sides.into_iter().zip(outer) {
            self.link(side, twin, wall);
        }
        self.link(3 * t + 1, 3 * u + 2, wall::FREE);
        sides
    }

    /// Whether the edge `h` may and must be flipped to be Delaunay.
    #[inline]
    pub(crate) fn is_illegal(&self, h: u32) -> bool {
        let g = self.twin[h as usize];
        if g == NONE || self.walls[h as usize] != wall::FREE {
            return false;
        }
        let [a, b, c, d] =
            [self.start(h), self.end(h), self.apex(h), self.apex(g)].map(|v| coord(self.point(v)));
        incircle(a, b, c, d) > 0.0
    }

    /// Flips what the triangles around a new vertex ask for; the stack holds the sides across
    /// from it.
    pub(crate) fn legalize(&mut self) {
        while let Some(h) = self.stack.pop() {
            if self.is_illegal(h) {
                let sides = self.flip(h);
                self.stack.extend_from_slice(&sides[..2]);
            }
        }
    }

    /// Flips until every edge that the stack leads to is Delaunay.
    pub(crate) fn legalize_all(&mut self) {
        while let Some(h) = self.stack.pop() {
            if self.is_illegal(h) {
                let sides = self.flip(h);
                self.stack.extend(sides);
            }
        }
    }
}

pub(crate) fn id(i: usize) -> u32 {
    u32::try_from(i).expect("a cover has fewer than 2^32 vertices and half-edges")
}
