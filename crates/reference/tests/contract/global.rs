//! The solver's global step against converged steps, also while its factor lags behind a cut.

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, TriangleId, icosphere, torus};
use incise_pbd_gpu::{Material, Scheme, Solver, SolverParams, Stiffness};
use incise_reference::{Model, State, Stepper};

const DT: f32 = 1.0 / 60.0;

fn params(iterations: u32) -> SolverParams {
    SolverParams {
        iterations,
        scheme: Scheme::Global,
        ..SolverParams::paper()
    }
}

/// A body that hangs from its highest vertices.
fn hung(mut surface: Surface) -> (Surface, Solver) {
    let material = Material {
        stretch: Stiffness::Compliance(1e-4),
        bending: Some(Stiffness::Compliance(1e-1)),
        damping: 0.0,
        ..Material::default()
    };
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    let top = surface.bounds().max[1] - 0.05;
    let is_high = |v: &incise_mesh::VertexId| surface.positions()[v.index()][1] > top;
    let pins: Vec<_> = surface.topology().vertices().filter(is_high).collect();
    for v in pins {
        solver.pin(&mut surface, v).unwrap();
    }
    (surface, solver)
}

/// Steps by a frame and returns the error of the step, as a share of its motion.
fn step_error(surface: &mut Surface, solver: &mut Solver, iterations: u32) -> f64 {
    let model = Model::of(solver, surface, &params(1)).unwrap();
    let start = State::of(solver, surface);
    let mut exact = start.clone();
    let mut stepper = Stepper::new(&model).unwrap();
    stepper.step(&mut exact, f64::from(DT), &[]).unwrap();
    solver.step(surface, DT, &params(iterations)).unwrap();
    let found = State::of(solver, surface);
    let distance = |a: &State, b: &State| {
        let pairs = a.x.iter().zip(&b.x).zip(&model.mass);
        pairs
            .map(|((a, b), m)| m * (a - b).norm_squared())
            .sum::<f64>()
            .sqrt()
    };
    distance(&found, &exact) / distance(&start, &exact)
}

#[test]
fn many_iterations_converge_to_the_implicit_step() {
    for surface in [icosphere(2, 0.5), torus(0.4, 0.15, 24, 12)] {
        let (mut surface, mut solver) = hung(surface);
        let mut worst = 0.0_f64;
        for _ in 0..3 {
            worst = worst.max(step_error(&mut surface, &mut solver, 60));
        }
        // Motions of a stiff body are a hundredth of an edge; 32-bit positions round them.
        assert!(worst < 5e-3, "{worst} of the motion");
    }
}

#[test]
fn the_accuracy_returns_after_a_cut() {
    let (mut surface, mut solver) = hung(icosphere(2, 0.5));
    for _ in 0..10 {
        solver.step(&mut surface, DT, &params(12)).unwrap();
    }
    let before = step_error(&mut surface, &mut solver, 12);
    let sweep = Sweep::from_plane([1.0, 0.3, 0.2], 0.02, &surface.bounds()).unwrap();
    let mut cutter = Cutter::new(&surface);
    let cut = cutter
        .cut(&mut surface, &sweep, &CutParams::default())
        .unwrap();
    solver.apply_delta(&mut surface, &cut.delta).unwrap();
    let errors: Vec<f64> = (0..6)
        .map(|_| step_error(&mut surface, &mut solver, 12))
        .collect();
    assert_eq!(solver.global_stats().factorizations, 2, "one after the cut");
    // At worst the body does not move while the old factor is in use.
    assert!(errors[0] < 1.1 && errors[1] < 1.1, "{errors:?}");
    assert!(
        errors[2] < 0.15 && errors[5] < 0.02,
        "{errors:?} with the new factor"
    );
    assert!(before < 0.02, "{before} before the cut");
}

/// A piece without pins starts to fall in the frame of the cut, while the factor still ties it to
/// the held one.
#[test]
fn a_piece_that_is_cut_off_falls_at_once() {
    let (mut surface, mut solver) = hung(icosphere(3, 0.5));
    for _ in 0..10 {
        solver.step(&mut surface, DT, &params(12)).unwrap();
    }
    let sweep = Sweep::from_plane([0.1, 1.0, 0.2], 0.0, &surface.bounds()).unwrap();
    let mut cutter = Cutter::new(&surface);
    let cut = cutter
        .cut(&mut surface, &sweep, &CutParams::default())
        .unwrap();
    solver.apply_delta(&mut surface, &cut.delta).unwrap();
    let topology = surface.topology();
    let height = |t: TriangleId| surface.triangle_positions(t)[0].y;
    let lowest = topology
        .triangles()
        .min_by(|&a, &b| height(a).total_cmp(&height(b)));
    let free = surface.piece(lowest.unwrap());
    let mut is_free = vec![false; surface.positions().len()];
    for t in topology.triangles().filter(|&t| surface.piece(t) == free) {
        for v in topology.triangle(t) {
            is_free[v.index()] = true;
        }
    }
    assert!(solver.pins().iter().all(|pin| !is_free[pin.vertex.index()]));
    let momentum = |solver: &Solver| {
        let mut sums = (0.0, 0.0);
        for (v, _) in is_free.iter().enumerate().filter(|(_, is_free)| **is_free) {
            let mass = f64::from(solver.masses()[v]);
            sums.0 += mass;
            sums.1 += mass * f64::from(solver.velocities()[v][1]);
        }
        sums
    };
    let (mass, before) = momentum(&solver);
    solver.step(&mut surface, DT, &params(12)).unwrap();
    let (_, after) = momentum(&solver);
    let share = (after - before) / (-9.81 * f64::from(DT) * mass);
    assert!((share - 1.0).abs() < 0.25, "{share} of the weight acts");
}
