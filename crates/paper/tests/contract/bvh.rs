//! BVH, undo and deferred updates of a cutter whose surface the paper's method cuts.

use incise_cut::{CutError, CutParams, Cutter, Sweep};
use incise_mesh::{Surface, cube_sphere, torus};
use incise_paper::{PaperError, PaperParams, cut};
use incise_test_support::random::Random;
use proptest::prelude::*;

fn plane(normal: [f64; 3], d: f64, surface: &Surface) -> Sweep {
    Sweep::from_plane(normal, d, &surface.bounds()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Cuts of both methods, undos and motion in any order.
    #[test]
    fn the_bvh_follows_cuts_and_undos(seed in any::<u64>(), steps in 1..12_usize) {
        let mut random = Random::new(seed);
        let mut surface = if seed % 2 == 0 { torus(1.0, 0.4, 24, 12) } else { cube_sphere(8, 0.9) };
        let mut cutter = Cutter::new(&surface);
        for _ in 0..steps {
            let [x, y, z, d] = [(); 4].map(|()| random.signed());
            let sweep = plane([x, y, z + 1.5], 0.8 * d, &surface);
            // A cut that fails changes nothing.
            let undo = if random.below(2) == 0 {
                let cut = cut(&mut cutter, &mut surface, &sweep, &PaperParams::default());
                cut.ok().and_then(|outcome| outcome.cut.undo)
            } else {
                let cut = cutter.cut(&mut surface, &sweep, &CutParams::default());
                cut.ok().and_then(|outcome| outcome.undo)
            };
            cutter.bvh().validate(&surface).unwrap();
            surface.validate_closed().unwrap();
            if let Some(undo) = undo && random.below(2) == 0 {
                cutter.undo(&mut surface, undo).unwrap();
                cutter.bvh().validate(&surface).unwrap();
            }
            for p in surface.positions_mut() {
                p[random.below(3)] += 0.01;
            }
            cutter.refit(&surface);
        }
    }
}

#[test]
fn a_deferred_bvh_is_updated_before_the_next_cut() {
    let mut surface = cube_sphere(8, 0.5);
    let mut cutter = Cutter::new(&surface);
    cutter.set_defers_bvh(true);
    let params = PaperParams::default();
    let sweep = plane([0.1, 1.0, 0.2], 0.03, &surface);
    let outcome = cut(&mut cutter, &mut surface, &sweep, &params).unwrap();
    let next = plane([0.1, 1.0, 0.2], 0.2, &surface);
    let refused = cut(&mut cutter, &mut surface, &next, &params);
    assert_eq!(refused, Err(PaperError::Cut(CutError::SurfaceEdited)));
    cutter.update_bvh(&surface, &outcome.cut.delta);
    cutter.bvh().validate(&surface).unwrap();
    let outcome = cut(&mut cutter, &mut surface, &next, &params).unwrap();
    assert!(!outcome.cut.is_miss());
}
