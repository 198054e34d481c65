//! Stress tests: inputs and motions that break solvers, with the invariant that each must keep.
//!
//! `tests/tests/gpu` runs them on a GPU. `incise-bench stability` has those that take minutes or
//! that fail today.

#![allow(
    clippy::cast_possible_truncation,
    reason = "positions as they are stored"
)]

mod motions;
mod runner;
mod shapes;
mod volumes;

use libtest_mimic::{Arguments, Trial};
use runner::{Case, Runner};
use std::process::ExitCode;

fn main() -> ExitCode {
    let on_cpu = |(name, case): Case| {
        Trial::test(name, move || {
            case(&mut Runner {
                advance: &mut |surface, solver, dt, params, frames| {
                    for _ in 0..frames {
                        solver.step(surface, dt, params).expect("a step");
                    }
                },
                is_gpu: false,
            });
            Ok(())
        })
    };
    let all: [&[Case]; 3] = [&shapes::CASES, &motions::CASES, &volumes::CASES];
    let trials = all.into_iter().flatten().copied().map(on_cpu).collect();
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}
