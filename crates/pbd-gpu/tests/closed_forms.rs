//! Closed forms, on the CPU.

#[path = "common/closed_forms.rs"]
mod closed_forms;

use closed_forms::LAWS;
use libtest_mimic::{Arguments, Trial};
use std::process::ExitCode;

fn main() -> ExitCode {
    let trials = LAWS.map(|(name, law)| {
        Trial::test(name, move || {
            law(&mut |surface, solver, dt, params, frames| {
                for _ in 0..frames {
                    solver.step(surface, dt, params).expect("a step");
                }
            });
            Ok(())
        })
    });
    libtest_mimic::run(&Arguments::from_args(), trials.into()).exit_code()
}
