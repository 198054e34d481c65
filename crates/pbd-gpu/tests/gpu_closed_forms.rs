//! Closed forms, on a device, in every schedule that bodies so small can have.

#[path = "common/closed_forms.rs"]
mod closed_forms;
#[path = "common/gpu.rs"]
mod gpu;

use closed_forms::LAWS;
use gpu::{Needs, trial};
use incise_pbd_gpu::{GpuBackend, Schedule};
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut trials = Vec::new();
    for (name, law) in LAWS {
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
