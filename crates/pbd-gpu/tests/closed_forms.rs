//! Closed forms, on the CPU.

#[path = "common/closed_forms.rs"]
mod closed_forms;
#[path = "common/single_steps.rs"]
mod single_steps;

use libtest_mimic::{Arguments, Trial};
use std::process::ExitCode;

fn main() -> ExitCode {
    let laws = closed_forms::LAWS.into_iter().chain(single_steps::LAWS);
    let trials = laws.map(|(name, law)| {
        Trial::test(name, move || {
            law(&mut |surface, solver, dt, params, frames| {
                for _ in 0..frames {
                    solver.step(surface, dt, params).expect("a step");
                }
            });
            Ok(())
        })
    });
    libtest_mimic::run(&Arguments::from_args(), trials.collect()).exit_code()
}
