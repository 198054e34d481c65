//! Tests of solver results with closed forms, on the GPU in every schedule.

use incise_pbd_gpu::{GpuBackend, Schedule};
use incise_test_support::gpu::{Needs, trial};
use libtest_mimic::Trial;

pub(crate) fn trials() -> Vec<Trial> {
    let mut trials = Vec::new();
    let cases = incise_test_support::closed_forms::CASES
        .into_iter()
        .chain(incise_test_support::single_steps::CASES);
    for (name, test) in cases {
        for schedule in [Schedule::WholeBody, Schedule::Colors] {
            let name = format!("{name} by {}", schedule.name());
            trials.push(trial(&name, Needs::AnyDevice, move |context| {
                let mut gpu = GpuBackend::from_context(context).expect("a device");
                gpu.force_schedule(Some(schedule));
                test(&mut |surface, solver, dt, params, frames| {
                    solver.mark_all_changed();
                    let body = gpu.add(surface, solver).expect("room");
                    for _ in 0..frames {
                        gpu.step([(body, &mut *solver)], dt, params)
                            .expect("a step");
                    }
                    gpu.read(body, surface, solver).expect("a state");
                    gpu.remove(body);
                });
            }));
        }
    }
    trials
}
