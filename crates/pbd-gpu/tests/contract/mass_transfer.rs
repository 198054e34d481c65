//! Transfer of mass and velocity to new vertices: no added spin, bounded speed.

use incise_mesh::geometry::to_f32;
use incise_mesh::{HalfEdge, Surface, Vec3, VertexId};
use incise_pbd_gpu::{Material, Solver};
use incise_test_support::edits::{replace_vertex, split};
use incise_test_support::random::noise;
use incise_test_support::surfaces::sphere;
use proptest::prelude::*;

fn fastest(solver: &Solver) -> f64 {
    let squares = solver.velocities().iter().map(|v| {
        let square = |&c: &f32| f64::from(c) * f64::from(c);
        v.iter().map(square).sum::<f64>()
    });
    squares.fold(0.0, f64::max).sqrt()
}

proptest! {
    #[test]
    fn a_body_in_straight_flight_does_not_spin_after_an_edit(renews: bool, at in 0..66_u32) {
        let mut surface = sphere(2, [0.0, 2.0, 0.0]);
        let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
        let velocity = [30.0, -2.0, 0.125];
        for v in surface.topology().vertices() {
            solver.set_velocity(v, velocity).unwrap();
        }
        let delta = if renews {
            replace_vertex(&mut surface, VertexId(at))
        } else {
            split(&mut surface, HalfEdge(at), 0.3)
        };
        solver.apply_delta(&mut surface, &delta.unwrap()).unwrap();
        for v in surface.topology().vertices() {
            for (now, was) in solver.velocity(v).into_iter().zip(velocity) {
                prop_assert!((now - was).abs() <= 3e-4, "{v} moves at {now} and not at {was}");
            }
        }
    }

    #[test]
    fn a_split_edge_keeps_its_rotation(
        at in 0..384_u32,
        t in 0.1_f32..0.9,
        spin in prop::array::uniform3(-8.0_f64..8.0),
    ) {
        let mut surface = sphere(2, [0.0, 2.0, 0.0]);
        let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
        for v in surface.topology().vertices() {
            let turn = to_f32(Vec3::from(spin).cross(&surface.position(v)));
            let at = |k: u64| 0.5 * noise(u64::from(v.0) << 2 | k);
            let velocity = [turn[0] + at(0), turn[1] + at(1), turn[2] + at(2)];
            solver.set_velocity(v, velocity).unwrap();
        }
        let about = [1.0, 0.0, -2.0];
        let sums = |solver: &Solver, surface: &Surface| -> (Vec3, Vec3) {
            let angular = solver.angular_momentum(surface, about);
            (solver.momentum().into(), angular.into())
        };
        let before = sums(&solver, &surface);
        let scale = solver.total_mass() * fastest(&solver);
        let delta = split(&mut surface, HalfEdge(at), t).unwrap();
        solver.apply_delta(&mut surface, &delta).unwrap();
        let after = sums(&solver, &surface);
        prop_assert!((after.0 - before.0).norm() <= 2e-6 * scale);
        let change = (after.1 - before.1).norm();
        prop_assert!(change <= 8e-6 * scale, "{} became {}", before.1, after.1);
    }
}

#[test]
fn speeds_are_bounded_when_mass_concentrates() {
    let mut surface = sphere(2, [0.0, 2.0, 0.0]);
    let mut solver = Solver::new(&mut surface, &Material::default()).unwrap();
    for i in 0..200_u32 {
        for v in surface.topology().vertices() {
            let at = |k: u64| noise(u64::from(i) << 32 | u64::from(v.0) << 2 | k);
            solver.set_velocity(v, [at(0), at(1), at(2)]).unwrap();
        }
        let (speed, energy) = (fastest(&solver), solver.kinetic_energy());
        let count = surface.topology().vertex_count();
        let v = surface.topology().vertices().nth(i as usize * 7 % count);
        let Some(delta) = replace_vertex(&mut surface, v.unwrap()) else {
            continue;
        };
        solver.apply_delta(&mut surface, &delta).unwrap();
        assert!(fastest(&solver) <= 12.0 * speed);
        let most = 0.5 * solver.total_mass() * (12.0 * speed).powi(2);
        assert!(solver.kinetic_energy() <= energy.max(most));
    }
}
