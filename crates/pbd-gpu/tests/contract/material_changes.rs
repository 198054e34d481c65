//! Changes between frames: masses, stiffness, and invalid positions.

use incise_mesh::VertexId;
use incise_pbd_gpu::{
    ConstraintError, Density, Material, Solver, SolverParams, StepError, Stiffness, Volume,
};
use incise_test_support::surfaces::sphere;

#[test]
fn a_position_that_is_not_finite_is_an_error_before_the_step() {
    let mut surface = sphere(1, [0.0; 3]);
    let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
    let params = SolverParams::paper();
    solver.step(&mut surface, 0.01, &params).unwrap();
    let (vertex, place) = (VertexId(4), surface.positions()[4]);
    for bad in [f32::NAN, f32::INFINITY] {
        surface.positions_mut()[4] = [place[0], bad, place[2], place[3]];
        let bits = |p: &[f32; 4]| p.map(f32::to_bits);
        let before: Vec<[u32; 4]> = surface.positions().iter().map(bits).collect();
        let velocities = solver.velocities().to_vec();
        let refused = solver.step(&mut surface, 0.01, &params).map(|_| ());
        assert_eq!(refused, Err(StepError::NonFiniteInput { vertex }));
        let after: Vec<[u32; 4]> = surface.positions().iter().map(bits).collect();
        assert!(before == after, "a refused step moved something");
        assert_eq!(solver.velocities(), velocities);
    }
    surface.positions_mut()[4] = place;
    solver.step(&mut surface, 0.01, &params).unwrap();
}

#[test]
fn a_load_has_weight_and_stays_at_its_vertex() {
    let mut surface = sphere(1, [0.0; 3]);
    let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
    let (v, total) = (VertexId(4), solver.total_mass());
    let had = f64::from(solver.masses()[v.index()]);
    solver.set_mass(&mut surface, v, 8.0).unwrap();
    assert_eq!(surface.positions()[v.index()][3], 0.125);
    assert!((solver.total_mass() - (total - had + 8.0)).abs() < 1e-6);
    solver.pin(&mut surface, v).unwrap();
    solver.set_mass(&mut surface, v, 4.0).unwrap();
    assert_eq!(surface.positions()[v.index()][3], 0.0, "a pin stays a pin");
    solver.unpin(&mut surface, v).unwrap();
    assert_eq!(surface.positions()[v.index()][3], 0.25);
    for value in [0.0, -1.0, f32::INFINITY, f32::MIN_POSITIVE / 16.0] {
        let refused = solver.set_mass(&mut surface, v, value);
        assert_eq!(refused, Err(ConstraintError::BadMass { vertex: v, value }));
    }
    assert_eq!(
        solver.masses()[v.index()],
        4.0,
        "what was refused is not set"
    );
}

#[test]
fn damping_can_be_changed_between_frames() {
    let fallen = |material: &Material, change: Option<f32>| {
        let mut surface = sphere(1, [0.0; 3]);
        let mut solver = Solver::new(&mut surface, material).unwrap();
        if let Some(damping) = change {
            solver.set_damping(damping).unwrap();
        }
        for _ in 0..10 {
            (solver.step(&mut surface, 0.01, &SolverParams::paper())).unwrap();
        }
        let refused = solver.set_damping(-1.0);
        assert!(refused.is_err(), "a rate is not negative");
        surface.positions().to_vec()
    };
    let damped = Material {
        damping: 2.0,
        ..Material::default()
    };
    let changed = fallen(&Material::default(), Some(2.0));
    assert_eq!(changed, fallen(&damped, None));
    assert_ne!(changed, fallen(&Material::default(), None), "it is felt");
}

#[test]
fn stretch_can_be_changed_between_frames() {
    let mut surface = sphere(1, [0.0; 3]);
    let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
    let bad = solver.set_stretch(Stiffness::Pbd(2.0)).unwrap_err();
    assert_eq!(
        bad.to_string(),
        "stretch.stiffness is 2; it must be from 0 to 1"
    );
    assert_eq!(solver.material(), &Material::default());
    solver.set_stretch(Stiffness::Compliance(0.5)).unwrap();
    let mut other = sphere(1, [0.0; 3]);
    let soft = Material {
        stretch: Stiffness::Compliance(0.5),
        ..Material::default()
    };
    let mut made_so = Solver::new(&mut other, &soft).unwrap();
    for (solver, surface) in [(&mut solver, &mut surface), (&mut made_so, &mut other)] {
        solver.pin(surface, VertexId(0)).unwrap();
        for _ in 0..10 {
            solver.step(surface, 0.01, &SolverParams::paper()).unwrap();
        }
    }
    assert_eq!(surface.positions(), other.positions());
}

#[test]
fn a_changed_material_acts_as_one_from_the_start() {
    let before = Material::default();
    let after = Material {
        stretch: Stiffness::Compliance(1e-3),
        bending: Some(Stiffness::Compliance(0.1)),
        volume: Some(Volume::default()),
        damping: 3.0,
        friction: 0.1,
        ..before
    };
    let stepped = |first: &Material| {
        let mut surface = sphere(1, [0.0; 3]);
        let mut solver = Solver::new(&mut surface, first).unwrap();
        solver.set_material(&surface, &after).unwrap();
        solver.validate(&surface).unwrap();
        for _ in 0..10 {
            solver
                .step(&mut surface, 0.01, &SolverParams::paper())
                .unwrap();
        }
        surface.positions().to_vec()
    };
    assert_eq!(stepped(&before), stepped(&after));
}

#[test]
fn parts_of_a_material_that_are_made_with_the_body_are_fixed() {
    let mut surface = sphere(1, [0.0; 3]);
    let mut solver = Solver::new(&mut surface, &Material::shell()).unwrap();
    let same = Material::shell();
    for (name, material) in [
        (
            "density",
            Material {
                density: Density::Area(2.0),
                ..same
            },
        ),
        (
            "bending",
            Material {
                bending: None,
                ..same
            },
        ),
        (
            "cells of a solid",
            Material {
                solid: Some(Default::default()),
                ..same
            },
        ),
        (
            "interior springs",
            Material {
                interior_springs: Some(Default::default()),
                ..same
            },
        ),
    ] {
        let refused = solver.set_material(&surface, &material);
        assert_eq!(refused, Err(ConstraintError::FixedMaterial { name }));
    }
    let rough = Material {
        friction: f32::NAN,
        ..same
    };
    assert!(solver.set_material(&surface, &rough).is_err());
    assert_eq!(solver.material(), &same);
}
