//! Closed forms, on a device, in every schedule that bodies so small can have.

#[path = "common/closed_forms.rs"]
mod closed_forms;
#[path = "common/gpu.rs"]
mod gpu;
#[path = "common/single_steps.rs"]
mod single_steps;

use gpu::{Needs, trial};
use incise_pbd_gpu::{GpuBackend, Schedule};
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut trials = Vec::new();
    let laws = closed_forms::LAWS.into_iter().chain(single_steps::LAWS);
    for (name, law) in laws {
        for schedule in [Schedule::WholeBody, Schedule::Colors] {
            let name = format!("{name} by {}", schedule.name());
            trials.push(trial(&name, Needs::AnyDevice, move |context| {
                let mut gpu = GpuBackend::on(context).expect("a device");
                gpu.force_schedule(Some(schedule));
                law(&mut |surface, solver, dt, params, frames| {
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
    gpu::run(trials)
}
