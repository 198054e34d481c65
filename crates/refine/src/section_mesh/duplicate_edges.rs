//! Removal of inner edges that the surrounding surface already has.
//!
//! Two edges between the same vertices would put four triangles on one edge. The inner edge is
//! flipped, or split at its midpoint.

use super::boundary_band::BoundaryBand;
use super::cdt::constraint;
use super::lattice::Lattice;
use super::loop_triangulation::{INSIDE, LoopTriangulation};
use incise_mesh::index_u32;

/// Returns the inner edges between corners of loops for which `has_edge` is true.
pub(crate) fn find(
    triangulation: &LoopTriangulation,
    has_edge: impl Fn(u32, u32) -> bool,
) -> Vec<[u32; 2]> {
    let cdt = &triangulation.cdt;
    let m = index_u32(triangulation.corner_of.len());
    (0..3 * cdt.triangles())
        .filter(|&h| {
            cdt.region[(h / 3) as usize] == INSIDE
                && cdt.constraints[h as usize] != constraint::LOOP
                && h < cdt.twin[h as usize]
        })
        .map(|h| [cdt.start(h), cdt.end(h)])
        .filter(|&[v, w]| v < m && w < m && has_edge(v, w))
        .collect()
}

/// Returns whether an edge can be flipped to an edge that the surface does not have.
pub(crate) fn can_flip(
    triangulation: &LoopTriangulation,
    [v, w]: [u32; 2],
    has_edge: impl Fn(u32, u32) -> bool,
) -> bool {
    let cdt = &triangulation.cdt;
    let Some(h) = cdt.find_half_edge(v, w) else {
        return false;
    };
    let (c, d) = (cdt.opposite(h), cdt.opposite(cdt.twin[h as usize]));
    let m = index_u32(triangulation.corner_of.len());
    cdt.constraints[h as usize] == constraint::FREE
        && cdt.orientation(d, c, v) > 0.0
        && cdt.orientation(d, c, w) < 0.0
        && !(c < m && d < m && has_edge(c, d))
}

/// Flips an edge, or splits it at its midpoint.
pub(crate) fn replace(
    triangulation: &mut LoopTriangulation,
    lattice: &mut Lattice,
    band: &mut BoundaryBand,
    [v, w]: [u32; 2],
    flip: bool,
) {
    let cdt = &mut triangulation.cdt;
    let Some(h) = cdt.find_half_edge(v, w) else {
        return;
    };
    if flip {
        cdt.flip(h);
        return;
    }
    let (p, q) = (cdt.point(v), cdt.point(w));
    let at = [0, 1].map(|k| 0.5 * p[k] + 0.5 * q[k]);
    let (c, d) = (cdt.opposite(h), cdt.opposite(cdt.twin[h as usize]));
    let middle = cdt.push_point(at);
    let sound = [[c, v], [w, c], [d, w], [v, d]]
        .into_iter()
        .all(|[a, b]| cdt.orientation(a, b, middle) > 0.0);
    cdt.split_edge(h, middle);
    if sound {
        // These flips only make edges at the new vertex, which the surface does not have.
        cdt.legalize();
    } else {
        cdt.stack.clear();
    }
    band.lattice.push(index_u32(lattice.points.len()));
    lattice.points.push(at);
    lattice.parents.push([v, w, triangulation.next[v as usize]]);
    lattice.weights.push([0.5, 0.5, 0.0]);
}
