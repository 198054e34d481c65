//! Solids on the GPU match the CPU bit for bit: free, cut, pinned, on colliders and edited.

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, VertexId, cuboid, icosphere, torus};
use incise_pbd_gpu::{
    Collider, Contact, Context, GpuBackend, GpuError, Material, MovingCollider, Solid, Solver,
    SolverParams, StepError,
};
use incise_test_support::cpu_gpu_pair::{CpuGpuPair, DT, assert_same};
use incise_test_support::params::set_ground;
use incise_test_support::random::Random;

/// A single iteration of 720 substeps a second, with gravity.
const PARAMS: SolverParams = SolverParams {
    iterations: 1,
    substep: Some(1.0 / 720.0),
    gravity: [0.0, -9.81, 0.0],
    diagonal_scale: 0.5,
    conserve: true,
    ..SolverParams::paper()
};

/// Free and cut solids, supports, edits and refused calls.
pub(crate) fn to_the_bit(context: Context) {
    single_sweeps(&context);
    cut_in_flight(&context);
    on_pins(&context);
    on_colliders(&context);
    edits_between_frames(&context);
    changed_substeps(&context);
    contacts_are_refused(&context);
    numbers_that_are_none(&context);
}

/// A closeness that every adapter reaches in a frame, and the limit of loops of some.
pub(crate) fn within_rounding(_: Context) {
    incise_test_support::gpu::on_every_adapter(|context| {
        let mut gpu = GpuBackend::from_context(context).expect("a device");
        for mut twin in twins(&mut gpu) {
            twin.edit(|surface, solver| solver.pin(surface, VertexId(0)).expect("a vertex"));
            let height = twin.on_cpu.bounds().min[1] + 1e-3;
            for solver in [&mut twin.cpu, &mut twin.solver] {
                set_ground(solver, height);
            }
            twin.step(&mut gpu, &PARAMS);
            twin.read(&mut gpu);
            let pairs = twin.on_cpu.positions().iter().zip(twin.on_gpu.positions());
            for (cpu, found) in pairs {
                for k in 0..3 {
                    let error = (cpu[k] - found[k]).abs();
                    let name = &gpu.adapter().name;
                    assert!(error <= 1e-4, "{cpu:?} is {found:?} on {name}");
                }
            }
            gpu.remove(twin.body);
        }
        many_colliders(&mut gpu);
    });
}

/// A solid with more colliders than some adapters have loop iterations for.
fn many_colliders(gpu: &mut GpuBackend) {
    let mut twin = twins(gpu).swap_remove(1);
    let ball = Collider::Sphere {
        center: [0.0, 50.0, 0.0],
        radius: 0.1,
    };
    let still = MovingCollider {
        start: ball,
        velocity: [0.0; 3],
    };
    (twin.solver.set_colliders(&[still; 200])).expect("valid colliders");
    let step = gpu.step([(twin.body, &mut twin.solver)], DT, &PARAMS);
    let is_refused = matches!(step, Err(GpuError::LoopsTooShort { .. }));
    assert!(is_refused || step.is_ok(), "{step:?}");
    assert_eq!(
        is_refused,
        gpu.adapter().name.contains("llvmpipe"),
        "its loops end early"
    );
    gpu.remove(twin.body);
}

/// Returns a material with cells of a given size \[m\].
fn solid(young_modulus: f32, cell_size: f32, relaxation_time: f32) -> Material {
    let material = Material::solid(young_modulus, 0.4, 1000.0);
    Material {
        solid: material.solid.map(|solid| Solid {
            cell_size: Some(cell_size),
            relaxation_time,
            ..solid
        }),
        ..material
    }
}

/// Soft and stiff bodies of different shapes, about 1 m across.
fn bodies() -> [(Surface, Material); 3] {
    [
        (icosphere(2, 0.5), solid(1e5, 0.2, 0.005)),
        // So stiff that cells repeat a share of their forces.
        (torus(0.35, 0.15, 24, 12), solid(3e7, 0.1, 0.0)),
        // More than 256 cells a color.
        (cuboid([0.5, 0.3, 0.3], [5, 3, 3]), solid(1e6, 0.06, 0.02)),
    ]
}

fn twins(gpu: &mut GpuBackend) -> Vec<CpuGpuPair> {
    let twin = |(mut surface, material): (Surface, Material)| {
        let solver = Solver::new(&mut surface, &material).expect("a closed body");
        CpuGpuPair::from_solver(gpu, surface, solver)
    };
    bodies().into_iter().map(twin).collect()
}

/// Compares what an edit or a step may change, bit for bit.
fn assert_equal(twin: &mut CpuGpuPair, gpu: &mut GpuBackend, when: &str) {
    twin.assert_equal(gpu, when);
    let energies = [&twin.cpu, &twin.solver].map(Solver::elastic_energy);
    assert_eq!(
        energies.map(f64::to_bits)[0],
        energies.map(f64::to_bits)[1],
        "elastic energies {when}: {energies:?}"
    );
    let bounds = gpu.bounds(twin.body).expect("a box");
    assert_eq!(bounds, twin.on_cpu.bounds(), "the embedded vertices {when}");
}

/// Gives a body random velocities, and displaces its vertices at random.
fn shake(twin: &mut CpuGpuPair, gpu: &mut GpuBackend, random: &mut Random, by: f32, speed: f32) {
    let seed = random.bits();
    twin.edit(|surface, solver| {
        let mut random = Random::new(seed);
        let vertices: Vec<VertexId> = surface.topology().vertices().collect();
        for v in vertices {
            let p = &mut surface.positions_mut()[v.index()];
            for c in &mut p[..3] {
                *c += by * signed(&mut random);
            }
            let to = [(); 3].map(|()| speed * signed(&mut random));
            solver.set_velocity(v, to).expect("a vertex");
        }
        solver.mark_all_changed();
    });
    twin.update(gpu);
}

/// Returns a number from -0.9 to 0.9.
fn signed(random: &mut Random) -> f32 {
    random.fraction() * [-1.0, 1.0][random.below(2)]
}

/// One substep of deformed bodies: cells that turn, are flat or inside out.
fn single_sweeps(context: &Context) {
    let mut gpu = GpuBackend::from_context(context.clone()).expect("a device");
    let mut random = Random::new(1);
    for (i, mut twin) in twins(&mut gpu).into_iter().enumerate() {
        for by in [0.0, 0.01, 0.3] {
            shake(&mut twin, &mut gpu, &mut random, by, 1.0);
            let dt = 1.0 / 720.0;
            twin.cpu
                .step(&mut twin.on_cpu, dt, &PARAMS)
                .expect("a step");
            gpu.step([(twin.body, &mut twin.solver)], dt, &PARAMS)
                .expect("a step");
            let projected = gpu.stats().cell_projections;
            assert_eq!(projected, twin.cpu.stats().cell_projections, "all cells");
            let when = format!("after a substep of body {i}, displaced by {by} m");
            assert_equal(&mut twin, &mut gpu, &when);
        }
        gpu.remove(twin.body);
    }
}

/// Cuts a body along a plane through the middle of its box.
fn cut(twin: &mut CpuGpuPair, normal: [f64; 3]) {
    twin.edit(|surface, solver| {
        let bounds = surface.bounds();
        let distance = (0..3).map(|k| normal[k] * bounds.center()[k]).sum();
        let sweep = Sweep::from_plane(normal, distance, &bounds).expect("a plane");
        let outcome = Cutter::new(surface).cut(surface, &sweep, &CutParams::default());
        let outcome = outcome.expect("a cut");
        assert!(!outcome.is_miss(), "the plane cuts the body");
        solver
            .apply_delta(surface, &outcome.delta)
            .expect("it fits");
        outcome.delta.triangles_added.len()
    });
}

/// Bodies fly, alone and beside a surface, and are cut.
fn cut_in_flight(context: &Context) {
    let mut gpu = GpuBackend::from_context(context.clone()).expect("a device");
    let mut random = Random::new(2);
    let mut twins = twins(&mut gpu);
    let mut sphere = icosphere(2, 0.5);
    let shell = Solver::new(&mut sphere, &Material::default()).expect("a body");
    let mut beside = CpuGpuPair::from_solver(&mut gpu, sphere, shell);
    for twin in &mut twins {
        shake(twin, &mut gpu, &mut random, 0.02, 1.0);
    }
    for frame in 0..9 {
        if frame == 4 {
            for twin in &mut twins {
                cut(twin, [0.3, 1.0, 0.2]);
                twin.update(&mut gpu);
            }
        }
        for twin in twins.iter_mut().chain([&mut beside]) {
            twin.cpu
                .step(&mut twin.on_cpu, DT, &PARAMS)
                .expect("a step");
        }
        let all = twins.iter_mut().chain([&mut beside]);
        let all = all.map(|twin| (twin.body, &mut twin.solver));
        gpu.step(all, DT, &PARAMS).expect("a step");
        if frame % 3 == 0 {
            for (i, twin) in twins.iter_mut().enumerate() {
                assert_equal(twin, &mut gpu, &format!("of body {i} in frame {frame}"));
            }
            beside.assert_equal(&mut gpu, "of a surface beside solids");
        }
    }
    let before = gpu.memory().rented;
    for twin in &mut twins {
        twin.read(&mut gpu);
        twin.solver.mark_all_changed();
        twin.update(&mut gpu);
    }
    assert_eq!(
        gpu.memory().rented,
        before,
        "uploads free what they replace"
    );
    for twin in twins.iter().chain([&beside]) {
        gpu.remove(twin.body);
    }
    assert_eq!(gpu.memory().rented, 0, "removed bodies free their memory");
}

/// Pins of one end that move, come and go.
fn on_pins(context: &Context) {
    let mut gpu = GpuBackend::from_context(context.clone()).expect("a device");
    for (i, mut twin) in twins(&mut gpu).into_iter().enumerate() {
        let first: Vec<VertexId> = (twin.on_cpu.topology().vertices()).take(7).collect();
        let mut targets = Vec::new();
        for frame in 0..8_u16 {
            if frame == 2 {
                twin.read(&mut gpu);
                for &v in &first {
                    twin.edit(|surface, solver| solver.pin(surface, v).expect("a vertex"));
                    targets.push(twin.on_cpu.positions()[v.index()]);
                }
                twin.update(&mut gpu);
            }
            if frame == 6 {
                twin.read(&mut gpu);
                twin.edit(|surface, solver| solver.unpin(surface, first[3]).expect("pinned"));
                twin.update(&mut gpu);
            }
            if (3..6).contains(&frame) {
                for (v, [x, y, z, _]) in first.iter().zip(&targets) {
                    let to = [*x, y + 0.01 * f32::from(frame), *z];
                    for solver in [&mut twin.cpu, &mut twin.solver] {
                        solver.set_pin_target(*v, to).expect("pinned");
                    }
                }
            }
            twin.step(&mut gpu, &PARAMS);
            if frame != 4 {
                assert_equal(
                    &mut twin,
                    &mut gpu,
                    &format!("of body {i} in frame {frame}"),
                );
            }
        }
        gpu.remove(twin.body);
    }
}

/// The ground, and a ball, a capsule and a box that move.
fn colliders(frame: u16) -> Vec<MovingCollider> {
    let speed = if frame < 4 { 0.0 } else { 1.0 };
    let all = [
        Collider::Plane {
            point: [0.0, -0.31, 0.0],
            normal: [0.1, 1.0, 0.0],
        },
        Collider::Sphere {
            center: [0.6, 0.0, 0.1],
            radius: 0.25,
        },
        Collider::Capsule {
            ends: [[-0.5, -0.5, 0.5], [-0.5, 0.5, 0.4]],
            radius: 0.2,
        },
        Collider::Box {
            center: [0.0, 0.1, -0.6],
            half: [0.3, 0.1, 0.35],
            axes: [[1.0, 0.2, 0.0], [0.0, 1.0, 0.5]],
        },
    ];
    let count = [1, 1, 0, 1, 4, 4, 2, 0][usize::from(frame) % 8];
    let list = all.into_iter().take(count);
    list.map(|start| MovingCollider {
        start,
        velocity: [0.0, 0.2 * speed, 0.3 * speed],
    })
    .collect()
}

/// Colliders of every kind, and pins between them.
fn on_colliders(context: &Context) {
    let mut gpu = GpuBackend::from_context(context.clone()).expect("a device");
    let mut met = 0;
    for (i, mut twin) in twins(&mut gpu).into_iter().enumerate() {
        for frame in 0..8 {
            if frame == 5 {
                twin.read(&mut gpu);
                twin.edit(|surface, solver| solver.pin(surface, VertexId(3)).expect("a vertex"));
                twin.update(&mut gpu);
            }
            let list = colliders(frame);
            for solver in [&mut twin.cpu, &mut twin.solver] {
                solver.set_colliders(&list).expect("valid colliders");
            }
            let falling = twin.cpu.momentum()[1];
            twin.step(&mut gpu, &PARAMS);
            met += u32::from(twin.cpu.momentum()[1] > falling);
            assert_equal(
                &mut twin,
                &mut gpu,
                &format!("of body {i} in frame {frame}"),
            );
        }
        gpu.remove(twin.body);
    }
    assert!(met > 3, "colliders push the bodies");
}

/// A state that was read back, saved as a clone and uploaded elsewhere goes on as it was.
fn edits_between_frames(context: &Context) {
    let mut gpu = GpuBackend::from_context(context.clone()).expect("a device");
    let mut random = Random::new(3);
    for (i, mut twin) in twins(&mut gpu).into_iter().enumerate() {
        for frame in 0..4 {
            twin.step(&mut gpu, &PARAMS);
            twin.read(&mut gpu);
            shake(&mut twin, &mut gpu, &mut random, 0.01, 0.5);
            // The same update again changes nothing.
            twin.update(&mut gpu);
            twin.step(&mut gpu, &PARAMS);
            assert_equal(
                &mut twin,
                &mut gpu,
                &format!("of body {i} in round {frame}"),
            );
            let (mut surface, mut solver) = (twin.on_gpu.clone(), twin.solver.clone());
            let other = gpu.add(&surface, &mut solver).expect("room");
            let both = [(other, &mut solver), (twin.body, &mut twin.solver)];
            gpu.step(both, DT, &PARAMS).expect("a step");
            twin.cpu
                .step(&mut twin.on_cpu, DT, &PARAMS)
                .expect("a step");
            gpu.read(other, &mut surface, &mut solver).expect("a state");
            let when = format!("of a copy of body {i} in round {frame}");
            assert_same((&surface, &solver), (&twin.on_cpu, &twin.cpu), &when);
            assert_equal(&mut twin, &mut gpu, &when);
            gpu.remove(other);
        }
        let v = VertexId(1);
        twin.step(&mut gpu, &PARAMS);
        twin.solver.set_velocity(v, [1.0; 3]).expect("a vertex");
        let stale = gpu.step([(twin.body, &mut twin.solver)], DT, &PARAMS);
        assert_eq!(stale.err(), Some(GpuError::StaleBody), "an edit to upload");
        gpu.remove(twin.body);
    }
}

/// Substeps of other lengths, for which forces are summed again, in frames without a readback.
fn changed_substeps(context: &Context) {
    let mut gpu = GpuBackend::from_context(context.clone()).expect("a device");
    for (i, mut twin) in twins(&mut gpu).into_iter().enumerate() {
        for frame in 0..6_u8 {
            let (odd, third) = (usize::from(frame % 2), usize::from(frame % 3));
            let params = SolverParams {
                substep: Some([1.0 / 720.0, 1.0 / 500.0][odd]),
                iterations: 1 + u32::from(frame / 3),
                ..PARAMS
            };
            let dt = DT * [1.0, 0.07, 0.35][third];
            twin.cpu
                .step(&mut twin.on_cpu, dt, &params)
                .expect("a step");
            gpu.step([(twin.body, &mut twin.solver)], dt, &params)
                .expect("a step");
        }
        assert_equal(&mut twin, &mut gpu, &format!("of body {i}"));
        gpu.remove(twin.body);
    }
}

/// Contacts of solids share nodes within a color, so that the CPU steps such bodies.
fn contacts_are_refused(context: &Context) {
    let mut gpu = GpuBackend::from_context(context.clone()).expect("a device");
    let mut twin = twins(&mut gpu).swap_remove(0);
    let contact = Contact::plane(VertexId(0), [0.0, 1.0, 0.0], 0.0);
    twin.edit(|_, solver| solver.set_contacts(&[contact]).expect("a vertex"));
    let refused = gpu.step([(twin.body, &mut twin.solver)], DT, &PARAMS);
    let unsupported = GpuError::Step(StepError::UnsupportedOnGpu);
    assert_eq!(refused.err(), Some(unsupported), "a solid with contacts");
    twin.edit(|_, solver| solver.set_contacts(&[]).expect("none"));
    twin.step(&mut gpu, &PARAMS);
    assert_equal(&mut twin, &mut gpu, "after a call that was refused");
}

/// A vertex that flies infinitely far is reported, and the copy on the CPU stays.
fn numbers_that_are_none(context: &Context) {
    let mut gpu = GpuBackend::from_context(context.clone()).expect("a device");
    let mut twin = twins(&mut gpu).swap_remove(0);
    twin.edit(|surface, solver| {
        for v in surface.topology().vertices() {
            solver.set_velocity(v, [3e38, 0.0, 0.0]).expect("a vertex");
        }
    });
    twin.update(&mut gpu);
    let params = SolverParams {
        substep: Some(1.0),
        ..PARAMS
    };
    let expected = twin.cpu.step(&mut twin.on_cpu, 4.0, &params).map(|_| ());
    gpu.step([(twin.body, &mut twin.solver)], 4.0, &params)
        .expect("not known yet");
    let before = twin.on_gpu.positions().to_vec();
    let found = gpu.read(twin.body, &mut twin.on_gpu, &mut twin.solver);
    let expected = expected.expect_err("velocities overflow");
    assert_eq!(
        found,
        Err(GpuError::Step(expected)),
        "a vertex and a substep"
    );
    assert_eq!(twin.on_gpu.positions(), before, "the copy on the CPU");
}
