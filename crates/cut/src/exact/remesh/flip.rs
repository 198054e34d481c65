//! An edge turned in its two triangles.

use super::super::contract::Opened;
use super::ring::Ring;
use incise_mesh::{Edit, HalfEdge};

impl Opened<'_, '_> {
    /// Flips the edge of `h`: it joins the corners across from it then. Both triangles keep their slots. False, and
    /// nothing is done, where that would leave a boundary that is not the rim's to other half-edges.
    pub(super) fn turn(&mut self, ring: &Ring, h: HalfEdge) -> bool {
        let topology = self.edit.surface().topology();
        let g = topology.twin(h);
        // From corner a to c, with d and b across: the sides d-a and b-c change their triangles, or, where
        // both of these are boundaries, a-b and c-d could.
        let sides = [(h, g.prev()), (g, h.prev())];
        let beyond = sides.map(|(_, side)| topology.twin(side));
        let mut rims = [None; 2];
        for (rim, (&(new, side), beyond)) in rims.iter_mut().zip(sides.iter().zip(beyond)) {
            if beyond.is_null() {
                let [from, to] = [topology.origin(side), topology.target(side)];
                let (Some(from), Some(to)) = (ring.node_of(from), ring.node_of(to)) else {
                    return false;
                };
                let (node, lip) = if from.1 == 0 { to } else { from };
                if self.lips.rim[node as usize][lip] != side {
                    return false;
                }
                *rim = Some((node, lip, new));
            }
        }
        if rims.iter().all(Option::is_some) {
            return false;
        }
        let [b, d] = [g.prev(), h.prev()];
        copy_corner(self.edit, b, h);
        copy_corner(self.edit, d, g);
        // The new edge first: that opens the sides that become it, and the old edge opens with the first
        // of the sides that is joined.
        self.edit.join(b, d);
        for ((new, _), beyond) in sides.into_iter().zip(beyond) {
            if !beyond.is_null() {
                self.edit.join(new, beyond);
            }
        }
        for (node, lip, new) in rims.into_iter().flatten() {
            self.lips.rim[node as usize][lip] = new;
        }
        true
    }
}

/// Makes the corner at `to` what the one at `from` is.
fn copy_corner(edit: &mut Edit<'_>, from: HalfEdge, to: HalfEdge) {
    let surface = edit.surface();
    let v = surface.topology().origin(from);
    let uv = surface.corners.uv.get(from.index()).copied();
    let normal = surface.corners.normal.get(from.index()).copied();
    edit.set_corner(to, v);
    if let Some(uv) = uv {
        edit.set_uv(to, uv);
    }
    if let Some(normal) = normal {
        edit.set_normal(to, normal);
    }
}
