//! Texture seams: how a renderer comes to count more vertices than there are points.

use crate::geometry::widen;
use crate::ids::{HalfEdge, VertexId};
use crate::surface::Surface;
use crate::topology::Topology;

/// Cuts the texture of a closed surface along a tree of `extra + 1` edges, which makes exactly `extra`
/// more corners: a tree vertex with d tree edges has d sides, and the sum of d - 1 over a tree of E
/// edges is E - 1. The surface had no texture coordinates; afterward u and v are x and y scaled to
/// the box's larger side, plus the number of the side in u, so that a repeating texture runs on
/// across a seam.
pub(super) fn split_corners(surface: &mut Surface, extra: usize) {
    let topology = surface.topology();
    let seam = seam_tree(surface, extra + 1);
    let bounds = surface.bounds();
    let low = widen(bounds.min);
    let size = (widen(bounds.max) - low).max();
    let mut uv = vec![[0.0; 2]; 3 * topology.triangle_slots()];
    for v in topology.vertices() {
        let p = (surface.position(v) - low) / size;
        let mut fan: Vec<HalfEdge> = topology.outgoing_fan(v).collect();
        if let Some(first) = fan.iter().position(|h| seam[h.index()]) {
            fan.rotate_left(first);
        }
        let mut side = 0.0;
        for (i, h) in fan.into_iter().enumerate() {
            if i > 0 && seam[h.index()] {
                side += 1.0;
            }
            uv[h.index()] = round_uv(p.x + side, p.y);
        }
    }
    surface.corners.uv = uv;
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "this is the one rounding of a computed coordinate"
)]
fn round_uv(u: f64, v: f64) -> [f32; 2] {
    [u as f32, v as f32]
}

/// Marks both half-edges of `edges` edges that form a tree: of the breadth-first tree from the lowest
/// vertex, the longest branches, each cut off a longer one. Long branches run along limbs, where an
/// artist would put a seam.
fn seam_tree(surface: &Surface, edges: usize) -> Vec<bool> {
    let topology = surface.topology();
    let root = topology
        .vertices()
        .min_by(|&a, &b| surface.position(a).y.total_cmp(&surface.position(b).y))
        .expect("a surface with seams has vertices");
    let (order, parent) = breadth_first(topology, root);
    // The height of a vertex is the length of the longest way down; that way's first step continues
    // the branch on which the vertex lies, every other child begins a branch of its own.
    let mut height = vec![0_u32; topology.vertex_slots()];
    let mut heir = vec![VertexId::NULL; topology.vertex_slots()];
    for &v in order.iter().skip(1).rev() {
        let up = topology.origin(parent[v.index()]).index();
        if heir[up].is_null() || height[v.index()] + 1 >= height[up] {
            height[up] = height[v.index()] + 1;
            heir[up] = v;
        }
    }
    let mut branches: Vec<VertexId> = order
        .iter()
        .copied()
        .filter(|&v| {
            let h = parent[v.index()];
            !h.is_null() && (topology.origin(h) == root || heir[topology.origin(h).index()] != v)
        })
        .collect();
    branches.sort_by_key(|v| std::cmp::Reverse(height[v.index()]));
    let mut seam = vec![false; 3 * topology.triangle_slots()];
    let mut left = edges;
    for mut v in branches {
        while left > 0 && !v.is_null() {
            let h = parent[v.index()];
            seam[h.index()] = true;
            seam[topology.twin(h).index()] = true;
            left -= 1;
            v = heir[v.index()];
        }
    }
    assert!(left == 0, "more seams are asked for than the surface has");
    seam
}

/// Vertices in the order of their distance from `root` in edges, and for each the half-edge that
/// reaches it first, null for the root.
fn breadth_first(topology: &Topology, root: VertexId) -> (Vec<VertexId>, Vec<HalfEdge>) {
    let mut parent = vec![HalfEdge::NULL; topology.vertex_slots()];
    let mut order = vec![root];
    let mut at = 0;
    while at < order.len() {
        for h in topology.outgoing_fan(order[at]) {
            let v = topology.target(h);
            if v != root && parent[v.index()].is_null() {
                parent[v.index()] = h;
                order.push(v);
            }
        }
        at += 1;
    }
    (order, parent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::cube_sphere;

    #[test]
    fn a_tree_of_seams_makes_one_corner_less_than_it_has_edges() {
        let plain = cube_sphere(4, 1.0);
        let n = plain.topology().vertex_count();
        for extra in [0, 1, 2, 17, n - 2] {
            let mut surface = plain.clone();
            split_corners(&mut surface, extra);
            assert_eq!(surface.seam_split_vertices(), n + extra);
        }
    }
}
