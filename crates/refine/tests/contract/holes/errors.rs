//! Invalid input: a typed error and an unchanged surface.

use super::punched::{disc, without};
use incise_mesh::{HalfEdge, Surface, TriangleId, VertexId, icosphere};
use incise_refine::{HoleError, HoleParams, RefinementLevel, fill_hole, fill_holes};

fn open() -> Surface {
    let body = icosphere(3, 1.0);
    without(&body, &disc(body.topology(), TriangleId(5), 60))
}

/// Returns the error of filling `rim` and checks that the surface is unchanged.
fn error_of(surface: &Surface, rim: &[HalfEdge]) -> HoleError {
    let mut copy = surface.clone();
    let error = fill_hole(&mut copy, rim, &HoleParams::default()).unwrap_err();
    assert_eq!(&copy, surface, "the surface is unchanged");
    error
}

#[test]
fn a_level_must_be_positive() {
    for z in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let params = HoleParams {
            level: RefinementLevel::Z(z),
            ..HoleParams::default()
        };
        let error = fill_holes(&mut open(), &params).unwrap_err();
        assert!(matches!(error, HoleError::Parameter(_)), "{error}");
    }
}

#[test]
fn the_triangle_limit_holds() {
    let before = open();
    for (z, max_triangles) in [(1e-9, 20_000), (0.2, 100), (1.0, 5), (1.0, 0)] {
        for bend in [0.0, 0.5] {
            let mut surface = before.clone();
            for p in surface.positions_mut() {
                p[2] += bend * p[0] * p[0];
            }
            let params = HoleParams {
                level: RefinementLevel::Z(z),
                max_triangles,
                ..HoleParams::default()
            };
            let copy = surface.clone();
            let error = fill_holes(&mut surface, &params).unwrap_err();
            assert_eq!(
                error,
                HoleError::TooManyTriangles {
                    limit: max_triangles
                }
            );
            assert_eq!(surface, copy);
        }
    }
}

#[test]
fn coordinates_must_be_finite() {
    let mut surface = open();
    let rim = surface.topology().boundary_loops().remove(0);
    let vertex = surface.topology().origin(rim[3]);
    surface.positions_mut()[vertex.index()][1] = f32::NAN;
    assert_eq!(
        fill_holes(&mut surface, &HoleParams::default()).unwrap_err(),
        HoleError::NonFinite { vertex }
    );
    surface.positions_mut()[vertex.index()][1] = 0.0;
    surface.rest_positions_mut()[vertex.index()][2] = f32::INFINITY;
    assert_eq!(
        fill_holes(&mut surface, &HoleParams::default()).unwrap_err(),
        HoleError::NonFinite { vertex }
    );
}

#[test]
fn a_rim_must_be_a_closed_boundary_chain() {
    let surface = open();
    let rim = surface.topology().boundary_loops().remove(0);
    assert_eq!(
        error_of(&surface, &rim[1..]),
        HoleError::OpenRim { half_edge: rim[1] }
    );
    let inner = surface.topology().twin(rim[0].next());
    assert_eq!(
        error_of(&surface, &[inner]),
        HoleError::OpenRim { half_edge: inner }
    );
    let mut swapped = rim.clone();
    swapped.swap(1, 2);
    assert_eq!(
        error_of(&surface, &swapped),
        HoleError::OpenRim { half_edge: rim[2] }
    );
    let nowhere = HalfEdge(3_000_000);
    assert_eq!(
        error_of(&surface, &[nowhere]),
        HoleError::OpenRim { half_edge: nowhere }
    );
}

#[test]
fn a_rim_must_not_repeat_a_vertex() {
    let body = icosphere(2, 1.0);
    let topology = body.topology();
    let v = topology
        .vertices()
        .find(|&v| topology.outgoing_fan(v).count() == 6)
        .unwrap();
    let fan: Vec<TriangleId> = topology.outgoing_fan(v).map(|h| h.triangle()).collect();
    let open = without(&body, &[fan[0], fan[3]]);
    let loops = open.topology().boundary_loops();
    // Both loops concatenated at the shared vertex.
    let from_v = |i: usize| {
        let mut rim = loops[i].clone();
        let at = rim
            .iter()
            .position(|&h| open.topology().origin(h) == v)
            .unwrap();
        rim.rotate_left(at);
        rim
    };
    let both = [from_v(0), from_v(1)].concat();
    assert_eq!(
        error_of(&open, &both),
        HoleError::RepeatedVertex { vertex: v }
    );
}

#[test]
fn a_vertex_must_not_pinch_the_surface() {
    let corners = [
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [-1.0, 0.0, 0.0],
        [-1.0, -1.0, 0.0],
    ];
    let surface = Surface::from_triangles(&corners, &[[0, 1, 2], [0, 3, 4]]).unwrap();
    let rim = surface.topology().boundary_loops().remove(0);
    // Filling one of the two loops would not give a manifold either.
    assert_eq!(
        error_of(&surface, &rim),
        HoleError::Pinched {
            vertex: VertexId(0)
        }
    );
    let error = fill_holes(&mut surface.clone(), &HoleParams::default()).unwrap_err();
    assert_eq!(
        error,
        HoleError::Pinched {
            vertex: VertexId(0)
        }
    );
}
