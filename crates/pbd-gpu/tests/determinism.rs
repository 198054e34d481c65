//! Bit-identical results on any number of threads, and no allocation while stepping.

use incise_pbd_gpu::{Material, Solver, SolverParams, Stiffness, Volume};
use incise_test_support::surfaces::sphere;

fn run(threads: usize) -> Vec<[u32; 4]> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    pool.install(|| {
        let mut surface = sphere(7, [0.0, 1.01, 0.0]);
        let material = Material {
            volume: Some(Volume::default()),
            ..Material::default()
        };
        let mut solver = Solver::new(&mut surface, &material).unwrap();
        let params = SolverParams {
            ground: Some(0.0),
            ..SolverParams::paper()
        };
        for _ in 0..4 {
            solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
        }
        let bits = |p: &[f32; 4]| p.map(f32::to_bits);
        surface.positions().iter().map(bits).collect()
    })
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    let one = run(1);
    assert!(one == run(2), "two threads differ from one");
    for count in [3, 4, 16, 64] {
        assert!(one == run(count), "{count} threads differ from one");
    }
}

#[test]
fn a_step_does_not_allocate() {
    let stiffnesses = [Stiffness::Pbd(1.0), Stiffness::Compliance(1e-6)];
    for (stiffness, residual) in stiffnesses.into_iter().zip([None, Some(1e-4)]) {
        let mut surface = sphere(3, [0.0, 1.2, 0.0]);
        let material = Material {
            stretch: stiffness,
            bending: Some(stiffness),
            volume: Some(Volume::default()),
            ..Material::default()
        };
        let mut solver = Solver::new(&mut surface, &material).unwrap();
        let params = SolverParams {
            ground: Some(0.0),
            residual,
            ..SolverParams::paper()
        };
        solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
        let room = solver.capacity();
        for _ in 0..100 {
            solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
            assert_eq!(solver.capacity(), room);
        }
    }
}
