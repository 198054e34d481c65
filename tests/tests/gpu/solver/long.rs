//! Long tests: closed forms and stress tests, whose references do not come from the CPU backend.

use incise_pbd_gpu::{Context, GpuBackend};
use incise_test_support::closed_forms::{self, Advance};
use incise_test_support::single_steps;
use incise_tests::stress::{Runner, cases};

/// Results with a closed form.
pub(crate) fn closed_forms(context: Context) {
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    for (_, case) in closed_forms::CASES.into_iter().chain(single_steps::CASES) {
        with_backend(&mut gpu, |advance| case(advance));
    }
}

/// Inputs and motions that break solvers.
pub(crate) fn stress(context: Context) {
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    for (_, case) in cases() {
        with_backend(&mut gpu, |advance| {
            case(&mut Runner {
                advance,
                is_gpu: true,
            });
        });
    }
}

/// Runs a test with steps on the GPU.
fn with_backend(gpu: &mut GpuBackend, test: impl FnOnce(Advance<'_>)) {
    test(&mut |surface, solver, dt, params, frames| {
        solver.mark_all_changed();
        let body = gpu.add(surface, solver).expect("room");
        for _ in 0..frames {
            let stepped = gpu.step([(body, &mut *solver)], dt, params);
            stepped.expect("a step");
        }
        gpu.read(body, surface, solver).expect("a state");
        gpu.remove(body);
    });
}
