//! The band between the loops and the lattice core.
//!
//! Lattice points on the core's boundary are inserted into the triangulation of the loops; its
//! triangles inside the core are excluded.

use super::cdt::insertion_order::insertion_order;
use super::cdt::segment_insertion::SegmentInsertion;
use super::cdt::{Cdt, NONE, constraint};
use super::lattice::Lattice;
use super::loop_triangulation::{INSIDE, LoopTriangulation};
use incise_mesh::index_u32;

/// Region of triangles that the lattice's own triangles replace.
const CORE: u8 = 2;

/// The lattice points that are vertices of the triangulation of the loops.
#[derive(Debug, Clone, Default)]
pub(crate) struct BoundaryBand {
    /// Lattice point of vertex `first + i` of the triangulation.
    pub(crate) lattice: Vec<u32>,
    /// The first vertex that is a corner of neither a loop nor the box.
    pub(crate) first: u32,
    /// Vertex of each lattice point.
    vertex: Vec<u32>,
    points: Vec<[f64; 2]>,
    order: Vec<(u64, u32)>,
    queue: Vec<u32>,
}

impl BoundaryBand {
    pub(crate) fn clear(&mut self, triangulation: &LoopTriangulation) {
        self.lattice.clear();
        self.first = index_u32(triangulation.corner_of.len() + 4);
    }

    /// Inserts the band's lattice points and marks the core.
    ///
    /// Returns false on failure; the triangulation is then invalid.
    pub(crate) fn connect(
        &mut self,
        triangulation: &mut LoopTriangulation,
        lattice: &Lattice,
    ) -> bool {
        self.clear(triangulation);
        self.vertex.clear();
        self.vertex.resize(lattice.points.len(), NONE);
        self.points.clear();
        for (point, &p) in (0u32..).zip(&lattice.points) {
            if lattice.in_band[point as usize] {
                self.vertex[point as usize] = self.first + index_u32(self.lattice.len());
                self.lattice.push(point);
                self.points.push(p);
                triangulation.cdt.push_point(p);
            }
        }
        insertion_order(
            &self.points,
            triangulation.low,
            triangulation.high,
            &mut self.order,
        );
        for &(_, i) in &self.order {
            if triangulation.cdt.insert(self.first + i).is_err() {
                return false;
            }
        }
        self.queue.clear();
        for ends in &lattice.boundary {
            let [v, w] = ends.map(|p| self.vertex[p as usize]);
            if let Some(h) = triangulation.cdt.find_half_edge(v, w) {
                if triangulation.cdt.constraints[h as usize] == constraint::FREE {
                    triangulation.cdt.set_constraint(h, constraint::CORE);
                }
                continue;
            }
            if !matches!(
                triangulation.cdt.insert_segment(
                    v,
                    w,
                    constraint::CORE,
                    &mut triangulation.segments
                ),
                SegmentInsertion::Inserted(_)
            ) {
                return false;
            }
        }
        for ends in &lattice.boundary {
            let [v, w] = ends.map(|p| self.vertex[p as usize]);
            let Some(h) = triangulation.cdt.find_half_edge(v, w) else {
                return false;
            };
            self.add_to_core(&mut triangulation.cdt, h);
        }
        self.flood_core(&mut triangulation.cdt)
    }

    /// Adds the triangle of a half-edge to the core.
    fn add_to_core(&mut self, cdt: &mut Cdt, h: u32) {
        let t = h / 3;
        if cdt.region[t as usize] == INSIDE {
            cdt.region[t as usize] = CORE;
            self.queue.push(t);
        }
    }

    /// Marks all triangles up to the core's boundary. Returns false if it reaches a loop.
    fn flood_core(&mut self, cdt: &mut Cdt) -> bool {
        while let Some(t) = self.queue.pop() {
            for h in [3 * t, 3 * t + 1, 3 * t + 2] {
                let kind = cdt.constraints[h as usize];
                if kind == constraint::LOOP {
                    return false;
                }
                if kind == constraint::FREE {
                    let g = cdt.twin[h as usize];
                    if g == NONE {
                        return false;
                    }
                    self.add_to_core(cdt, g);
                }
            }
        }
        true
    }
}
