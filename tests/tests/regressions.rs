//! Counterexamples that random cuts and the reference cuts found, by what went wrong.

use incise_cut::{CutError, CutMethod, CutParams, Cutter, Sweep};
use incise_mesh::{Surface, icosphere};
use incise_refine::RefinementLevel;
use incise_tests::{Blade, Body, Deformation, Shape, cut_and_check};

/// Caps that are coarser than the surface, and this snapping.
fn coarser(snap: f64) -> CutParams {
    let mut params = CutParams {
        snap,
        ..CutParams::default()
    };
    params.refine.level = RefinementLevel::Coarser2;
    params
}

/// An old vertex stood for the point of a loose edge: walls and cap cancelled, and the piece beyond
/// the plane was gone. The Euler characteristic knows.
#[test]
fn a_tip_of_loose_edges_does_not_vanish() {
    let body = Body {
        shape: Shape::Torus(3, 6),
        deformation: Deformation::None,
        lattice: None,
        seed: 0,
    };
    let normal = [
        -0.373_882_029_838_111_1,
        0.452_775_582_158_547_1,
        0.979_388_913_557_901,
    ];
    let blade = Blade::Plane(normal, 0.883_901_180_654_020_9);
    let params = CutParams {
        method: CutMethod::Rebuild,
        ..coarser(0.1)
    };
    let mut surface = body.build();
    let sweep = blade.sweep(&surface).expect("a plane");
    let mut cutter = Cutter::new(&surface);
    let outcome = cut_and_check(&mut surface, &mut cutter, &sweep, &params).expect("a full slice");
    assert_eq!(outcome.delta.pieces_added, [(1, 0)], "a tip comes off");
}

/// The tip of a cavity was taken for a fold of the surface because its section is small.
#[test]
fn the_tip_of_a_cavity_is_a_hole_of_the_section() {
    let (outer, inner) = (icosphere(2, 0.5), icosphere(2, 0.4));
    let count = u32::try_from(outer.rest.len()).expect("few vertices");
    let triangles = |s: &Surface| -> Vec<[u32; 3]> {
        let t = s.topology();
        t.triangles()
            .map(|id| t.triangle(id).map(|v| v.0))
            .collect()
    };
    let mut positions = outer.rest.clone();
    positions.extend(&inner.rest);
    let mut faces = triangles(&outer);
    faces.extend(
        triangles(&inner)
            .iter()
            .map(|&[a, b, c]| [a, c, b].map(|v| v + count)),
    );
    let hollow = Surface::from_triangles(&positions, &faces).expect("two spheres");
    // Along a direction in which the cavity has a vertex, just before it.
    let [x, y, z] = inner.rest[0].map(f64::from);
    for part in [0.0, 0.5, 0.9, 0.98] {
        let mut surface = hollow.clone();
        let d = part * (x * x + y * y + z * z);
        let sweep = Sweep::across_box([x, y, z], d, &surface.bounds()).expect("a plane");
        let mut cutter = Cutter::new(&surface);
        let result = cut_and_check(&mut surface, &mut cutter, &sweep, &rebuild());
        assert!(
            matches!(result, Err(CutError::NestedSection { .. })),
            "{part} of the way to the tip: {:?}",
            result.map(|outcome| outcome.report)
        );
    }
}

/// A plane that leaves only one corner's width of a cube: chords between far points left a flat
/// sheet of that side, of no volume.
#[test]
fn a_cube_cut_near_a_face_keeps_both_sides() {
    let corners: Vec<[f32; 3]> = (0..8u8)
        .map(|i| [i & 1, i >> 1 & 1, i >> 2 & 1].map(f32::from))
        .collect();
    let faces = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    let cube = Surface::from_triangles(&corners, &faces).unwrap();
    assert_eq!(cube.volume(), 1.0);
    let normal = [
        -0.999_087_967_067_1,
        -0.042_444_454_601_9,
        -0.004_658_575_981_6,
    ];
    let exact = 0.124;
    let mut body = cube.clone();
    let sweep = Sweep::across_box(normal, -0.898_312_815_462_6, &body.bounds()).unwrap();
    Cutter::new(&body)
        .cut(&mut body, &sweep, &rebuild())
        .unwrap();
    let smaller = body.piece_volumes().into_iter().fold(1.0, f64::min);
    assert!((smaller - exact).abs() < exact / 2.0, "{smaller}");
}

fn rebuild() -> CutParams {
    CutParams {
        method: CutMethod::Rebuild,
        ..CutParams::default()
    }
}

/// A tip of three triangles was contracted to one by snapping, and its cap was that one again: a piece
/// of two triangles back to back. The piece is the corner of an octant, cut off near its vertex.
#[test]
fn snapping_leaves_a_tip_its_triangles() {
    for snap in [0.05, 0.1, 0.3, 0.49] {
        for height in [0.5, 0.9, 0.95, 0.99, 0.999] {
            let corners = [
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.0, 0.0, 1.0],
            ];
            let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
            let mut body = Surface::from_triangles(&corners, &faces).expect("a tetrahedron");
            let sweep = Sweep::across_box([0.01, 0.02, 1.0], height, &body.bounds());
            let params = CutParams {
                snap,
                ..CutParams::default()
            };
            let mut cutter = Cutter::new(&body);
            let cut = cut_and_check(&mut body, &mut cutter, &sweep.expect("a plane"), &params);
            let pieces = cut.expect("a full slice").delta.pieces_added;
            assert_eq!(pieces, [(1, 0)], "the tip at {height}, snap {snap}");
            // One of two was flat: the tip's only vertex had been pulled onto the sweep.
            let tip = (1.0 - height).powi(3) / 6.0;
            let volumes = body.piece_volumes();
            assert!(
                volumes.iter().all(|&volume| volume > 0.5 * tip),
                "{volumes:?}, the tip at {height} has {tip}"
            );
        }
    }
}

/// Edges along a needle are ten thousand times as long as it is wide, and snapping moved what is little
/// for a body as wide as that: more than half of this one.
#[test]
fn snapping_leaves_a_needle_its_volume() {
    let corners: Vec<[f32; 3]> = (0..8u8)
        .map(|i| [i & 1, i >> 1 & 1, i >> 2 & 1].map(f32::from))
        .map(|[x, y, z]| [10.0 * x, 1e-3 * y, 1e-3 * z])
        .collect();
    let faces = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    let needle = Surface::from_triangles(&corners, &faces).expect("a box");
    for slope in [0.0, 1e-5, -1e-4, 1e-3, 0.1] {
        for part in [0.1, 0.3, 0.5, 0.8] {
            let mut body = needle.clone();
            let normal = [slope, 1.0, 0.4];
            let d = 5.0 * slope + 1.4e-3 * part;
            let sweep = Sweep::across_box(normal, d, &body.bounds()).expect("a plane");
            let mut cutter = Cutter::new(&body);
            let cut = cut_and_check(&mut body, &mut cutter, &sweep, &CutParams::default());
            cut.expect("a full slice");
            let change = (body.volume() - needle.volume()).abs() / needle.volume();
            assert!(
                change < 2e-3,
                "slope {slope} at {part} changed it by {change}"
            );
        }
    }
}

/// Where loops touched, the corners that were moved apart to triangulate them left the crease, and what
/// was between lay across it. Every bent sweep through two pieces that an earlier cut left side by
/// side touches so.
#[test]
fn a_bent_sweep_through_pieces_side_by_side_follows_its_crease() {
    let body = Body {
        shape: Shape::Icosphere(0),
        deformation: Deformation::Wild(0.2),
        lattice: None,
        seed: 0,
    };
    let mut surface = body.build();
    let mut cutter = Cutter::new(&surface);
    let blades = [
        Blade::Plane([0.0, 0.0, -0.785_037_711_961_721_5], 0.0),
        Blade::Bent([0.0, 1.0, 0.0], 0.0, 0.090_867_632_342_828_84),
    ];
    for blade in blades {
        let sweep = blade.sweep(&surface).expect("a sweep");
        let params = CutParams {
            snap: 0.0,
            ..CutParams::default()
        };
        let cut = cut_and_check(&mut surface, &mut cutter, &sweep, &params);
        cut.expect("a full slice");
    }
}

/// A point that had moved toward the crease had parents on both sides of it, and was not where they said.
#[test]
fn points_beside_a_crease_are_where_their_parents_say() {
    let body = Body {
        shape: Shape::CubeSphere(5),
        deformation: Deformation::Wild(1.122_776_985_539_091_7),
        lattice: None,
        seed: 0,
    };
    let mut surface = body.build();
    let mut cutter = Cutter::new(&surface);
    let normal = [
        -0.608_245_382_780_777_7,
        0.697_932_927_942_272_2,
        0.649_143_342_211_986_4,
    ];
    let blades = [
        (Blade::AxisThroughVertex(0, 62368), 0.1),
        (Blade::InFace(21516), 0.0),
        (
            Blade::Bent(normal, 0.223_260_120_685_637_58, -0.261_925_259_133_558_2),
            0.0,
        ),
    ];
    for (blade, snap) in blades {
        let sweep = blade.sweep(&surface).expect("a sweep");
        let params = coarser(snap);
        let cut = cut_and_check(&mut surface, &mut cutter, &sweep, &params);
        cut.expect("a full slice");
    }
}

/// A bent sweep of which the crease lay in the plane of a triangle but for rounding: where it pierces that was
/// all rounding, far off the crease, and the section was laid flat as if it were on it.
#[test]
fn a_crease_in_the_plane_of_a_triangle_is_met_where_it_runs() {
    let body = Body {
        shape: Shape::Torus(3, 4),
        deformation: Deformation::None,
        lattice: None,
        seed: 198,
    };
    let mut surface = body.build();
    let mut cutter = Cutter::new(&surface);
    let normal = [
        0.308_062_177_396_328_24,
        0.127_621_631_649_285_64,
        0.671_879_603_217_203_6,
    ];
    for blade in [
        Blade::Plane(normal, -0.043_426_369_718_057_134),
        Blade::InFace(35327),
    ] {
        let sweep = blade.sweep(&surface).expect("a sweep");
        let params = coarser(0.0);
        let cut = cut_and_check(&mut surface, &mut cutter, &sweep, &params);
        cut.expect("a full slice");
    }
}

/// Where a body had moved along one axis alone, rest positions in caps were carried on along the others as well,
/// and off by rounding.
#[test]
fn rest_positions_stay_means_along_axes_that_nothing_moved_along() {
    let mut surface = icosphere(2, 0.5);
    let vertices: Vec<_> = surface.topology().vertices().collect();
    for v in vertices {
        let [x, y, z, w] = surface.positions[v.index()];
        surface.positions[v.index()] = [x + 0.05 * (7.0 * y).sin(), y, z, w];
    }
    let mut cutter = Cutter::new(&surface);
    for (normal, part) in [([0.3, 0.8, 0.2], 0.1), ([0.9, 0.1, -0.4], -0.2)] {
        let sweep = Blade::Plane(normal, part).sweep(&surface).expect("a plane");
        let cut = cut_and_check(&mut surface, &mut cutter, &sweep, &CutParams::default());
        cut.expect("a full slice");
    }
}
