//! Cuts and what follows them have the same bits on any number of threads.

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, cube_sphere};
use incise_pbd_gpu::{Material, Solver, SolverParams};
use incise_scene::follow_cut;
use std::num::NonZeroUsize;

/// Cuts a ball along three planes, undoes the last cut and steps the rest.
fn cut_and_step(threads: Option<usize>) -> Surface {
    let threads = threads.and_then(NonZeroUsize::new);
    let mut surface = cube_sphere(40, 0.5);
    let mut solver = Solver::new(&mut surface, &Material::shell()).unwrap();
    let mut cutter = Cutter::new(&surface);
    cutter.set_threads(threads);
    cutter.set_defers_bvh(true);
    let mut undo = None;
    for normal in [[0.1, 1.0, 0.2], [1.0, 0.3, 0.1], [-0.3, 0.2, 1.0]] {
        cutter.refit_moved(&surface, &[]);
        let sweep = Sweep::from_plane(normal, 0.03, &surface.bounds()).unwrap();
        let outcome = cutter.cut(&mut surface, &sweep, &CutParams::default());
        let outcome = outcome.unwrap();
        let delta = &outcome.delta;
        assert!(delta.triangles_added.len() > 1500, "threads share the cut");
        follow_cut(&mut cutter, &mut solver, &mut surface, delta, threads).unwrap();
        cutter.bvh().validate(&surface).unwrap();
        undo = outcome.undo;
    }
    let delta = cutter.undo(&mut surface, undo.unwrap()).unwrap();
    solver.apply_delta(&mut surface, &delta).unwrap();
    let params = SolverParams {
        threads,
        ..SolverParams::default()
    };
    for _ in 0..2 {
        solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
    }
    surface
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let alone = cut_and_step(Some(1));
    for threads in [2, 3, 5, 8] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let shared = pool.build().unwrap().install(|| cut_and_step(None));
        assert_eq!(shared, alone, "{threads} threads");
    }
}
