//! Tests of scenes, reference and errors together.

use super::convergence::{Convergence, FLOOR_SUBSTEPS};
use super::error::distance;
use super::run::on_cpu;
use super::scene::Scheme;
use super::scenes;
use crate::motion::DT;
use incise_pbd_gpu::{Integrator, Stiffness};

#[test]
fn stiffnesses_take_the_place_of_compliances() {
    let scene = scenes::scene("sheet-1e4").unwrap();
    let [coarse, fine] = [1.0, 64.0].map(|n| {
        let body = scene.body_by(Scheme::Pbd, f64::from(DT) / n).unwrap();
        let material = body.solver.material();
        let (Stiffness::Pbd(stretch), Some(Stiffness::Pbd(bending))) =
            (material.stretch, material.bending)
        else {
            panic!("{material:?}");
        };
        [stretch, bending]
    });
    for k in 0..2 {
        assert!(
            0.0 < fine[k] && fine[k] < coarse[k] && coarse[k] <= 1.0,
            "{fine:?}, {coarse:?}"
        );
    }
    // The middle edge is a side of a square, between a vertex of four triangles and one of eight.
    // Each triangle is 1/288 kg, a third of it at every corner.
    let weight = 3.0 * 288.0 * (1.0 / 4.0 + 1.0 / 8.0);
    let alpha = 1e-4 * 3600.0;
    let off = f64::from(coarse[0]) - weight / (weight + alpha);
    assert!(off.abs() < 1e-6, "off by {off:e}");
}

/// Substeps tend to the extrapolated limit in the first order, converged BDF2 steps in the second.
///
/// The sheet is so soft that steps of a frame's fourth see its waves already.
#[test]
fn substeps_and_floors_tend_to_the_limit_of_the_reference() {
    let mut scene = scenes::scene("sheet-1e2").unwrap();
    scene.frames = 4;
    scene.fine = [16, 32, 64];
    let body = scene.body().unwrap();
    let convergence = Convergence::compute(&scene, &body, &[4, 8]).unwrap();
    let exact = convergence.exact().unwrap();
    let measure = &convergence.measure;
    let errors = [4, 16, 64].map(|substeps| {
        let run = on_cpu(&body, &scene.params(substeps, 32), scene.frames).unwrap();
        measure.errors(&run.states, &exact.states).position
    });
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log(4.0);
        assert!((0.8..1.2).contains(&order), "order {order} of {errors:?}");
    }
    let uncertainty = exact.uncertainty;
    assert!(uncertainty < 0.1 * errors[2], "{uncertainty} of {errors:?}");
    // Solved as far as it can be, it is the converged step but for the way of its gradients.
    let run = on_cpu(&body, &scene.params(4, 256), scene.frames).unwrap();
    let known = convergence.known(Integrator::Euler, 4).unwrap();
    let own = measure.errors(&run.states, known).position;
    assert!(own < 0.2 * errors[0], "{own} of {errors:?}");
    let floors = FLOOR_SUBSTEPS.map(|substeps| convergence.floor(&exact, substeps).unwrap());
    for pair in floors[1..].windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.6..2.4).contains(&order), "order {order} of {floors:?}");
    }
    let first_order = convergence.known(Integrator::Euler, 8).unwrap();
    let first_order = distance(&measure.model, first_order, &exact.states);
    assert!(
        4.0 * floors[3] < first_order,
        "{floors:?}, and {first_order}"
    );
}
