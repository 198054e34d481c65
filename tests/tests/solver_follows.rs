//! A solver that follows cuts by their deltas: its constraints are those that it would get from
//! scratch, its colors are proper, mass and momentum are what they were.

use incise_cut::{CutParams, Cutter};
use incise_mesh::Surface;
use incise_pbd_gpu::{Density, Material, Solver, SolverParams, Stiffness};
use incise_refine::{RefineParams, RefinementLevel};
use incise_tests::{Blade, Body, any_blade, any_body, any_level, cases, cut_and_check};
use proptest::prelude::*;

/// Sums of thousands of masses that are stored in f32 [relative].
const ROUNDING: f64 = 1e-5;

fn materials() -> impl Strategy<Value = Material> {
    let stiffness = prop_oneof![
        (0.1..=1.0_f32).prop_map(Stiffness::Pbd),
        (0.0..1e-3_f32).prop_map(Stiffness::Compliance),
    ];
    let bending = prop::option::of(stiffness.clone());
    (0.1..5.0_f32, stiffness, bending).prop_map(|(density, stretch, bending)| Material {
        density: Density::Area(density),
        stretch,
        bending,
        ..Material::default()
    })
}

/// Sets a turning motion, so that momentum differs from vertex to vertex.
fn spin(surface: &Surface, solver: &mut Solver) {
    for v in surface.topology().vertices() {
        let [x, y, z, _] = surface.positions[v.index()];
        let to = [1.0 - y, x + 0.5 * z, -0.5 * y - 2.0];
        solver.set_velocity(v, to).expect("the vertex exists");
    }
}

/// The largest momentum that the masses could have at the largest speed, to which rounding is relative.
fn momentum_scale(solver: &Solver) -> f64 {
    let speed = |v: &[f32; 4]| {
        f64::from(v[0])
            .hypot(f64::from(v[1]))
            .hypot(f64::from(v[2]))
    };
    let fastest = solver.velocities().iter().map(speed).fold(0.0, f64::max);
    solver.total_mass() * fastest
}

fn follow(body: &Body, material: &Material, blades: &[(Blade, RefinementLevel)], steps: usize) {
    let mut surface = body.build();
    // A coarse lattice may make vertices coincide: edges without length have no constraint.
    let Ok(mut solver) = Solver::new(&mut surface, material) else {
        return;
    };
    let mut cutter = Cutter::new(&surface);
    solver
        .validate(&surface)
        .expect("constraints made from scratch");
    spin(&surface, &mut solver);
    let (mass, step_params) = (solver.total_mass(), SolverParams::default());
    for (blade, level) in blades {
        for _ in 0..steps {
            solver
                .step(&mut surface, 1.0 / 60.0, &step_params)
                .expect("positions stay finite");
        }
        cutter.refit(&surface);
        let params = CutParams {
            refine: RefineParams {
                level: *level,
                ..RefineParams::default()
            },
            ..CutParams::default()
        };
        let Ok(sweep) = blade.sweep(&surface) else {
            continue;
        };
        let Ok(outcome) = cut_and_check(&mut surface, &mut cutter, &sweep, &params) else {
            continue;
        };
        let (momentum, scale) = (solver.momentum(), momentum_scale(&solver));
        solver
            .apply_delta(&mut surface, &outcome.delta)
            .expect("the delta of a cut fits");
        solver
            .validate(&surface)
            .expect("constraints are those from scratch");
        let lost = (solver.total_mass() - mass).abs();
        assert!(lost <= ROUNDING * mass, "mass {mass} changed by {lost}");
        for (was, is) in momentum.into_iter().zip(solver.momentum()) {
            assert!(
                (is - was).abs() <= ROUNDING * scale,
                "momentum {was} became {is}"
            );
        }
        for v in surface.topology().vertices() {
            let inverse = surface.positions[v.index()][3];
            assert!(
                inverse > 0.0 && inverse.is_finite(),
                "{v} has no mass or all of it"
            );
        }
    }
    for _ in 0..steps {
        solver
            .step(&mut surface, 1.0 / 60.0, &step_params)
            .expect("positions stay finite");
    }
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn constraints_mass_and_momentum_follow_cuts(
        body in any_body(),
        material in materials(),
        blades in prop::collection::vec((any_blade(), any_level()), 1..=6),
        steps in 0..4_usize,
    ) {
        follow(&body, &material, &blades, steps);
    }
}
