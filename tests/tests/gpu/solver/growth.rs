//! Bodies and buffers that grow, and motions of every schedule within rounding.

use incise_mesh::{HalfEdge, Surface, torus};
use incise_models::scenes::FRAME;
use incise_pbd_gpu::{Context, GpuBackend, Material, PatchParams, Schedule, Solver};
use incise_test_support::cpu_gpu_pair::{CpuGpuPair, SCHEDULES, solver_for, with_most_features};
use incise_test_support::edits::split;
use incise_test_support::gpu::Needs;
use incise_test_support::materials::elastic_shell;
use incise_test_support::params::{TEN_ITERATIONS, set_ground};
use incise_tests::stress::{Body, ball, largest_offset};

/// Largest distance from the CPU's positions \[m\].
const MAX_OFFSET: f64 = 1e-4;

/// A body outgrows the memory of its workgroup, on a strict adapter.
pub(crate) fn out_of_a_workgroup(context: Context) {
    for solver_of in SCHEDULES {
        outgrown(context.clone(), solver_of);
    }
}

/// Motions of every schedule stay close to those of the CPU, also while edits outgrow buffers.
pub(crate) fn motions(context: Context) {
    let portable = Context::open(&Needs::AnyDevice.portable_request()).expect("an adapter");
    every_schedule(&mut GpuBackend::from_context(portable.clone()).expect("a device"));
    outgrow(context, Some(PatchParams::default()));
    outgrow(portable, None);
}

/// A body that outgrows the memory of a workgroup continues pass by pass, divided or not.
fn outgrown(context: Context, solver_of: Schedule) {
    let (material, params) = with_most_features();
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    let torus_with_solver = |segments| {
        let mut surface = torus(1.0, 0.3, segments, 8);
        let solver = solver_for(&mut surface, &material, solver_of);
        (surface, solver)
    };
    let mut largest = 0;
    for segments in 100.. {
        let (surface, mut solver) = torus_with_solver(segments);
        let body = gpu.add(&surface, &mut solver).expect("room");
        let schedule = gpu.schedule(body).expect("it was added");
        gpu.remove(body);
        if schedule == Schedule::Patches {
            break;
        }
        largest = segments;
    }
    let (surface, solver) = torus_with_solver(largest);
    let mut twin = CpuGpuPair::from_solver(&mut gpu, surface, solver);
    assert_eq!(gpu.schedule(twin.body), Ok(Schedule::WholeBody));
    for i in 0..10 {
        twin.edit(|surface, solver| {
            let delta = split(surface, HalfEdge(60 * i), 0.5).expect("it is closed");
            solver.apply_delta(surface, &delta).expect("it fits");
        });
        twin.update(&mut gpu);
        twin.step(&mut gpu, &params);
        twin.assert_equal(&mut gpu, &format!("after {i} splits"));
    }
    assert_eq!(gpu.schedule(twin.body), Ok(Schedule::Patches));
}

/// A body that turns, so that every vertex has a velocity of its own.
fn turning(surface: Surface, material: &Material, patches: Option<PatchParams>) -> Body {
    let mut surface = surface;
    let mut solver =
        Solver::with_patches(&mut surface, material, patches.as_ref()).expect("a body");
    for v in surface.topology().vertices() {
        let [x, y, z, _] = surface.positions()[v.index()];
        let to = [z, -0.25 * y, -x];
        solver.set_velocity(v, to).expect("a vertex");
    }
    Body { surface, solver }
}

fn every_schedule(gpu: &mut GpuBackend) {
    let [elastic, default] = [elastic_shell(1e-4, 1e-1), Material::default()];
    let divided = Some(PatchParams::default());
    for (subdivisions, material, schedule, patches) in [
        (2, default, Schedule::WholeBody, None),
        (2, elastic, Schedule::Patches, None),
        (4, default, Schedule::Patches, None),
        (4, elastic, Schedule::Patches, divided),
    ] {
        let mut there = turning(ball(subdivisions, 0.6), &material, patches);
        let mut here = there.clone();
        gpu.force_schedule(Some(schedule));
        let body = gpu.add(&there.surface, &mut there.solver).expect("room");
        for _ in 0..30 {
            let stepped = gpu.step([(body, &mut there.solver)], FRAME, &TEN_ITERATIONS);
            stepped.expect("a step");
            (here.solver.step(&mut here.surface, FRAME, &TEN_ITERATIONS)).expect("a step");
        }
        let read = gpu.read(body, &mut there.surface, &mut there.solver);
        read.expect("a state");
        gpu.remove(body);
        let offset = largest_offset(here.surface.positions(), there.surface.positions());
        assert!(
            offset <= MAX_OFFSET,
            "{offset} m, {subdivisions} subdivisions by {}",
            schedule.name()
        );
    }
}

/// Splits edges until the backend has replaced its buffers by larger ones twice.
fn outgrow(context: Context, patches: Option<PatchParams>) {
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    // Its vertices with their slack just fit the first buffers.
    let mut there = turning(ball(4, 0.6), &elastic_shell(1e-4, 1e-1), patches);
    set_ground(&mut there.solver, 0.0);
    gpu.force_schedule(Some(Schedule::Patches));
    let body = gpu.add(&there.surface, &mut there.solver).expect("room");
    let first = gpu.memory().reserved;
    let (mut has_grown, mut next) = (false, 0);
    for _ in 0..100 {
        for _ in 0..50 {
            let delta = split(&mut there.surface, HalfEdge(next), 0.5).expect("it is closed");
            (there.solver.apply_delta(&mut there.surface, &delta)).expect("it fits");
            next = (next + 211) % 15_000;
        }
        gpu.update(body, &there.surface, &mut there.solver)
            .expect("room");
        // Starts from the state of the GPU, since rounding grows at hinges near half a turn.
        let mut here = there.clone();
        let stepped = gpu.step([(body, &mut there.solver)], FRAME, &TEN_ITERATIONS);
        stepped.expect("a step");
        let read = gpu.read(body, &mut there.surface, &mut there.solver);
        read.expect("a state");
        (here.solver.step(&mut here.surface, FRAME, &TEN_ITERATIONS)).expect("a step");
        let offset = largest_offset(here.surface.positions(), there.surface.positions());
        assert!(offset <= MAX_OFFSET, "{offset} m after an edit");
        if has_grown {
            return;
        }
        has_grown = gpu.memory().reserved > first;
    }
    panic!("the first buffers had room for all edits");
}
