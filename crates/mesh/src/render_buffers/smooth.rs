//! The corners of a vertex that share a buffer vertex.

use super::{NONE, RenderBuffers};
use crate::geometry::{area_vector, to_f64};
use crate::ids::{HalfEdge, TriangleId};
use crate::surface::{Domain, Surface};

impl RenderBuffers {
    /// Collects the corners that share a buffer vertex with the corner at `h`, itself first.
    pub(super) fn collect_smooth(&mut self, surface: &Surface, h: HalfEdge) {
        let topology = surface.topology();
        self.fan.clear();
        self.fan.push(h);
        let mut at = h;
        loop {
            let next = topology.twin(at.prev());
            if next == h {
                return;
            }
            if next.is_null() || !self.is_smooth(surface, at, next) {
                break;
            }
            self.fan.push(next);
            at = next;
        }
        let mut at = h;
        loop {
            let beyond = topology.twin(at);
            if beyond.is_null() || !self.is_smooth(surface, beyond.next(), at) {
                return;
            }
            at = beyond.next();
            self.fan.push(at);
        }
    }

    /// Returns whether two corners of a vertex in neighboring triangles share a buffer vertex.
    fn is_smooth(&self, surface: &Surface, a: HalfEdge, b: HalfEdge) -> bool {
        let triangles = [a, b].map(HalfEdge::triangle);
        let [s, t] = triangles.map(TriangleId::index);
        let is_one_part = self.place[t] != NONE && self.submesh[s] == self.submesh[t];
        let bits = |h: HalfEdge| {
            let uv = surface
                .corner_uvs()
                .get(h.index())
                .map(|uv| uv.map(f32::to_bits));
            let normal = surface.corner_normals().get(h.index());
            (uv, normal.map(|normal| normal.map(f32::to_bits)))
        };
        let corner_channels = surface
            .channels()
            .iter()
            .filter(|c| c.domain() == Domain::Corner);
        if !is_one_part
            || bits(a) != bits(b)
            || corner_channels
                .into_iter()
                .any(|c| c.row(a.index()) != c.row(b.index()))
        {
            return false;
        }
        if !surface.corner_normals().is_empty() {
            return true;
        }
        let [u, v] = triangles.map(|t| {
            let corners = surface.topology().triangle(t);
            area_vector(corners.map(|v| to_f64(surface.rest_positions()[v.index()])))
        });
        u.dot(&v) >= self.params.crease_angle.cos() * u.norm() * v.norm()
    }
}
