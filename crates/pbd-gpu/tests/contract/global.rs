//! The global step: discrete laws, convergence, edits, and the same bits on any number of threads.

use incise_mesh::geometry::to_f32;
use incise_mesh::{HalfEdge, Surface, TriangleId, Vec3, VertexId, icosphere};
use incise_pbd_gpu::{
    Collider, GlobalStats, Material, Scheme, Solver, SolverParams, Stiffness, Volume,
};
use incise_test_support::edits::split;
use nalgebra::Matrix3;
use std::num::NonZeroUsize;

const DT: f32 = 1.0 / 60.0;

/// One substep of four iterations without ground.
const GLOBAL: SolverParams = SolverParams {
    iterations: 4,
    scheme: Scheme::Global,
    ..SolverParams::paper()
};

fn elastic(stretch: f32, bending: f32) -> Material {
    Material {
        stretch: Stiffness::Compliance(stretch),
        bending: Some(Stiffness::Compliance(bending)),
        damping: 0.0,
        ..Material::default()
    }
}

fn body(mut surface: Surface, material: &Material) -> (Surface, Solver) {
    let solver = Solver::new(&mut surface, material).unwrap();
    (surface, solver)
}

/// Mass, momentum and angular momentum about the origin.
fn momentum(surface: &Surface, solver: &Solver) -> (f64, Vec3, Vec3) {
    let mut sums = (0.0, Vec3::zeros(), Vec3::zeros());
    for v in surface.topology().vertices() {
        let mass = f64::from(solver.masses()[v.index()]);
        let [x, y, z, _] = solver.velocities()[v.index()].map(f64::from);
        let velocity = Vec3::new(x, y, z);
        sums.0 += mass;
        sums.1 += velocity * mass;
        sums.2 += surface.position(v).cross(&velocity) * mass;
    }
    sums
}

fn set_velocities(solver: &mut Solver, surface: &Surface, of: impl Fn(Vec3) -> Vec3) {
    for v in surface.topology().vertices() {
        let velocity = to_f32(of(surface.position(v)));
        solver.set_velocity(v, velocity).unwrap();
    }
}

#[test]
fn a_spring_moves_as_in_backward_euler() {
    let compliance = 1e-3_f32;
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let surface = Surface::from_triangles(&corners, &[[0, 1, 2]]).unwrap();
    let material = Material {
        stretch: Stiffness::Compliance(compliance),
        bending: None,
        damping: 0.0,
        ..Material::default()
    };
    let (mut surface, mut solver) = body(surface, &material);
    solver.pin(&mut surface, VertexId(0)).unwrap();
    solver.pin(&mut surface, VertexId(2)).unwrap();
    surface.positions_mut()[1][0] = 1.25;
    let params = SolverParams {
        iterations: 30,
        gravity: [0.0; 3],
        ..GLOBAL
    };
    // The objective has its minimum where the implicit Euler step has its solution: x and y are
    // those of a mass on two springs, found by Newton's method.
    let mass = f64::from(solver.masses()[1]);
    let (mut x, mut v) = (Vec3::new(1.25, 0.0, 0.0), Vec3::zeros());
    let anchors = [Vec3::zeros(), Vec3::new(0.0, 1.0, 0.0)];
    let h = f64::from(DT);
    for step in 0..100 {
        solver.step(&mut surface, DT, &params).unwrap();
        let goal = x + v * h;
        let mut at = goal;
        for _ in 0..50 {
            let mut force = (at - goal) * (mass / (h * h));
            let mut slope = Matrix3::identity() * (mass / (h * h));
            for (anchor, rest) in anchors.iter().zip([1.0, 2.0_f64.sqrt()]) {
                let edge = at - anchor;
                let n = edge / edge.norm();
                let stretched = edge.norm() - rest;
                force += n * (stretched / f64::from(compliance));
                slope += n * n.transpose() / f64::from(compliance);
            }
            at -= slope.try_inverse().unwrap() * force;
        }
        (v, x) = ((at - x) / h, at);
        let found = surface.position(VertexId(1));
        assert!(
            (found - x).norm() < 1e-5,
            "{found}, not {x}, in step {step}"
        );
    }
}

#[test]
fn a_free_body_falls_exactly_and_keeps_its_momentum() {
    let (mut surface, mut solver) = body(icosphere(2, 0.5), &elastic(1e-5, 1e-2));
    // A stretched ball that flies and turns.
    surface.positions_mut().iter_mut().for_each(|p| p[0] *= 1.2);
    set_velocities(&mut solver, &surface, |x| Vec3::new(1.0 - x.y, x.x, 0.5));
    let (mass, mut expected, _) = momentum(&surface, &solver);
    let start = center(&surface, &solver);
    let mut fallen = start;
    for frame in 0..60 {
        solver.step(&mut surface, DT, &GLOBAL).unwrap();
        expected.y -= 9.81 * f64::from(DT) * mass;
        fallen += expected / mass * f64::from(DT);
        let (_, found, _) = momentum(&surface, &solver);
        let error = (found - expected).norm() / mass;
        assert!(
            error < 1e-4,
            "velocity off by {error} m/s after frame {frame}"
        );
    }
    let error = (center(&surface, &solver) - fallen).norm();
    assert!(error < 1e-3, "center off by {error} m");
}

fn center(surface: &Surface, solver: &Solver) -> Vec3 {
    let vertices = surface.topology().vertices();
    let (sum, mass) = vertices.fold((Vec3::zeros(), 0.0), |(sum, total), v| {
        let mass = f64::from(solver.masses()[v.index()]);
        (sum + surface.position(v) * mass, total + mass)
    });
    sum / mass
}

/// Regression: after the second release the factor of the pinned body had no correction.
#[test]
fn a_released_body_falls_at_once_each_time() {
    let (mut surface, mut solver) = body(icosphere(2, 0.5), &elastic(1e-6, 1e-3));
    for release in 0..3 {
        solver.pin(&mut surface, VertexId(0)).unwrap();
        // Until the factor of the pinned body is in use.
        for _ in 0..6 {
            solver.step(&mut surface, DT, &GLOBAL).unwrap();
        }
        solver.unpin(&mut surface, VertexId(0)).unwrap();
        set_velocities(&mut solver, &surface, |_| Vec3::zeros());
        let before = center(&surface, &solver);
        solver.step(&mut surface, DT, &GLOBAL).unwrap();
        let fallen = before.y - center(&surface, &solver).y;
        let expected = 9.81 * f64::from(DT).powi(2);
        let off = (fallen / expected - 1.0).abs();
        assert!(off < 1e-3, "release {release}: {fallen} of {expected} m");
        for _ in 0..6 {
            solver.step(&mut surface, DT, &GLOBAL).unwrap();
        }
    }
}

#[test]
fn spin_decays_as_in_implicit_euler() {
    for iterations in [1, 4, 16] {
        let (mut surface, mut solver) = body(icosphere(3, 0.5), &elastic(1e-6, 1e-3));
        let rate = 3.0;
        set_velocities(&mut solver, &surface, |x| Vec3::new(-x.y, x.x, 0.0) * rate);
        let params = SolverParams {
            iterations,
            gravity: [0.0; 3],
            ..GLOBAL
        };
        let start = momentum(&surface, &solver).2.norm();
        // A point on a circle: the step ends where the circle meets the ray to the prediction. The
        // velocity is that of the chord, which leaves the circle at half of the turn.
        let mut turn = (rate * f64::from(DT)).atan();
        let mut expected = start * turn.sin() / (rate * f64::from(DT));
        for frame in 0..30 {
            solver.step(&mut surface, DT, &params).unwrap();
            let found = momentum(&surface, &solver).2.norm();
            let error = (found / expected - 1.0).abs();
            assert!(
                error < 2e-3,
                "off by {error} after frame {frame}, {iterations} iterations"
            );
            let next = (turn.sin() / (2.0 - turn.cos())).atan();
            expected *= next.sin() / turn.sin();
            turn = next;
        }
    }
}

/// Hangs a ball from its top, splits edges while it swings, and returns all bits at the end.
fn swing(pool: usize, limit: Option<usize>, clones: bool) -> Vec<[u32; 4]> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(pool).build();
    pool.unwrap().install(|| {
        let (mut surface, mut solver) = body(icosphere(4, 0.5), &elastic(1e-5, 1e-2));
        for v in surface.topology().vertices().collect::<Vec<_>>() {
            if surface.position(v).y > 0.45 {
                solver.pin(&mut surface, v).unwrap();
            }
        }
        let params = SolverParams {
            threads: limit.and_then(NonZeroUsize::new),
            ..GLOBAL
        };
        for frame in 0..12 {
            if frame == 2 || frame == 4 {
                let triangles = surface.topology().triangles();
                let all: Vec<HalfEdge> = triangles.flat_map(TriangleId::half_edges).collect();
                let delta = split(&mut surface, all[101 * (frame + 1)], 0.4).unwrap();
                solver.apply_delta(&mut surface, &delta).unwrap();
            }
            solver.step(&mut surface, DT, &params).unwrap();
            if clones {
                solver = solver.clone();
            }
        }
        assert_eq!(solver.global_stats().factorizations, 3, "one for each edit");
        let bits = |p: &[f32; 4]| p.map(f32::to_bits);
        surface.positions().iter().map(bits).collect()
    })
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let one = swing(1, Some(1), false);
    for pool in [1, 2, 3, 5, 8] {
        assert!(
            one == swing(pool, None, false),
            "{pool} threads differ from one"
        );
    }
    assert!(one == swing(2, None, true), "a clone differs");
}

#[test]
fn a_body_that_does_not_take_it_has_no_matrix() {
    let sweeps = SolverParams {
        scheme: Scheme::Sweeps,
        ..GLOBAL
    };
    let (mut surface, mut solver) = body(icosphere(2, 0.5), &elastic(1e-5, 1e-2));
    solver.step(&mut surface, DT, &sweeps).unwrap();
    assert_eq!(solver.global_stats(), GlobalStats::default());
    solver.step(&mut surface, DT, &GLOBAL).unwrap();
    let stats = solver.global_stats();
    assert!(stats.factor_entries > 162 && stats.bytes > 8 * stats.factor_entries);
    assert_eq!(
        (stats.factorizations, solver.stats().global_iterations),
        (1, 4)
    );
    assert_eq!(solver.stats().stretch_projections, 0, "no sweeps");
    solver.step(&mut surface, DT, &sweeps).unwrap();
    assert_eq!(solver.global_stats(), GlobalStats::default(), "dropped");
    // A stiffness of PBD has no energy.
    let soft = Material {
        stretch: Stiffness::Pbd(0.5),
        ..Material::default()
    };
    let (mut surface, mut solver) = body(icosphere(2, 0.5), &soft);
    solver.step(&mut surface, DT, &GLOBAL).unwrap();
    assert_eq!(solver.global_stats(), GlobalStats::default());
    assert!(solver.stats().stretch_projections > 0, "sweeps");
}

#[test]
fn memory_and_age_of_the_factor_are_reported() {
    let (mut surface, mut solver) = body(icosphere(3, 0.5), &elastic(1e-5, 1e-2));
    solver.step(&mut surface, DT, &GLOBAL).unwrap();
    let sweeps = solver.capacity() - solver.global_stats().bytes / 8;
    for frame in 1..8 {
        assert_eq!(solver.global_stats().factor_age, frame - 1);
        solver.step(&mut surface, DT, &GLOBAL).unwrap();
        let bytes = solver.global_stats().bytes;
        assert_eq!(solver.capacity(), sweeps + bytes / 8, "frame {frame}");
    }
    let delta = split(&mut surface, TriangleId(77).half_edges()[0], 0.4).unwrap();
    solver.apply_delta(&mut surface, &delta).unwrap();
    // Copied in the next frame and taken into use two frames later.
    for (age, count) in [(8, 1), (9, 1), (2, 2), (3, 2)] {
        solver.step(&mut surface, DT, &GLOBAL).unwrap();
        let stats = solver.global_stats();
        assert_eq!((stats.factor_age, stats.factorizations), (age, count));
    }
}

#[test]
fn the_frame_of_an_edit_makes_a_quarter_of_the_iterations_of_a_large_body() {
    for (level, expected) in [(4, [8, 8, 8]), (5, [8, 2, 8])] {
        let (mut surface, mut solver) = body(icosphere(level, 0.5), &elastic(1e-5, 1e-2));
        let params = SolverParams {
            iterations: 4,
            ..GLOBAL
        }
        .with_substeps(DT, 2);
        let found = [false, true, false].map(|is_edited| {
            if is_edited {
                let delta = split(&mut surface, TriangleId(77).half_edges()[0], 0.4).unwrap();
                solver.apply_delta(&mut surface, &delta).unwrap();
            }
            solver.step(&mut surface, DT, &params).unwrap();
            solver.stats().global_iterations
        });
        assert_eq!(found, expected, "{} vertices", surface.positions().len());
    }
}

#[test]
fn stiff_bodies_take_it_by_themselves() {
    let auto = SolverParams {
        scheme: Scheme::Auto,
        ..GLOBAL
    };
    let stiff = elastic(1e-6, 1e-4);
    let limp = Material {
        bending: None,
        ..stiff
    };
    for (material, iterations, expected) in [
        (&stiff, 4, 4),
        (&stiff, 1, 0),
        (&limp, 4, 0),
        (&elastic(1e-2, 1.0), 4, 0),
    ] {
        let (mut surface, mut solver) = body(icosphere(2, 0.5), material);
        let params = SolverParams { iterations, ..auto };
        solver.step(&mut surface, DT, &params).unwrap();
        assert_eq!(solver.stats().global_iterations, expected, "{material:?}");
        let has_memory = solver.global_stats() != GlobalStats::default();
        assert_eq!(has_memory, expected > 0, "{material:?}");
    }
}

/// A cube with sides of 1 m, whose vertices are those of a ball moved onto its faces.
fn block() -> Surface {
    let mut surface = icosphere(2, 0.5);
    for i in 0..surface.positions().len() {
        let p = surface.rest_position(VertexId::from_index(i));
        let [x, y, z] = to_f32(p * (0.5 / p.amax()));
        surface.rest_positions_mut()[i] = [x, y, z];
        let w = surface.positions()[i][3];
        surface.positions_mut()[i] = [x, y, z, w];
    }
    surface
}

/// A block that falls on the ground from 0.2 m, and the parameters of its steps. A ball would roll
/// without end.
fn block_above_the_ground(material: &Material, substeps: u32) -> (Surface, Solver, SolverParams) {
    let (mut surface, mut solver) = body(block(), material);
    surface.positions_mut().iter_mut().for_each(|p| p[1] += 0.7);
    solver
        .set_colliders(&[Collider::ground(0.0).into()])
        .unwrap();
    let params = SolverParams {
        iterations: 8,
        ..GLOBAL
    }
    .with_substeps(DT, substeps);
    (surface, solver, params)
}

fn max_speed(solver: &Solver) -> f32 {
    let velocities = solver.velocities().iter().flatten();
    velocities.fold(0.0, |far: f32, v| far.max(v.abs()))
}

/// Returns the largest speed relative to the rigid motion of a body, which may roll [m/s].
fn max_relative_speed(surface: &Surface, solver: &Solver) -> f64 {
    let vertices: Vec<VertexId> = surface.topology().vertices().collect();
    let mass = |v: VertexId| f64::from(solver.masses()[v.index()]);
    let velocity_of = |v: VertexId| Vec3::from(solver.velocity(v).map(f64::from));
    let total = solver.total_mass();
    let center = vertices
        .iter()
        .map(|&v| surface.position(v) * mass(v))
        .sum::<Vec3>()
        / total;
    let velocity = vertices
        .iter()
        .map(|&v| velocity_of(v) * mass(v))
        .sum::<Vec3>()
        / total;
    let (mut momentum, mut inertia) = (Vec3::zeros(), Matrix3::zeros());
    for &v in &vertices {
        let arm = surface.position(v) - center;
        momentum += arm.cross(&velocity_of(v)) * mass(v);
        let squares = Matrix3::identity() * arm.norm_squared();
        inertia += (squares - arm * arm.transpose()) * mass(v);
    }
    let turn = inertia.try_inverse().unwrap() * momentum;
    let relative = vertices.iter().map(|&v| {
        let rigid = velocity + turn.cross(&(surface.position(v) - center));
        (velocity_of(v) - rigid).norm()
    });
    relative.fold(0.0, f64::max)
}

#[test]
#[ignore = "long"]
fn stiff_bodies_come_to_rest_on_the_ground() {
    for (compliance, volume) in [(1e-6, None), (1e-4, Some(Volume::default()))] {
        let material = Material {
            volume,
            friction: 0.5,
            damping: 2.0,
            ..elastic(compliance, 100.0 * compliance)
        };
        let (mut surface, mut solver, params) = block_above_the_ground(&material, 4);
        for _ in 0..900 {
            solver.step(&mut surface, DT, &params).unwrap();
        }
        let bounds = surface.bounds();
        let heights = [bounds.min[1], bounds.max[1]];
        assert!(heights[0] >= 0.0 && heights[0] < 1e-3, "{heights:?}");
        assert!((heights[1] - 1.0).abs() < 0.03, "{heights:?}");
        let speed = max_speed(&solver);
        assert!(speed < 0.02, "{speed} m/s");
    }
}

#[test]
fn a_volume_does_not_tremble_in_long_substeps() {
    for compliance in [1e-4, 1e-5, 1e-6] {
        let material = Material {
            volume: Some(Volume::default()),
            friction: 0.5,
            damping: 2.0,
            ..elastic(compliance, 100.0 * compliance)
        };
        let (mut surface, mut solver, params) = block_above_the_ground(&material, 1);
        let rest = surface.volume();
        for _ in 0..600 {
            solver.step(&mut surface, DT, &params).unwrap();
        }
        let volume = surface.volume() / rest;
        assert!((volume - 1.0).abs() < 1e-4, "{volume}, {compliance} m/N");
        let speed = max_relative_speed(&surface, &solver);
        assert!(speed < 5e-3, "{speed} m/s, {compliance} m/N");
    }
}
