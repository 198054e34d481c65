//! Motions that the global step must survive: strained bodies, bodies on the ground and in contact.

use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, VertexId, cube_sphere, icosphere, torus};
use incise_models::{Model, build_model};
use incise_pbd_gpu::{
    Collider, Contact, Integrator, Material, MovingCollider, Scheme, Solver, SolverParams,
    Stiffness, Volume,
};

const DT: f32 = 1.0 / 60.0;

/// Two substeps of four iterations without gravity and ground.
const GLOBAL: SolverParams = SolverParams {
    iterations: 4,
    gravity: [0.0; 3],
    scheme: Scheme::Global,
    ..SolverParams::paper()
}
.with_substeps(DT, 2);

fn elastic(stretch: f32, bending: Option<f32>) -> Material {
    Material {
        stretch: Stiffness::Compliance(stretch),
        bending: bending.map(Stiffness::Compliance),
        ..Material::default()
    }
}

/// Returns the energy of edges and motion \[J\] with a stretch compliance [m/N].
fn energy(surface: &Surface, solver: &Solver, compliance: f64) -> f64 {
    let topology = surface.topology();
    let of_edges: f64 = topology
        .edges()
        .map(|h| {
            let [a, b] = [topology.origin(h), topology.target(h)];
            let length = (surface.position(b) - surface.position(a)).norm();
            let rest = (surface.rest_position(b) - surface.rest_position(a)).norm();
            (length - rest).powi(2) / (2.0 * compliance)
        })
        .sum();
    of_edges + solver.kinetic_energy()
}

/// Regression: a start from a strained prediction made energy, 1e7 J in half a second.
#[test]
fn a_strained_body_gains_no_energy() {
    for compliance in [1e-5_f32, 1e-3] {
        let mut surface = icosphere(3, 0.5);
        let mut solver = Solver::new(&mut surface, &elastic(compliance, None)).unwrap();
        for p in surface.positions_mut() {
            *p = [2.0 * p[0], 0.5 * p[1], 0.5 * p[2], p[3]];
        }
        let compliance = f64::from(compliance);
        let first = energy(&surface, &solver, compliance);
        let mut last = first;
        for frame in 0..30 {
            solver.step(&mut surface, DT, &GLOBAL).unwrap();
            last = energy(&surface, &solver, compliance);
            assert!(last <= first, "{first} J, {last} J in frame {frame}");
        }
        assert!(last < 0.01 * first, "{first} J became {last} J");
    }
}

/// A slab of 0.6 x 0.2 x 0.6 m that lies on the ground.
fn slab() -> Surface {
    let mut surface = cube_sphere(6, 1.0);
    for p in surface.rest_positions_mut() {
        let largest = p.iter().fold(0.0_f32, |a, c| a.max(c.abs()));
        *p = [
            0.3 * p[0] / largest,
            0.1 + 0.1 * p[1] / largest,
            0.3 * p[2] / largest,
        ];
    }
    let rest = surface.rest_positions().to_vec();
    for (p, rest) in surface.positions_mut().iter_mut().zip(rest) {
        *p = [rest[0], rest[1], rest[2], p[3]];
    }
    surface
}

/// Regression: the ground gave a slab at rest 7e6 J within three seconds.
#[test]
fn a_slab_on_the_ground_stays_in_place() {
    let mut surface = slab();
    let material = Material {
        damping: 1.0,
        ..elastic(1e-5, Some(1e-3))
    };
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    let params = SolverParams {
        gravity: [0.0, -9.81, 0.0],
        ..GLOBAL
    };
    solver
        .set_colliders(&[Collider::ground(0.0).into()])
        .unwrap();
    let before = center(&surface);
    for _ in 0..300 {
        solver.step(&mut surface, DT, &params).unwrap();
    }
    let moved = (center(&surface) - before).norm();
    assert!(moved < 0.01, "{moved} m");
    let energy = solver.kinetic_energy();
    assert!(energy < 0.01, "{energy} J");
}

/// Regression: contacts after each iteration made momentum and energy.
#[test]
fn a_body_in_contact_takes_sweeps() {
    let mut surface = icosphere(3, 0.5);
    let mut solver = Solver::new(&mut surface, &elastic(1e-4, Some(1e-2))).unwrap();
    solver.step(&mut surface, DT, &GLOBAL).unwrap();
    assert_eq!(solver.stats().global_iterations, 8);
    let bytes = solver.global_stats().bytes;
    let ground = Contact::plane(VertexId(0), [0.0, 1.0, 0.0], -2.0);
    solver.set_contacts(&[ground]).unwrap();
    solver.step(&mut surface, DT, &GLOBAL).unwrap();
    assert_eq!(solver.stats().global_iterations, 0);
    assert_eq!(solver.substeps(), 32, "four for each iteration");
    assert_eq!(solver.global_stats().bytes, bytes, "the factor is kept");
    solver.set_contacts(&[]).unwrap();
    solver.step(&mut surface, DT, &GLOBAL).unwrap();
    assert_eq!(solver.stats().global_iterations, 8);
    assert_eq!(solver.substeps(), 2);
}

/// Regression: strain that sweeps leave became motion in the first frames of the global step, 27 J.
#[test]
fn strain_that_sweeps_leave_does_not_become_motion() {
    let mut surface = build_model(Model::Bunny);
    let mut solver = Solver::new(&mut surface, &elastic(1e-5, Some(1e-2))).unwrap();
    pin_top(&mut solver, &mut surface);
    let params = SolverParams {
        gravity: [0.0, -9.81, 0.0],
        ..GLOBAL
    };
    for _ in 0..60 {
        let params = SolverParams {
            scheme: Scheme::Sweeps,
            ..params
        };
        solver.step(&mut surface, DT, &params).unwrap();
    }
    let before = energy(&surface, &solver, 1e-5);
    assert!(before > 1000.0, "it is hardly strained: {before} J");
    let weight: f64 = solver.masses().iter().map(|&m| 9.81 * f64::from(m)).sum();
    for frame in 0..240 {
        solver.step(&mut surface, DT, &params).unwrap();
        assert_eq!(solver.stats().global_iterations, 8, "frame {frame}");
        let kinetic = solver.kinetic_energy();
        assert!(kinetic < 0.1 * weight, "{kinetic} J in frame {frame}");
    }
    let after = energy(&surface, &solver, 1e-5);
    assert!(after < 1e-3 * before, "{before} J, later {after} J");
}

/// Regression: a body that settles did not follow its pins, and was torn by 1e6 J.
#[test]
fn a_settling_body_follows_its_pins() {
    let mut surface = build_model(Model::Bunny);
    let mut solver = Solver::new(&mut surface, &elastic(1e-5, Some(1e-2))).unwrap();
    pin_top(&mut solver, &mut surface);
    let pins: Vec<VertexId> = solver.pins().iter().map(|pin| pin.vertex).collect();
    let before = center(&surface);
    for frame in 0..80 {
        let scheme = match frame {
            0..20 => Scheme::Sweeps,
            _ => Scheme::Global,
        };
        let params = SolverParams {
            gravity: [0.0, -9.81, 0.0],
            scheme,
            ..GLOBAL
        };
        if frame >= 20 {
            for &v in &pins {
                let to = surface.position(v) + Vec3::new(1.0 / 60.0, 0.0, 0.0);
                solver.set_pin_target(v, to_f32(to)).unwrap();
            }
        }
        solver.step(&mut surface, DT, &params).unwrap();
    }
    let moved = (center(&surface) - before).x;
    assert!((moved - 1.0).abs() < 0.1, "{moved} of 1 m");
}

fn center(surface: &Surface) -> Vec3 {
    let points = surface.topology().vertices().map(|v| surface.position(v));
    points.sum::<Vec3>() / surface.positions().len() as f64
}

/// Pins the upper tenth of a body.
fn pin_top(solver: &mut Solver, surface: &mut Surface) {
    let [bottom, top] = [surface.bounds().min[1], surface.bounds().max[1]].map(f64::from);
    for v in surface.topology().vertices().collect::<Vec<_>>() {
        if surface.position(v).y > top - 0.1 * (top - bottom) {
            solver.pin(surface, v).unwrap();
        }
    }
}

/// Regression: a hanging body that was touched never took the global step again. It slept two edges
/// lower than it hangs. Later its iterations found no way past triangles that had collapsed, 939 J.
#[test]
fn a_hanging_body_that_was_touched_takes_the_global_step_again() {
    let mut surface = build_model(Model::Bunny);
    let material = Material {
        damping: 1.0,
        ..elastic(1e-5, Some(1e-2))
    };
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    pin_top(&mut solver, &mut surface);
    let params = SolverParams {
        gravity: [0.0, -9.81, 0.0],
        substep: None,
        ..GLOBAL
    };
    let is_pushed = |v: &VertexId| surface.position(*v).x > 0.1;
    let pushed = surface.topology().vertices().filter(is_pushed);
    let wall: Vec<Contact> = pushed
        .map(|v| Contact::plane(v, [-1.0, 0.0, 0.0], -0.1))
        .collect();
    solver.set_contacts(&wall).unwrap();
    for _ in 0..20 {
        solver.step(&mut surface, DT, &params).unwrap();
    }
    solver.set_contacts(&[]).unwrap();
    for _ in 0..900 {
        solver.step(&mut surface, DT, &params).unwrap();
    }
    assert!(
        solver.stats().global_iterations > 0,
        "it still takes sweeps"
    );
    let elastic = energy(&surface, &solver, 1e-5);
    assert!(elastic < 0.1, "it hangs lower: {elastic} J");
}

/// Regression: second-order sweeps of a stiff body in contact gained 130 J.
#[test]
fn frames_in_contact_are_of_first_order() {
    let step = |integrator| {
        let mut surface = icosphere(2, 0.5);
        let mut solver = Solver::new(&mut surface, &elastic(1e-5, Some(1e-3))).unwrap();
        let plane = Contact::plane(VertexId(0), [0.0, 1.0, 0.0], 0.2);
        solver.set_contacts(&[plane]).unwrap();
        for _ in 0..3 {
            let params = SolverParams {
                integrator,
                ..GLOBAL
            };
            solver.step(&mut surface, DT, &params).unwrap();
        }
        surface.positions().to_vec()
    };
    assert_eq!(step(Integrator::Bdf2), step(Integrator::Euler));
}

/// Regression: volumes with a compressibility gained 90 J after a cut, those with a pressure
/// jumped by a fifth at each change of the scheme.
#[test]
fn only_volumes_at_rest_take_the_global_step() {
    let of = |compressibility, pressure| {
        let mut surface = icosphere(2, 0.5);
        let material = Material {
            volume: Some(Volume {
                compressibility,
                pressure,
            }),
            ..elastic(1e-5, Some(1e-3))
        };
        let mut solver = Solver::new(&mut surface, &material).unwrap();
        solver.step(&mut surface, DT, &GLOBAL).unwrap();
        solver.stats().global_iterations
    };
    assert_eq!([of(0.0, 1.0), of(1e-6, 1.0), of(0.0, 1.2)], [8, 0, 0]);
}

/// Regression: one iteration without a bound of its start gained 8,000 J.
#[test]
fn one_iteration_does_not_explode() {
    let mut surface = torus(0.4, 0.12, 28, 10);
    let mut solver = Solver::new(&mut surface, &elastic(5.6e-4, Some(7e-4))).unwrap();
    for v in (0..surface.positions().len()).map(VertexId::from_index) {
        let p = surface.position(v);
        let velocity = Vec3::new(4.3 * p.z, 0.0, -4.3 * p.x);
        solver.set_velocity(v, to_f32(velocity)).unwrap();
    }
    let first = solver.kinetic_energy();
    for frame in 0..80 {
        let params = SolverParams {
            substep: None,
            iterations: 1,
            ..GLOBAL
        };
        solver.step(&mut surface, DT, &params).unwrap();
        let now = solver.kinetic_energy();
        assert!(now < 1.5 * first, "{first} J, {now} J in frame {frame}");
    }
}

/// A stiff ball of 1 m at the origin, and its global iterations in a frame beside obstacles.
fn iterations_beside(collider: MovingCollider, speed: f32) -> u32 {
    let mut surface = icosphere(3, 0.5);
    let mut solver = Solver::new(&mut surface, &elastic(1e-6, Some(1e-4))).unwrap();
    for v in (0..surface.positions().len()).map(VertexId::from_index) {
        solver.set_velocity(v, [0.0, -speed, 0.0]).unwrap();
    }
    solver.set_colliders(&[collider]).unwrap();
    let params = SolverParams {
        scheme: Scheme::Auto,
        ..GLOBAL
    };
    solver.step(&mut surface, DT, &params).unwrap();
    solver.stats().global_iterations
}

#[test]
fn a_body_near_an_obstacle_takes_sweeps() {
    for (height, speed, expected) in [(-9.0, 0.0, 8), (-0.51, 0.0, 0), (-9.0, 300.0, 0)] {
        let of_ground = iterations_beside(Collider::ground(height).into(), speed);
        assert_eq!(of_ground, expected, "ground at {height} m, {speed} m/s");
        let sphere = Collider::Sphere {
            center: [0.0, height - 1.0, 0.0],
            radius: 1.0,
        };
        let still = iterations_beside(sphere.into(), speed);
        assert_eq!(still, expected, "sphere at {height} m, {speed} m/s");
        let rising = MovingCollider {
            start: sphere,
            velocity: [0.0, speed, 0.0],
        };
        let met = iterations_beside(rising, 0.0);
        assert_eq!(
            met, expected,
            "sphere at {height} m that rises at {speed} m/s"
        );
    }
    let around = Collider::Box {
        center: [0.0; 3],
        half: [3.0; 3],
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };
    assert_eq!(iterations_beside(around.into(), 0.0), 0);
}

/// Regression: the ground dented a ball, which then stood still, a tenth lower than its diameter.
#[test]
fn a_ball_that_lands_stays_round() {
    let mut surface = icosphere(3, 0.5);
    let mut solver = Solver::new(&mut surface, &elastic(1e-4, Some(1e-2))).unwrap();
    let params = SolverParams {
        gravity: [0.0, -9.81, 0.0],
        ..GLOBAL
    };
    solver
        .set_colliders(&[Collider::ground(-1.5).into()])
        .unwrap();
    for _ in 0..240 {
        solver.step(&mut surface, DT, &params).unwrap();
    }
    let bounds = surface.bounds();
    let height = bounds.max[1] - bounds.min[1];
    assert!((height - 1.0).abs() < 0.01, "{height} m");
}
