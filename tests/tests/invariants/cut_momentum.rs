//! A cut preserves mass, center of mass, momentum and angular momentum of a body.

use incise_cut::{CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::{Surface, Vec3, VertexId, cube_sphere, icosphere, torus};
use incise_paper::PaperParams;
use incise_pbd_gpu::{Density, Material, Solver};
use incise_test_support::random::noise;
use proptest::prelude::*;

/// Rounding of sums in 32 bits, relative to the sum of absolute values.
const ROUNDING: f64 = 2e-6;

fn solver(surface: &mut Surface) -> Solver {
    let material = Material {
        density: Density::Volume(800.0),
        ..Material::default()
    };
    Solver::new(surface, &material).unwrap()
}

fn center(surface: &Surface, solver: &Solver) -> Vec3 {
    let (mut sum, mut total) = (Vec3::zeros(), 0.0);
    for v in surface.topology().vertices() {
        let mass = f64::from(solver.masses()[v.index()]);
        sum += surface.position(v) * mass;
        total += mass;
    }
    sum / total
}

fn max_speed(solver: &Solver) -> f64 {
    let squares = solver.velocities().iter().map(|v| {
        let square = |&c: &f32| f64::from(c) * f64::from(c);
        v.iter().map(square).sum::<f64>()
    });
    squares.fold(0.0, f64::max).sqrt()
}

/// Returns the preserved sums about a fixed point.
fn sums(surface: &Surface, solver: &Solver, about: [f64; 3]) -> (f64, Vec3, Vec3, Vec3) {
    (
        solver.total_mass(),
        center(surface, solver),
        solver.momentum().into(),
        solver.angular_momentum(surface, about).into(),
    )
}

/// Cuts by the exact method without and with snapping, or by the paper's.
fn cut(kind: u8, surface: &mut Surface, sweep: &Sweep) -> Option<CutOutcome> {
    let mut cutter = Cutter::new(surface);
    if kind == 2 {
        let cut = incise_paper::cut(&mut cutter, surface, sweep, &PaperParams::default());
        return cut.ok().map(|outcome| outcome.cut);
    }
    let params = CutParams {
        snap: if kind == 1 { 0.1 } else { 0.0 },
        ..CutParams::default()
    };
    cutter.cut(surface, sweep, &params).ok()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn a_cut_preserves_mass_and_momentum(
        shape in 0..3_u8,
        kind in 0..3_u8,
        normal in prop::array::uniform3(-1.0_f64..1.0),
        offset in -0.2_f64..0.2,
        fly in prop::array::uniform3(-5.0_f32..5.0),
        spin in prop::array::uniform3(-8.0_f32..8.0),
        shake in 0.0_f32..4.0,
        seed: u64,
    ) {
        let length = normal.iter().map(|c| c * c).sum::<f64>();
        prop_assume!(length > 0.01);
        let mut surface = match shape {
            0 => icosphere(3, 0.5),
            1 => cube_sphere(8, 0.5),
            _ => torus(0.35, 0.15, 24, 12),
        };
        let mut solver = solver(&mut surface);
        for v in surface.topology().vertices() {
            let [x, y, z, _] = surface.positions()[v.index()];
            let [a, b, c] = spin;
            let turn = [b * z - c * y, c * x - a * z, a * y - b * x];
            let at = |k: u64| shake * noise(seed ^ (u64::from(v.0) << 2 | k));
            let velocity = [0, 1, 2].map(|k| fly[k] + turn[k] + at(k as u64));
            solver.set_velocity(v, velocity).unwrap();
        }
        let about = [3.0, -1.0, 0.5];
        let (mass, center, momentum, angular) = sums(&surface, &solver, about);
        let (energy, speed) = (solver.kinetic_energy(), max_speed(&solver));
        let sweep = Sweep::from_plane(normal, offset, &surface.bounds()).unwrap();
        let Some(outcome) = cut(kind, &mut surface, &sweep) else {
            // The paper's method supports simple loops only.
            prop_assert_eq!(kind, 2);
            return Ok(());
        };
        prop_assume!(!outcome.is_miss());
        solver.apply_delta(&mut surface, &outcome.delta).unwrap();
        solver.validate(&surface).unwrap();
        let now = sums(&surface, &solver, about);
        prop_assert!((now.0 - mass).abs() <= ROUNDING * mass);
        let scale = mass * speed;
        prop_assert!((now.2 - momentum).norm() <= ROUNDING * scale, "{momentum} became {}", now.2);
        prop_assert!((now.1 - center).norm() <= ROUNDING, "{center} became {}", now.1);
        let lost = (now.3 - angular).norm();
        prop_assert!(lost <= 4.0 * ROUNDING * scale, "{angular} became {}", now.3);
        // The energy of vertices at the rim is distributed to more or to fewer vertices.
        let now = solver.kinetic_energy();
        prop_assert!(now <= 1.5 * energy, "{energy} became {now}");
        prop_assert!(max_speed(&solver) <= 12.0 * speed);
    }

    #[test]
    fn a_body_in_straight_flight_does_not_spin_after_a_cut(
        kind in 0..3_u8,
        normal in prop::array::uniform3(-1.0_f64..1.0),
    ) {
        prop_assume!(normal.iter().map(|c| c * c).sum::<f64>() > 0.01);
        let mut surface = icosphere(3, 0.5);
        let mut solver = solver(&mut surface);
        let velocity = [30.0, -2.0, 0.125];
        for v in surface.topology().vertices() {
            solver.set_velocity(v, velocity).unwrap();
        }
        let sweep = Sweep::from_plane(normal, 0.07, &surface.bounds()).unwrap();
        let delta = cut(kind, &mut surface, &sweep).unwrap().delta;
        solver.apply_delta(&mut surface, &delta).unwrap();
        for v in surface.topology().vertices() {
            for (now, was) in solver.velocity(v).into_iter().zip(velocity) {
                prop_assert!((now - was).abs() <= 3e-4, "{v} moves at {now} and not at {was}");
            }
        }
    }
}

#[test]
fn pinned_vertices_stay_and_free_ones_take_the_momentum() {
    let mut surface = icosphere(3, 0.5);
    let mut solver = solver(&mut surface);
    for v in surface.topology().vertices() {
        let [x, y, z, _] = surface.positions()[v.index()];
        solver.set_velocity(v, [y - z, 1.0 - x, x]).unwrap();
    }
    let pinned: Vec<VertexId> = (surface.topology().vertices())
        .filter(|v| surface.positions()[v.index()][0] > 0.4)
        .collect();
    for &v in &pinned {
        solver.pin(&mut surface, v).unwrap();
    }
    let (momentum, angular) = (
        Vec3::from(solver.momentum()),
        Vec3::from(solver.angular_momentum(&surface, [0.0; 3])),
    );
    let scale = solver.total_mass() * max_speed(&solver);
    let sweep = Sweep::from_plane([0.1, 1.0, 0.2], 0.02, &surface.bounds()).unwrap();
    let outcome = cut(0, &mut surface, &sweep).unwrap();
    solver.apply_delta(&mut surface, &outcome.delta).unwrap();
    for &v in &pinned {
        assert_eq!(solver.velocity(v), [0.0; 3], "{v} is pinned");
        assert_eq!(surface.positions()[v.index()][3], 0.0, "{v} is pinned");
    }
    let lost = (Vec3::from(solver.momentum()) - momentum).norm();
    assert!(lost <= ROUNDING * scale, "momentum changed by {lost}");
    let now = Vec3::from(solver.angular_momentum(&surface, [0.0; 3]));
    let lost = (now - angular).norm();
    assert!(
        lost <= ROUNDING * scale,
        "angular momentum changed by {lost}"
    );
}
