//! Compares each GPU kernel with its CPU counterpart, alone where a plan allows it.
//!
//! The bits are equal on a strict adapter, and within a stated error on any other.

mod cases;

use cases::{
    Body, CASES, CRUMPLED, Case, DRIFT, UNFOLDING, WELL_CONDITIONED, aim, bodies, params, standing,
};
use incise_mesh::VertexId;
use incise_pbd_gpu::{Context, GpuBackend, GpuBody, GpuError, SolverParams, Stiffness};
use incise_test_support::cpu_gpu_pair::SCHEDULES;

pub(crate) const DT: f32 = 1.0 / 60.0;

/// Every kernel on a strict adapter, in every state of [`CASES`] and after other frames and bodies.
pub(crate) fn to_the_bit(context: Context) {
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    for (name, case) in CASES {
        compare_case(&mut gpu, name, &case);
    }
    zeros(&mut gpu);
    leaving_the_ground(&mut gpu);
    places_used_again(&mut gpu);
}

/// Every kernel on every adapter, within rounding; reports of boxes and of numbers not finite.
pub(crate) fn on_every_adapter(_: Context) {
    incise_test_support::gpu::on_every_adapter(|context| {
        let mut gpu = GpuBackend::from_context(context).expect("a device");
        for (name, case) in CASES {
            within_rounding(&mut gpu, name, &case);
        }
        numbers_that_are_none(&mut gpu);
        boxes(&mut gpu);
    });
}

/// Takes bodies in.
fn add(gpu: &mut GpuBackend, bodies: &mut [Body]) -> Vec<GpuBody> {
    let add = |(surface, solver): &mut Body| gpu.add(surface, solver).expect("room");
    bodies.iter_mut().map(add).collect()
}

/// Steps bodies on the device by one frame, all at once.
fn step(gpu: &mut GpuBackend, ids: &[GpuBody], bodies: &mut [Body], params: &SolverParams) {
    let solvers = bodies.iter_mut().map(|(_, solver)| solver);
    // Not in the order of their places on the device.
    let all = ids.iter().copied().zip(solvers).rev();
    gpu.step(all, DT, params).expect("a step");
    for (&id, (surface, solver)) in ids.iter().zip(bodies) {
        gpu.read(id, surface, solver).expect("a state");
    }
}

/// Positions and velocities \[m, m/s\] of a body, vertex by vertex.
fn state(body: &Body) -> impl Iterator<Item = [f32; 8]> {
    let both = body.0.positions().iter().zip(body.1.velocities());
    both.map(|(&[x, y, z, w], &[u, v, s, t])| [x, y, z, w, u, v, s, t])
}

/// Steps the same bodies on the CPU, and compares them to the bit.
fn compare(
    gpu: &mut GpuBackend,
    ids: &[GpuBody],
    both: [&mut Vec<Body>; 2],
    params: &SolverParams,
    name: &str,
) {
    let [on_cpu, on_gpu] = both;
    for (surface, solver) in on_cpu.iter_mut() {
        solver.step(surface, DT, params).expect("a step");
    }
    step(gpu, ids, on_gpu, params);
    for (i, (cpu, gpu)) in on_cpu.iter().zip(on_gpu).enumerate() {
        for (v, (cpu, gpu)) in state(cpu).zip(state(gpu)).enumerate() {
            assert!(
                cpu.map(f32::to_bits) == gpu.map(f32::to_bits),
                "{name}: {cpu:?} is {gpu:?} at vertex {v} of body {i}"
            );
        }
    }
}

fn compare_case(gpu: &mut GpuBackend, name: &str, case: &Case) {
    let params = params(case);
    for schedule in SCHEDULES {
        gpu.force_schedule(Some(schedule));
        for shaken in [WELL_CONDITIONED, CRUMPLED] {
            let (mut on_cpu, mut on_gpu) = (bodies(case, shaken), bodies(case, shaken));
            let ids = add(gpu, &mut on_gpu);
            for frame in 0..2 {
                aim(&mut on_cpu, frame);
                aim(&mut on_gpu, frame);
                compare(gpu, &ids, [&mut on_cpu, &mut on_gpu], &params, name);
            }
            ids.into_iter().for_each(|id| gpu.remove(id));
        }
    }
}

/// Tolerance of a position after one projection on adapters that are not strict \[m\].
///
/// Such adapters contract, and divide and take roots with errors of some units in the last place.
/// Bodies have a size of about 2 m.
const ROUNDING: f32 = 2.0 * 32.0 * f32::EPSILON;

fn within_rounding(gpu: &mut GpuBackend, name: &str, case: &Case) {
    let params = params(case);
    let projections = (case.iterations * case.substeps) as f32;
    for schedule in SCHEDULES {
        gpu.force_schedule(Some(schedule));
        let (mut on_cpu, mut on_gpu) = (
            bodies(case, WELL_CONDITIONED),
            bodies(case, WELL_CONDITIONED),
        );
        let ids = add(gpu, &mut on_gpu);
        aim(&mut on_cpu, 0);
        aim(&mut on_gpu, 0);
        for (surface, solver) in &mut on_cpu {
            solver.step(surface, DT, &params).expect("a step");
        }
        step(gpu, &ids, &mut on_gpu, &params);
        ids.into_iter().for_each(|id| gpu.remove(id));
        let h = DT / case.substeps as f32;
        for (i, (cpu, device)) in on_cpu.iter().zip(&on_gpu).enumerate() {
            for (v, (cpu, device)) in state(cpu).zip(state(device)).enumerate() {
                for k in 0..8 {
                    let error = (cpu[k] - device[k]).abs() * if k < 4 { 1.0 } else { h };
                    assert!(
                        error <= projections * ROUNDING,
                        "{name} by {schedule:?} on {}: {cpu:?} is {device:?} at vertex {v} \
                         of body {i}",
                        gpu.adapter().name
                    );
                }
            }
        }
    }
}

/// A vertex flies so far that the square of its distance to a neighbor is infinite. Others follow
/// in later substeps; the first one is reported.
fn numbers_that_are_none(gpu: &mut GpuBackend) {
    let params = SolverParams {
        iterations: 2,
        ..SolverParams::paper()
    }
    .with_substeps(DT, 4);
    let make = || {
        let mut bodies = bodies(&DRIFT, WELL_CONDITIONED);
        for (_, solver) in &mut bodies {
            let h = DT / 4.0;
            let far = [1.1e19 / h, 0.0, 0.0];
            solver.set_velocity(VertexId(2), far).expect("a vertex");
            let less = [0.0, 0.0, 0.7e19 / h];
            solver.set_velocity(VertexId(0), less).expect("a vertex");
        }
        bodies
    };
    for schedule in SCHEDULES {
        gpu.force_schedule(Some(schedule));
        for (i, (mut surface, mut solver)) in make().into_iter().enumerate() {
            let id = gpu.add(&surface, &mut solver).expect("room");
            let mut other = make().swap_remove(i);
            let wanted = other.1.step(&mut other.0, DT, &params).map(|_| ());
            let wanted = wanted.expect_err("the square of a length is infinite");
            gpu.step([(id, &mut solver)], DT, &params)
                .expect("nobody knows yet");
            let before = surface.positions().to_vec();
            let found = gpu.read(id, &mut surface, &mut solver);
            assert_eq!(found, Err(GpuError::Step(wanted)), "{schedule:?}, body {i}");
            assert_eq!(surface.positions(), before, "the host's copy is as it was");
            gpu.remove(id);
        }
    }
}

fn boxes(gpu: &mut GpuBackend) {
    for (mut surface, mut solver) in bodies(&DRIFT, CRUMPLED) {
        for (p, &mass) in surface.positions_mut().iter_mut().zip(solver.masses()) {
            // The body is on one side of zero, and unused slots are far from it.
            p[0] -= if mass > 0.0 { 20.0 } else { 1e3 };
        }
        let id = gpu.add(&surface, &mut solver).expect("room");
        for _ in 0..2 {
            gpu.step([(id, &mut solver)], DT, &SolverParams::paper())
                .expect("a step");
            let found = gpu.bounds(id).expect("a box");
            gpu.read(id, &mut surface, &mut solver).expect("a state");
            assert_eq!(found, surface.bounds(), "the box of what is used");
        }
    }
}

/// Bodies that touch a plane at height -0 or 0.
fn zeros(gpu: &mut GpuBackend) {
    for schedule in SCHEDULES {
        gpu.force_schedule(Some(schedule));
        for (ground, height) in [(-0.0, 0.0), (0.0, -0.0), (-0.0, -0.0)] {
            let case = Case {
                ground: Some(ground),
                ..UNFOLDING
            };
            let (mut on_cpu, mut on_gpu) = (standing(&case, height), standing(&case, height));
            let ids = add(gpu, &mut on_gpu);
            let both = [&mut on_cpu, &mut on_gpu];
            compare(gpu, &ids, both, &params(&case), "signs of zero");
            ids.into_iter().for_each(|id| gpu.remove(id));
        }
    }
}

/// Bodies stand on the ground for a frame. In the next one they are predicted above it, but expand
/// into it.
fn leaving_the_ground(gpu: &mut GpuBackend) {
    for schedule in SCHEDULES {
        gpu.force_schedule(Some(schedule));
        let (mut on_cpu, mut on_gpu) = (standing(&UNFOLDING, 0.0), standing(&UNFOLDING, 0.0));
        let ids = add(gpu, &mut on_gpu);
        let params = params(&UNFOLDING);
        compare(gpu, &ids, [&mut on_cpu, &mut on_gpu], &params, "standing");
        for (surface, solver) in on_cpu.iter_mut().chain(&mut on_gpu) {
            let vertices: Vec<VertexId> = surface.topology().vertices().collect();
            for v in vertices {
                let height = surface.positions()[v.index()][1];
                let rise = [0.0, (0.01 + 0.2 * height - height) / DT, 0.0];
                solver.set_velocity(v, rise).expect("a vertex");
            }
        }
        compare(gpu, &ids, [&mut on_cpu, &mut on_gpu], &params, "rising");
        let touches = |(surface, _): &Body| surface.bounds().min[1].abs() <= f32::EPSILON;
        let touching = on_cpu.iter().filter(|body| touches(body)).count();
        assert!(touching > 0, "some unfolded into the ground");
        ids.into_iter().for_each(|id| gpu.remove(id));
    }
}

/// Bodies come to lie where others lay that had more colors, beside one that still has them.
fn places_used_again(gpu: &mut GpuBackend) {
    let case = Case {
        stretch: Stiffness::Pbd(0.9),
        bending: Some(Stiffness::Compliance(1e-4)),
        iterations: 2,
        ..DRIFT
    };
    for schedule in SCHEDULES {
        gpu.force_schedule(Some(schedule));
        for turn in 0..4 {
            let (mut on_cpu, mut on_gpu) = (
                bodies(&case, WELL_CONDITIONED),
                bodies(&case, WELL_CONDITIONED),
            );
            on_cpu.rotate_left(turn);
            on_gpu.rotate_left(turn);
            let ids = add(gpu, &mut on_gpu);
            let both = [&mut on_cpu, &mut on_gpu];
            compare(gpu, &ids, both, &params(&case), "memory used again");
            ids.into_iter().for_each(|id| gpu.remove(id));
        }
    }
}
