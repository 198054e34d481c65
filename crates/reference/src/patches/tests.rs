//! Steps by patches against converged steps.

use super::*;
use crate::{Plane, Stepper};

/// A strip of triangles, pinned at one end, stretched and twisted.
fn strip() -> (Model, State) {
    let n = 40;
    let at = |i: usize| Vector3::new(0.1 * i as f64, 0.1 * (i % 2) as f64, 0.0);
    let pairs = (1..n).map(|i| [i - 1, i]).chain((2..n).map(|i| [i - 2, i]));
    let pairs: Vec<[usize; 2]> = pairs.collect();
    let hinges = (3..n).map(|i| match i % 2 {
        0 => [i - 1, i - 2, i, i - 3],
        _ => [i - 2, i - 1, i, i - 3],
    });
    let hinges: Vec<[usize; 4]> = hinges.collect();
    let model = Model {
        mass: (0..n).map(|i| if i < 2 { 0.0 } else { 0.01 }).collect(),
        stretch: Constraints {
            rest: pairs.iter().map(|&[a, b]| (at(b) - at(a)).norm()).collect(),
            vertices: pairs,
            compliance: 1e-4,
        },
        bending: Constraints {
            rest: vec![0.0; hinges.len()],
            vertices: hinges,
            compliance: 0.1,
        },
        gravity: Vector3::new(0.0, 0.0, -9.81),
        damping: 0.5,
        ..Model::default()
    };
    let twisted = |i: usize| Rotation3::new(Vector3::x() * (0.02 * i as f64)) * at(i) * 1.02;
    (model, State::at((0..n).map(twisted).collect()))
}

#[test]
fn cycles_converge_to_the_step_of_the_reference() {
    let (model, start) = strip();
    let h = 1.0 / 240.0;
    let (mut found, mut expected) = (start.clone(), start.clone());
    let stepper = PatchStepper::new(&model, &start.x).unwrap();
    stepper.step(&mut found, h, 400);
    Stepper::new(&model)
        .unwrap()
        .step(&mut expected, h, &[])
        .unwrap();
    for ((a, b), before) in found.x.iter().zip(&expected.x).zip(&start.x) {
        assert!(
            (a - b).norm() < 1e-6 * (1e-3 + (b - before).norm()),
            "{a}, not {b}"
        );
    }
}

#[test]
fn no_motion_of_a_patch_raises_the_objective() {
    let (model, start) = strip();
    let goal = Goal::new(&model, &start, 0.1);
    let PatchStepper { whole, patches, .. } = PatchStepper::new(&model, &start.x).unwrap();
    let mut x = goal.to.clone();
    let first = goal.value(&whole, &x);
    let mut before = first;
    for _ in 0..5 {
        for patch in &patches {
            goal.lower(patch, &mut x);
            let value = goal.value(&whole, &x);
            assert!(value <= before * (1.0 + 1e-12), "from {before} to {value}");
            before = value;
        }
    }
    assert!(before < 0.5 * first, "{before} after {first}");
}

#[test]
fn every_level_has_every_free_vertex_once() {
    let (model, start) = strip();
    let stepper = PatchStepper::new(&model, &start.x).unwrap();
    let mut all: Vec<usize> = (stepper.patches.iter())
        .flat_map(|patch| patch.vertices.iter().copied())
        .collect();
    all.sort_unstable();
    let levels: Vec<usize> = (2..40).flat_map(|v| [v; 3]).collect();
    assert_eq!(
        all, levels,
        "the whole, 8 patches of 4 or 5, single vertices"
    );
    let (whole, last) = (&stepper.patches[0], stepper.patches.len() - 1);
    assert_eq!(
        (whole.stretch.len(), whole.bending.len()),
        (3, 2),
        "at the pins"
    );
    assert_eq!(stepper.patches[last].vertices.len(), 1);
}

#[test]
fn parts_without_an_energy_are_refused() {
    for spoil in [
        |model: &mut Model| {
            model.plane = Some(Plane {
                normal: Vector3::y(),
                offset: 0.0,
            });
        },
        |model: &mut Model| model.stretch.compliance = 0.0,
        |model: &mut Model| model.bending.compliance = 0.0,
    ] {
        let (mut model, start) = strip();
        spoil(&mut model);
        let refused = PatchStepper::new(&model, &start.x).map(|_| ());
        assert_eq!(refused, Err(ReferenceError::NoPatches));
    }
}
