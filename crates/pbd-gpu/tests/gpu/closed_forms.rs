//! Tests of solver results with closed forms, on the GPU.

use incise_pbd_gpu::{GpuBackend, Schedule};
use incise_test_support::gpu::{Needs, trial};
use libtest_mimic::Trial;

/// Returns the tests: single steps by both schedules, motions by that of whole bodies.
///
/// Motions of hundreds of frames take minutes color by color on a software GPU. `matches_cpu`
/// compares the schedules bit for bit.
pub(crate) fn trials() -> Vec<Trial> {
    let motions = incise_test_support::closed_forms::CASES;
    let steps = incise_test_support::single_steps::CASES;
    let of_motions = motions.map(|case| (case, Schedule::WholeBody));
    let both = [Schedule::WholeBody, Schedule::Colors];
    let of_steps = both.map(|schedule| steps.map(|case| (case, schedule)));
    let all = of_motions.into_iter().chain(of_steps.into_iter().flatten());
    all.map(|((name, test), schedule)| {
        let name = format!("{name} by {}", schedule.name());
        trial(&name, Needs::AnyDevice, move |context| {
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
        })
    })
    .collect()
}
