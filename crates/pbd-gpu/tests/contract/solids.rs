//! Solids: closed forms, conservation and rest, on the CPU.
#![allow(
    clippy::cast_possible_truncation,
    reason = "small whole numbers, and numbers as they are stored"
)]

use incise_mesh::{Surface, Vec3, VertexId, cuboid, icosphere, torus};
use incise_pbd_gpu::{ConstraintError, Material, Solid, Solver, SolverParams};
use incise_test_support::beams::cantilever_sag;
use incise_test_support::params::set_ground;
use incise_test_support::random::Random;

const WEIGHTLESS: SolverParams = SolverParams {
    gravity: [0.0; 3],
    ..WEIGHTY
};

const WEIGHTY: SolverParams = SolverParams {
    iterations: 1,
    substep: Some(1.0 / 720.0),
    lift: 0.48,
    gravity: [0.0, -9.81, 0.0],
    residual: None,
    diagonal_scale: 0.5,
    conserve: true,
    attachments: true,
    ..SolverParams::paper()
};

const DT: f32 = 1.0 / 60.0;

fn solid(young_modulus: f32, poisson_ratio: f32, cell_size: Option<f32>) -> Material {
    let mut material = Material::solid(young_modulus, poisson_ratio, 1000.0);
    material.solid = material.solid.map(|solid| Solid { cell_size, ..solid });
    material
}

fn with_relaxation(material: Material, relaxation_time: f32) -> Material {
    Material {
        solid: material.solid.map(|solid| Solid {
            relaxation_time,
            ..solid
        }),
        ..material
    }
}

/// Bodies of different shapes, about 1 m across.
fn bodies() -> [Surface; 3] {
    [
        icosphere(3, 0.5),
        torus(0.35, 0.15, 32, 16),
        cuboid([0.5, 0.1, 0.2], [10, 2, 4]),
    ]
}

fn pin_where(surface: &mut Surface, solver: &mut Solver, is_held: impl Fn(Vec3) -> bool) {
    let vertices: Vec<VertexId> = surface.topology().vertices().collect();
    for v in vertices {
        if is_held(surface.rest_position(v)) {
            solver.pin(surface, v).unwrap();
        }
    }
}

fn max_speed(solver: &Solver) -> f64 {
    let squares = solver.velocities().iter().map(|v| {
        let v = v.map(f64::from);
        v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
    });
    squares.fold(0.0, f64::max).sqrt()
}

/// Returns the sag of a cantilever of 1 x 0.2 x 0.2 m, relative to that of a beam.
fn sag(across: u32, squares: u32, dt: f32, poisson_ratio: f32) -> f64 {
    let mut surface = cuboid([0.5, 0.1, 0.1], [5 * squares, squares, squares]);
    let cell = 0.2 / across as f32;
    // Damped to rest in 6 s.
    let material = with_relaxation(solid(1e6, poisson_ratio, Some(cell)), 0.05);
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    pin_where(&mut surface, &mut solver, |p| p.x < -0.499);
    let frames = (6.0 / f64::from(dt)).round() as u32;
    for _ in 0..frames {
        solver.step(&mut surface, dt, &WEIGHTY).unwrap();
    }
    let ends = surface
        .topology()
        .vertices()
        .filter(|&v| surface.rest_position(v).x > 0.499);
    let sags: Vec<f64> = ends
        .map(|v| surface.rest_position(v).y - surface.position(v).y)
        .collect();
    let weight = 1000.0 * 9.81 * 0.04;
    let shear = 1e6 / (2.0 * (1.0 + f64::from(poisson_ratio))) * 0.04 * 5.0 / 6.0;
    let expected = cantilever_sag(1.0, weight, 1e6 * 0.2_f64.powi(4) / 12.0, shear);
    sags.iter().sum::<f64>() / sags.len() as f64 / expected
}

#[test]
fn a_cantilever_sags_like_a_beam() {
    for (across, poisson_ratio) in [(1, 0.4), (2, 0.3), (2, 0.45), (4, 0.3), (4, 0.45)] {
        let ratio = sag(across, 4, DT, poisson_ratio);
        assert!(
            (ratio - 1.0).abs() < 0.1,
            "{across} cells, {poisson_ratio}: {ratio}"
        );
    }
}

#[test]
fn the_sag_depends_neither_on_the_surface_nor_on_frames() {
    let expected = sag(2, 4, DT, 0.4);
    for (squares, dt) in [(2, DT), (8, DT), (4, 1.0 / 30.0), (4, 1.0 / 240.0)] {
        let ratio = sag(2, squares, dt, 0.4) / expected;
        assert!(
            (ratio - 1.0).abs() < 0.01,
            "{squares} squares, {dt} s: {ratio}"
        );
    }
}

#[test]
fn a_hanging_bar_is_as_long_as_hookes_law_says() {
    let mut surface = cuboid([0.1, 0.5, 0.1], [2, 10, 2]);
    let material = with_relaxation(solid(2e5, 0.0, Some(0.1)), 0.05);
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    pin_where(&mut surface, &mut solver, |p| p.y > 0.499);
    for _ in 0..180 {
        solver.step(&mut surface, DT, &WEIGHTY).unwrap();
    }
    let low = surface.bounds().min[1];
    // Strain is rho g y / E over the length, and cells have the mean strain of their part.
    let expected = 1000.0 * 9.81 / (2.0 * 2e5);
    let stretch = f64::from(-0.5 - low);
    assert!(
        (stretch / expected - 1.0).abs() < 0.03,
        "{stretch} m, {expected} m"
    );
}

#[test]
fn a_body_at_rest_stays() {
    for surface in bodies() {
        let mut moved = surface.clone();
        let mut solver = Solver::new(&mut moved, &solid(1e5, 0.45, None)).unwrap();
        for _ in 0..60 {
            solver.step(&mut moved, DT, &WEIGHTLESS).unwrap();
        }
        assert!(max_speed(&solver) < 1e-6, "{} m/s", max_speed(&solver));
    }
}

#[test]
fn free_fall_is_exact_and_keeps_the_shape() {
    for mut surface in bodies() {
        let mut solver = Solver::new(&mut surface, &solid(1e5, 0.45, None)).unwrap();
        for _ in 0..60 {
            solver.step(&mut surface, DT, &WEIGHTY).unwrap();
        }
        let [x, y, z] = solver.momentum().map(|p| p / solver.total_mass());
        assert!((y + 9.81).abs() < 1e-4, "{y} m/s");
        assert!(x.abs().max(z.abs()) < 1e-4, "{x}, {z} m/s");
        assert!(max_speed(&solver) < 9.811, "{} m/s", max_speed(&solver));
    }
}

#[test]
fn a_spinning_body_keeps_its_angular_momentum() {
    let params = SolverParams {
        conserve: false,
        ..WEIGHTLESS
    };
    for mut surface in bodies() {
        let mut solver = Solver::new(&mut surface, &solid(1e5, 0.45, None)).unwrap();
        spin(&surface, &mut solver, Vec3::new(0.5, 3.0, -1.0));
        // The first step maps the velocities of vertices to the nodes.
        solver.step(&mut surface, DT, &params).unwrap();
        let before = Vec3::from(solver.angular_momentum(&surface, [0.0; 3]));
        for _ in 0..120 {
            solver.step(&mut surface, DT, &params).unwrap();
        }
        let after = Vec3::from(solver.angular_momentum(&surface, [0.0; 3]));
        let lost = (after - before).norm() / before.norm();
        assert!(lost < 1e-3, "{lost}");
    }
}

/// Gives vertices the velocities of a rotation [rad/s].
fn spin(surface: &Surface, solver: &mut Solver, rate: Vec3) {
    for v in surface.topology().vertices() {
        let velocity = rate.cross(&surface.position(v));
        let velocity = [velocity.x, velocity.y, velocity.z].map(|c| c as f32);
        solver.set_velocity(v, velocity).unwrap();
    }
}

#[test]
fn a_body_that_is_let_go_does_not_turn() {
    // Stretched and sheared: viscous forces are not parallel to the strain.
    for (young_modulus, most) in [(1e5, 0.012), (1e6, 0.06)] {
        let mut surface = cuboid([0.5, 0.1, 0.1], [20, 4, 4]);
        let material = solid(young_modulus, 0.45, Some(0.05));
        let mut solver = Solver::new(&mut surface, &material).unwrap();
        for x in surface.positions_mut() {
            *x = [1.1 * x[0], x[1] + 0.15 * x[0], x[2], x[3]];
        }
        let params = SolverParams {
            conserve: false,
            ..WEIGHTLESS
        };
        for _ in 0..12 {
            solver.step(&mut surface, DT, &params).unwrap();
        }
        let momentum = Vec3::from(solver.angular_momentum(&surface, [0.0; 3]));
        let inertia = solver.total_mass() / 12.0;
        let rate = momentum.norm() / inertia;
        assert!(rate < most, "{rate} rad/s at {young_modulus} Pa");
    }
}

#[test]
fn velocities_and_positions_of_vertices_move_the_nodes() {
    let mut surface = icosphere(3, 0.5);
    let mut solver = Solver::new(&mut surface, &solid(1e6, 0.45, None)).unwrap();
    let rate = Vec3::new(0.5, 3.0, -1.0);
    spin(&surface, &mut solver, rate);
    let instant = 1.0 / 720.0;
    solver.step(&mut surface, instant, &WEIGHTLESS).unwrap();
    for v in surface.topology().vertices() {
        let velocity = Vec3::from(solver.velocity(v).map(f64::from));
        let off = velocity - rate.cross(&surface.position(v));
        assert!(off.norm() < 0.02, "{v}: {off:?}");
    }
    // Turned by 90 degrees about z and moved.
    let turned: Vec<[f32; 4]> = surface
        .positions()
        .iter()
        .map(|&[x, y, z, w]| [2.0 - y, x, z + 1.0, w])
        .collect();
    surface.positions_mut().copy_from_slice(&turned);
    for v in surface.topology().vertices() {
        solver.set_velocity(v, [0.0; 3]).unwrap();
    }
    solver.step(&mut surface, instant, &WEIGHTLESS).unwrap();
    for (now, then) in surface.positions().iter().zip(&turned) {
        let off = (0..3).map(|k| (now[k] - then[k]).abs()).fold(0.0, f32::max);
        assert!(off < 1e-4, "{now:?}, {then:?}");
    }
    assert!(max_speed(&solver) < 0.05, "{} m/s", max_speed(&solver));
}

#[test]
fn energy_never_rises() {
    for (seed, mut surface) in (1..).zip(bodies()) {
        for young_modulus in [1e4, 1e5, 1e6, 1e7, 1e9] {
            let material = with_relaxation(solid(young_modulus, 0.45, None), 0.0);
            let mut solver = Solver::new(&mut surface, &material).unwrap();
            let mut random = Random::new(seed);
            for v in surface.topology().vertices() {
                let velocity = [0, 1, 2].map(|_| random.signed() as f32);
                solver.set_velocity(v, velocity).unwrap();
            }
            let energy = |solver: &Solver| solver.kinetic_energy() + solver.elastic_energy();
            solver.step(&mut surface, 1.0 / 720.0, &WEIGHTLESS).unwrap();
            let start = energy(&solver);
            for _ in 0..60 {
                solver.step(&mut surface, DT, &WEIGHTLESS).unwrap();
                let now = energy(&solver);
                assert!(
                    now <= start * 1.001,
                    "{now} J of {start} J at {young_modulus} Pa"
                );
            }
            for (x, rest) in surface.rest_positions().to_vec().iter().enumerate() {
                surface.positions_mut()[x][..3].copy_from_slice(rest);
            }
        }
    }
}

#[test]
fn a_dropped_body_lies_on_the_ground_with_its_volume() {
    for (number, mut surface) in bodies().into_iter().enumerate() {
        let volume = surface.volume();
        let mut solver = Solver::new(&mut surface, &solid(1e6, 0.45, None)).unwrap();
        set_ground(&mut solver, -1.0);
        let height = |solver: &Solver| -> f64 {
            let nodes = solver.nodes().iter();
            nodes
                .map(|x| 9.81 * f64::from(x[1]) / f64::from(x[3]))
                .sum()
        };
        let start = height(&solver);
        for _ in 0..300 {
            solver.step(&mut surface, DT, &WEIGHTY).unwrap();
            let energy = height(&solver) + solver.kinetic_energy() + solver.elastic_energy();
            assert!(
                energy <= start + 1e-3 * start.abs(),
                "{energy} J of {start} J"
            );
        }
        let low = surface.bounds().min[1];
        assert!((low + 1.0).abs() < 5e-3, "{low}");
        // The ball may roll.
        let is_still = number == 0 || max_speed(&solver) < 0.05;
        assert!(is_still, "{} m/s", max_speed(&solver));
        assert!((surface.volume() / volume - 1.0).abs() < 0.02);
    }
}

#[test]
fn a_block_rests_on_the_ground_at_any_friction() {
    for (friction, across) in [(0.5, 8), (2.0, 1), (2.0, 4), (5.0, 8)] {
        let mut surface = cuboid([0.4; 3], [12; 3]);
        let mut material = Material {
            friction,
            ..solid(1e6, 0.45, None)
        };
        material.solid.as_mut().unwrap().cells_across = across;
        let mut solver = Solver::new(&mut surface, &material).unwrap();
        set_ground(&mut solver, -0.41);
        // Without the limits of energy and momenta, friction itself must not add any.
        let params = SolverParams {
            conserve: false,
            ..WEIGHTY
        };
        for _ in 0..300 {
            solver.step(&mut surface, DT, &params).unwrap();
        }
        let speed = max_speed(&solver);
        assert!(speed < 1e-3, "{speed} m/s at friction {friction}");
        // Under its own weight a uniform block holds `(rho g L)^2 V / 6 E` at most.
        let energy = solver.elastic_energy();
        assert!(energy < 5.3, "{energy} J at friction {friction}");
    }
}

#[test]
fn pins_hold_and_move() {
    let mut surface = cuboid([0.5, 0.1, 0.1], [10, 2, 2]);
    let mut solver = Solver::new(&mut surface, &solid(1e6, 0.4, Some(0.1))).unwrap();
    pin_where(&mut surface, &mut solver, |p| p.x.abs() > 0.499);
    let pins = solver.pins().to_vec();
    for frame in 1..=60 {
        for pin in &pins {
            let [x, y, z] = pin.target;
            let by = 0.05 * frame as f32 / 60.0;
            let target = [x + by * x.signum(), y, z];
            solver.set_pin_target(pin.vertex, target).unwrap();
        }
        solver.step(&mut surface, DT, &WEIGHTLESS).unwrap();
        for pin in solver.pins() {
            let at = surface.positions()[pin.vertex.index()];
            let off = (0..3)
                .map(|k| (at[k] - pin.target[k]).abs())
                .fold(0.0, f32::max);
            assert!(off < 1e-4, "{}: {off} m", pin.vertex);
        }
    }
    let length = surface.bounds().max[0] - surface.bounds().min[0];
    assert!((length - 1.1).abs() < 1e-3, "{length} m");
}

#[test]
fn threads_do_not_change_bits() {
    let run = |threads: usize| {
        let mut surface = icosphere(4, 0.5);
        let material = solid(1e5, 0.45, Some(0.04));
        let mut solver = Solver::new(&mut surface, &material).unwrap();
        set_ground(&mut solver, -0.6);
        let params = SolverParams {
            threads: std::num::NonZeroUsize::new(threads),
            ..WEIGHTY
        };
        for _ in 0..30 {
            solver.step(&mut surface, DT, &params).unwrap();
        }
        let bits = |x: &[f32; 4]| x.map(f32::to_bits);
        surface.positions().iter().map(bits).collect::<Vec<_>>()
    };
    let expected = run(1);
    assert!(run(2) == expected && run(8) == expected, "bits differ");
}

#[test]
fn surfaces_without_an_inside_are_refused() {
    let mut sheet = incise_mesh::sheet([1.0; 2], [4; 2]);
    let error = Solver::new(
        &mut sheet,
        &Material {
            density: incise_pbd_gpu::Density::Area(1.0),
            ..solid(1e5, 0.4, None)
        },
    );
    let error = error.unwrap_err();
    assert!(matches!(error, ConstraintError::Lattice(_)), "{error}");
    assert!(error.to_string().contains("open"), "{error}");
}
