//! Flip, split and collapse of an edge as operations of an [`Edit`].
//!
//! Traversal here uses twins only, because [`Topology::outgoing`](crate::Topology::outgoing) may be
//! out of date until the edit is finished.

use super::Edit;
use crate::delta::VertexOrigin;
use crate::ids::{HalfEdge, VertexId};
use crate::surface::{CornerValues, Surface};

/// The error of an edge operation that would not leave a manifold. Nothing changes then.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EdgeError {
    /// The half-edge belongs to no triangle.
    #[error("{half_edge} belongs to no triangle; pass a half-edge of the surface")]
    NoEdge {
        /// The half-edge.
        half_edge: HalfEdge,
    },
    /// The edge has only one triangle.
    #[error("the edge of {half_edge} has one triangle, a flip needs two; pass an interior edge")]
    Boundary {
        /// The half-edge.
        half_edge: HalfEdge,
    },
    /// Two vertices would have more than one edge, or a vertex an edge to itself.
    #[error(
        "the edge of {half_edge} cannot be changed: {a} and {b} would be joined by more than one \
         edge"
    )]
    RepeatedEdge {
        /// The half-edge.
        half_edge: HalfEdge,
        /// One end of the edge that would repeat.
        a: VertexId,
        /// The other end.
        b: VertexId,
    },
    /// A collapse would pinch the surface at a vertex or fold it.
    #[error("collapsing the edge of {half_edge} would leave no manifold; choose another edge")]
    NotManifold {
        /// The half-edge.
        half_edge: HalfEdge,
    },
}

impl Edit<'_> {
    /// Flips the edge of `h`, so that it connects the two opposite corners.
    ///
    /// Creates and removes nothing. Both triangles keep their slots, pieces and materials. `h` and
    /// its twin become sides; `h.prev()` and its twin become the new edge. Corners keep their
    /// attributes: a moved corner copies those of the same vertex in the other triangle. Returns
    /// `h.prev()`.
    ///
    /// # Errors
    /// [`EdgeError`] if the edge is a boundary or the opposite corners already share an edge.
    pub fn flip_edge(&mut self, h: HalfEdge) -> Result<HalfEdge, EdgeError> {
        self.check_edge(h)?;
        let topology = self.surface().topology();
        let g = topology.twin(h);
        if g.is_null() {
            return Err(EdgeError::Boundary { half_edge: h });
        }
        let [b, d] = [g.prev(), h.prev()];
        let [from, to] = [b, d].map(|side| topology.origin(side));
        if from == to || self.has_neighbor(b, to) {
            return Err(EdgeError::RepeatedEdge {
                half_edge: h,
                a: from,
                b: to,
            });
        }
        let beyond = [b, d].map(|side| topology.twin(side));
        self.copy_corner(b, h);
        self.copy_corner(d, g);
        // The new edge first: it unpairs the sides that become it, and the first side then unpairs
        // the old edge.
        self.set_twins(b, d);
        for (new, beyond) in [h, g].into_iter().zip(beyond) {
            if beyond.is_null() {
                self.part(new);
            } else {
                self.set_twins(new, beyond);
            }
        }
        Ok(d)
    }

    /// Splits the edge of `h` at a new vertex.
    ///
    /// Creates one vertex, and one triangle for each triangle at the edge. The triangles at the
    /// edge keep their slots and the part next to the origin of `h`. New triangles inherit piece
    /// and material. Corner attributes are interpolated at `t`, from 0 at the origin of `h` to 1 at
    /// its target. `position` and `rest` need not lie on the edge. Returns the vertex, which
    /// becomes the target of `h`.
    ///
    /// # Errors
    /// [`EdgeError::NoEdge`].
    pub fn split_edge(
        &mut self,
        h: HalfEdge,
        position: [f32; 4],
        rest: [f32; 3],
        t: f32,
    ) -> Result<VertexId, EdgeError> {
        self.check_edge(h)?;
        let topology = self.surface().topology();
        let (g, [a, b]) = (topology.twin(h), [topology.origin(h), topology.target(h)]);
        let v = self.add_vertex(position, rest, VertexOrigin::OnEdge { a, b, t });
        let at_v = |surface: &Surface, a: HalfEdge, b: HalfEdge| {
            let [a, b] = [a, b].map(|corner| surface.corner_values(corner));
            CornerValues::interpolate([&a, &b, &b], [1.0 - t, t, 0.0])
        };
        let ahead_at_v = at_v(self.surface(), h, h.next());
        let ahead = self.cut_off(h.next(), h.next(), v, &ahead_at_v);
        if !g.is_null() {
            let behind_at_v = at_v(self.surface(), g.next(), g);
            let behind = self.cut_off(g, g.prev(), v, &behind_at_v);
            self.set_twins(ahead, behind);
        }
        Ok(v)
    }

    /// Collapses the edge of `h` onto its origin.
    ///
    /// Removes the target of `h` and the one or two triangles at the edge, and creates nothing. The
    /// other triangles around the target keep their slots and get the origin as corner. Corners
    /// with the target's attributes get those of the origin. Returns the origin.
    ///
    /// # Errors
    /// [`EdgeError`] unless the link condition holds (Dey et al. 1999): the ends share no neighbors
    /// except the opposite corners, do not connect two boundaries, and more than a tetrahedron or a
    /// single triangle remains.
    pub fn collapse_edge(&mut self, h: HalfEdge) -> Result<VertexId, EdgeError> {
        self.check_edge(h)?;
        let topology = self.surface().topology();
        let g = topology.twin(h);
        let kept = topology.origin(h);
        let sides: Vec<HalfEdge> = [h, g].into_iter().filter(|side| !side.is_null()).collect();
        let opposite: Vec<VertexId> = sides.iter().map(|s| topology.origin(s.prev())).collect();
        let repeated = |b| EdgeError::RepeatedEdge {
            half_edge: h,
            a: kept,
            b,
        };
        let (around_kept, kept_is_open) = self.neighbors(h);
        let (around_gone, gone_is_open) = self.neighbors(h.next());
        for &v in around_gone.iter().filter(|&&v| v != kept) {
            if around_kept.contains(&v) && !opposite.contains(&v) {
                return Err(repeated(v));
            }
        }
        // Two boundaries that meet pinch the surface; an ear or a tetrahedron folds.
        let is_pinched = !g.is_null() && kept_is_open && gone_is_open;
        let folds = |side: &HalfEdge| {
            let [ahead, behind] = [side.next(), side.prev()].map(|s| topology.twin(s));
            match (ahead.is_null(), behind.is_null()) {
                (true, true) => true,
                (false, false) => {
                    around_gone.len() <= 3
                        && topology.origin(ahead.prev()) == topology.origin(behind.prev())
                }
                _ => false,
            }
        };
        if is_pinched || sides.iter().any(folds) {
            return Err(EdgeError::NotManifold { half_edge: h });
        }
        let fan = self.fan(h.next());
        let outer = sides
            .iter()
            .map(|s| [s.next(), s.prev()].map(|side| topology.twin(side)));
        let outer: Vec<[HalfEdge; 2]> = outer.collect();
        // Corners of the removed and of the kept vertex, in each triangle at the edge.
        let mut charts = vec![[h.next(), h].map(|corner| self.surface().corner_values(corner))];
        if !g.is_null() {
            charts.push([g, g.next()].map(|corner| self.surface().corner_values(corner)));
        }
        for &corner in &fan {
            if sides
                .iter()
                .all(|side| side.triangle() != corner.triangle())
            {
                self.set_corner(corner, kept);
                for [from, to] in &charts {
                    self.replace_corner_values(corner, from, to);
                }
            }
        }
        for side in &sides {
            self.remove_triangle(side.triangle());
        }
        for [ahead, behind] in outer {
            if !ahead.is_null() && !behind.is_null() {
                self.set_twins(ahead, behind);
            }
        }
        Ok(kept)
    }

    fn check_edge(&self, h: HalfEdge) -> Result<(), EdgeError> {
        if !h.is_null() && self.surface().topology().is_triangle(h.triangle()) {
            Ok(())
        } else {
            Err(EdgeError::NoEdge { half_edge: h })
        }
    }

    /// Returns the outgoing half-edges at the origin of `h`, in its fan.
    fn fan(&self, h: HalfEdge) -> Vec<HalfEdge> {
        let topology = self.surface().topology();
        let mut fan = vec![h];
        let mut at = topology.twin(h.prev());
        while !at.is_null() && at != h {
            fan.push(at);
            at = topology.twin(at.prev());
        }
        if at.is_null() {
            let mut back = topology.twin(h);
            while !back.is_null() {
                fan.push(back.next());
                back = topology.twin(back.next());
            }
        }
        fan
    }

    /// Returns the neighbors of the origin of `h`, and whether it is on a boundary.
    fn neighbors(&self, h: HalfEdge) -> (Vec<VertexId>, bool) {
        let topology = self.surface().topology();
        let mut out = Vec::new();
        let mut is_open = false;
        for corner in self.fan(h) {
            out.push(topology.target(corner));
            if topology.twin(corner.prev()).is_null() {
                out.push(topology.origin(corner.prev()));
                is_open = true;
            }
        }
        (out, is_open)
    }

    /// Returns whether the origin of `h` has an edge to `v`.
    fn has_neighbor(&self, h: HalfEdge, v: VertexId) -> bool {
        self.neighbors(h).0.contains(&v)
    }

    /// Moves the corner at `moved` to `v` and fills the gap with a new triangle.
    ///
    /// `side` connects that corner to the apex, and both triangles share it afterwards. Returns the
    /// half-edge of the new triangle between `v` and the old corner.
    fn cut_off(
        &mut self,
        moved: HalfEdge,
        side: HalfEdge,
        v: VertexId,
        at_v: &CornerValues,
    ) -> HalfEdge {
        let (surface, t) = (self.surface(), moved.triangle());
        let topology = surface.topology();
        let (leaves, end) = (side == moved, topology.origin(moved));
        let apex = if leaves { side.next() } else { side };
        let (tip, beyond) = (topology.origin(apex), topology.twin(side));
        let (piece, material) = (surface.piece(t), surface.material(t));
        let [at_end, at_tip] = [moved, apex].map(|corner| self.surface().corner_values(corner));
        let corners = if leaves { [v, end, tip] } else { [end, v, tip] };
        let [first, second, third] = self.add_triangle(corners, piece, material).half_edges();
        let (new_v, new_end) = if leaves {
            (first, second)
        } else {
            (second, first)
        };
        self.set_corner_values(new_v, at_v);
        self.set_corner_values(new_end, &at_end);
        self.set_corner_values(third, &at_tip);
        self.set_corner(moved, v);
        self.set_corner_values(moved, at_v);
        let (outer, inner) = if leaves {
            (second, third)
        } else {
            (third, second)
        };
        if !beyond.is_null() {
            self.set_twins(outer, beyond);
        }
        self.set_twins(inner, side);
        first
    }

    /// Copies vertex and attributes of the corner at `from` to the one at `to`.
    fn copy_corner(&mut self, from: HalfEdge, to: HalfEdge) {
        let v = self.surface().topology().origin(from);
        let corner = self.surface().corner_values(from);
        self.set_corner(to, v);
        self.set_corner_values(to, &corner);
    }
}
