//! Pressure: volumes that differ from those at rest.

use incise_pbd_gpu::{Material, Solver, SolverParams, Volume};
use incise_test_support::materials::{limp, with_pressure};
use incise_test_support::surfaces::{scaled, sphere};

const DT: f32 = 1.0 / 60.0;

fn weightless() -> SolverParams {
    SolverParams {
        gravity: [0.0; 3],
        ..SolverParams::default()
    }
}

#[test]
fn pressure_scales_the_volume_of_a_ball() {
    for (pressure, place) in [(2.0, 0.0), (0.5, 0.0), (1.5, 1000.0)] {
        let mut surface = sphere(3, [place, 0.0, 0.0]);
        let rest = surface.volume();
        let mut solver = Solver::new(&mut surface, &limp(with_pressure(pressure))).unwrap();
        for _ in 0..60 {
            solver.step(&mut surface, DT, &weightless()).unwrap();
        }
        let times = surface.volume() / rest;
        // Positions a kilometer away are stored to 6e-5 m.
        let rounding = if place > 0.0 { 2e-3 } else { 1e-4 };
        assert!(
            (times - f64::from(pressure)).abs() < rounding,
            "{times} of {pressure} volumes at {place} m"
        );
        let center = surface.bounds().center();
        assert!((center.x - f64::from(place)).abs() < 1e-3, "{center}");
    }
}

/// Regression: changes of pressure became velocity, and the vertices of a ball that had collapsed
/// flew apart with 57 J, to 100,000 times its volume.
#[test]
fn a_weightless_ball_follows_every_pressure() {
    let mut surface = scaled(sphere(3, [0.0; 3]), [0.5; 3]);
    let rest = surface.volume();
    let mut solver = Solver::new(&mut surface, &limp(Volume::default())).unwrap();
    let params = SolverParams {
        iterations: 10,
        substep: None,
        ..weightless()
    };
    for pressure in [0.0_f32, 0.1, 1.0, 5.0, 0.0, 20.0, 0.1, 1.0] {
        let volume = with_pressure(pressure);
        solver.set_volume(&surface, Some(volume)).unwrap();
        let mut before = surface.volume() / rest;
        for _ in 0..540 {
            solver.step(&mut surface, DT, &params).unwrap();
            let now = surface.volume() / rest;
            // Three volumes a second.
            assert!((now - before).abs() < 0.051, "{before} became {now}");
            before = now;
        }
        assert!((before - f64::from(pressure)).abs() < 1e-3, "{before}");
        let energy = solver.kinetic_energy();
        assert!(energy < 1e-4, "{energy} J at {pressure} volumes");
    }
}

/// The pressure of an incompressible ball changes to 10 and then to 0.1.
#[test]
fn a_change_of_pressure_acts_slowly() {
    let mut surface = sphere(3, [0.0; 3]);
    let rest = surface.volume();
    let mut solver = Solver::new(&mut surface, &limp(Volume::default())).unwrap();
    for pressure in [10.0, 0.1] {
        let volume = with_pressure(pressure);
        solver.set_volume(&surface, Some(volume)).unwrap();
        let mut before = surface.volume() / rest;
        for _ in 0..240 {
            solver.step(&mut surface, DT, &weightless()).unwrap();
            let now = surface.volume() / rest;
            // Three volumes a second.
            assert!((now - before).abs() < 0.051, "{before} became {now}");
            before = now;
        }
        assert!((before - f64::from(pressure)).abs() < 1e-3, "{before}");
        let speed = (2.0 * solver.kinetic_energy() / solver.total_mass()).sqrt();
        assert!(speed < 1.0, "a radius of 1 m drifts by {speed} m/s");
    }
}

/// Regression: edges that do not stretch and a volume that cannot be reached undid each other's
/// corrections, and their remainder spun a soft ball up to 2.2 m/s in four seconds.
#[test]
fn a_pressure_that_the_edges_resist_spins_nothing() {
    let shell = Material {
        damping: 1.0,
        ..Material::default()
    };
    for level in [1, 3] {
        for pressure in [0.5_f32, 1.1, 1.5, 3.0] {
            let material = Material {
                volume: Some(with_pressure(pressure)),
                ..shell
            };
            let mut surface = scaled(sphere(level, [0.0; 3]), [0.5; 3]);
            let rest = surface.volume();
            let mut solver = Solver::new(&mut surface, &material).unwrap();
            for _ in 0..480 {
                solver.step(&mut surface, DT, &weightless()).unwrap();
            }
            let speed = (2.0 * solver.kinetic_energy() / solver.total_mass()).sqrt();
            assert!(speed < 0.02, "{speed} m/s at {pressure} volumes");
            let times = surface.volume() / rest;
            assert!(
                (times - 1.0) * (f64::from(pressure) - 1.0) > 0.0,
                "{times} volumes"
            );
        }
    }
}
