//! Slits that cross slits.

use crate::common::{check, params};
use incise_cut::{Cutter, Incision, Sweep};
use incise_mesh::{Surface, icosphere};

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
        [0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 7, 3], [0, 4, 7],
        [1, 2, 6], [1, 6, 5], [0, 5, 4], [0, 1, 5], [3, 7, 6], [3, 6, 2],
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
            if let Err(e) = &outcome { eprintln!("{e}"); }
            refused += usize::from(outcome.is_err());
            check(body);
        }
    }
    refused
}

#[test]
fn a_slit_across_the_tip_of_another_one() {
    let slit = [-0.888_367_9, -0.292_896_87, 0.302_574_13];
    let slit = slit.map(|z| [[0.0, -0.787_087_4, z], [0.0, 0.787_087_4, z]]);
    let across = [-0.888_367_9, -0.296_122_6, 0.296_122_6, 0.888_367_9];
    let across = across.map(|z| [[-0.076_038_17, -1.309_944_7, z], [0.145_112_23, 1.303_696_2, z]]);
    let mut body = turned_box();
    let refused = cut(&mut body, &[&slit, &across], 0.1);
    eprintln!("refused {refused}");
}

#[test]
fn fifty_sweeps_of_a_ball() {
    for seed in 0..8u64 {
        let mut random = incise_test_random(seed);
        let mut body = icosphere(2, 0.5);
        let mut cutter = Cutter::new(&body);
        let mut errors = 0;
        for _ in 0..50 {
            let mut v = || { let v = [random(), random(), random()]; v };
            // unit vectors
            let unit = |v: [f64;3]| { let l = v.iter().map(|x| x*x).sum::<f64>().sqrt(); v.map(|x| x / l) };
            let d = unit(v());
            let w = v();
            let e = unit([d[1]*w[2]-d[2]*w[1], d[2]*w[0]-d[0]*w[2], d[0]*w[1]-d[1]*w[0]]);
            let p = |a: f64, b: f64| [0,1,2].map(|k| (d[k]*a + e[k]*b) as f32);
            let sweep = Sweep::new([p(0.7,-1.0), p(0.7,1.0)], [p(0.5 - 0.6, -1.0), p(0.5 - 0.6, 1.0)]).unwrap();
            let r = cutter.incise(&mut body, &sweep, &params(0.1));
            if r.is_err() { errors += 1; }
            check(&body);
        }
        eprintln!("seed {seed} errors {errors}");
    }
}

fn incise_test_random(seed: u64) -> impl FnMut() -> f64 {
    let mut s = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(12345);
    move || {
        s ^= s << 13; s ^= s >> 7; s ^= s << 17;
        (s >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}
