//! A closed surface in 64 bits during its generation: a corner table with edge collapse and flip.
//!
//! This is not [`incise_mesh::Edit`], whose positions have 32 bits: collapses and smoothing would
//! accumulate rounding. It also needs no log, attributes or boundaries.

use incise_mesh::Topology;
use incise_mesh::Vec3;
use incise_mesh::{HalfEdge, VertexId};

/// A closed oriented surface. Removed triangles and vertices keep their slots, marked by null.
#[derive(Debug)]
pub(super) struct Shell {
    /// Positions, shape \[vertex slots\].
    pub(super) points: Vec<Vec3>,
    origin: Vec<VertexId>,
    twin: Vec<HalfEdge>,
    outgoing: Vec<HalfEdge>,
    live_triangles: usize,
}

impl Shell {
    /// Connects the triangles of a closed surface.
    ///
    /// # Panics
    /// If the triangles do not form a closed oriented manifold.
    pub(super) fn new(points: Vec<Vec3>, triangles: &[[u32; 3]]) -> Self {
        let topology = Topology::from_triangles(points.len(), triangles)
            .expect("the caller makes an oriented manifold");
        assert!(topology.is_closed(), "the caller makes a closed surface");
        let half_edges = || (0..3 * triangles.len()).map(HalfEdge::from_index);
        Self {
            origin: half_edges().map(|h| topology.origin(h)).collect(),
            twin: half_edges().map(|h| topology.twin(h)).collect(),
            outgoing: (0..points.len())
                .map(|v| topology.outgoing(VertexId::from_index(v)))
                .collect(),
            live_triangles: triangles.len(),
            points,
        }
    }

    pub(super) fn live_triangles(&self) -> usize {
        self.live_triangles
    }

    pub(super) fn point(&self, v: VertexId) -> Vec3 {
        self.points[v.index()]
    }

    pub(super) fn origin(&self, h: HalfEdge) -> VertexId {
        self.origin[h.index()]
    }

    pub(super) fn target(&self, h: HalfEdge) -> VertexId {
        self.origin[h.next().index()]
    }

    pub(super) fn twin(&self, h: HalfEdge) -> HalfEdge {
        self.twin[h.index()]
    }

    /// Returns the corners of the triangle of `h`, starting at its origin.
    pub(super) fn corners(&self, h: HalfEdge) -> [VertexId; 3] {
        [h, h.next(), h.prev()].map(|h| self.origin(h))
    }

    /// Iterates over the vertices, in slot order.
    pub(super) fn vertices(&self) -> impl Iterator<Item = VertexId> + '_ {
        (0..self.outgoing.len())
            .map(VertexId::from_index)
            .filter(|v| !self.outgoing[v.index()].is_null())
    }

    /// Iterates over one half-edge of every edge, in slot order.
    pub(super) fn edges(&self) -> impl Iterator<Item = HalfEdge> + '_ {
        (0..self.origin.len())
            .map(HalfEdge::from_index)
            .filter(|&h| !self.origin(h).is_null() && h < self.twin(h))
    }

    /// Iterates over the outgoing half-edges of `v`, counterclockwise.
    pub(super) fn fan(&self, v: VertexId) -> impl Iterator<Item = HalfEdge> + '_ {
        let start = self.outgoing[v.index()];
        let mut at = start;
        std::iter::from_fn(move || {
            let current = at;
            if !current.is_null() {
                at = self.twin(current.prev());
                if at == start {
                    at = HalfEdge::NULL;
                }
            }
            (!current.is_null()).then_some(current)
        })
    }

    pub(super) fn is_edge(&self, a: VertexId, b: VertexId) -> bool {
        self.fan(a).any(|h| self.target(h) == b)
    }

    /// Returns whether a collapse of the edge leaves a manifold.
    ///
    /// This is the link condition: the ends share only the two opposite vertices as neighbors.
    pub(super) fn can_collapse(&self, h: HalfEdge) -> bool {
        let (a, b) = (self.origin(h), self.target(h));
        let common = self
            .fan(a)
            .filter(|&g| self.is_edge(self.target(g), b))
            .count();
        common == 2 && self.live_triangles > 4
    }

    /// Collapses an edge that [`Self::can_collapse`] to its origin, which moves to `point`.
    pub(super) fn collapse(&mut self, h: HalfEdge, point: Vec3) {
        let (kept, gone) = (self.origin(h), self.target(h));
        let fan: Vec<HalfEdge> = self.fan(gone).collect();
        for g in fan {
            self.origin[g.index()] = kept;
        }
        for side in [h, self.twin(h)] {
            let (x, y) = (self.twin(side.next()), self.twin(side.prev()));
            self.twin[x.index()] = y;
            self.twin[y.index()] = x;
            for g in [x, y] {
                let v = self.origin(g);
                self.outgoing[v.index()] = g;
            }
            for g in [side, side.next(), side.prev()] {
                self.origin[g.index()] = VertexId::NULL;
                self.twin[g.index()] = HalfEdge::NULL;
            }
        }
        self.outgoing[gone.index()] = HalfEdge::NULL;
        self.points[kept.index()] = point;
        self.live_triangles -= 2;
    }

    /// Returns whether the edge can be flipped.
    ///
    /// The opposite vertices must not share an edge, and no vertex may keep fewer than three edges.
    pub(super) fn can_flip(&self, h: HalfEdge) -> bool {
        let c = self.origin(h.prev());
        let d = self.origin(self.twin(h).prev());
        let keeps_three = |v| self.fan(v).nth(3).is_some();
        c != d && !self.is_edge(c, d) && keeps_three(self.origin(h)) && keeps_three(self.target(h))
    }

    /// Flips an edge that [`Self::can_flip`].
    ///
    /// `h` then runs from the vertex opposite to its twin to the vertex opposite to itself.
    pub(super) fn flip(&mut self, h: HalfEdge) {
        let g = self.twin(h);
        let (a, b) = (self.origin(h), self.origin(g));
        let (c, d) = (self.origin(h.prev()), self.origin(g.prev()));
        let [bc, ca] = [h.next(), h.prev()].map(|x| self.twin(x));
        let [ad, db] = [g.next(), g.prev()].map(|x| self.twin(x));
        // The triangle of h becomes (d, c, a), that of g (c, d, b).
        self.set_triangle(h, [d, c, a], [g, ca, ad]);
        self.set_triangle(g, [c, d, b], [h, db, bc]);
    }

    fn set_triangle(&mut self, h: HalfEdge, corners: [VertexId; 3], twins: [HalfEdge; 3]) {
        for ((x, v), t) in [h, h.next(), h.prev()].into_iter().zip(corners).zip(twins) {
            self.origin[x.index()] = v;
            self.outgoing[v.index()] = x;
            self.twin[x.index()] = t;
            self.twin[t.index()] = x;
        }
    }

    /// Returns the remaining points and triangles, in slot order.
    pub(super) fn into_triangles(self) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let mut new_id = vec![u32::MAX; self.points.len()];
        let mut points = Vec::new();
        for v in self.vertices() {
            new_id[v.index()] = VertexId::from_index(points.len()).0;
            points.push(self.point(v));
        }
        let triangles = self
            .origin
            .chunks_exact(3)
            .filter(|corners| !corners[0].is_null())
            .map(|c| [c[0], c[1], c[2]].map(|v| new_id[v.index()]))
            .collect();
        (points, triangles)
    }
}

/// Returns the quality of a triangle: 1 for an equilateral one, 0 without area.
///
/// It is negative for a triangle that faces against `normal`.
pub(super) fn shape_quality([a, b, c]: [Vec3; 3], normal: Vec3) -> f64 {
    let (u, v, w) = (b - a, c - b, a - c);
    let area = u.cross(&(c - a));
    let squares = u.norm_squared() + v.norm_squared() + w.norm_squared();
    if squares == 0.0 {
        return 0.0;
    }
    let quality = 2.0 * 3.0_f64.sqrt() * area.norm() / squares;
    if area.dot(&normal) > 0.0 {
        quality
    } else {
        -quality
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise_mesh::Surface;
    use incise_mesh::icosphere;

    fn sphere() -> Shell {
        let surface = icosphere(2, 1.0);
        let t = surface.topology();
        let points = t.vertices().map(|v| surface.position(v)).collect();
        let faces: Vec<[u32; 3]> = t.triangles().map(|f| t.triangle(f).map(|v| v.0)).collect();
        Shell::new(points, &faces)
    }

    fn check(shell: Shell) -> Surface {
        let (points, faces) = shell.into_triangles();
        let positions: Vec<[f32; 3]> = points
            .into_iter()
            .map(incise_mesh::geometry::to_f32)
            .collect();
        let surface = Surface::from_triangles(&positions, &faces).unwrap();
        let t = surface.topology();
        t.validate().unwrap();
        assert!(t.is_closed());
        assert_eq!(
            t.vertices().count() + t.triangle_count() - t.edges().count(),
            2
        );
        surface
    }

    #[test]
    fn collapsing_as_long_as_possible_ends_at_a_tetrahedron() {
        let mut shell = sphere();
        loop {
            let next = shell.edges().find(|&h| shell.can_collapse(h));
            let Some(h) = next else { break };
            let p = shell.point(shell.origin(h));
            shell.collapse(h, p);
        }
        assert_eq!(shell.live_triangles(), 4);
        check(shell);
    }

    #[test]
    fn flips_keep_the_surface_closed() {
        let mut shell = sphere();
        let mut flipped = 0;
        for h in (0..960).map(HalfEdge) {
            if shell.can_flip(h) {
                shell.flip(h);
                flipped += 1;
            }
        }
        assert!(flipped > 300, "most edges of a sphere can flip");
        assert_eq!(check(shell).topology().triangle_count(), 320);
    }
}
