//! Fixtures with holes, and checks of the invariants of filled holes.

use incise_mesh::{MeshData, Surface, Topology, TriangleId, Vec3, VertexId};
use incise_refine::{FillReport, HoleParams, fill_holes};
use std::collections::BTreeSet;

/// Returns `surface` without `triangles` and the vertices that become unused.
pub(crate) fn without(surface: &Surface, triangles: &[TriangleId]) -> Surface {
    let mut out = surface.clone();
    let unused = out.remove_triangles(triangles);
    out.remove_vertices(&unused);
    out
}

/// Returns `count` triangles around `seed` in breadth-first order.
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

/// Returns the surface as read from a file, with vertices separated at pinched points.
pub(crate) fn reread(surface: &Surface) -> Surface {
    let topology = surface.topology();
    let positions: Vec<[f32; 3]> = (surface.positions().iter())
        .map(|&[x, y, z, _]| [x, y, z])
        .collect();
    let triangles: Vec<[u32; 3]> = topology
        .triangles()
        .map(|t| topology.triangle(t).map(|v| v.0))
        .collect();
    let data = MeshData::from_triangles(&positions, &triangles).unwrap();
    data.into_open_surface().unwrap().0
}

/// Returns a strip of triangles outside of `rim`, whose vertices are `0..n`.
///
/// The rim is counterclockwise seen from above.
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

/// Returns the boundary loop of a collar along its rim.
pub(crate) fn inner_loop(surface: &Surface, n: usize) -> Vec<incise_mesh::HalfEdge> {
    let mut loops = surface.topology().boundary_loops();
    loops.retain(|boundary| surface.topology().origin(boundary[0]).index() < n);
    loops.pop().unwrap()
}

/// Returns the Euler characteristic.
pub(crate) fn euler(surface: &Surface) -> i64 {
    let topology = surface.topology();
    let count = |n: usize| i64::try_from(n).unwrap();
    count(topology.vertices().count()) - count(topology.edges().count())
        + count(topology.triangle_count())
}

/// Checks that every vertex has one fan and that no edge is duplicated.
pub(crate) fn check_manifold(surface: &Surface) {
    let topology = surface.topology();
    topology.validate().unwrap();
    let mut corners = vec![0; topology.vertex_slots()];
    let mut sides = BTreeSet::new();
    for h in topology.triangles().flat_map(|t| t.half_edges()) {
        corners[topology.origin(h).index()] += 1;
        let side = (topology.origin(h), topology.target(h));
        assert!(sides.insert(side), "the edge {side:?} is duplicated");
    }
    for v in topology.vertices() {
        let fan = topology.outgoing_fan(v).count();
        assert_eq!(fan, corners[v.index()], "{v} has one fan");
    }
}

/// Fills all holes of `open` and checks the invariants of the result.
pub(crate) fn fill_and_check(open: &Surface, params: &HoleParams) -> (Surface, FillReport) {
    let loops = open.topology().boundary_loops().len();
    let mut surface = open.clone();
    let report = fill_holes(&mut surface, params).unwrap();
    assert_eq!(report.holes.len(), loops, "one hole for each loop");
    assert!(surface.topology().is_closed(), "no boundary is left");
    check_manifold(&surface);
    let discs = i64::try_from(loops).unwrap();
    assert_eq!(
        euler(&surface),
        euler(open) + discs,
        "one disc for each hole"
    );
    for v in open.topology().vertices() {
        let bits = |s: &Surface| s.positions()[v.index()].map(f32::to_bits);
        assert_eq!(bits(&surface), bits(open), "{v} is unchanged");
        assert_eq!(
            surface.rest_positions()[v.index()],
            open.rest_positions()[v.index()],
            "{v} at rest"
        );
    }
    for t in open.topology().triangles() {
        let corners = [&surface, open].map(|s| s.topology().triangle(t));
        assert_eq!(corners[0], corners[1], "{t} stays");
        assert_eq!(surface.piece(t), open.piece(t), "the piece of {t}");
        assert_eq!(surface.material(t), open.material(t), "the material of {t}");
    }
    let mut triangles = 0;
    for hole in &report.holes {
        let expected = hole.rim_edges - 2 + 2 * hole.new_vertices;
        assert_eq!(hole.triangles.len(), expected, "Euler's formula for a disc");
        triangles += hole.triangles.len();
    }
    assert!(triangles <= params.max_triangles, "the limit holds");
    let delta = &report.delta;
    assert_eq!(
        delta.triangles_added.len(),
        triangles,
        "the delta has all new triangles"
    );
    let removed = delta.triangles_removed.len() + delta.vertices_removed.len();
    assert_eq!(removed, 0, "nothing is removed");
    if let Some(undo) = report.undo.clone() {
        let mut back = surface.clone();
        undo.revert(&mut back).unwrap();
        assert_eq!(&back, open, "undo restores the surface");
    }
    (surface, report)
}

/// Returns the root mean square distance of vertices from a sphere around the origin.
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
