//! Constrained Delaunay triangulation of a group of loops, and its inside.
//!
//! [`super::triangulate_section`] builds one for each group; [`super::repair_loops`] rebuilds it
//! with other loops where it reports intersections.

use super::cdt::insertion_order::insertion_order;
use super::cdt::segment_insertion::{SegmentInsertion, SegmentScratch};
use super::cdt::{Cdt, NONE, constraint};
use super::loops::SectionLoops;
use incise_mesh::index_u32;

/// Region of a triangle that the flood fill has not reached.
const UNKNOWN: u8 = u8::MAX;
/// Region of triangles outside of the section.
pub(crate) const OUTSIDE: u8 = 0;
/// Region of triangles inside the section.
pub(crate) const INSIDE: u8 = 1;

/// Whether a group of loops bounds a region of the plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LoopValidity {
    /// Disjoint simple loops with winding number 0 or 1 everywhere.
    Valid,
    /// Some loops touch, cross or have the wrong orientation.
    ///
    /// See [`LoopTriangulation::intersecting`] and [`LoopTriangulation::misoriented`].
    Invalid,
}

/// An intersection of loops; an edge is named by its first vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Intersection {
    /// Two vertices have the same position.
    Coincident(u32, u32),
    /// An edge passes through a vertex.
    VertexOnEdge(u32, u32),
    /// Two edges cross.
    Crossing(u32, u32),
}

impl Intersection {
    /// Returns the vertices of the two intersecting elements.
    pub(crate) fn vertices(self, triangulation: &LoopTriangulation) -> [u32; 4] {
        let after = |v: u32| triangulation.next[v as usize];
        match self {
            Self::Coincident(v, w) => [v, w, v, w],
            Self::VertexOnEdge(v, w) => [v, after(v), w, w],
            Self::Crossing(v, w) => [v, after(v), w, after(w)],
        }
    }
}

/// The triangulation of a group of loops.
///
/// Vertices below `corner_of.len()` are corners of loops. The four corners of the bounding box
/// follow, then Steiner points.
#[derive(Debug, Clone, Default)]
pub(crate) struct LoopTriangulation {
    pub(crate) cdt: Cdt,
    /// The corner (of [`SectionLoops`]) of each vertex.
    pub(crate) corner_of: Vec<u32>,
    /// The next vertex on the loop of each vertex.
    pub(crate) next: Vec<u32>,
    /// The loop, by its index in the group, of each vertex.
    pub(crate) loop_of: Vec<u32>,
    /// Whether each loop of the group intersects itself or another one.
    pub(crate) intersecting: Vec<bool>,
    /// All intersections found.
    pub(crate) intersections: Vec<Intersection>,
    /// Whether each loop of the group has the wrong orientation for its nesting depth.
    pub(crate) misoriented: Vec<bool>,
    /// Bounding box of the loops, lower corner.
    pub(crate) low: [f64; 2],
    /// Bounding box of the loops, upper corner.
    pub(crate) high: [f64; 2],
    pub(crate) segments: SegmentScratch,
    order: Vec<(u64, u32)>,
    queue: Vec<u32>,
    seen: Vec<bool>,
}

impl LoopTriangulation {
    /// Triangulates a group of loops; `mirrored` negates x and so reverses their orientation.
    pub(crate) fn build(
        &mut self,
        loops: &SectionLoops,
        group: &[u32],
        mirrored: bool,
    ) -> LoopValidity {
        self.load(loops, group, mirrored);
        let m = self.corner_of.len();
        insertion_order(&self.cdt.points[..m], self.low, self.high, &mut self.order);
        self.cdt.reset_to_box(self.low, self.high);
        for i in 0..m {
            let v = self.order[i].1;
            // A neighbor on the loop is a better start than the last insertion.
            for near in [self.next[v as usize], v.saturating_sub(1)] {
                let h = self.cdt.outgoing[near as usize];
                if h != NONE {
                    self.cdt.last = h / 3;
                }
            }
            if let Err(other) = self.cdt.insert(v) {
                self.add_intersection(Intersection::Coincident(v, other));
            }
        }
        for v in 0..index_u32(m) {
            let w = self.next[v as usize];
            if self.cdt.outgoing[v as usize] == NONE || self.cdt.outgoing[w as usize] == NONE {
                continue;
            }
            match self
                .cdt
                .insert_segment(v, w, constraint::LOOP, &mut self.segments)
            {
                SegmentInsertion::Inserted(_) => {}
                SegmentInsertion::PassesVertex(other) => {
                    self.add_intersection(Intersection::VertexOnEdge(v, other))
                }
                SegmentInsertion::CrossesConstraint(h) => {
                    let (a, b) = (self.cdt.start(h), self.cdt.end(h));
                    let start = if self.next[a as usize] == b { a } else { b };
                    self.add_intersection(Intersection::Crossing(v, start));
                }
            }
        }
        if self.intersecting.contains(&true) {
            return LoopValidity::Invalid;
        }
        self.classify_regions(index_u32(m));
        if self.misoriented.contains(&true) {
            return LoopValidity::Invalid;
        }
        LoopValidity::Valid
    }

    /// Copies the corners of the loops and computes their bounding box.
    fn load(&mut self, loops: &SectionLoops, group: &[u32], mirrored: bool) {
        self.cdt.points.clear();
        self.corner_of.clear();
        self.next.clear();
        self.loop_of.clear();
        self.intersecting.clear();
        self.intersecting.resize(group.len(), false);
        self.intersections.clear();
        self.misoriented.clear();
        self.misoriented.resize(group.len(), false);
        for (i, &r) in (0u32..).zip(group) {
            let first = index_u32(self.corner_of.len());
            let corners = loops.corners(r as usize);
            let n = index_u32(corners.len());
            self.corner_of.extend_from_slice(corners);
            self.loop_of.extend(corners.iter().map(|_| i));
            self.next.extend((0..n).map(|k| first + (k + 1) % n));
        }
        self.low = [f64::INFINITY; 2];
        self.high = [f64::NEG_INFINITY; 2];
        for &c in &self.corner_of {
            let mut p = loops.points[c as usize];
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

    fn add_intersection(&mut self, intersection: Intersection) {
        let (Intersection::Coincident(v, w)
        | Intersection::VertexOnEdge(v, w)
        | Intersection::Crossing(v, w)) = intersection;
        for v in [v, w] {
            let index = self.loop_of[v as usize] as usize;
            self.intersecting[index] = true;
        }
        if v != w {
            self.intersections.push(intersection);
        }
    }

    /// Returns the first vertex of a vertex's loop.
    pub(crate) fn first_of_loop(&self, v: u32) -> u32 {
        index_u32(
            self.loop_of
                .partition_point(|&index| index < self.loop_of[v as usize]),
        )
    }

    /// Returns the vertex before `v` on its loop.
    pub(crate) fn prev(&self, v: u32) -> u32 {
        let end = self
            .loop_of
            .partition_point(|&index| index <= self.loop_of[v as usize]);
        if v == self.first_of_loop(v) {
            index_u32(end - 1)
        } else {
            v - 1
        }
    }

    /// Classifies triangles as inside or outside by a flood fill from the box.
    ///
    /// Crossing a loop from outside must change the winding number from 0 to 1 or from 1 to 0. A
    /// loop that does not is marked as misoriented and ignored.
    fn classify_regions(&mut self, box_corner: u32) {
        let cdt = &mut self.cdt;
        cdt.region.fill(UNKNOWN);
        self.seen.clear();
        self.seen.resize(self.intersecting.len(), false);
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
                if cdt.constraints[h as usize] == constraint::LOOP {
                    let (v, w) = (cdt.start(h), cdt.end(h));
                    let forward = self.next[v as usize] == w;
                    let index = self.loop_of[v as usize] as usize;
                    // The winding number left of a loop's edge is one more than right of it.
                    let fits = if forward {
                        here == INSIDE
                    } else {
                        here == OUTSIDE
                    };
                    if !self.seen[index] {
                        self.seen[index] = true;
                        self.misoriented[index] = !fits;
                    }
                    if !self.misoriented[index] {
                        there = 1 - here;
                    }
                }
                cdt.region[(g / 3) as usize] = there;
                self.queue.push(g / 3);
            }
        }
    }
}
