//! Counterexamples that property tests and reference cuts found.

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, icosphere};
use incise_paper::{PaperError, PaperParams};
use incise_refine::RefinementLevel;
use incise_tests::{Blade, Body, Deformation, Shape, cut_and_check, paper_cut_and_check};

/// Returns parameters for caps coarser than the surface.
fn coarser(snap: f64) -> CutParams {
    let mut params = CutParams {
        snap,
        ..CutParams::default()
    };
    params.refine.level = RefinementLevel::Coarser2;
    params
}

/// An old vertex replaced the point of an edge, so that walls and cap cancelled.
///
/// The piece beyond the plane vanished; the Euler characteristic detects it.
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
    let params = PaperParams {
        level: RefinementLevel::Coarser2,
        ..PaperParams::default()
    };
    let mut surface = body.build();
    let sweep = blade.sweep(&surface).expect("a plane");
    let mut cutter = Cutter::new(&surface);
    let outcome = paper_cut_and_check(&mut surface, &mut cutter, &sweep, &params);
    let outcome = outcome.expect("a full slice");
    assert_eq!(outcome.delta.pieces_added, [(1, 0)], "a tip comes off");
}

/// The small section of a cavity's tip was classified as a fold of the surface.
#[test]
fn the_tip_of_a_cavity_is_a_hole_of_the_section() {
    let (outer, inner) = (icosphere(2, 0.5), icosphere(2, 0.4));
    let count = u32::try_from(outer.rest_positions().len()).expect("few vertices");
    let triangles = |s: &Surface| -> Vec<[u32; 3]> {
        let t = s.topology();
        t.triangles()
            .map(|id| t.triangle(id).map(|v| v.0))
            .collect()
    };
    let mut positions = outer.rest_positions().to_vec();
    positions.extend(inner.rest_positions());
    let mut faces = triangles(&outer);
    faces.extend(
        triangles(&inner)
            .iter()
            .map(|&[a, b, c]| [a, c, b].map(|v| v + count)),
    );
    let hollow = Surface::from_triangles(&positions, &faces).expect("two spheres");
    // Planes between the center and a vertex of the cavity.
    let [x, y, z] = inner.rest_positions()[0].map(f64::from);
    for part in [0.0, 0.5, 0.9, 0.98] {
        let mut surface = hollow.clone();
        let d = part * (x * x + y * y + z * z);
        let sweep = Sweep::from_plane([x, y, z], d, &surface.bounds()).expect("a plane");
        let mut cutter = Cutter::new(&surface);
        let result =
            paper_cut_and_check(&mut surface, &mut cutter, &sweep, &PaperParams::default());
        assert!(
            matches!(result, Err(PaperError::NestedSection { .. })),
            "{part} of the way to the tip: {:?}",
            result.map(|outcome| outcome.report)
        );
    }
}

/// A plane close to a face of a cube: chords between distant points left a side without volume.
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
    let sweep = Sweep::from_plane(normal, -0.898_312_815_462_6, &body.bounds()).unwrap();
    let mut cutter = Cutter::new(&body);
    let outcome = incise_paper::cut(&mut cutter, &mut body, &sweep, &PaperParams::default());
    assert!(!outcome.unwrap().cut.is_miss());
    let smaller = body.piece_volumes().into_iter().fold(1.0, f64::min);
    assert!((smaller - exact).abs() < exact / 2.0, "{smaller}");
}

/// Snapping collapsed a tip of three triangles to one, which coincided with its cap.
///
/// The tip is the corner of an octant, cut off near its vertex.
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
            let sweep = Sweep::from_plane([0.01, 0.02, 1.0], height, &body.bounds());
            let params = CutParams {
                snap,
                ..CutParams::default()
            };
            let mut cutter = Cutter::new(&body);
            let cut = cut_and_check(&mut body, &mut cutter, &sweep.expect("a plane"), &params);
            let pieces = cut.expect("a full slice").delta.pieces_added;
            assert_eq!(pieces, [(1, 0)], "the tip at {height}, snap {snap}");
            // One piece was flat: its only vertex had been snapped onto the sweep.
            let tip = (1.0 - height).powi(3) / 6.0;
            let volumes = body.piece_volumes();
            assert!(
                volumes.iter().all(|&volume| volume > 0.5 * tip),
                "{volumes:?}, the tip at {height} has {tip}"
            );
        }
    }
}

/// Snapping a needle with edges 10,000 times its width moved more than half of its volume.
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
            let sweep = Sweep::from_plane(normal, d, &body.bounds()).expect("a plane");
            let mut cutter = Cutter::new(&body);
            let cut = cut_and_check(&mut body, &mut cutter, &sweep, &CutParams::default());
            let _ = cut.expect("a full slice");
            let change = (body.volume() - needle.volume()).abs() / needle.volume();
            assert!(
                change < 2e-3,
                "slope {slope} at {part} changed it by {change}"
            );
        }
    }
}

/// Corners of touching loops were separated away from the crease, so triangles crossed it.
///
/// Bent sweeps through two adjacent pieces of an earlier cut have such loops.
#[test]
fn a_bent_sweep_through_pieces_side_by_side_follows_its_crease() {
    let body = Body {
        shape: Shape::Icosphere(0),
        deformation: Deformation::SelfIntersecting(0.2),
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
        let _ = cut.expect("a full slice");
    }
}

/// A point that was moved toward the crease had parents on both sides of it.
#[test]
fn points_next_to_a_crease_lie_between_their_parents() {
    let body = Body {
        shape: Shape::CubeSphere(5),
        deformation: Deformation::SelfIntersecting(1.122_776_985_539_091_7),
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
        let _ = cut.expect("a full slice");
    }
}

/// The crease of a bent sweep lay in the plane of a triangle up to rounding.
///
/// The computed intersection point was far from the crease, but was unfolded as if it were on it.
#[test]
fn a_crease_in_the_plane_of_a_triangle_has_its_points_on_the_crease() {
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
        let _ = cut.expect("a full slice");
    }
}

/// In a body displaced along one axis, rest positions of caps had rounding errors along the others.
#[test]
fn rest_positions_are_exact_along_axes_without_displacement() {
    let mut surface = icosphere(2, 0.5);
    let vertices: Vec<_> = surface.topology().vertices().collect();
    for v in vertices {
        let [x, y, z, w] = surface.positions()[v.index()];
        surface.positions_mut()[v.index()] = [x + 0.05 * (7.0 * y).sin(), y, z, w];
    }
    let mut cutter = Cutter::new(&surface);
    for (normal, part) in [([0.3, 0.8, 0.2], 0.1), ([0.9, 0.1, -0.4], -0.2)] {
        let sweep = Blade::Plane(normal, part).sweep(&surface).expect("a plane");
        let cut = cut_and_check(&mut surface, &mut cutter, &sweep, &CutParams::default());
        let _ = cut.expect("a full slice");
    }
}
