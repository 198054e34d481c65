//! Early termination of iterations once a residual is reached.

use incise_mesh::Surface;
use incise_pbd_gpu::{Collider, Material, Solver, SolverParams, Stiffness};
use incise_test_support::surfaces::sphere;

const DT: f32 = 1.0 / 60.0;

/// Stiffness that is the same for any number of iterations.
fn rigid() -> Material {
    Material {
        stretch: Stiffness::Pbd(1.0),
        bending: None,
        ..Material::default()
    }
}

/// Returns a compressed sphere on the ground.
fn squeezed(levels: u32, material: &Material) -> (Surface, Solver) {
    let mut surface = sphere(levels, [0.0, 0.8, 0.0]);
    let mut solver = Solver::new(&mut surface, material).unwrap();
    solver
        .set_colliders(&[Collider::ground(0.0).into()])
        .unwrap();
    for p in surface.positions_mut() {
        p[1] = p[1].max(0.0) * 1.1;
    }
    (surface, solver)
}

fn params(iterations: u32, residual: Option<f32>) -> SolverParams {
    SolverParams {
        iterations,
        residual,
        ..SolverParams::paper()
    }
}

fn bits(surface: &Surface, solver: &Solver) -> Vec<[u32; 4]> {
    let all = surface.positions().iter().chain(solver.velocities());
    all.map(|p| p.map(f32::to_bits)).collect()
}

/// Returns the maximum distance along an axis between the vertices of two states \[m\].
fn apart(a: &Surface, b: &Surface) -> f32 {
    let pairs = a.positions().iter().zip(b.positions());
    let axes = pairs.flat_map(|(a, b)| [a[0] - b[0], a[1] - b[1], a[2] - b[2]]);
    axes.map(f32::abs).fold(0.0, f32::max)
}

#[test]
fn a_residual_of_zero_skips_nothing() {
    let soft = Material {
        stretch: Stiffness::Compliance(1e-5),
        bending: Some(Stiffness::Compliance(1e-2)),
        ..Material::default()
    };
    for material in [Material::default(), soft] {
        let [full, zero] = [None, Some(0.0)].map(|residual| {
            let (mut surface, mut solver) = squeezed(2, &material);
            let params = SolverParams {
                ..params(5, residual)
            }
            .with_substeps(DT, 3);
            for _ in 0..20 {
                let stats = solver.step(&mut surface, DT, &params).unwrap();
                assert_eq!(stats.iterations_skipped, 0);
            }
            bits(&surface, &solver)
        });
        assert!(full == zero, "it is the same step");
    }
}

#[test]
fn the_last_iterations_of_a_substep_are_skipped() {
    let (surface, solver) = squeezed(3, &rigid());
    let after = |iterations, residual| {
        let (mut surface, mut solver) = (surface.clone(), solver.clone());
        let stats = *solver
            .step(&mut surface, DT, &params(iterations, residual))
            .unwrap();
        (surface, solver, stats)
    };
    let mut kept_before = 0;
    for residual in [4e-3, 2e-3, 1e-3] {
        let (early, early_solver, stats) = after(60, Some(residual));
        let kept = 60 - stats.iterations_skipped;
        assert!((3..60).contains(&kept), "{kept} iterations at {residual}");
        assert!(kept > kept_before, "a smaller residual takes more of them");
        kept_before = kept;
        let (same, same_solver, _) = after(kept, None);
        assert!(bits(&early, &early_solver) == bits(&same, &same_solver));
        let constraints = solver.stretch().len() as u64;
        assert_eq!(stats.stretch_projections, 2 * u64::from(kept) * constraints);
        // Only the last iteration moved the body by less than the residual.
        let [two_less, one_less] = [2, 1].map(|n| after(kept - n, None).0);
        let rounding = 2.0 * f32::EPSILON;
        assert!(apart(&early, &one_less) < residual + rounding);
        assert!(apart(&one_less, &two_less) >= residual - rounding);
    }
}

#[test]
fn the_error_is_below_one_residual_per_skipped_iteration() {
    let mut surface = sphere(3, [0.0; 3]);
    let solver = Solver::new(&mut surface, &rigid()).unwrap();
    for p in surface.positions_mut() {
        p[1] *= 1.01;
    }
    let after = |residual| {
        let (mut surface, mut solver) = (surface.clone(), solver.clone());
        let params = SolverParams {
            gravity: [0.0; 3],
            ..params(200, residual)
        };
        let stats = *solver.step(&mut surface, DT, &params).unwrap();
        (surface, stats.iterations_skipped)
    };
    let (full, _) = after(None);
    let mut off_before = f32::INFINITY;
    for residual in [1e-3, 3e-4, 1e-4, 3e-5] {
        let (early, skipped) = after(Some(residual));
        let off = apart(&early, &full);
        let bound = residual * skipped as f32;
        assert!(
            off > 0.0 && off <= bound,
            "{off} m off, at most {bound} of {skipped} left out at {residual}"
        );
        assert!(off < off_before, "a smaller residual is nearer");
        off_before = off;
    }
}

#[test]
fn a_body_at_rest_takes_one_iteration() {
    let mut surface = sphere(3, [0.0; 3]);
    let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
    let params = SolverParams {
        gravity: [0.0; 3],
        residual: Some(1e-5),
        ..SolverParams::paper()
    }
    .with_substeps(DT, 4);
    let stats = *solver.step(&mut surface, DT, &params).unwrap();
    assert_eq!(stats.iterations_skipped, 4 * 4);
    let stretch = solver.stretch().len() as u64;
    assert_eq!(stats.stretch_projections, 2 * 4 * stretch);
    let single = SolverParams {
        iterations: 1,
        ..params
    };
    let stats = solver.step(&mut surface, DT, &single).unwrap();
    assert_eq!(stats.iterations_skipped, 0, "there is none to leave out");
}

#[test]
fn skipped_iterations_do_not_depend_on_threads() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let (mut surface, mut solver) = squeezed(7, &Material::default());
            let params = params(10, Some(2e-3));
            let mut skipped = Vec::new();
            for _ in 0..3 {
                let stats = solver.step(&mut surface, DT, &params).unwrap();
                skipped.push(stats.iterations_skipped);
            }
            (skipped, bits(&surface, &solver))
        })
    };
    let one = run(1);
    assert!(one.0.iter().sum::<u32>() > 0, "{:?}", one.0);
    assert!(one == run(2), "two threads differ from one");
    assert!(one == run(3), "three threads differ from one");
}

#[test]
fn an_invalid_residual_is_an_error() {
    let (mut surface, mut solver) = squeezed(1, &rigid());
    let before = surface.clone();
    for value in [-0.5, f32::INFINITY, f32::NAN] {
        let refused = solver.step(&mut surface, DT, &params(2, Some(value)));
        let text = format!("residual is {value}; it must be a finite number of at least 0");
        assert_eq!(refused.unwrap_err().to_string(), text);
    }
    assert_eq!(surface, before, "nothing was stepped");
}
