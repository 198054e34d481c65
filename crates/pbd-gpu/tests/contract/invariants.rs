//! Invariants of motion that hold for any constraints.

use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, VertexId};
use incise_pbd_gpu::{
    Collider, ConstraintError, Density, Integrator, Material, Pass, Solver, SolverParams,
    StepError, Stiffness, Volume,
};
use incise_test_support::surfaces::{sphere, two_spheres};

const G: f64 = 9.81;

#[test]
fn free_fall_equals_its_closed_form() {
    // 6000 substeps per second, where velocities from rounded positions would be inaccurate.
    for place in [1.0_f32, 10.0] {
        let mut surface = sphere(1, [place, place, place]);
        let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
        let params = SolverParams {
            iterations: 1,
            ..SolverParams::paper()
        }
        .with_substeps(1.0 / 60.0, 100);
        let v0 = 0.3;
        for v in surface.topology().vertices() {
            solver.set_velocity(v, [0.0, v0, 0.0]).unwrap();
        }
        let start = surface.positions().to_vec();
        let frames = 6;
        for _ in 0..frames {
            solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
        }
        let n = f64::from(frames * 100);
        let h = 1.0 / 6000.0;
        let fallen = n * h * f64::from(v0) - G * h * h * n * (n + 1.0) / 2.0;
        for (now, then) in surface.positions().iter().zip(&start) {
            let moved = f64::from(now[1]) - f64::from(then[1]);
            assert!(
                (moved - fallen).abs() < 1e-4,
                "moved {moved} m, not {fallen} m, at {place} m"
            );
        }
    }
}

#[test]
fn a_free_body_keeps_its_momentum() {
    let mut surface = two_spheres(2);
    let material = Material {
        bending: Some(Stiffness::Pbd(0.5)),
        ..Material::default()
    };
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    for v in surface.topology().vertices() {
        let [x, y, z, _] = surface.positions()[v.index()];
        solver
            .set_velocity(v, [3.0 * y - z, 1.0 + x * z, 2.0 * z])
            .unwrap();
    }
    let before = solver.momentum();
    let params = SolverParams {
        gravity: [0.0; 3],
        ..SolverParams::paper()
    };
    for _ in 0..200 {
        solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
    }
    let scale = before.iter().map(|c| c.abs()).fold(0.0, f64::max);
    for (now, then) in solver.momentum().iter().zip(before) {
        assert!(
            (now - then).abs() < 1e-4 * scale,
            "{before:?} became {:?}",
            solver.momentum()
        );
    }
}

#[test]
fn pins_hold_and_follow_their_targets() {
    let mut surface = sphere(2, [0.0; 3]);
    let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
    let v = VertexId(1);
    solver.pin(&mut surface, v).unwrap();
    let place = surface.positions()[v.index()];
    let params = SolverParams::paper().with_substeps(1.0 / 60.0, 3);
    for _ in 0..60 {
        solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
    }
    assert_eq!(
        surface.positions()[v.index()],
        place,
        "it did not move a bit"
    );
    let target = [0.25, 1.5, -0.5];
    solver.set_pin_target(v, target).unwrap();
    solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
    for (now, wanted) in surface.positions()[v.index()].iter().zip(target) {
        assert!((now - wanted).abs() < 1e-6);
    }
    solver.unpin(&mut surface, v).unwrap();
    assert!((surface.positions()[v.index()][3] * solver.masses()[v.index()] - 1.0).abs() < 1e-6);
    assert_eq!(
        solver.set_pin_target(v, target),
        Err(ConstraintError::NotPinned { vertex: v })
    );
}

/// A flat tetrahedron on the ground slides with 1 m/s; its speed after `frames` of 1/60 s [m/s].
fn slide(friction: f32, frames: u32) -> f64 {
    let points = [
        [-1.0, 0.0, -1.0],
        [1.0, 0.0, -1.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.5, -0.2],
    ];
    let faces = [[0, 1, 2], [1, 0, 3], [2, 1, 3], [0, 2, 3]];
    let mut surface = Surface::from_triangles(&points, &faces).unwrap();
    let material = Material {
        friction,
        ..Material::default()
    };
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    for v in surface.topology().vertices() {
        solver.set_velocity(v, [1.0, 0.0, 0.0]).unwrap();
    }
    let params = SolverParams::paper();
    solver
        .set_colliders(&[Collider::ground(0.0).into()])
        .unwrap();
    for _ in 0..frames {
        solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
        let lowest = surface.bounds().min[1];
        let rounding = 2.0 * f32::EPSILON * surface.bounds().max[1];
        assert!(lowest >= -rounding, "{lowest} m is below the ground");
    }
    solver.momentum()[0] / solver.total_mass()
}

#[test]
fn the_ground_stops_falls_and_friction_stops_slides() {
    assert!((slide(0.0, 60) - 1.0).abs() < 1e-3, "nothing holds it back");
    assert!(slide(0.5, 60).abs() < 1e-4, "friction brings it to rest");
    let expected = 1.0 - 0.2 * G * 15.0 / 60.0;
    let speed = slide(0.2, 15);
    assert!(
        (speed - expected).abs() < 0.05,
        "{speed} m/s, not {expected} m/s"
    );
}

#[test]
fn a_ground_out_of_reach_costs_nothing() {
    let mut surface = sphere(1, [0.0, 5.0, 0.0]);
    let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
    let params = SolverParams::paper();
    solver
        .set_colliders(&[Collider::ground(0.0).into()])
        .unwrap();
    let stats = *solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
    let has_pass = |solver: &Solver| solver.plan().passes().any(|pass| pass == Pass::Colliders);
    assert!(!has_pass(&solver));
    assert_eq!(stats.stretch_projections, 10 * 48);
    assert_eq!(stats.bending_projections, 10 * 48);
    for v in surface.topology().vertices() {
        solver.set_velocity(v, [0.0, -200.0, 0.0]).unwrap();
    }
    solver.step(&mut surface, 1.0 / 60.0, &params).unwrap();
    assert!(has_pass(&solver), "it falls by 3 m");
}

/// Free particles keep their rigid motion and lose the rest by `exp(-damping t)`.
#[test]
fn damping_equals_its_closed_form() {
    let mut surface = sphere(2, [0.0; 3]);
    let material = Material {
        stretch: Stiffness::Pbd(0.0),
        bending: None,
        damping: 6000.0,
        ..Material::default()
    };
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    // A sphere has equal moments of inertia and its center at the origin.
    let (velocity, turn) = (Vec3::new(1.0, -0.5, 0.2), Vec3::new(0.3, 2.0, -1.0));
    let breathing = |p: Vec3| p * 0.4;
    for v in surface.topology().vertices() {
        let p = surface.position(v);
        let of = velocity + turn.cross(&p) + breathing(p);
        solver.set_velocity(v, to_f32(of)).unwrap();
    }
    let start = surface.clone();
    // A short frame, in which particles hardly move.
    solver
        .step(&mut surface, 1e-4, &SolverParams::paper())
        .unwrap();
    let fall = Vec3::new(0.0, -9.81e-4, 0.0);
    let kept = (-0.6_f64).exp();
    for v in surface.topology().vertices() {
        let p = start.position(v);
        let rigid = velocity + fall + turn.cross(&p);
        let expected = rigid + breathing(p) * kept;
        let off = (Vec3::from(solver.velocity(v).map(f64::from)) - expected).norm();
        assert!(off < 2e-3, "{off} m/s off");
    }
}

/// A damped body falls as one without damping, and its spin stays.
#[test]
fn damping_slows_neither_fall_nor_spin() {
    let mut surface = sphere(2, [0.0; 3]);
    let damped = Material {
        volume: Some(Volume::default()),
        damping: 1.0,
        ..Material::default()
    };
    let mut solver = Solver::new(&mut surface, &damped).unwrap();
    for v in surface.topology().vertices() {
        let [x, _, z] = to_f32(surface.position(v));
        solver.set_velocity(v, [2.0 * z, 0.0, -2.0 * x]).unwrap();
    }
    let about = |surface: &Surface, solver: &Solver| {
        let center = (surface.topology().vertices())
            .map(|v| surface.position(v) * f64::from(solver.masses()[v.index()]));
        center.sum::<Vec3>() / solver.total_mass()
    };
    let spin = |surface: &Surface, solver: &Solver| {
        Vec3::from(solver.angular_momentum(surface, about(surface, solver).into())).norm()
    };
    let before = spin(&surface, &solver);
    for _ in 0..180 {
        solver
            .step(&mut surface, 1.0 / 60.0, &SolverParams::default())
            .unwrap();
    }
    let fallen = -about(&surface, &solver).y;
    // Substeps begin with gravity, so that the fall is longer by half of one.
    let (n, h) = (2160.0, 1.0 / 720.0);
    let expected = 9.81 * h * h * n * (n + 1.0) / 2.0;
    assert!(
        (fallen / expected - 1.0).abs() < 1e-4,
        "{fallen} m, not {expected} m"
    );
    let after = spin(&surface, &solver);
    assert!((after / before - 1.0).abs() < 1e-3, "{after} of {before}");
}

#[test]
fn mass_follows_from_density() {
    let mut surface = sphere(3, [1.0, 2.0, 3.0]);
    let shell = Material {
        density: Density::Area(2.5),
        ..Material::default()
    };
    let solver = Solver::new(&mut surface, &shell).unwrap();
    assert!((solver.total_mass() - 2.5 * surface.area()).abs() < 1e-4);
    let filled = Material {
        density: Density::Volume(1000.0),
        ..Material::default()
    };
    let solver = Solver::new(&mut surface, &filled).unwrap();
    let expected = 1000.0 * surface.volume();
    assert!((solver.total_mass() / expected - 1.0).abs() < 1e-5);
}

#[test]
fn invalid_bodies_and_frames_are_errors() {
    let points = [[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let mut flat = Surface::from_triangles(&points, &faces).unwrap();
    let (a, b) = (VertexId(0), VertexId(1));
    assert_eq!(
        Solver::new(&mut flat, &Material::default()).err(),
        Some(ConstraintError::ZeroRestLength { a, b })
    );
    let mut surface = sphere(1, [0.0; 3]);
    surface.positions_mut()[4][2] = f32::NAN;
    assert_eq!(
        Solver::new(&mut surface, &Material::default()).err(),
        Some(ConstraintError::NonFinitePosition {
            vertex: VertexId(4)
        })
    );
    let mut surface = sphere(1, [0.0; 3]);
    let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
    let params = SolverParams::paper();
    // compliance / h^2 is infinite, or 0 / 0, or is so in the shorter substeps of second order.
    let second = SolverParams {
        integrator: Integrator::Bdf2,
        ..params
    };
    for (compliance, dt, h, params) in [
        (1e33, 1e-3, 1e-3, &params),
        (0.0, 1e-23, 1e-23, &params),
        (2e32, 1e-3, 1e-3_f32 * (2.0 / 3.0), &second),
    ] {
        let before = (surface.positions().to_vec(), solver.velocities().to_vec());
        solver
            .set_stretch(Stiffness::Compliance(compliance))
            .unwrap();
        let refused = solver.step(&mut surface, dt, params).map(|_| ());
        assert_eq!(refused, Err(StepError::SubstepTooShort { h }));
        assert_eq!(
            (surface.positions().to_vec(), solver.velocities().to_vec()),
            before
        );
    }
    solver.set_stretch(Stiffness::Pbd(1.0)).unwrap();
    solver
        .set_velocity(VertexId(3), [f32::MAX, 0.0, 0.0])
        .unwrap();
    let broken = (0..9).find_map(|_| solver.step(&mut surface, 1e3, &params).map(|_| ()).err());
    assert!(
        matches!(broken, Some(StepError::NonFinitePosition { .. })),
        "{broken:?}"
    );
}

#[test]
fn a_body_without_bending_has_none() {
    let mut surface = sphere(2, [0.0; 3]);
    let material = Material {
        bending: None,
        ..Material::default()
    };
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    assert!(solver.bending().is_none());
    let stats = solver
        .step(&mut surface, 0.01, &SolverParams::paper())
        .unwrap();
    assert_eq!(stats.bending_projections, 0);
}

#[test]
fn stretch_error_is_weighted_by_length() {
    // A very short edge must not dominate the error.
    let whole = sphere(2, [0.0; 3]);
    let topology = whole.topology();
    let a = VertexId(0);
    let near = topology.target(topology.outgoing(a));
    let mut points: Vec<[f32; 3]> = whole
        .positions()
        .iter()
        .map(|&[x, y, z, _]| [x, y, z])
        .collect();
    points[a.index()] = points[near.index()];
    points[a.index()][0] += 1e-6;
    let faces: Vec<[u32; 3]> = topology
        .triangles()
        .map(|t| topology.triangle(t).map(|v| v.0))
        .collect();
    let mut surface = Surface::from_triangles(&points, &faces).unwrap();
    let solver = Solver::new(&mut surface, &Material::default()).unwrap();
    let error = solver.stretch_error(&surface);
    assert!(error < 1e-7, "{error} at rest");
    let rest = surface.positions().to_vec();
    for p in surface.positions_mut() {
        *p = [1.25 * p[0], 1.25 * p[1], 1.25 * p[2], p[3]];
    }
    let error = solver.stretch_error(&surface);
    assert!(
        (error - 0.25).abs() < 1e-6,
        "{error} at 1.25 times the size"
    );
    surface.positions_mut().copy_from_slice(&rest);
    surface.positions_mut()[a.index()][1] += 0.01;
    let error = solver.stretch_error(&surface);
    assert!(
        error > 0.0 && error < 0.01,
        "{error} after one short edge grew"
    );
}
