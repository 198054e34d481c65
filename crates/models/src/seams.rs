//! Texture seams, which increase the number of vertices that a renderer needs.

use incise_mesh::Surface;
use incise_mesh::Topology;
use incise_mesh::geometry::to_f64;
use incise_mesh::{HalfEdge, VertexId};

/// Cuts the texture of a closed surface along a tree of `extra + 1` edges, for `extra` more
/// corners.
///
/// A tree vertex with d tree edges has d sides, and the sum of d - 1 over a tree of E edges is
/// E - 1. u and v become x and y scaled to the box's larger side. u also has the number of the side
/// added, so that a repeating texture continues across a seam.
pub(super) fn split_corners(surface: &mut Surface, extra: usize) {
    let topology = surface.topology();
    let seam = seam_tree(surface, extra + 1);
    let bounds = surface.bounds();
    let low = to_f64(bounds.min);
    let size = (to_f64(bounds.max) - low).max();
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
    surface
        .set_corner_uvs(uv)
        .expect("one value for each corner");
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "this is the one rounding of a computed coordinate"
)]
fn round_uv(u: f64, v: f64) -> [f32; 2] {
    [u as f32, v as f32]
}

/// Marks both half-edges of `edges` edges that form a tree.
///
/// They are the longest branches of the breadth-first tree from the lowest vertex. Long branches
/// follow limbs, where an artist would place seams.
fn seam_tree(surface: &Surface, edges: usize) -> Vec<bool> {
    let topology = surface.topology();
    let root = topology
        .vertices()
        .min_by(|&a, &b| surface.position(a).y.total_cmp(&surface.position(b).y))
        .expect("a surface with seams has vertices");
    let (order, parent) = breadth_first(topology, root);
    // The height of a vertex is the length of its longest path down. The first step of that path
    // continues the vertex's branch; every other child starts a branch.
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

/// Returns the vertices in breadth-first order from `root`, and the half-edge that reaches each.
///
/// The root's half-edge is null.
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
    use incise_mesh::cube_sphere;

    #[test]
    fn a_seam_tree_splits_one_corner_less_than_its_edges() {
        let plain = cube_sphere(4, 1.0);
        let n = plain.topology().vertex_count();
        for extra in [0, 1, 2, 17, n - 2] {
            let mut surface = plain.clone();
            split_corners(&mut surface, extra);
            assert_eq!(surface.seam_split_vertices(), n + extra);
        }
    }
}
