//! Operations that remeshing must refuse, one reason per test.

use super::shape::{Point, Quad};
use super::*;
use crate::exact::open::Sides;
use crate::exact::rim::Rim;
use incise_mesh::{Surface, Vec3};

/// Four points around the flat quad (0, 0), (1, 0.1), (2, 0), (1, -0.1), whose long diagonal makes
/// slivers: the second and the fourth are lifted by `lift`.
fn quad(lift: f64) -> Quad {
    let points = [
        [0.0, 0.0, 0.0],
        [1.0, -0.1, lift],
        [2.0, 0.0, 0.0],
        [1.0, 0.1, lift],
    ];
    Quad(points.map(|p| Point {
        at: [Vec3::from(p); 2],
        uv: [0.0; 2],
    }))
}

#[test]
fn a_flip_moves_the_surface_by_the_distance_of_the_diagonals() {
    assert_eq!(quad(0.0).flip_distance(), Some(0.0));
    let lifted = quad(0.01).flip_distance();
    let distance = lifted.expect("an edge of 11 degrees is none");
    assert!((distance - 0.01).abs() < 1e-15, "{distance}");
}

#[test]
fn an_edge_that_is_a_feature_is_not_flipped() {
    // Both sides of the edge rise by the sine of the angle: 14 and 16 degrees make 28 and 32.
    for (degrees, is_feature) in [(14.0_f64, false), (16.0, true)] {
        let lift = 0.1 * degrees.to_radians().tan();
        let distance = quad(lift).flip_distance();
        assert_eq!(distance.is_none(), is_feature, "{degrees} degrees");
    }
}

#[test]
fn a_quad_that_is_not_convex_is_not_flipped() {
    let mut quad = quad(0.0);
    for layer in 0..2 {
        quad.0[1].at[layer] = Vec3::new(4.0, -0.1, 0.0);
    }
    assert_eq!(quad.flip_distance(), None);
}

#[test]
fn a_body_whose_rest_shape_folds_is_not_flipped() {
    let mut quad = quad(0.0);
    quad.0[1].at[1] = Vec3::new(4.0, -0.1, 0.0);
    assert_eq!(quad.flip_distance(), None);
}

#[test]
fn texture_moves_no_farther_than_the_surface_may() {
    let mut quad = quad(0.0);
    for p in &mut quad.0 {
        p.uv = [p.at[0].x / 4.0, p.at[0].y / 4.0];
    }
    let even = quad.flip_distance().expect("a flat quad");
    assert!(even < 1e-15, "an affine texture stays: {even}");
    // A quarter of a unit a meter: a corner that is off by 0.01 units takes the crossing along by
    // half of 0.04 m, by the mean scale of the sides.
    quad.0[1].uv[0] += 0.01;
    let slid = quad.flip_distance().expect("it does not turn over");
    assert!((slid - 0.02).abs() < 1e-3, "{slid}");
    quad.0[1].uv = [0.25, 0.1];
    assert_eq!(quad.flip_distance(), None, "the texture would fold");
}

/// A closed surface as a cut without a rim, all of it in the ring.
fn with_all_in_the_ring(
    surface: &mut Surface,
    test: impl FnOnce(&mut Remesher, &mut Opened<'_, '_>),
) {
    let triangles: Vec<TriangleId> = surface.topology().triangles().collect();
    let mut edit = surface.edit();
    let (mut sides, mut rim) = (Sides::default(), Rim::default());
    let mut cut = Opened {
        edit: &mut edit,
        nodes: &[],
        sides: &mut sides,
        rim: &mut rim,
    };
    let mut remesher = Remesher::default();
    remesher.ring.find(&cut, 0.1, &[]);
    for t in triangles {
        remesher.ring.add(t, f64::INFINITY);
    }
    remesher.is_queued.resize(remesher.ring.len(), false);
    test(&mut remesher, &mut cut);
}

/// A flat 4 by 4 grid of squares, closed by a point far below, with the vertex in its middle moved
/// close to the next one.
fn grid() -> Surface {
    let mut points: Vec<[f32; 3]> = (0..25_u8)
        .map(|i| [f32::from(i % 5), f32::from(i / 5), 0.0])
        .collect();
    points[12] = [2.9, 2.0, 0.0];
    points.push([2.0, 2.0, -50.0]);
    let mut faces = Vec::new();
    for (x, y) in (0..16).map(|i| (i % 4, i / 4)) {
        let a = 5 * y + x;
        faces.extend([[a, a + 1, a + 6], [a, a + 6, a + 5]]);
    }
    let around = [0, 1, 2, 3, 4, 9, 14, 19, 24, 23, 22, 21, 20, 15, 10, 5];
    for i in 0..16 {
        faces.push([around[(i + 1) % 16], around[i], 25]);
    }
    Surface::from_triangles(&points, &faces).unwrap()
}

/// Whether the vertex in the middle of the grid is contracted onto the next one.
fn contracts(surface: &mut Surface) -> bool {
    let h = surface
        .topology()
        .find_half_edge(VertexId(12), VertexId(13))
        .unwrap();
    let mut is_done = false;
    with_all_in_the_ring(surface, |remesher, cut| {
        if remesher.stars[0][0].find(cut.edit.surface(), &remesher.ring, h) {
            is_done = remesher.contract(cut, 0, 0, &mut Remeshed::default());
            if is_done {
                let removed = cut.edit.surface().topology().triangle_count();
                assert_eq!(removed, 46, "two triangles go");
            }
        }
    });
    is_done
}

fn flips(surface: &mut Surface, ends: [u32; 2]) -> bool {
    let [a, b] = ends.map(VertexId);
    let h = surface.topology().find_half_edge(a, b).unwrap();
    let mut is_done = false;
    with_all_in_the_ring(surface, |remesher, cut| {
        is_done = remesher.flip(cut, h, &mut Remeshed::default());
    });
    is_done
}

#[test]
fn a_seam_of_the_texture_stays() {
    assert!(contracts(&mut grid()), "a plain one is contracted");
    assert!(flips(&mut grid(), [6, 12]), "a plain one is flipped");
    let with_uv = |seam: bool| {
        let mut surface = grid();
        let corners = surface.topology().corners().to_vec();
        let uv = corners.iter().map(|v| {
            [
                surface.positions()[v.index()][0],
                surface.positions()[v.index()][1],
            ]
        });
        surface.set_corner_uvs(uv.collect()).unwrap();
        if seam {
            // One of the triangles beside the edge from 6 to 12 has a chart of its own.
            let h = surface
                .topology()
                .find_half_edge(VertexId(6), VertexId(12))
                .unwrap();
            for h in h.triangle().half_edges() {
                surface.corner_uvs_mut()[h.index()][0] += 10.0;
            }
        }
        surface
    };
    assert!(contracts(&mut with_uv(false)));
    assert!(flips(&mut with_uv(false), [6, 12]));
    assert!(!contracts(&mut with_uv(true)));
    assert!(!flips(&mut with_uv(true), [6, 12]));
}

#[test]
fn another_material_a_pin_and_a_feature_stay() {
    let h = |s: &Surface| {
        s.topology()
            .find_half_edge(VertexId(6), VertexId(12))
            .unwrap()
    };
    let mut surface = grid();
    surface.set_material(h(&surface).triangle(), 7);
    assert!(!contracts(&mut surface));
    assert!(!flips(&mut surface, [6, 12]));

    let mut surface = grid();
    surface.positions_mut()[12][3] = 0.0;
    assert!(!contracts(&mut surface), "a pinned vertex would be lost");
    surface.positions_mut()[13][3] = 0.0;
    assert!(contracts(&mut surface), "both are pinned");

    // Folded by 40 degrees along the line of the edge, and across it.
    let mut surface = grid();
    for p in surface
        .positions_mut()
        .iter_mut()
        .zip(0..25)
        .map(|(p, _)| p)
    {
        p[2] -= 0.84 * (p[1] - 2.0).max(0.0);
    }
    assert!(contracts(&mut surface), "along the fold");
    let mut surface = grid();
    surface.positions_mut()[7][0] = 2.9;
    surface.positions_mut()[17][0] = 2.9;
    for p in surface
        .positions_mut()
        .iter_mut()
        .zip(0..25)
        .map(|(p, _)| p)
    {
        p[2] -= 0.84 * (p[0] - 2.9).max(0.0);
    }
    for v in 0..surface.positions().len() {
        let [x, y, z, _] = surface.positions()[v];
        surface.rest_positions_mut()[v] = [x, y, z];
    }
    assert!(!contracts(&mut surface), "off the fold");
}

#[test]
fn an_edge_that_is_there_is_not_made_again_and_links_hold() {
    // Two triangles back to back with a point above and one below: the three edges in the middle
    // have three common neighbors, the others two.
    let points = [
        [1.0, 0.0, 0.0],
        [-0.5, 0.9, 0.0],
        [-0.5, -0.9, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let faces = [
        [0, 1, 3],
        [1, 2, 3],
        [2, 0, 3],
        [1, 0, 4],
        [2, 1, 4],
        [0, 2, 4],
    ];
    let mut surface = Surface::from_triangles(&points, &faces).unwrap();
    let h = |s: &Surface, a, b| {
        s.topology()
            .find_half_edge(VertexId(a), VertexId(b))
            .unwrap()
    };
    let (around, up) = (h(&surface, 0, 1), h(&surface, 0, 3));
    with_all_in_the_ring(&mut surface, |remesher, cut| {
        for (start, holds) in [(around, false), (up, true)] {
            let surface = cut.edit.surface();
            assert!(remesher.stars[0][0].find(surface, &remesher.ring, start));
            let twin = surface.topology().twin(start);
            assert_eq!(remesher.is_linked_twice(surface.topology(), twin, 0), holds);
        }
        // From 0 to 3 across: the edge from 1 to 2 is there.
        assert!(remesher.would_repeat(cut.edit.surface().topology(), up));
        assert!(!remesher.would_repeat(cut.edit.surface().topology(), around));
    });
}
