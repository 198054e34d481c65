//! Results with closed forms.

use incise_test_support::closed_forms::{self, Case};
use incise_test_support::single_steps;

fn run(cases: &[(&str, Case)]) {
    for (name, case) in cases {
        // Printed if the case fails.
        eprintln!("{name}");
        case(&mut |surface, solver, dt, params, frames| {
            for _ in 0..frames {
                solver.step(surface, dt, params).expect("a step");
            }
        });
    }
}

#[test]
fn motions_match_their_closed_forms() {
    run(&closed_forms::CASES);
}

#[test]
fn single_steps_match_their_closed_forms() {
    run(&single_steps::CASES);
}
