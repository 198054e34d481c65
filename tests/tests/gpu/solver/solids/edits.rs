//! Edits of solids between frames, other substeps, late copies and refused calls.

use super::{PARAMS, assert_equal, shake, twins};
use incise_mesh::VertexId;
use incise_pbd_gpu::{Contact, Context, GpuBackend, GpuError, SolverParams, StepError};
use incise_test_support::cpu_gpu_pair::{DT, assert_same};
use incise_test_support::random::Random;

/// A state that was read back, saved as a clone and uploaded elsewhere goes on as it was.
pub(super) fn edits_between_frames(context: &Context) {
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
pub(super) fn changed_substeps(context: &Context) {
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

/// A state that is collected after a frame with other substeps goes on as it would have then.
pub(super) fn late_copies(context: &Context) {
    let mut gpu = GpuBackend::from_context(context.clone()).expect("a device");
    let others = SolverParams {
        substep: Some(1.0 / 360.0),
        ..PARAMS
    };
    for (i, mut twin) in twins(&mut gpu).into_iter().enumerate() {
        twin.step(&mut gpu, &PARAMS);
        gpu.prefetch(twin.body).expect("a known body");
        twin.step(&mut gpu, &PARAMS);
        gpu.step([(twin.body, &mut twin.solver)], DT, &others)
            .expect("a step");
        while !(gpu.collect(twin.body, &mut twin.on_gpu, &mut twin.solver)).expect("a state") {}
        for when in ["as collected", "a frame later"] {
            let copy = (&twin.on_gpu, &twin.solver);
            assert_same(
                copy,
                (&twin.on_cpu, &twin.cpu),
                &format!("{when}, body {i}"),
            );
            for (surface, solver) in [
                (&mut twin.on_cpu, &mut twin.cpu),
                (&mut twin.on_gpu, &mut twin.solver),
            ] {
                solver.step(surface, DT, &PARAMS).expect("a step");
            }
        }
        gpu.remove(twin.body);
    }
}

/// Contacts of solids share nodes within a color, so that the CPU steps such bodies.
pub(super) fn contacts_are_refused(context: &Context) {
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
pub(super) fn numbers_that_are_none(context: &Context) {
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
