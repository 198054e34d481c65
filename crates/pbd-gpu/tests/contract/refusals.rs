//! Invalid inputs cause typed errors and change nothing.

use incise_mesh::{Surface, TopologyDelta, TriangleId, VertexId};
use incise_pbd_gpu::{
    Collider, ConstraintError, Density, Integrator, Material, Solver, SolverParams, StepError,
    Stiffness,
};
use incise_test_support::surfaces::sphere;

const FRAME: f32 = 1.0 / 60.0;

const PARAMS: SolverParams = SolverParams::paper();

/// Returns the bits of positions and velocities.
fn bits(surface: &Surface, solver: &Solver) -> [Vec<[u32; 4]>; 2] {
    [surface.positions(), solver.velocities()]
        .map(|all| all.iter().map(|v| v.map(f32::to_bits)).collect())
}

/// A ball that has moved for some frames.
fn moving() -> (Surface, Solver) {
    let mut surface = sphere(2, [0.0, 1.1, 0.0]);
    let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
    solver
        .set_colliders(&[Collider::ground(0.0).into()])
        .unwrap();
    for _ in 0..10 {
        solver.step(&mut surface, FRAME, &PARAMS).unwrap();
    }
    (surface, solver)
}

#[test]
fn invalid_materials_and_positions_leave_the_surface_unchanged() {
    type Spoil = fn(&mut Surface, &mut Material);
    let bad: [(&str, Spoil); 14] = [
        ("density 0", |_, m| m.density = Density::Area(0.0)),
        ("density NaN", |_, m| m.density = Density::Area(f32::NAN)),
        ("compliance -1", |_, m| {
            m.stretch = Stiffness::Compliance(-1.0);
        }),
        ("compliance NaN", |_, m| {
            m.bending = Some(Stiffness::Compliance(f32::NAN));
        }),
        ("compliance infinite", |_, m| {
            m.stretch = Stiffness::Compliance(f32::INFINITY);
        }),
        ("stiffness 1.5", |_, m| m.stretch = Stiffness::Pbd(1.5)),
        ("stiffness NaN", |_, m| {
            m.bending = Some(Stiffness::Pbd(f32::NAN));
        }),
        ("friction -1", |_, m| m.friction = -1.0),
        ("damping NaN", |_, m| m.damping = f32::NAN),
        ("position NaN", |s, _| s.positions_mut()[7][1] = f32::NAN),
        ("position infinite", |s, _| {
            s.positions_mut()[7][1] = f32::NEG_INFINITY;
        }),
        ("rest position NaN", |s, _| {
            s.rest_positions_mut()[7][2] = f32::NAN
        }),
        ("rest position infinite", |s, _| {
            s.rest_positions_mut()[7][2] = f32::INFINITY;
        }),
        ("a density by volume of a body inside out", |s, m| {
            m.density = Density::Volume(1.0);
            s.rest_positions_mut().iter_mut().for_each(|r| r[0] = -r[0]);
        }),
    ];
    for (name, spoil) in bad {
        let (mut surface, mut material) = (sphere(1, [0.0; 3]), Material::default());
        spoil(&mut surface, &mut material);
        let bits = |s: &Surface| -> Vec<[u32; 4]> {
            s.positions().iter().map(|p| p.map(f32::to_bits)).collect()
        };
        let before = bits(&surface);
        assert!(Solver::new(&mut surface, &material).is_err(), "{name}");
        assert!(bits(&surface) == before, "{name} changed something");
    }
}

#[test]
fn a_failed_step_moves_nothing() {
    let (mut surface, mut solver) = moving();
    let with = |change: fn(&mut SolverParams)| {
        let mut params = PARAMS;
        change(&mut params);
        params
    };
    let time_step = |value| (value, PARAMS, StepError::BadTimeStep { value }.to_string());
    let count = |text: &str, params| {
        let text = format!("{text}; it must be from 1 to 1048576");
        (FRAME, params, text)
    };
    let not_positive = |text: &str, params| {
        let text = format!("{text}; it must be a finite number above 0");
        (FRAME, params, text)
    };
    let not_finite = |text: &str, params| {
        let text = format!("{text}; it must be a finite number");
        (FRAME, params, text)
    };
    let too_many = PARAMS.with_substeps(FRAME, 2 * SolverParams::MAX_COUNT);
    let too_short = StepError::SubstepTooShort {
        h: FRAME / (1 << 21) as f32,
    };
    for (dt, params, expected) in [
        time_step(0.0),
        time_step(-1.0),
        time_step(f32::INFINITY),
        count("iterations is 0", with(|p| p.iterations = 0)),
        not_positive("substep is 0", with(|p| p.substep = Some(0.0))),
        not_positive("substep is -1", with(|p| p.substep = Some(-1.0))),
        not_positive("substep is NaN", with(|p| p.substep = Some(f32::NAN))),
        not_positive("substep is inf", with(|p| p.substep = Some(f32::INFINITY))),
        (FRAME, too_many, too_short.to_string()),
        not_finite("gravity is NaN", with(|p| p.gravity[1] = f32::NAN)),
        not_finite("gravity is inf", with(|p| p.gravity[1] = f32::INFINITY)),
    ] {
        let before = bits(&surface, &solver);
        let result = solver.step(&mut surface, dt, &params).map(|_| ());
        assert_eq!(
            result.unwrap_err().to_string(),
            expected,
            "{dt} s, {params:?}"
        );
        assert!(bits(&surface, &solver) == before, "{dt} s moved something");
    }
    let before = bits(&surface, &solver);
    assert!(solver.step(&mut surface, f32::NAN, &PARAMS).is_err());
    assert!(bits(&surface, &solver) == before, "NaN moved something");
    solver.step(&mut surface, FRAME, &PARAMS).unwrap();
    surface.add_vertex([0.0, 0.0, 0.0, 1.0], [0.0; 3]);
    let before = bits(&surface, &solver);
    let refused = solver.step(&mut surface, FRAME, &PARAMS).map(|_| ());
    assert!(matches!(refused, Err(StepError::SurfaceMismatch { .. })));
    assert!(
        bits(&surface, &solver) == before,
        "an edit without its delta"
    );
}

#[test]
fn a_substep_has_a_square_that_is_a_normal_number() {
    let least = SolverParams::MIN_SUBSTEP;
    assert_eq!(least * least, f32::MIN_POSITIVE, "it is its square root");
    let paper = SolverParams::paper();
    let two = |dt| paper.with_substeps(dt, 2);
    let second = SolverParams {
        integrator: Integrator::Bdf2,
        ..paper
    };
    for (params, dt, h) in [
        (paper, 1e-44, 1e-44),
        (paper, least.next_down(), least.next_down()),
        (two(least), least, 0.5 * least),
        (second, least, 2.0 / 3.0 * least),
    ] {
        let (mut surface, mut solver) = moving();
        let before = bits(&surface, &solver);
        let expected = Err(StepError::SubstepTooShort { h });
        assert_eq!(params.check(dt), expected);
        let result = solver.step(&mut surface, dt, &params).map(|_| ());
        assert_eq!(result, expected);
        assert!(bits(&surface, &solver) == before, "{dt} s moved something");
    }
    for (params, dt) in [
        (paper, least),
        (two(2.0 * least), 2.0 * least),
        (second, 1.5 * least.next_up()),
    ] {
        let (mut surface, mut solver) = moving();
        solver.step(&mut surface, dt, &params).unwrap();
        let velocities = solver.velocities().iter().flatten();
        let mut all = velocities.chain(surface.positions().iter().flatten());
        assert!(all.all(|x| x.is_finite()), "{dt} s, {params:?}");
    }
}

#[test]
fn invalid_pins_velocities_and_masses_change_nothing() {
    let (mut surface, mut solver) = moving();
    let state = |surface: &Surface, solver: &Solver| {
        let (masses, pins) = (solver.masses().to_vec(), solver.pins().to_vec());
        (bits(surface, solver), masses, pins)
    };
    let before = state(&surface, &solver);
    let (v, unknown, nan) = (VertexId(3), VertexId(1 << 20), [0.0, f32::NAN, 0.0]);
    let refused = [
        solver.set_velocity(v, nan),
        solver.set_velocity(unknown, [0.0; 3]),
        solver.pin(&mut surface, unknown),
        solver.pin(&mut surface, VertexId::NULL),
        solver.unpin(&mut surface, v),
        solver.set_pin_target(v, [0.0; 3]),
        solver.set_pin_target(v, nan),
        solver.set_mass(&mut surface, v, 0.0),
        solver.set_mass(&mut surface, v, -1.0),
        solver.set_mass(&mut surface, v, f32::NAN),
        solver.set_mass(&mut surface, v, f32::INFINITY),
        // A mass whose inverse is infinite.
        solver.set_mass(&mut surface, v, 1e-45),
        solver.set_mass(&mut surface, unknown, 1.0),
        solver.set_stretch(Stiffness::Compliance(f32::NAN)),
        solver.set_stretch(Stiffness::Pbd(2.0)),
    ];
    assert!(refused.iter().all(Result::is_err), "{refused:?}");
    assert!(state(&surface, &solver) == before, "one left a trace");
    solver.step(&mut surface, FRAME, &PARAMS).unwrap();
}

#[test]
fn a_delta_of_another_surface_changes_nothing() {
    let (mut surface, mut solver) = moving();
    let corners = surface.topology().triangle(TriangleId(0));
    let [a, b, c] = corners;
    let unknown = TriangleId(1 << 20);
    let removed = |t, corners| TopologyDelta {
        triangles_removed: vec![(t, corners)],
        ..TopologyDelta::default()
    };
    let added = TopologyDelta {
        triangles_added: vec![unknown],
        ..TopologyDelta::default()
    };
    for delta in [
        removed(TriangleId(0), [b, a, c]),
        removed(unknown, corners),
        added,
    ] {
        let before = bits(&surface, &solver);
        let refused = solver.apply_delta(&mut surface, &delta);
        assert!(
            matches!(
                refused,
                Err(ConstraintError::DeltaMismatch { .. }
                    | ConstraintError::DeltaUnknownTriangle { .. })
            ),
            "{refused:?}"
        );
        solver.validate(&surface).unwrap();
        assert!(bits(&surface, &solver) == before, "{delta:?} left a trace");
    }
    solver.step(&mut surface, FRAME, &PARAMS).unwrap();
}

#[test]
fn bodies_of_a_few_triangles_are_simulated() {
    let points = [
        [0.0, 0.5, 0.0],
        [1.0, 0.5, 0.0],
        [0.0, 1.5, 0.0],
        [0.0, 0.5, 1.0],
    ];
    let faces: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let elastic = Material {
        stretch: Stiffness::Compliance(1e-4),
        bending: Some(Stiffness::Compliance(1e-2)),
        ..Material::default()
    };
    for (vertices, triangles) in [(0, 0), (3, 1), (4, 4)] {
        for material in [Material::default(), elastic] {
            let body = Surface::from_triangles(&points[..vertices], &faces[..triangles]);
            let mut surface = body.unwrap();
            let mut solver = Solver::new(&mut surface, &material).unwrap();
            for _ in 0..60 {
                solver.step(&mut surface, FRAME, &PARAMS).unwrap();
            }
        }
    }
}
