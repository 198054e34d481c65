//! Models and checks that tests of the reference share.

use incise_reference::{Model, State, StepReport, Stepper};
use nalgebra::Vector3;

/// Gravity [m/s^2].
pub(crate) const G: f64 = 9.81;

/// Gravity as a vector [m/s^2].
pub(crate) fn gravity() -> Vector3<f64> {
    Vector3::new(0.0, -G, 0.0)
}

/// Makes so many steps of `h` \[s\]; the report of the last.
pub(crate) fn run(model: &Model, state: &mut State, h: f64, steps: usize) -> StepReport {
    let mut stepper = Stepper::new(model).unwrap();
    let mut report = StepReport::default();
    for _ in 0..steps {
        report = stepper.step(state, h, &[]).unwrap();
    }
    report
}
