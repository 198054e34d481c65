//! Tests of solver results with closed forms, on the CPU.

use libtest_mimic::{Arguments, Trial};
use std::process::ExitCode;

fn main() -> ExitCode {
    let cases = incise_test_support::closed_forms::CASES
        .into_iter()
        .chain(incise_test_support::single_steps::CASES);
    let trials = cases.map(|(name, test)| {
        Trial::test(name, move || {
            test(&mut |surface, solver, dt, params, frames| {
                for _ in 0..frames {
                    solver.step(surface, dt, params).expect("a step");
                }
            });
            Ok(())
        })
    });
    libtest_mimic::run(&Arguments::from_args(), trials.collect()).exit_code()
}
