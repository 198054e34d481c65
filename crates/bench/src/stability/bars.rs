//! Bars of 12 triangles that cross: only their edges meet.

use super::case::Case;
use super::error::StressError;
use super::group::{Group, Grouping, touching};
use super::measured::{Measured, Quantities, worst_of};
use super::runner::Runner;
use super::scenes::place;
use super::solids::box_of;
use incise_mesh::Vec3;
use incise_pbd_gpu::{Material, Stiffness};
use incise_scene::BackendRequest;

pub(super) const CASES: [Case; 1] = [Case {
    id: "bars",
    stress: "a bar of 12 triangles falls across a held one, at every angle, as bodies and as \
             pieces",
    invariant: "height that it has lost after a second, in thicknesses",
    bound: 0.5,
    run: |runner| worst_of(runner, 0, cross),
}];

/// Sides of a bar \[m\].
const SIDES: [f64; 3] = [1.0, 0.1, 0.1];
/// Height of the fall \[m\].
const GAP: f64 = 0.05;

/// Lets bars fall at angles of 15 to 90 degrees, or finer steps in a full run.
fn cross(runner: &Runner) -> Result<Vec<Measured>, StressError> {
    let step = runner.pick(25, 5);
    let mut runs = Vec::new();
    for (name, grouping) in Grouping::ALL {
        runs.extend(
            (15_u32..=90)
                .step_by(step)
                .map(|angle| (name, grouping, angle)),
        );
    }
    Ok(
        runner.each(&runs, |backend, &(name, grouping, angle)| Measured {
            at: format!("{angle} degrees, {name}"),
            quantities: fall(backend, grouping, f64::from(angle).to_radians()),
        }),
    )
}

fn fall(
    backend: &BackendRequest,
    grouping: Grouping,
    angle: f64,
) -> Result<Quantities, StressError> {
    let lower = box_of(SIDES, [1; 3])?;
    let mut upper = lower.clone();
    let (sin, cos) = angle.sin_cos();
    place(&mut upper, |p| {
        let turned = Vec3::new(cos * p.x + sin * p.z, p.y, cos * p.z - sin * p.x);
        turned + Vec3::new(0.0, SIDES[1] + GAP, 0.0)
    });
    let material = Material {
        stretch: Stiffness::Compliance(0.0),
        ..Material::soft_body()
    };
    let params = touching(9.81, None);
    let mut group = Group::new(backend, params, (&[lower, upper], grouping), &material)?;
    group.pin(0, |_| true)?;
    for _ in 0..60 {
        group.step()?;
    }
    let lost = (SIDES[1] - group.center(1)?.y) / SIDES[1];
    Ok(vec![Some(lost)])
}
