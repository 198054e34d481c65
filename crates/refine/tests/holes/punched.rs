//! Surfaces with holes, and what must hold once these are closed.

#[cfg(feature = "fair")]
use incise_mesh::VertexId;
use incise_mesh::{MeshData, Surface, Topology, TriangleId, Vec3};
use incise_refine::{Filled, HoleParams, fill_holes};
use std::collections::BTreeSet;

/// `surface` without `triangles` and vertices that only they used.
pub(crate) fn without(surface: &Surface, triangles: &[TriangleId]) -> Surface {
    let mut out = surface.clone();
    let unused = out.remove_triangles(triangles);
    out.remove_vertices(&unused);
    out
}

/// The `count` triangles nearest to `seed`, by steps from neighbor to neighbor.
pub(crate) fn disc(topology: &Topology, seed: TriangleId, count: usize) -> Vec<TriangleId> {
    let mut out = vec![seed];
    let mut at = 0;
    while at < out.len() && out.len() < count {
        for h in out[at].half_edges() {
            let t = topology.twin(h).triangle();
            if out.len() < count && !out.contains(&t) {
                out.push(t);
            }
        }
        at += 1;
    }
    out
}

/// The surface of what is left, as it would come from a file.
pub(crate) fn reread(surface: &Surface) -> Surface {
    let topology = surface.topology();
    let positions: Vec<[f32; 3]> = (surface.positions.iter())
        .map(|&[x, y, z, _]| [x, y, z])
        .collect();
    let triangles: Vec<[u32; 3]> = topology
        .triangles()
        .map(|t| topology.triangle(t).map(|v| v.0))
        .collect();
    let data = MeshData::from_triangles(&positions, &triangles).unwrap();
    data.into_open_surface().unwrap().0
}

/// A ring of triangles around `rim`, counterclockwise seen from above, on its outside: vertices
/// `0..n` are the rim's.
pub(crate) fn collar(rim: &[[f32; 3]]) -> Surface {
    let n = u32::try_from(rim.len()).unwrap();
    let outer = rim.iter().map(|&[x, y, z]| [1.5 * x, 1.5 * y, z]);
    let positions: Vec<[f32; 3]> = rim.iter().copied().chain(outer).collect();
    let triangles: Vec<[u32; 3]> = (0..n)
        .flat_map(|i| {
            let (a, b) = (i, (i + 1) % n);
            [[b, a, a + n], [b, a + n, b + n]]
        })
        .collect();
    Surface::from_triangles(&positions, &triangles).unwrap()
}

/// The loop of a collar's boundary along its rim.
pub(crate) fn inner_loop(surface: &Surface, n: usize) -> Vec<incise_mesh::HalfEdge> {
    let mut loops = surface.topology().boundary_loops();
    loops.retain(|boundary| surface.topology().origin(boundary[0]).index() < n);
    loops.pop().unwrap()
}

pub(crate) fn euler(surface: &Surface) -> i64 {
    let topology = surface.topology();
    let count = |n: usize| i64::try_from(n).unwrap();
    count(topology.vertices().count()) - count(topology.edges().count())
        + count(topology.triangle_count())
}

/// Every vertex has one fan, and no two vertices have two edges.
pub(crate) fn check_manifold(surface: &Surface) {
    let topology = surface.topology();
    topology.validate().unwrap();
    let mut corners = vec![0; topology.vertex_slots()];
    let mut sides = BTreeSet::new();
    for h in topology.triangles().flat_map(|t| t.half_edges()) {
        corners[topology.origin(h).index()] += 1;
        let side = (topology.origin(h), topology.target(h));
        assert!(sides.insert(side), "the edge {side:?} is there twice");
    }
    for v in topology.vertices() {
        let fan = topology.outgoing_fan(v).count();
        assert_eq!(fan, corners[v.index()], "{v} has one fan");
    }
}

/// Fills all holes of `open` and checks all that must hold whatever they are.
pub(crate) fn fill_and_check(open: &Surface, params: &HoleParams) -> (Surface, Filled) {
    let loops = open.topology().boundary_loops().len();
    let mut surface = open.clone();
    let filled = fill_holes(&mut surface, params).unwrap();
    assert_eq!(filled.holes.len(), loops, "a hole a loop");
    assert!(surface.topology().is_closed(), "no boundary is left");
    check_manifold(&surface);
    let discs = i64::try_from(loops).unwrap();
    assert_eq!(euler(&surface), euler(open) + discs, "a disc a hole");
    for v in open.topology().vertices() {
        let bits = |s: &Surface| s.positions[v.index()].map(f32::to_bits);
        assert_eq!(bits(&surface), bits(open), "{v} stays where it is");
        assert_eq!(surface.rest[v.index()], open.rest[v.index()], "{v} at rest");
    }
    for t in open.topology().triangles() {
        let corners = [&surface, open].map(|s| s.topology().triangle(t));
        assert_eq!(corners[0], corners[1], "{t} stays");
        assert_eq!(surface.piece(t), open.piece(t), "the piece of {t}");
        assert_eq!(surface.material(t), open.material(t), "the material of {t}");
    }
    let mut triangles = 0;
    for hole in &filled.holes {
        let expected = hole.rim - 2 + 2 * hole.inserted;
        assert_eq!(hole.triangles.len(), expected, "Euler's formula for a disc");
        triangles += hole.triangles.len();
    }
    assert!(triangles <= params.max_triangles, "the budget holds");
    let delta = &filled.delta;
    assert_eq!(
        delta.triangles_added.len(),
        triangles,
        "the delta has them all"
    );
    let removed = delta.triangles_removed.len() + delta.vertices_removed.len();
    assert_eq!(removed, 0, "nothing is removed");
    if let Some(undo) = filled.undo.clone() {
        let mut back = surface.clone();
        undo.revert(&mut back).unwrap();
        assert_eq!(&back, open, "undone it is the same");
    }
    (surface, filled)
}

/// The root mean square of the distances of vertices from a sphere around the origin.
#[cfg(feature = "fair")]
pub(crate) fn distance_to_sphere(surface: &Surface, vertices: &[VertexId], radius: f64) -> f64 {
    let squares = vertices
        .iter()
        .map(|&v| (surface.position(v).norm() - radius).powi(2));
    (squares.sum::<f64>() / vertices.len() as f64).sqrt()
}

pub(crate) fn area(surface: &Surface, t: TriangleId) -> f64 {
    let [a, b, c]: [Vec3; 3] = surface.triangle_positions(t);
    (b - a).cross(&(c - a)).norm() / 2.0
}
