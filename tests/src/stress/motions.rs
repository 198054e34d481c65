//! Pins that leap and turn, parameters that change, falls, impacts, and random bodies.

use super::runner::{Body, Case, Runner, ball, largest_offset};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, VertexId, cube_sphere, icosphere, torus};
use incise_models::scenes::FRAME;
use incise_models::{double_cone, place, pose, sheet};
use incise_pbd_gpu::{Density, Material, SolverParams, Stiffness};
use incise_test_support::energy::{
    EnergyBudget, Limits, MAX_STRAIN, max_distance, mechanical, total,
};
use incise_test_support::materials::{elastic_shell, shells};
use incise_test_support::params::{TEN_ITERATIONS, WEIGHTLESS};
use incise_test_support::random::Random;

pub(super) const CASES: [Case; 12] = [
    ("a_body_of_pins_does_not_move", all_pinned),
    ("a_sheet_follows_a_pin_that_leaps", leaping_pin),
    ("a_sheet_follows_a_pin_that_turns", turning_pin),
    ("a_pin_that_comes_and_goes_adds_no_energy", toggled_pin),
    ("compliances_that_change_add_no_energy", changing_compliance),
    (
        "gravity_that_turns_over_adds_its_work_only",
        changing_gravity,
    ),
    ("time_steps_that_change_add_no_energy", changing_steps),
    ("subnormal_compliances_are_rigid", subnormal_compliances),
    ("falls_on_faces_edges_and_corners_add_no_energy", falls),
    ("impacts_add_no_energy_and_stay_above_ground", impacts),
    ("a_ball_squeezed_through_itself_recovers", squeezed),
    ("random_undamped_bodies_gain_no_energy", random_bodies),
];

/// Shells of sheets and balls that are pulled at.
fn pulled_shells() -> [(&'static str, Material); 3] {
    [
        ("stiffness 1", Material::default()),
        ("compliance 0", elastic_shell(0.0, 0.0)),
        ("compliance 1e-6", elastic_shell(1e-6, 1e-3)),
    ]
}

/// Upper corners of [`square`].
const CORNERS: [VertexId; 2] = [VertexId(0), VertexId(8)];

/// A square meter.
fn square(material: &Material) -> Body {
    Body::new(sheet([8, 8], [1.0, 1.0]), material)
}

fn all_pinned(runner: &mut Runner<'_>) {
    for (name, material) in pulled_shells() {
        let mut surface = ball(1, 0.0);
        pose(&mut surface, |p| p * 2.0);
        let before = surface.positions().to_vec();
        let mut body = Body::new(surface, &material);
        (0..before.len()).for_each(|v| body.pin(VertexId::from_index(v)));
        runner.step(&mut body, FRAME, &TEN_ITERATIONS, 100);
        let moved = largest_offset(&before, body.surface.positions());
        assert!(moved <= 0.0, "{name}: {moved} m");
    }
}

fn leaping_pin(runner: &mut Runner<'_>) {
    for (name, material) in pulled_shells() {
        let mut body = square(&material);
        body.pin(CORNERS[0]);
        for second in 0..runner.pick(2, 10) {
            let x = if second % 2 == 0 { 10.0 } else { 0.0 };
            body.set_target(CORNERS[0], [x, 0.0, 0.0]);
            runner.step(&mut body, FRAME, &TEN_ITERATIONS, 60);
        }
        runner.step(&mut body, FRAME, &TEN_ITERATIONS, 600);
        let strain = body.strain();
        assert!(strain <= MAX_STRAIN, "{name}: mean strain {strain}");
    }
}

/// 50 turns a second in a circle of 0.2 m.
fn turning_pin(runner: &mut Runner<'_>) {
    const STEP: f32 = 1.0 / 600.0;
    const RADIUS: f32 = 0.2;
    // From the circle's far side along the sheet's diagonal. At 314 rad/s the mass of 1 kg, whose
    // center is 0.91 m from that of the circle, pulls with 90 kN. The k-th row from the pin has 2 k
    // edges across the diagonal, at 45 degrees: a load of F lengthens it by F c / k. F falls as
    // the mass between the pin and the row, k (k - 1) / 2 of 64 squares up to the other diagonal.
    let load = 90e3;
    let row = |k: u32| (1.0 - f64::from(k * (k - 1)) / 128.0) / f64::from(k);
    let rows: f64 = (1..=8).map(row).sum();
    let reach = |name: &str| {
        let compliance = if name == "compliance 1e-6" { 1e-6 } else { 0.0 };
        1.05 * (f64::from(RADIUS) * 2.0 + 2.0_f64.sqrt()) + compliance * load * rows
    };
    let steps: u16 = runner.pick(120, 6000);
    for (name, material) in pulled_shells() {
        let mut body = square(&material);
        body.pin(CORNERS[0]);
        for step in 0..steps {
            let turn = std::f32::consts::TAU * 50.0 * f32::from(step) * STEP;
            let target = [RADIUS * (turn.cos() - 1.0), RADIUS * turn.sin(), 0.0];
            body.set_target(CORNERS[0], target);
            runner.step(&mut body, STEP, &TEN_ITERATIONS, 1);
            let distance = max_distance(&body.surface);
            assert!(
                distance <= reach(name),
                "{name}: {distance} m in step {step}"
            );
        }
    }
}

fn toggled_pin(runner: &mut Runner<'_>) {
    for (name, material) in pulled_shells() {
        let mut body = square(&material);
        pose(&mut body.surface, |p| Vec3::new(p.x, 0.0, p.y));
        body.pin(CORNERS[0]);
        // A corner that is let go falls, and hangs lower where it is held next.
        let limits = Limits::above(-2.0).within(3.0);
        let mut budget = EnergyBudget::new(&body.surface, &body.solver, &TEN_ITERATIONS, limits);
        for frame in 0..runner.pick(60, 600) {
            if frame % 2 == 0 {
                body.pin(CORNERS[1]);
            } else {
                body.unpin(CORNERS[1]);
            }
            runner.step(&mut body, FRAME, &TEN_ITERATIONS, 1);
            budget.check(&body.surface, &body.solver, &TEN_ITERATIONS, 0.0, name);
        }
    }
}

fn changing_compliance(runner: &mut Runner<'_>) {
    for soft in [1.0_f32, 1e-2, 1e-4] {
        let mut body = Body::on_ground(ball(1, 0.6), &elastic_shell(soft, 1e-2));
        for turn in 0..runner.pick(6, 60) {
            let now = if turn % 2 == 1 { soft * 1e-6 } else { soft };
            let set = body.solver.set_stretch(Stiffness::Compliance(now));
            set.expect("a compliance");
            // A change puts energy in or takes it out: the budget begins after it.
            let (context, limits) = (format!("{soft:e} m/N"), Limits::above(0.0));
            runner.watch(&mut body, FRAME, &TEN_ITERATIONS, 10, limits, &context);
        }
    }
}

fn changing_gravity(runner: &mut Runner<'_>) {
    let shells = [
        ("stiffness 1", Material::default()),
        ("elastic", elastic_shell(1e-5, 1e-2)),
    ];
    for (name, material) in shells {
        let mut body = Body::on_ground(ball(1, 0.6), &material);
        let mut params = TEN_ITERATIONS;
        let limits = Limits::above(0.0).within(20.0);
        let mut budget = EnergyBudget::new(&body.surface, &body.solver, &params, limits);
        for frame in 0..runner.pick(60, 600) {
            let up = frame / 7 % 2 == 1;
            let turned = SolverParams {
                gravity: [0.0, if up { 9.81 } else { -9.81 }, 0.0],
                ..TEN_ITERATIONS
            };
            let energy = |p: &SolverParams| mechanical(&body.surface, &body.solver, p, 0.0);
            budget.add_work(energy(&turned) - energy(&params));
            params = turned;
            runner.step(&mut body, FRAME, &params, 1);
            budget.check(&body.surface, &body.solver, &params, 0.0, name);
        }
    }
}

/// Time steps from 1/600 to 1/60 s.
fn changing_steps(runner: &mut Runner<'_>) {
    let mut random = Random::new(11);
    for (stretch, params) in [
        (None, TEN_ITERATIONS),
        (Some(1e-3), TEN_ITERATIONS),
        (Some(1e-3), WEIGHTLESS),
        (Some(1e-5), TEN_ITERATIONS),
        (Some(1e-5), WEIGHTLESS),
    ] {
        let material = stretch.map_or_else(Material::default, |a| elastic_shell(a, 1e2 * a));
        let mut body = Body::new(ball(1, 0.6), &material);
        let is_weightless = params == WEIGHTLESS;
        // Substeps of one length; those of whole frames would change with them.
        let params = params.with_substeps(FRAME, 4);
        if is_weightless {
            pose(&mut body.surface, |p| p * 1.2);
        } else {
            body.put_on_ground();
        }
        let limits = Limits::above(0.0).within(5.0);
        let mut budget = EnergyBudget::new(&body.surface, &body.solver, &params, limits);
        for frame in 0..runner.pick(60, 600) {
            runner.step(&mut body, random.log(1.0 / 600.0, 1.0 / 60.0), &params, 1);
            let context = format!("{stretch:?} m/N, frame {frame}");
            budget.check(&body.surface, &body.solver, &params, 0.0, &context);
        }
    }
}

fn subnormal_compliances(runner: &mut Runner<'_>) {
    let mut dropped = |stretch: f32| {
        let material = Material {
            stretch: Stiffness::Compliance(stretch),
            bending: None,
            ..Material::default()
        };
        let mut body = Body::on_ground(ball(1, 0.6), &material);
        let (context, limits) = (format!("{stretch:e} m/N"), Limits::above(0.0).within(3.0));
        runner.watch(&mut body, FRAME, &TEN_ITERATIONS, 60, limits, &context);
        body.surface.positions().to_vec()
    };
    let rigid = dropped(0.0);
    for compliance in [1e-36, 1e-38, 1e-40, 1e-45] {
        let offset = largest_offset(&rigid, &dropped(compliance));
        assert!(offset <= 1e-6, "{offset} m of {compliance:e} m/N");
    }
}

/// An icosahedron half a meter around that stands on a face, an edge or a corner, or is drawn out
/// to a needle.
fn falling(name: &str) -> Surface {
    let mut surface = icosphere(0, 0.5);
    let topology = surface.topology();
    let h = topology.outgoing(VertexId(0));
    let corners = [VertexId(0), topology.target(h), topology.origin(h.prev())];
    let [a, b, c] = corners.map(|v| surface.position(v));
    let down = match name {
        "face" => a + b + c,
        "edge" => a + b,
        _ => a,
    };
    // Two reflections turn `down` to the ground.
    let (from, to) = (down.normalize(), Vec3::new(0.0, -1.0, 0.0));
    let mirror = |p: Vec3, n: Vec3| p - n * (2.0 * p.dot(&n));
    let turn = |p: Vec3| match (from + to).try_normalize(1e-6) {
        Some(between) => mirror(mirror(p, from), between),
        None => Vec3::new(p.x, -p.y, -p.z),
    };
    let width = if name == "needle" { 1e-2 } else { 1.0 };
    place(&mut surface, |p| {
        turn(p).component_mul(&Vec3::new(width, 1.0, width)) + Vec3::new(0.0, 1.0, 0.0)
    });
    surface
}

fn falls(runner: &mut Runner<'_>) {
    let frames = runner.pick(60, 600);
    for name in ["face", "edge", "corner", "needle"] {
        for (kind, material) in shells() {
            let mut body = Body::on_ground(falling(name), &material);
            let limits = Limits::above(0.0).within(5.0).recovering();
            let context = format!("{name}, {kind}");
            runner.watch(&mut body, FRAME, &TEN_ITERATIONS, frames, limits, &context);
        }
    }
}

fn impacts(runner: &mut Runner<'_>) {
    let frames = runner.pick(60, 300);
    let seconds = f64::from(FRAME) * f64::from(frames);
    for speed in [10.0_f32, 1000.0] {
        for (name, material) in shells() {
            let mut body = Body::on_ground(ball(2, 1.0), &material);
            body.throw([0.3 * speed, -speed, 0.0]);
            // As far as its speed carries it, and its fall.
            let way = 1.1 * 1.09_f64.sqrt() * f64::from(speed) * seconds + 5.0 * seconds.powi(2);
            let limits = Limits::above(0.0).within(2.0 + way).recovering();
            let context = format!("{speed} m/s, {name}");
            let mut budget =
                EnergyBudget::new(&body.surface, &body.solver, &TEN_ITERATIONS, limits);
            for _ in 0..frames {
                runner.step(&mut body, FRAME, &TEN_ITERATIONS, 1);
                let of = (&body.surface, &body.solver);
                budget.check(of.0, of.1, &TEN_ITERATIONS, f64::from(FRAME), &context);
                let lowest = body.surface.bounds().min[1];
                let highest = f64::from(speed * FRAME) + body.surface.bounds().diagonal();
                let rounding = 2.0 * f64::from(f32::EPSILON) * highest;
                let is_above = f64::from(lowest) >= -rounding;
                assert!(is_above, "{context}: {lowest} m is below the ground");
            }
            budget.finish(&body.surface, &body.solver, &context);
        }
    }
}

/// Pins the ends of a ball at a height of 1 m, moves them past each other in two seconds, and lets
/// go.
pub(super) fn squeeze(runner: &mut Runner<'_>, body: &mut Body) {
    let all = body.surface.topology().vertices();
    let ends: Vec<(VertexId, Vec3)> = all
        .map(|v| (v, body.surface.position(v)))
        .filter(|(_, p)| (p.y - 1.0).abs() > 0.3)
        .collect();
    ends.iter().for_each(|&(v, _)| body.pin(v));
    for frame in 0..120_u8 {
        let share = 1.0 - f64::from(frame) / 60.0;
        for &(v, p) in &ends {
            let to = Vec3::new(p.x, 1.0 + (p.y - 1.0) * share, p.z);
            body.set_target(v, to_f32(to));
        }
        runner.step(body, FRAME, &TEN_ITERATIONS, 1);
    }
    ends.iter().for_each(|&(v, _)| body.unpin(v));
}

fn squeezed(runner: &mut Runner<'_>) {
    for (name, material) in shells() {
        let mut body = Body::new(ball(2, 1.0), &material);
        squeeze(runner, &mut body);
        body.put_on_ground();
        runner.step(&mut body, FRAME, &TEN_ITERATIONS, 600);
        let strain = body.strain();
        assert!(strain <= MAX_STRAIN, "{name}: mean strain {strain}");
    }
}

fn random_shape(random: &mut Random) -> Surface {
    let mut surface = match (5.0 * f64::midpoint(random.signed(), 1.0)) as u32 {
        0 => icosphere(0, 0.5),
        1 => icosphere(2, 0.5),
        2 => torus(0.35, 0.15, 12, 6),
        3 => cube_sphere(4, 0.5),
        _ => double_cone(70),
    };
    let scale = f64::from(random.log(0.1, 10.0));
    let axes = Vec3::from_fn(|_, _| 1.0 + 0.5 * random.signed()) * scale;
    let up = Vec3::new(0.0, 1.5 * scale, 0.0);
    place(&mut surface, |p| p.component_mul(&axes) + up);
    surface
}

fn random_stiffness(random: &mut Random) -> Stiffness {
    if random.signed() > 0.0 {
        Stiffness::Pbd(random.log(0.1, 1.0))
    } else {
        Stiffness::Compliance(random.log(1e-9, 1e-1))
    }
}

fn random_material(random: &mut Random) -> Material {
    Material {
        density: Density::Area(random.log(1e-2, 1e2)),
        stretch: random_stiffness(random),
        bending: (random.signed() > -0.5).then(|| random_stiffness(random)),
        damping: random.log(1e-3, 1.0),
        friction: random.log(1e-3, 1.0),
        ..Material::default()
    }
}

/// Spins a body about the vertical axis through its center and squeezes it along that axis.
fn spin_and_squeeze(body: &mut Body) {
    let center = body.surface.bounds().center();
    for v in body.surface.topology().vertices() {
        let r = body.surface.position(v) - center;
        let velocity = to_f32(Vec3::new(r.z, -0.25 * r.y, -r.x));
        body.solver.set_velocity(v, velocity).expect("a vertex");
    }
}

/// In no second there is more energy than in a second before.
fn random_bodies(runner: &mut Runner<'_>) {
    for seed in 1000..1000 + runner.pick(4, 40) {
        let mut random = Random::new(seed);
        let surface = random_shape(&mut random);
        // Energy is known of constraints with a compliance only.
        let compliance = |random: &mut Random| Stiffness::Compliance(random.log(1e-9, 1e-1));
        let material = Material {
            stretch: compliance(&mut random),
            bending: (random.signed() > -0.5).then(|| compliance(&mut random)),
            damping: 0.0,
            ..random_material(&mut random)
        };
        let params = SolverParams {
            iterations: if random.signed() > 0.0 { 1 } else { 10 },
            ..TEN_ITERATIONS
        };
        let substeps = if random.signed() > 0.0 { 1 } else { 5 };
        let is_on_ground = random.signed() > 0.0;
        let dt = random.log(1e-3, 1.0 / 30.0);
        let params = params.with_substeps(dt, substeps);
        let mut body = Body::new(surface, &material);
        if is_on_ground {
            body.put_on_ground();
        }
        spin_and_squeeze(&mut body);
        let limits = Limits::above(0.0);
        let mut budget = EnergyBudget::new(&body.surface, &body.solver, &params, limits);
        let interval = runner.pick(10, 1);
        for _ in 0..3 {
            let mut most = f64::NEG_INFINITY;
            for _ in 0..(1.0 / dt).ceil() as u32 / interval {
                runner.step(&mut body, dt, &params, interval);
                let (surface, solver) = (&body.surface, &body.solver);
                budget.check(surface, solver, &params, 0.0, &format!("seed {seed}"));
                most = most.max(total(surface, solver, &params, 0.0));
            }
            budget.lower(most);
        }
    }
}
