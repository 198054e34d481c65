//! Cuts do not fold the skin.

use crate::common::{check, folds, lattice_box, params};
use incise_cut::{Cutter, Incision};
use incise_mesh::{Surface, icosphere, torus};
use proptest::prelude::*;

/// Moves a blade along poses, up to a refused step, and asserts that no step folds the skin.
fn assert_unfolded(mut body: Surface, poses: &[[[f32; 3]; 2]], snap: f64) {
    let mut cutter = Cutter::new(&body);
    let mut incision = Incision::default();
    for (i, pose) in poses.iter().enumerate() {
        let outcome = cutter.advance(&mut body, &mut incision, pose, &params(snap));
        if outcome.is_err() {
            break;
        }
        check(&body);
        let found = folds(&body);
        assert_eq!(found, [], "step {i}");
    }
}

#[test]
fn a_blade_turning_through_a_corner_of_a_cube() {
    let cube = lattice_box([1; 3], |p| p.map(|x| x - 0.5));
    let poses = [
        [[-0.84, 0.69, -0.27], [-0.96, 0.93, 0.29]],
        [[-0.49, 0.37, -0.54], [-0.6, 0.61, 0.02]],
        [[-0.1, -0.02, -1.03], [-0.21, 0.21, -0.47]],
    ];
    assert_unfolded(cube, &poses, 0.0);
}

/// Returns the cube of side 1 with a diagonal of each face chosen by a bit.
fn cube(diagonals: u32) -> Surface {
    let quads = [
        [0, 3, 2, 1],
        [4, 5, 6, 7],
        [0, 4, 7, 3],
        [1, 2, 6, 5],
        [0, 1, 5, 4],
        [3, 7, 6, 2],
    ];
    let corner = |i: u32| {
        let [x, y, z] = [i / 4, u32::from(i % 4 == 1 || i % 4 == 2), i % 4 / 2];
        [x, y, z].map(|bit| if bit == 0 { -0.5 } else { 0.5 })
    };
    let positions: Vec<[f32; 3]> = (0..8).map(corner).collect();
    let faces = quads.into_iter().enumerate().flat_map(|(k, [a, b, c, d])| {
        if diagonals >> k & 1 == 0 {
            [[a, b, c], [a, c, d]]
        } else {
            [[b, c, d], [b, d, a]]
        }
    });
    Surface::from_triangles(&positions, &faces.collect::<Vec<_>>()).unwrap()
}

/// The sweep passed through itself: its curve crossed the one from the tip, in one triangle.
#[test]
fn a_sweep_through_itself_does_not_fold_the_skin() {
    let poses = [
        [
            [0.376_680_14, 0.918_717_6, -1.102_284_4],
            [0.190_379_02, 0.230_752_11, 0.590_283_4],
        ],
        [
            [0.031_410_314, 1.084_857_1, -1.154_562_6],
            [-0.119_766_9, 0.405_698_75, 0.566_245_14],
        ],
        [
            [0.108_988_22, 1.166_405_3, -1.633_723],
            [-0.076_559_08, 0.552_344_56, 0.122_986_06],
        ],
        [
            [-0.091_334_276, 1.178_353_5, -1.197_477],
            [-0.217_370_33, 0.549_743_8, 0.611_000_36],
        ],
    ];
    assert_unfolded(cube(54), &poses, 0.0);
    let poses = [
        [
            [-0.433_603_7, -0.821_566_5, 0.556_371_45],
            [-0.495_573_34, -0.446_397_96, -0.199_154_62],
        ],
        [
            [-0.243_665_87, -0.473_579_65, 0.565_213_8],
            [-0.394_209_44, -0.044_683_3, -0.189_067],
        ],
        [
            [-0.140_779_39, -0.792_667_03, 0.270_433_9],
            [-0.220_242_17, -0.352_560_13, -0.432_769_54],
        ],
        [
            [0.304_750_26, -0.618_636_97, -0.079_465_82],
            [0.252_642_72, -0.239_907_49, -0.804_062_1],
        ],
        [
            [0.646_505_4, -0.238_700_67, -0.295_120_57],
            [0.610_769_9, 0.198_229_33, -1.073_757_2],
        ],
    ];
    assert_unfolded(cube(21), &poses, 0.1);
}

fn bodies() -> impl Strategy<Value = Surface> {
    prop_oneof![
        (0u32..64).prop_map(cube),
        prop::sample::select(vec![
            icosphere(0, 0.6),
            icosphere(1, 0.6),
            icosphere(2, 0.6),
            torus(0.4, 0.2, 5, 4),
            torus(0.4, 0.2, 12, 8),
            lattice_box([1, 2, 3], |p| p.map(|x| x - 0.5)),
        ]),
    ]
}

fn vector(size: f32) -> impl Strategy<Value = [f32; 3]> {
    prop::array::uniform3(-size..size)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]
    #[test]
    fn saws_do_not_fold_the_skin(
        body in bodies(),
        ends in [vector(1.2), vector(1.2)],
        steps in prop::collection::vec((vector(0.5), vector(0.05)), 1..8),
        snap in prop::sample::select(vec![0.0, 0.1]),
        scale in prop::sample::select(vec![1.0, 1e-3, 100.0]),
    ) {
        let mut pose = ends;
        let mut poses = vec![pose];
        for (motion, turn) in steps {
            pose = [pose[0], pose[1]].map(|p| [0, 1, 2].map(|k| p[k] + motion[k]));
            for k in 0..3 {
                pose[1][k] += turn[k];
            }
            poses.push(pose);
        }
        let mut body = body;
        for p in body.positions_mut() {
            (0..3).for_each(|k| p[k] *= scale);
        }
        for p in body.rest_positions_mut() {
            (0..3).for_each(|k| p[k] *= scale);
        }
        let scaled = poses.iter().map(|pose| pose.map(|p| p.map(|x| x * scale)));
        assert_unfolded(body, &scaled.collect::<Vec<_>>(), snap);
    }
}
