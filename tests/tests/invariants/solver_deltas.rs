//! A solver that applies the deltas of cuts has the constraints of one built from scratch, a valid
//! coloring, and the same mass and momentum.

use incise_cut::{CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::{Surface, TopologyDelta};
use incise_models::{Model, build_model};
use incise_paper::PaperParams;
use incise_pbd_gpu::{
    ConstraintSet, Density, MAX_COLORS, Material, PatchParams, Solver, SolverParams, Stiffness,
    Volume,
};
use incise_refine::RefinementLevel;
use incise_tests::{
    Blade, Body, any_blade, any_body, any_level, cases, cut_and_check, paper_cut_and_check,
};
use proptest::prelude::*;

/// Relative rounding of sums of thousands of masses in 32 bits.
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
        volume: Some(Volume::default()),
        ..Material::default()
    })
}

/// Sets a rotation, so that momentum differs between vertices.
fn spin(surface: &Surface, solver: &mut Solver) {
    for v in surface.topology().vertices() {
        let [x, y, z, _] = surface.positions()[v.index()];
        let to = [1.0 - y, x + 0.5 * z, -0.5 * y - 2.0];
        solver.set_velocity(v, to).expect("the vertex exists");
    }
}

/// Returns the total mass times the highest speed, for tolerances of rounding.
fn momentum_scale(solver: &Solver) -> f64 {
    let speed = |v: &[f32; 4]| {
        f64::from(v[0])
            .hypot(f64::from(v[1]))
            .hypot(f64::from(v[2]))
    };
    let fastest = solver.velocities().iter().map(speed).fold(0.0, f64::max);
    solver.total_mass() * fastest
}

/// Returns patches of any size, and no patches.
fn patches() -> impl Strategy<Value = Option<PatchParams>> {
    let sizes = (8..=256_u32).prop_flat_map(|vertices| (Just(vertices), 0..vertices));
    prop::option::of(sizes.prop_map(|(vertices, room)| PatchParams { vertices, room }))
}

/// Applies a delta and asserts the preserved sums.
fn follow_delta(solver: &mut Solver, surface: &mut Surface, delta: &TopologyDelta, mass: f64) {
    let (momentum, scale) = (solver.momentum(), momentum_scale(solver));
    solver
        .apply_delta(surface, delta)
        .expect("the delta of a cut fits");
    solver
        .validate(surface)
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
        let inverse = surface.positions()[v.index()][3];
        assert!(
            inverse > 0.0 && inverse.is_finite(),
            "{v} has no mass or all of it"
        );
    }
}

/// A cut method.
#[derive(Debug, Clone, Copy)]
enum Method {
    Exact { snap: f64, remesh: f64 },
    Paper,
}

impl Method {
    /// Cuts and checks the result; `None` for a refused cut.
    fn cut(
        self,
        surface: &mut Surface,
        cutter: &mut Cutter,
        sweep: &Sweep,
        level: RefinementLevel,
    ) -> Option<CutOutcome> {
        match self {
            Self::Exact { snap, remesh } => {
                let mut params = CutParams {
                    snap,
                    remesh,
                    ..CutParams::default()
                };
                params.refine.level = level;
                cut_and_check(surface, cutter, sweep, &params).ok()
            }
            Self::Paper => {
                let params = PaperParams {
                    level,
                    ..PaperParams::default()
                };
                paper_cut_and_check(surface, cutter, sweep, &params).ok()
            }
        }
    }
}

/// Returns the paper's method and the exact one with and without snapping.
fn methods() -> impl Strategy<Value = Method> {
    let exact = |snap| Method::Exact { snap, remesh: 0.0 };
    prop_oneof![
        1 => Just(Method::Paper),
        1 => Just(exact(0.0)),
        2 => Just(exact(0.1)),
    ]
}

fn follow(
    body: &Body,
    material: &Material,
    patches: Option<&PatchParams>,
    blades: &[(Blade, RefinementLevel, Method)],
    steps: usize,
) {
    let mut surface = body.build();
    let made = Solver::with_patches(&mut surface, material, patches);
    // On a coarse lattice vertices may coincide, and edges of length 0 have no constraint.
    let Ok(mut solver) = made else {
        return;
    };
    let mut cutter = Cutter::new(&surface);
    solver
        .validate(&surface)
        .expect("constraints made from scratch");
    spin(&surface, &mut solver);
    let (mass, step_params) = (solver.total_mass(), SolverParams::paper());
    let mut undos = Vec::new();
    for (blade, level, method) in blades {
        for _ in 0..steps {
            solver
                .step(&mut surface, 1.0 / 60.0, &step_params)
                .expect("positions stay finite");
        }
        cutter.refit(&surface);
        let Ok(sweep) = blade.sweep(&surface) else {
            continue;
        };
        let Some(outcome) = method.cut(&mut surface, &mut cutter, &sweep, *level) else {
            continue;
        };
        follow_delta(&mut solver, &mut surface, &outcome.delta, mass);
        undos.extend(outcome.undo);
    }
    // Undoes all cuts, whatever has moved since.
    for undo in undos.into_iter().rev() {
        let delta = (cutter.undo(&mut surface, undo)).expect("nothing was edited since");
        follow_delta(&mut solver, &mut surface, &delta, mass);
    }
    for _ in 0..steps {
        solver
            .step(&mut surface, 1.0 / 60.0, &step_params)
            .expect("positions stay finite");
    }
}

proptest! {
    #![proptest_config(cases(100))]

    #[test]
    fn constraints_mass_and_momentum_match_after_cuts(
        body in any_body(),
        material in materials(),
        patches in patches(),
        blades in prop::collection::vec((any_blade(), any_level(), methods()), 1..=6),
        steps in 0..4_usize,
    ) {
        follow(&body, &material, patches.as_ref(), &blades, steps);
    }
}

/// Returns the exact method with remeshing, which flips edges and removes vertices.
fn remeshing() -> impl Strategy<Value = Method> {
    let exact = |(snap, remesh)| Method::Exact { snap, remesh };
    (0.0..0.3_f64, 0.01..0.3_f64).prop_map(exact)
}

proptest! {
    #![proptest_config(cases(50))]

    #[test]
    fn constraints_mass_and_momentum_match_after_remeshing(
        body in any_body(),
        material in materials(),
        patches in patches(),
        blades in prop::collection::vec((any_blade(), any_level(), remeshing()), 1..=4),
        steps in 0..4_usize,
    ) {
        follow(&body, &material, patches.as_ref(), &blades, steps);
    }
}

/// A rotating body that is cut and restored keeps its angular momentum.
#[test]
fn angular_momentum_is_kept_by_exact_cuts_and_undo() {
    for (model, snap) in [
        (Model::Bunny, 0.1),
        (Model::Octopus, 0.0),
        (Model::Banana, 0.3),
    ] {
        let mut surface = build_model(model);
        let made = Solver::new(&mut surface, &Material::default());
        let mut solver = made.expect("a model has lengths");
        let mut cutter = Cutter::new(&surface);
        spin(&surface, &mut solver);
        let (about, reach) = ([0.3, -0.1, 0.2], 0.5 + surface.bounds().diagonal());
        let scale = momentum_scale(&solver) * reach;
        let expected = solver.angular_momentum(&surface, about);
        let assert_kept = |solver: &Solver, surface: &Surface, when: &str| {
            let found = solver.angular_momentum(surface, about);
            for (was, is) in expected.into_iter().zip(found) {
                assert!(
                    (is - was).abs() <= ROUNDING * scale,
                    "{model:?} {when}: {expected:?} became {found:?}"
                );
            }
        };
        let params = CutParams {
            snap,
            ..CutParams::default()
        };
        let mut undos = Vec::new();
        for (normal, part) in [([1.0, 0.2, 0.3], 0.1), ([0.1, 1.0, -0.4], -0.1)] {
            let sweep = Blade::Plane(normal, part).sweep(&surface).expect("a plane");
            let cut = cut_and_check(&mut surface, &mut cutter, &sweep, &params);
            let outcome = cut.expect("a full slice");
            (solver.apply_delta(&mut surface, &outcome.delta)).expect("the delta of a cut fits");
            assert_kept(&solver, &surface, "cut");
            undos.extend(outcome.undo);
            // Masses changed, positions did not.
            cutter.refit_moved(&surface, &[]);
        }
        assert_eq!(undos.len(), 2, "both planes cut");
        for undo in undos.into_iter().rev() {
            let delta = (cutter.undo(&mut surface, undo)).expect("nothing was edited since");
            (solver.apply_delta(&mut surface, &delta)).expect("the delta of an undo fits");
            assert_kept(&solver, &surface, "healed");
        }
    }
}

/// Returns the fraction of constraints within no patch.
fn outside_patches<const N: usize>(set: &ConstraintSet<N>) -> f64 {
    let colors = set.batches().iter().take(MAX_COLORS);
    let left: usize = colors.chain([set.overflow()]).map(|b| b.len()).sum();
    left as f64 / set.len() as f64
}

#[test]
fn few_constraints_are_outside_of_patches_after_cuts() {
    // Caps of the exact method have twice the triangles, all of them new.
    assert_fraction_after_cuts(Method::Paper, [0.01, 0.03]);
    let (snap, remesh) = (0.1, 0.0);
    assert_fraction_after_cuts(Method::Exact { snap, remesh }, [0.01, 0.04]);
}

/// Cuts four times and bounds the fraction of stretch and bending constraints in no patch.
fn assert_fraction_after_cuts(method: Method, most: [f64; 2]) {
    let mut surface = build_model(Model::Banana);
    let params = PatchParams::default();
    let mut solver = Solver::with_patches(&mut surface, &Material::default(), Some(&params))
        .expect("a model has lengths");
    let mut cutter = Cutter::new(&surface);
    let normals = [
        [1.0, 0.1, 0.2],
        [0.1, 1.0, 0.3],
        [0.3, 0.2, 1.0],
        [1.0, -1.0, 0.5],
    ];
    for normal in normals {
        let bounds = surface.bounds();
        let center = bounds.center();
        let d = normal
            .iter()
            .zip(center.iter())
            .map(|(n, c)| n * c)
            .sum::<f64>();
        let sweep = Sweep::from_plane(normal, d, &bounds).expect("a plane");
        cutter.refit(&surface);
        let level = RefinementLevel::Original;
        let cut = method.cut(&mut surface, &mut cutter, &sweep, level);
        let outcome = cut.expect("a plane through the middle cuts");
        solver
            .apply_delta(&mut surface, &outcome.delta)
            .expect("the delta of a cut fits");
        assert_eq!(solver.validate(&surface), Ok(()), "{method:?}");
        let bending = solver.bending().expect("the material bends");
        let left = [outside_patches(solver.stretch()), outside_patches(bending)];
        assert!(
            left[0] < most[0] && left[1] < most[1],
            "{left:?} of stretch and bending constraints are in no patch"
        );
    }
}
