//! Misuse of the GPU backend is an error that leaves other bodies intact.

use incise_mesh::{HalfEdge, Surface, VertexId, icosphere};
use incise_pbd_gpu::{Context, GpuBackend, GpuError, Schedule, Solver, SolverParams, StepError};
use incise_test_support::cpu_gpu_pair::{
    CpuGpuPair, DT, SCHEDULES, assert_same, with_most_features,
};
use incise_test_support::edits::{flip, split};
use incise_test_support::gpu::Needs;
use incise_test_support::surfaces::sphere;

/// Rejected calls lose nothing, and accepted ones after them match the CPU.
///
/// Bodies and frames that exceed portable limits leave other bodies intact.
pub(crate) fn rejected_calls(context: Context) {
    without_update(context.clone());
    one_solver(context.clone());
    failed_step(context.clone());
    another_backend(context.clone());
    step_on_the_cpu(context);
    let portable = Context::open(&Needs::Strict.portable_request()).expect("an adapter");
    too_many_bodies(portable.clone());
    too_many_passes(portable);
}

fn without_update(context: Context) {
    let (material, params) = with_most_features();
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    for schedule in SCHEDULES {
        let mut twin = CpuGpuPair::add(&mut gpu, sphere(2, [0.0; 3]), &material, schedule);
        twin.step(&mut gpu, &params);
        twin.assert_equal(&mut gpu, "before");
        // A flip leaves the number of vertices; a split does not.
        for edit in [flip, |s: &mut Surface, h| split(s, h, 0.5)] {
            twin.edit(|surface, solver| {
                let delta = edit(surface, HalfEdge(5)).expect("it is closed");
                solver.apply_delta(surface, &delta).expect("it fits");
            });
            let here = (twin.on_gpu.clone(), twin.solver.clone());
            for _ in 0..2 {
                let stepped = gpu.step([(twin.body, &mut twin.solver)], DT, &params);
                assert_eq!(stepped.err(), Some(GpuError::StaleBody));
                let read = gpu.read(twin.body, &mut twin.on_gpu, &mut twin.solver);
                assert_eq!(read, Err(GpuError::StaleBody));
            }
            assert_same(
                (&here.0, &here.1),
                (&twin.on_gpu, &twin.solver),
                "after errors",
            );
            twin.update(&mut gpu);
            twin.assert_equal(&mut gpu, "after the edit");
            twin.step(&mut gpu, &params);
            twin.assert_equal(&mut gpu, "after a step");
        }
        let mut small = sphere(1, [0.0; 3]);
        let mismatch = GpuError::Step(StepError::SurfaceMismatch {
            surface: small.positions().len(),
            solver: twin.on_gpu.positions().len(),
        });
        let updated = gpu.update(twin.body, &small, &mut twin.solver);
        assert_eq!(updated, Err(mismatch.clone()));
        assert_eq!(gpu.add(&small, &mut twin.solver), Err(mismatch.clone()));
        let read = gpu.read(twin.body, &mut small, &mut twin.solver);
        assert!(read.is_err(), "{read:?}");
        twin.update(&mut gpu);
        twin.step(&mut gpu, &params);
        twin.assert_equal(&mut gpu, "after sizes that do not fit");
        gpu.remove(twin.body);
    }
}

/// A body accepts another solver, for example a clone, only after an update.
fn one_solver(context: Context) {
    let (material, params) = with_most_features();
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    let surface = || sphere(2, [0.0; 3]);
    let mut a = CpuGpuPair::add(&mut gpu, surface(), &material, Schedule::Patches);
    let mut b = CpuGpuPair::add(&mut gpu, surface(), &material, Schedule::WholeBody);
    let foreign = || Some(GpuError::ForeignSolver);
    let swapped = gpu.step([(a.body, &mut b.solver)], DT, &params);
    assert_eq!(swapped.err(), foreign());
    let read = gpu.read(a.body, &mut b.on_gpu, &mut b.solver);
    assert_eq!(read.err(), foreign());
    // So a body cannot be stepped twice at once.
    let mut copy = a.solver.clone();
    let twice = [(a.body, &mut a.solver), (a.body, &mut copy)];
    assert_eq!(gpu.step(twice, DT, &params).err(), foreign());
    a.step(&mut gpu, &params);
    b.step(&mut gpu, &params);
    a.assert_equal(&mut gpu, "after solvers that do not belong to it");
    b.assert_equal(&mut gpu, "after having been taken for another");
    // A copy takes over, and the body is as the copy was.
    let (mut old_surface, mut old) = (a.on_gpu.clone(), a.solver.clone());
    a.step(&mut gpu, &params);
    gpu.update(a.body, &old_surface, &mut old).expect("room");
    assert_eq!(
        gpu.step([(a.body, &mut a.solver)], DT, &params).err(),
        foreign()
    );
    gpu.step([(a.body, &mut old)], DT, &params).expect("a step");
    gpu.read(a.body, &mut old_surface, &mut old)
        .expect("a state");
    assert_same(
        (&old_surface, &old),
        (&a.on_cpu, &a.cpu),
        "of a copy that was stepped again",
    );
}

/// Changes of a body are uploaded even if an error of another body ended the step.
fn failed_step(context: Context) {
    let (material, params) = with_most_features();
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    let surface = || sphere(2, [0.0; 3]);
    let mut a = CpuGpuPair::add(&mut gpu, surface(), &material, Schedule::Patches);
    let mut b = CpuGpuPair::add(&mut gpu, surface(), &material, Schedule::Patches);
    let push = |solver: &mut Solver| {
        let v = VertexId(3);
        solver.set_velocity(v, [0.5, 1.0, 2.0]).expect("a vertex");
    };
    a.edit(|_, solver| push(solver));
    b.solver.mark_all_changed();
    let both = [(a.body, &mut a.solver), (b.body, &mut b.solver)];
    assert_eq!(gpu.step(both, DT, &params).err(), Some(GpuError::StaleBody));
    b.update(&mut gpu);
    a.step(&mut gpu, &params);
    a.assert_equal(&mut gpu, "after another body's error");
    // The first body is removed, and the next one takes its slot.
    a.edit(|_, solver| push(solver));
    b.solver.mark_all_changed();
    let both = [(a.body, &mut a.solver), (b.body, &mut b.solver)];
    assert_eq!(gpu.step(both, DT, &params).err(), Some(GpuError::StaleBody));
    gpu.remove(a.body);
    let mut c = CpuGpuPair::add(&mut gpu, surface(), &material, Schedule::Patches);
    b.update(&mut gpu);
    for twin in [&mut b, &mut c] {
        twin.step(&mut gpu, &params);
        twin.assert_equal(&mut gpu, "after a body's end");
    }
}

/// Adds bodies with the default limits of WebGPU until they do not fit.
fn too_many_bodies(context: Context) {
    let (material, params) = with_most_features();
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    let mut first = CpuGpuPair::add(&mut gpu, sphere(2, [0.0; 3]), &material, Schedule::Patches);
    let mut grown = CpuGpuPair::add(&mut gpu, sphere(2, [0.0; 3]), &material, Schedule::Patches);
    // A first step makes room for colliders.
    for twin in [&mut first, &mut grown] {
        twin.step(&mut gpu, &params);
        twin.assert_equal(&mut gpu, "after a first step");
    }
    let is_full = |error: &GpuError| {
        matches!(error, GpuError::BufferTooLarge { what, limit, .. }
        if what == "constraints" && *limit == 128 << 20)
    };
    let mut added = Vec::new();
    // Large ones as long as there is room, then small ones.
    for level in [6, 4, 2, 0] {
        let mut surface = icosphere(level, 0.5);
        let solver = Solver::new(&mut surface, &material).expect("a valid sphere");
        let error = loop {
            match gpu.add(&surface, &mut solver.clone()) {
                Ok(body) => added.push(body),
                Err(error) => break error,
            }
            assert!(added.len() < 256, "the limit is not kept");
        };
        assert!(is_full(&error), "{error:?}");
    }
    for _ in 0..80 {
        grown.edit(|surface, solver| {
            let delta = split(surface, HalfEdge(0), 0.5).expect("it is closed");
            solver.apply_delta(surface, &delta).expect("it fits");
        });
    }
    let refused = gpu.update(grown.body, &grown.on_gpu, &mut grown.solver);
    let error = refused.expect_err("there is no room");
    assert!(is_full(&error), "{error:?}");
    let stepped = gpu.step([(grown.body, &mut grown.solver)], DT, &params);
    assert_eq!(stepped.err(), Some(GpuError::StaleBody));
    for _ in 0..3 {
        first.step(&mut gpu, &params);
    }
    first.assert_equal(&mut gpu, "beside a full buffer");
    gpu.remove(added[0]);
    grown.update(&mut gpu);
    grown.step(&mut gpu, &params);
    grown.assert_equal(&mut gpu, "once there was room");
}

/// Bodies have the same places in both backends.
fn another_backend(context: Context) {
    let (material, params) = with_most_features();
    let mut here = GpuBackend::from_context(context).expect("a device");
    let other = Context::open(&Needs::Strict.request()).expect("it opens twice");
    let mut there = GpuBackend::from_context(other).expect("a device");
    let surface = || sphere(1, [0.0; 3]);
    let mut known = CpuGpuPair::add(&mut here, surface(), &material, Schedule::Patches);
    let unknown = CpuGpuPair::add(&mut there, surface(), &material, Schedule::Patches).body;
    let results = [
        here.bounds(unknown).map(|_| ()),
        here.prefetch(unknown),
        here.positions(unknown).map(|_| ()),
        here.update(unknown, &known.on_gpu, &mut known.solver),
    ];
    for result in results {
        assert_eq!(result, Err(GpuError::UnknownBody));
    }
    here.remove(unknown);
    known.step(&mut here, &params);
    known.assert_equal(&mut here, "after another body was removed elsewhere");
}

fn step_on_the_cpu(context: Context) {
    let (material, params) = with_most_features();
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    let mut twin = CpuGpuPair::add(
        &mut gpu,
        sphere(1, [0.0; 3]),
        &material,
        Schedule::WholeBody,
    );
    twin.edit(|surface, solver| {
        let done = solver.step(surface, DT, &params);
        done.map(|_| ()).expect("a step on the CPU");
    });
    let stepped = gpu.step([(twin.body, &mut twin.solver)], DT, &params);
    assert_eq!(stepped.err(), Some(GpuError::StaleBody));
    twin.update(&mut gpu);
    twin.step(&mut gpu, &params);
    twin.assert_equal(&mut gpu, "after a step on each");
}

/// Every substep has parameters of its own; that of a million does not fit is found before they are
/// made.
fn too_many_passes(context: Context) {
    let (material, params) = with_most_features();
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    let mut twin = CpuGpuPair::add(&mut gpu, sphere(1, [0.0; 3]), &material, Schedule::Patches);
    let many = params.with_substeps(DT, 1_000_000);
    let stepped = gpu.step([(twin.body, &mut twin.solver)], DT, &many);
    assert!(
        matches!(stepped, Err(GpuError::BufferTooLarge { .. })),
        "{stepped:?}"
    );
    let many = SolverParams {
        iterations: 1_000_000,
        ..params
    };
    let stepped = gpu.step([(twin.body, &mut twin.solver)], DT, &many);
    assert!(
        matches!(stepped, Err(GpuError::TooManyDispatches { .. })),
        "{stepped:?}"
    );
    twin.step(&mut gpu, &params);
    twin.assert_equal(&mut gpu, "after too many passes");
}
