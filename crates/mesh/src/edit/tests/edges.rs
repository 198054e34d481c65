//! Random flips, splits and collapses: the surface stays valid, and an undo restores every bit.

use super::{assert_same_bytes, body};
use crate::ids::HalfEdge;
use crate::shapes::{icosphere, torus};
use crate::surface::Surface;
use crate::{EdgeError, TriangleId, VertexId};
use proptest::prelude::*;

/// Applies up to `steps.len()` operations in one edit and returns the number that succeeded.
fn apply(surface: &mut Surface, steps: &[(u8, u16)]) -> (usize, crate::Undo) {
    let mut edit = surface.edit();
    let mut done = 0;
    for &(kind, at) in steps {
        let triangles: Vec<TriangleId> = edit.surface().topology().triangles().collect();
        let h = triangles[usize::from(at / 3) % triangles.len()].half_edges()[usize::from(at % 3)];
        let outcome = match kind {
            0 => edit.flip_edge(h).map(|_| ()),
            1 => {
                let topology = edit.surface().topology();
                let ends = [topology.origin(h), topology.target(h)];
                let [p, q] = ends.map(|v| edit.surface().positions()[v.index()]);
                let middle = std::array::from_fn(|k| (p[k] + q[k]) / 2.0);
                let [x, y, z, _] = middle;
                edit.split_edge(h, middle, [x, y, z], 0.5).map(|_| ())
            }
            _ => edit.collapse_edge(h).map(|_| ()),
        };
        done += usize::from(outcome.is_ok());
    }
    (done, edit.finish().1)
}

proptest! {
    #[test]
    fn edge_operations_keep_a_closed_manifold(
        steps in prop::collection::vec((0..3_u8, any::<u16>()), 0..60),
        is_torus: bool,
    ) {
        let mut surface = if is_torus { torus(1.0, 0.4, 6, 5) } else { icosphere(0, 1.0) };
        let before = surface.clone();
        let (_, undo) = apply(&mut surface, &steps);
        surface.validate_closed().unwrap();
        undo.revert(&mut surface).unwrap();
        assert_same_bytes(&surface, &before);
    }

    #[test]
    fn edge_operations_keep_open_surfaces_with_attributes_sound(
        steps in prop::collection::vec((0..3_u8, any::<u16>()), 0..40),
        holes in prop::collection::vec(any::<u16>(), 0..4),
    ) {
        check_open(&steps, &holes);
    }
}

/// Applies operations to a body with holes and checks the surface and the undo.
fn check_open(steps: &[(u8, u16)], holes: &[u16]) {
    let mut surface = body();
    for &hole in holes {
        let triangles: Vec<TriangleId> = surface.topology().triangles().collect();
        let t = triangles[usize::from(hole) % triangles.len()];
        let unused = surface.remove_triangles(&[t]);
        surface.remove_vertices(&unused);
    }
    let before = surface.clone();
    let (_, undo) = apply(&mut surface, steps);
    surface.validate().unwrap();
    let topology = surface.topology();
    let mut directed: Vec<_> = topology
        .triangles()
        .flat_map(TriangleId::half_edges)
        .map(|h| (topology.origin(h), topology.target(h)))
        .collect();
    directed.sort_unstable();
    assert!(
        directed.windows(2).all(|w| w[0] != w[1]),
        "each edge is there once"
    );
    undo.revert(&mut surface).unwrap();
    assert_same_bytes(&surface, &before);
}

/// The removed fan was found by its neighbors, the other one by nothing.
#[test]
fn a_boundary_vertex_keeps_its_other_fan() {
    check_open(
        &[(1, 0), (2, 5663), (1, 0), (1, 0), (2, 60203)],
        &[5401, 56600, 0],
    );
    // Two triangles that share one vertex: each is a fan of it.
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
    ];
    let faces = [[0, 1, 2], [0, 3, 4]];
    for removed in [0, 1] {
        let mut surface = Surface::from_triangles(&corners, &faces).unwrap();
        let before = surface.clone();
        let mut edit = surface.edit();
        edit.remove_triangle(TriangleId(removed));
        let (delta, undo) = edit.finish();
        surface.validate().unwrap();
        let center = surface.topology().outgoing(VertexId(0));
        assert_eq!(center.triangle(), TriangleId(1 - removed));
        assert_eq!(delta.vertices_removed.len(), 2, "the center has a triangle");
        undo.revert(&mut surface).unwrap();
        assert_same_bytes(&surface, &before);
    }
}

#[test]
fn edge_operations_that_leave_no_manifold_are_refused() {
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let mut tetrahedron = Surface::from_triangles(&corners, &faces).unwrap();
    let before = tetrahedron.clone();
    let mut edit = tetrahedron.edit();
    for h in (0..12).map(HalfEdge) {
        assert!(matches!(
            edit.flip_edge(h),
            Err(EdgeError::RepeatedEdge { .. })
        ));
        assert_eq!(
            edit.collapse_edge(h),
            Err(EdgeError::NotManifold { half_edge: h })
        );
    }
    for half_edge in [HalfEdge(12), HalfEdge::NULL] {
        let error = EdgeError::NoEdge { half_edge };
        assert_eq!(edit.flip_edge(half_edge), Err(error));
        assert_eq!(edit.collapse_edge(half_edge), Err(error));
        assert_eq!(
            edit.split_edge(half_edge, [0.0; 4], [0.0; 3], 0.5),
            Err(error)
        );
    }
    drop(edit.finish());
    assert_eq!(tetrahedron, before);
    let mut triangle = Surface::from_triangles(&corners[..3], &[[0, 1, 2]]).unwrap();
    let mut edit = triangle.edit();
    let half_edge = HalfEdge(0);
    assert_eq!(
        edit.flip_edge(half_edge),
        Err(EdgeError::Boundary { half_edge })
    );
    assert_eq!(
        edit.collapse_edge(half_edge),
        Err(EdgeError::NotManifold { half_edge })
    );
}

#[test]
fn boundary_edges_collapse() {
    let mut surface = body();
    // A hole of four edges: one of three would become two edges between the same vertices.
    let removed = surface.topology().triangles().next().unwrap();
    let [boundary, across, _] = removed.half_edges().map(|h| surface.topology().twin(h));
    let unused = surface.remove_triangles(&[removed, across.triangle()]);
    surface.remove_vertices(&unused);
    let count = surface.topology().triangle_count();
    let mut edit = surface.edit();
    edit.collapse_edge(boundary).unwrap();
    drop(edit.finish());
    surface.validate().unwrap();
    assert_eq!(
        surface.topology().triangle_count(),
        count - 1,
        "one triangle was at the edge"
    );
}
