//! Slits that cross slits.

use crate::common::{check, lattice_box, params, shortest_edge};
use incise_cut::{Cutter, Incision, Sweep};
use incise_mesh::{Surface, cube_sphere, icosphere};

/// A blade of two points at each of some poses.
type Path<'a> = &'a [[[f32; 3]; 2]];

/// A turned box, larger along one axis.
fn turned_box() -> Surface {
    let positions = [
        [-0.341_204_23, -0.292_448_1, -0.740_306_56],
        [-0.436_215_5, 0.639_009_24, -0.389_08],
        [-0.634_354_05, 0.275_551_2, 0.521_216_33],
        [-0.539_342_8, -0.655_906_14, 0.169_989_75],
        [0.634_354_05, -0.275_551_2, -0.521_216_33],
        [0.539_342_8, 0.655_906_14, -0.169_989_75],
        [0.341_204_23, 0.292_448_1, 0.740_306_56],
        [0.436_215_5, -0.639_009_24, 0.389_08],
    ];
    let faces = [
        [0, 2, 1],
        [0, 3, 2],
        [4, 5, 6],
        [4, 6, 7],
        [0, 7, 3],
        [0, 4, 7],
        [1, 2, 6],
        [1, 6, 5],
        [0, 5, 4],
        [0, 1, 5],
        [3, 7, 6],
        [3, 6, 2],
    ];
    Surface::from_triangles(&positions, &faces).unwrap()
}

/// Moves a new blade along each path; refused steps change nothing.
fn cut(body: &mut Surface, paths: &[Path<'_>], snap: f64) -> usize {
    let mut cutter = Cutter::new(body);
    let mut refused = 0;
    for path in paths {
        let mut incision = Incision::default();
        for pose in *path {
            let outcome = cutter.advance(body, &mut incision, pose, &params(snap));
            refused += usize::from(outcome.is_err());
            check(body);
        }
    }
    refused
}

#[test]
fn a_slit_crosses_the_tip_of_another_one() {
    let slit = [-0.888_367_9, -0.292_896_87, 0.302_574_13];
    let slit = slit.map(|z| [[0.0, -0.787_087_4, z], [0.0, 0.787_087_4, z]]);
    let across = [-0.888_367_9, -0.296_122_6, 0.296_122_6, 0.888_367_9];
    let across = across.map(|z| {
        [
            [-0.076_038_17, -1.309_944_7, z],
            [0.145_112_23, 1.303_696_2, z],
        ]
    });
    let mut body = turned_box();
    let refused = cut(&mut body, &[&slit, &across], 0.1);
    assert!(refused <= 1, "{refused} refused steps");
}

/// The section has a slit where it crosses the walls, whose sides stay apart.
#[test]
fn a_cut_across_a_slit_does_not_join_its_walls() {
    for cells in [1, 2, 5] {
        for depth in [-0.13, 0.07, 0.31] {
            for place in [-0.21, 0.011, 0.17] {
                let mut body = lattice_box([cells; 3], |p| p.map(|x| x - 0.5));
                let slit = [-0.9, depth].map(|z| [[0.012, -0.9, z], [0.012, 0.9, z]]);
                let across = [-0.9, 0.9].map(|z| [[-0.9, place, z], [0.9, place, z]]);
                let refused = cut(&mut body, &[&slit, &across], 0.1);
                assert_eq!(refused, 0);
                let shortest = shortest_edge(&body);
                assert!(shortest > 1e-4, "{cells} {depth} {place}: {shortest}");
            }
        }
    }
}

/// The walls, the tip and the blade at which points are one place lie in planes of symmetry.
#[test]
fn symmetric_slits_at_right_angles_leave_no_edge_without_length() {
    let bodies = [
        icosphere(2, 0.5),
        icosphere(3, 0.5),
        cube_sphere(1, 0.5),
        cube_sphere(8, 0.5),
    ];
    for (k, whole) in bodies.iter().enumerate() {
        for i in 0..12u8 {
            let i = f32::from(i);
            let (depth, offset) = (0.2 * (1.7 * i).sin(), 0.09 * (2.3 * i).cos());
            let path = |steps: f32, to: f32| {
                (0..=10u8).map(move |s| -0.6 + (0.6 + to) * f32::from(s).min(steps) / steps)
            };
            let slit: Vec<_> = path(7.0 + i % 3.0, depth)
                .map(|z| [[0.0, -0.8, z], [0.0, 0.8, z]])
                .collect();
            let across: Vec<_> = path(10.0, 0.6)
                .map(|z| [[-1.0, offset, z], [1.0, offset, z]])
                .collect();
            let mut body = whole.clone();
            let refused = cut(&mut body, &[&slit, &across], 0.1);
            assert_eq!(refused, 0, "body {k}, {i}");
            assert!(shortest_edge(&body) > 0.0, "body {k}, {i}");
        }
    }
}

#[test]
fn a_cross_on_the_skin_leaves_no_edge_without_length() {
    for (n, place) in [(16, 0.01f32), (8, 0.0), (12, 0.03)] {
        let mut body = cube_sphere(n, 0.5);
        let mut cutter = Cutter::new(&body);
        for edge in [[[-0.3, place], [0.3, place]], [[place, -0.3], [place, 0.3]]] {
            let pose = |y: f32| edge.map(|[x, z]| [x, y, z]);
            let sweep = Sweep::new(pose(1.0), pose(0.1)).unwrap();
            let _ = cutter.incise(&mut body, &sweep, &params(0.1)).unwrap();
            check(&body);
            assert!(shortest_edge(&body) > 0.0, "{n} cells, {place}");
        }
    }
}
