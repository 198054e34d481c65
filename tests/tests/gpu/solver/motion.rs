//! The GPU measures the motion of bodies like the CPU, and only on request.

use incise_mesh::{Aabb, VertexId};
use incise_pbd_gpu::{Context, GpuBackend, GpuBody, Schedule, Solver};
use incise_test_support::cpu_gpu_pair::{DT, SCHEDULES, solver_for, with_most_features};
use incise_test_support::gpu::on_every_adapter;
use incise_test_support::surfaces::sphere;

/// Number of measured steps.
const MEASURED_STEPS: u32 = 4;

/// Reports of motion: on request, the bits of the CPU on a strict adapter, close on any other.
pub(crate) fn reports(context: Context) {
    unasked(context.clone());
    for schedule in SCHEDULES {
        same(context.clone(), schedule);
        on_every_adapter(|context| near(context, schedule));
    }
}

/// Compares the motion measured on the CPU from the third step on with that of the GPU.
fn measured(context: Context, schedule: Schedule) -> [(f32, Aabb); 2] {
    let (material, params) = with_most_features();
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    gpu.force_schedule(Some(schedule));
    let mut on_cpu = sphere(3, [0.0; 3]);
    let mut cpu = solver_for(&mut on_cpu, &material, schedule);
    cpu.set_velocity(VertexId(5), [0.0, 3.0, 0.0])
        .expect("a vertex");
    let mut solver = cpu.clone();
    let body = gpu.add(&on_cpu, &mut solver).expect("room");
    let mut step = |gpu: &mut GpuBackend, dt: f32| {
        let done = cpu.step(&mut on_cpu, dt, &params).expect("a step");
        let moved = done.max_substep_displacement;
        gpu.step([(body, &mut solver)], dt, &params)
            .expect("a step");
        (moved, on_cpu.bounds())
    };
    // The motion of a long step, which the second request discards.
    gpu.measure_motion(body).expect("it is there");
    let before = step(&mut gpu, 9.0 * DT).0;
    gpu.measure_motion(body).expect("it is there");
    let mut on_cpu = (0.0_f32, Aabb::around([[0.0; 3]]));
    for frame in 1..=MEASURED_STEPS {
        if frame == MEASURED_STEPS {
            gpu.prefetch_motion(body).expect("it is there");
        }
        let (moved, bounds) = step(&mut gpu, DT);
        on_cpu = (on_cpu.0.max(moved), bounds);
    }
    assert!(on_cpu.0 > 0.0 && before > on_cpu.0, "it was faster before");
    for _ in 0..3 {
        step(&mut gpu, DT);
    }
    let on_gpu = gpu
        .motion(body)
        .expect("a report")
        .expect("it was asked for");
    assert_eq!(gpu.motion(body), Ok(None), "it is handed out once");
    [on_cpu, on_gpu]
}

fn same(context: Context, schedule: Schedule) {
    let [(on_cpu, cpu_box), (on_gpu, gpu_box)] = measured(context, schedule);
    assert_eq!(on_cpu.to_bits(), on_gpu.to_bits());
    assert_eq!(cpu_box, gpu_box);
}

fn near(context: Context, schedule: Schedule) {
    let [(on_cpu, _), (on_gpu, _)] = measured(context, schedule);
    assert!((on_cpu - on_gpu).abs() < 1e-3 * on_cpu, "{on_cpu} {on_gpu}");
}

fn unasked(context: Context) {
    let (material, params) = with_most_features();
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    let add = |gpu: &mut GpuBackend| -> (GpuBody, Solver) {
        let mut surface = sphere(2, [0.0; 3]);
        let mut solver = solver_for(&mut surface, &material, Schedule::Patches);
        (gpu.add(&surface, &mut solver).expect("room"), solver)
    };
    let (watched, mut solver) = add(&mut gpu);
    let (other, mut other_solver) = add(&mut gpu);
    gpu.measure_motion(watched).expect("it is there");
    for frame in 0..4 {
        if frame == 2 {
            gpu.prefetch_motion(watched).expect("it is there");
        }
        let both = [(watched, &mut solver), (other, &mut other_solver)];
        let stats = gpu.step(both, DT, &params).expect("a step");
        assert_eq!(stats.bytes_read, 0, "nobody has fetched it");
    }
    assert_eq!(gpu.motion(other), Ok(None));
    assert!(gpu.motion(watched).expect("a report").is_some());
    let both = [(watched, &mut solver), (other, &mut other_solver)];
    let stats = gpu.step(both, DT, &params).expect("a step");
    assert_eq!(stats.bytes_read, 44, "one report");
}
