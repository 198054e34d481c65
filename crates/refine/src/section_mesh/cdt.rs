//! Incremental constrained Delaunay triangulation (CDT) over flat arrays.
//!
//! Half-edge 3t + i runs from corner i of triangle t to corner i + 1, as in
//! [`incise_mesh::Topology`]. Two triangles form a bounding box around all points, so no convex
//! hull is maintained. Every decision is an exact sign, see [`predicates`].
//!
//! This is not [`incise_mesh::Edit`]: a triangulation in the plane has no attributes, no undo and
//! no non-manifold vertices, and flips are its inner loop. [`Cdt::flip`] and [`Cdt::split_edge`]
//! are the only flip and split of this module's users. Triangles in space, such as those of holes,
//! use [`crate::EdgeDictionary`] instead.

pub(crate) mod insertion_order;
mod location;
mod predicates;
pub(crate) mod segment_insertion;

use incise_mesh::index_u32;
pub(crate) use location::Location;
pub(crate) use predicates::{is_in_circle, orient};

/// The null half-edge and the null vertex.
pub(crate) const NONE: u32 = u32::MAX;

/// The kinds of constraint that a half-edge can have.
pub(crate) mod constraint {
    /// No constraint: the edge may be flipped.
    pub(crate) const FREE: u8 = 0;
    /// An edge of a loop.
    pub(crate) const LOOP: u8 = 1;
    /// An edge between the boundary band and the lattice core.
    pub(crate) const CORE: u8 = 2;
}

/// An edge on the boundary of a cavity.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinkEdge {
    /// Start and end of the half-edge inside the cavity.
    pub(crate) ends: [u32; 2],
    /// The half-edge outside of the cavity.
    pub(crate) outside: u32,
    pub(crate) constraint: u8,
}

/// A constrained Delaunay triangulation inside a bounding box.
#[derive(Debug, Default, Clone)]
pub(crate) struct Cdt {
    /// Positions of vertices, inserted or not, including the four corners of the box.
    pub(crate) points: Vec<[f64; 2]>,
    /// Corners of each triangle: the origin vertices of its half-edges.
    corners: Vec<[u32; 3]>,
    /// Opposite half-edge of each half-edge, [`NONE`] on the box.
    pub(crate) twin: Vec<u32>,
    /// [`constraint`] kind of each half-edge, equal on both half-edges of an edge.
    pub(crate) constraints: Vec<u8>,
    /// An outgoing half-edge of each vertex, [`NONE`] for a vertex that is not inserted.
    pub(crate) outgoing: Vec<u32>,
    /// Region number of each triangle; the parts of a split triangle inherit it.
    pub(crate) region: Vec<u8>,
    /// Half-edges to test for the Delaunay property, see [`Self::legalize`].
    pub(crate) stack: Vec<u32>,
    /// Triangle at which the next point location starts.
    pub(crate) last: u32,
}

/// Returns the half-edge after `h` in its triangle.
pub(crate) const fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// Returns the half-edge before `h` in its triangle.
pub(crate) const fn prev(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

impl Cdt {
    /// Resets the triangulation to a bounding box around `low` and `high`.
    ///
    /// `points` is kept; the caller pushes points before and after. Pushes the four corners of the
    /// box and returns the first corner's id.
    pub(crate) fn reset_to_box(&mut self, low: [f64; 2], high: [f64; 2]) -> u32 {
        self.corners.clear();
        self.twin.clear();
        self.outgoing.clear();
        self.constraints.clear();
        self.region.clear();
        self.last = 0;
        let first = index_u32(self.points.len());
        let margin = (high[0] - low[0]).max(high[1] - low[1]).max(f64::EPSILON);
        let (x0, y0) = (low[0] - margin, low[1] - margin);
        let (x1, y1) = (high[0] + margin, high[1] + margin);
        self.points.extend([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]);
        self.outgoing.resize(self.points.len(), NONE);
        let (t, u) = (self.push_triangle(0), self.push_triangle(0));
        self.set(t, [first, first + 1, first + 2]);
        self.set(u, [first, first + 2, first + 3]);
        self.set_twins(3 * t + 2, 3 * u, constraint::FREE);
        first
    }

    /// Appends a point without inserting it and returns its vertex id.
    pub(crate) fn push_point(&mut self, p: [f64; 2]) -> u32 {
        self.points.push(p);
        self.outgoing.push(NONE);
        index_u32(self.points.len() - 1)
    }

    /// Copies the triangles of `other`, without constraints, for point location.
    pub(crate) fn copy_triangles(&mut self, other: &Self) {
        self.points.clone_from(&other.points);
        self.corners.clone_from(&other.corners);
        self.twin.clone_from(&other.twin);
        self.region.clone_from(&other.region);
        self.outgoing.clone_from(&other.outgoing);
        self.last = 0;
    }

    /// Returns the number of triangles, those of the box included.
    pub(crate) fn triangles(&self) -> u32 {
        index_u32(self.region.len())
    }

    #[inline]
    pub(crate) fn corners(&self, t: u32) -> [u32; 3] {
        self.corners[t as usize]
    }

    /// Returns the corner positions of a triangle.
    #[inline]
    pub(crate) fn corner_points(&self, t: u32) -> [[f64; 2]; 3] {
        let [a, b, c] = self.corners(t);
        [self.point(a), self.point(b), self.point(c)]
    }

    #[inline]
    pub(crate) fn start(&self, h: u32) -> u32 {
        self.corners.as_flattened()[h as usize]
    }

    #[inline]
    pub(crate) fn end(&self, h: u32) -> u32 {
        self.start(next(h))
    }

    /// Returns the corner opposite to `h` in its triangle.
    #[inline]
    pub(crate) fn opposite(&self, h: u32) -> u32 {
        self.start(prev(h))
    }

    #[inline]
    pub(crate) fn point(&self, v: u32) -> [f64; 2] {
        self.points[v as usize]
    }

    /// Returns [`orient`] of three vertices.
    #[inline]
    pub(crate) fn orientation(&self, a: u32, b: u32, c: u32) -> f64 {
        orient(self.point(a), self.point(b), self.point(c))
    }

    /// Returns the half-edge from `a` to `b`; `a` must not be a corner of the box.
    pub(crate) fn find_half_edge(&self, a: u32, b: u32) -> Option<u32> {
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

    /// Inserts vertex `v` and restores the Delaunay property around it.
    ///
    /// Returns the other vertex as the error if one has the same coordinates; nothing changes then.
    pub(crate) fn insert(&mut self, v: u32) -> Result<(), u32> {
        match self.locate(self.point(v), self.last) {
            Location::Vertex(other) => return Err(other),
            Location::Face(t) => self.split_face(t, v),
            Location::Edge(h) => self.split_edge(h, v),
        }
        self.last = self.outgoing[v as usize] / 3;
        self.legalize();
        Ok(())
    }

    /// Replaces the triangles of a cavity by a fan around vertex `v` (Bowyer 1981, Watson 1981).
    ///
    /// `link` are the edges on the boundary of the cavity, all visible from `v`. The result is that
    /// of [`Self::insert`] if the cavity holds all triangles whose circumcircle contains `v`.
    pub(crate) fn insert_in_cavity(&mut self, v: u32, cavity: &mut Vec<u32>, link: &[LinkEdge]) {
        let region = self.region[cavity[0] as usize];
        while cavity.len() < link.len() {
            cavity.push(self.push_triangle(region));
        }
        for (&t, edge) in cavity.iter().zip(link) {
            let [a, b] = edge.ends;
            self.corners[t as usize] = [a, b, v];
            self.outgoing[a as usize] = 3 * t;
            self.set_twins(3 * t, edge.outside, edge.constraint);
        }
        for (&t, edge) in cavity.iter().zip(link) {
            let after = self.outgoing[edge.ends[1] as usize];
            self.set_twins(3 * t + 1, after + 2, constraint::FREE);
        }
        self.outgoing[v as usize] = 3 * cavity[0] + 2;
    }

    /// Appends a triangle without corners and returns its id.
    fn push_triangle(&mut self, region: u8) -> u32 {
        let t = self.triangles();
        self.corners.push([NONE; 3]);
        self.twin.extend_from_slice(&[NONE; 3]);
        self.constraints.extend_from_slice(&[constraint::FREE; 3]);
        self.region.push(region);
        t
    }

    fn set(&mut self, t: u32, corners: [u32; 3]) {
        self.corners[t as usize] = corners;
        for (h, v) in (3 * t..).zip(corners) {
            self.outgoing[v as usize] = h;
        }
    }

    /// Makes `h` and `g` twins with the constraint `kind`.
    fn set_twins(&mut self, h: u32, g: u32, kind: u8) {
        self.twin[h as usize] = g;
        self.constraints[h as usize] = kind;
        if g != NONE {
            self.twin[g as usize] = h;
            self.constraints[g as usize] = kind;
        }
    }

    /// Returns the twin and the constraint of `h`.
    pub(crate) fn twin_and_constraint(&self, h: u32) -> (u32, u8) {
        (self.twin[h as usize], self.constraints[h as usize])
    }

    /// Splits triangle `t` into three around `v` and pushes its sides on the stack.
    fn split_face(&mut self, t: u32, v: u32) {
        let [a, b, c] = self.corners(t);
        let outer = [3 * t, 3 * t + 1, 3 * t + 2].map(|h| self.twin_and_constraint(h));
        let region = self.region[t as usize];
        let parts = [t, self.push_triangle(region), self.push_triangle(region)];
        for (part, ends) in parts.into_iter().zip([[a, b, v], [b, c, v], [c, a, v]]) {
            self.set(part, ends);
        }
        for i in 0..3 {
            self.set_twins(3 * parts[i], outer[i].0, outer[i].1);
            self.set_twins(
                3 * parts[i] + 1,
                3 * parts[(i + 1) % 3] + 2,
                constraint::FREE,
            );
        }
        self.stack
            .extend_from_slice(&[3 * parts[0], 3 * parts[1], 3 * parts[2]]);
    }

    /// Splits edge `h`, which must not be on the box, at `v`.
    ///
    /// Both halves keep the constraint of `h`. Pushes the four outer sides on the stack.
    pub(crate) fn split_edge(&mut self, h: u32, v: u32) {
        let g = self.twin[h as usize];
        let (a, b, c, d) = (
            self.start(h),
            self.end(h),
            self.opposite(h),
            self.opposite(g),
        );
        let kind = self.constraints[h as usize];
        let outer = [prev(h), next(h), prev(g), next(g)].map(|h| self.twin_and_constraint(h));
        let (above, below) = (h / 3, g / 3);
        let (over, under) = (self.region[above as usize], self.region[below as usize]);
        let parts = [
            above,
            self.push_triangle(over),
            below,
            self.push_triangle(under),
        ];
        let ends = [[c, a, v], [b, c, v], [d, b, v], [a, d, v]];
        for i in 0..4 {
            self.set(parts[i], ends[i]);
            self.set_twins(3 * parts[i], outer[i].0, outer[i].1);
        }
        let [t, t1, u, u1] = parts.map(|part| 3 * part);
        self.set_twins(t + 1, u1 + 2, kind);
        self.set_twins(t1 + 2, u + 1, kind);
        self.set_twins(t + 2, t1 + 1, constraint::FREE);
        self.set_twins(u + 2, u1 + 1, constraint::FREE);
        self.stack.extend_from_slice(&[t, t1, u, u1]);
    }

    /// Flips edge `h`, whose two triangles must form a strictly convex quadrilateral.
    ///
    /// Returns the four sides of the quadrilateral, first the two across from `h`'s opposite
    /// corner.
    pub(crate) fn flip(&mut self, h: u32) -> [u32; 4] {
        let g = self.twin[h as usize];
        let (a, b, c, d) = (
            self.start(h),
            self.end(h),
            self.opposite(h),
            self.opposite(g),
        );
        let outer = [next(g), prev(g), next(h), prev(h)].map(|h| self.twin_and_constraint(h));
        let (t, u) = (h / 3, g / 3);
        self.set(t, [a, d, c]);
        self.set(u, [d, b, c]);
        let sides = [3 * t, 3 * u, 3 * u + 1, 3 * t + 2];
        for (side, (twin, kind)) in sides.into_iter().zip(outer) {
            self.set_twins(side, twin, kind);
        }
        self.set_twins(3 * t + 1, 3 * u + 2, constraint::FREE);
        sides
    }

    /// Returns whether edge `h` is unconstrained and not Delaunay.
    #[inline]
    pub(crate) fn is_illegal(&self, h: u32) -> bool {
        let g = self.twin[h as usize];
        if g == NONE || self.constraints[h as usize] != constraint::FREE {
            return false;
        }
        let [a, b, c, d] = [
            self.start(h),
            self.end(h),
            self.opposite(h),
            self.opposite(g),
        ]
        .map(|v| self.point(v));
        is_in_circle([a, b, c], d)
    }

    /// Restores the Delaunay property around a new vertex by Lawson flips.
    ///
    /// The stack holds the sides opposite to the new vertex.
    pub(crate) fn legalize(&mut self) {
        while let Some(h) = self.stack.pop() {
            if self.is_illegal(h) {
                let sides = self.flip(h);
                self.stack.extend_from_slice(&sides[..2]);
            }
        }
    }

    /// Restores the Delaunay property of any edges on the stack by Lawson flips.
    pub(crate) fn legalize_all(&mut self) {
        while let Some(h) = self.stack.pop() {
            if self.is_illegal(h) {
                let sides = self.flip(h);
                self.stack.extend(sides);
            }
        }
    }
}
