//! Cuts have the same bits on any number of threads.

use incise_cut::{CutError, CutParams, Cutter, Sweep};
use incise_mesh::{Surface, cube_sphere, torus};
use std::num::NonZeroUsize;

/// Cuts a body along three planes and undoes the last cut.
fn cuts(mut surface: Surface, params: &CutParams, threads: Option<usize>) -> Surface {
    let mut cutter = Cutter::new(&surface);
    cutter.set_threads(threads.and_then(NonZeroUsize::new));
    for normal in [[0.1, 1.0, 0.2], [1.0, 0.3, 0.1], [-0.3, 0.2, 1.0]] {
        let sweep = Sweep::from_plane(normal, 0.03, &surface.bounds()).unwrap();
        let outcome = cutter.cut(&mut surface, &sweep, params).unwrap();
        assert!(!outcome.is_miss(), "{normal:?} passes through the body");
        if normal[2] == 1.0 {
            cutter.undo(&mut surface, outcome.undo.unwrap()).unwrap();
        }
    }
    cutter.bvh().validate(&surface).unwrap();
    surface
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let sharp = CutParams {
        snap: 0.0,
        ..CutParams::default()
    };
    for params in [CutParams::default(), sharp] {
        for body in [cube_sphere(40, 0.5), torus(0.5, 0.2, 160, 60)] {
            let alone = cuts(body.clone(), &params, Some(1));
            assert!(alone.piece_bound() >= 4, "parts of the body are pieces");
            for threads in [2, 3, 5, 8] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
                let shared = (pool.build().unwrap()).install(|| cuts(body.clone(), &params, None));
                assert_eq!(shared, alone, "{threads} threads");
            }
        }
    }
}

#[test]
fn a_deferred_bvh_is_updated_before_the_next_cut() {
    let mut surface = cube_sphere(8, 0.5);
    let mut cutter = Cutter::new(&surface);
    cutter.set_defers_bvh(true);
    let mut cut = |cutter: &mut Cutter, height: f64| {
        let sweep = Sweep::from_plane([0.1, 1.0, 0.2], height, &surface.bounds()).unwrap();
        let outcome = cutter.cut(&mut surface, &sweep, &CutParams::default());
        (outcome, surface.clone())
    };
    let (outcome, after) = cut(&mut cutter, 0.03);
    let delta = outcome.unwrap().delta;
    assert_eq!(cut(&mut cutter, 0.2).0, Err(CutError::SurfaceEdited));
    cutter.update_bvh(&after, &delta);
    cutter.bvh().validate(&after).unwrap();
    assert!(cut(&mut cutter, 0.2).0.is_ok());
}
