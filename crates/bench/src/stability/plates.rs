//! Thin plates: one split in its plane, and one that a fast block hits.

use super::case::{Case, larger};
use super::error::StressError;
use super::group::{Group, Grouping, touching};
use super::measured::{Measured, Quantities, worst_of};
use super::runner::Runner;
use super::scenes::place;
use super::solids::box_of;
use incise_cut::Sweep;
use incise_mesh::Vec3;
use incise_pbd_gpu::Material;
use incise_scene::BackendRequest;

pub(super) const CASES: [Case; 3] = [
    Case {
        id: "plate",
        stress: "a plate of 1 cm on the ground is split in its plane",
        invariant: "speed of a vertex after three seconds [m/s]",
        bound: 0.01,
        run: |runner| worst_of(runner, 0, split),
    },
    Case {
        id: "plate",
        stress: "a plate of 1 cm on the ground is split in its plane",
        invariant: "relative volume error of a half in the last second",
        bound: 0.01,
        run: |runner| worst_of(runner, 1, split),
    },
    Case {
        id: "block",
        stress: "a block of 20 cm hits a plate of 2 cm, held at its rim, at 2 to 20 m/s",
        invariant: "depth of one in the other at the end of a frame, or of the block below the \
                    plate, in thicknesses",
        bound: 0.5,
        run: |runner| worst_of(runner, 0, hit),
    },
];

/// Frames until the halves lie still, and as many as are measured.
const FRAMES: [u32; 2] = [180, 60];
/// Thickness of the plate that is hit \[m\].
const THICKNESS: f64 = 0.02;

fn split(runner: &Runner) -> Result<Vec<Measured>, StressError> {
    let all = [("soft body", Material::soft_body()), ("damped", damped())];
    let cells = runner.pick(6, 12);
    Ok(runner.each(&all, |backend, (name, material)| Measured {
        at: (*name).to_owned(),
        quantities: split_one(backend, material, cells),
    }))
}

/// A soft body whose motions decay four times as fast.
fn damped() -> Material {
    Material {
        damping: 4.0,
        ..Material::soft_body()
    }
}

fn split_one(
    backend: &BackendRequest,
    material: &Material,
    cells: u32,
) -> Result<Quantities, StressError> {
    let mut plate = box_of([1.0, 0.01, 1.0], [cells, 1, cells])?;
    place(&mut plate, |p| p + Vec3::new(0.0, 0.005, 0.0));
    let sweep = Sweep::from_plane([0.0, 1.0, 0.0], 0.0052, &plate.bounds())?;
    let params = touching(9.81, Some(0.0));
    let mut group = Group::new(backend, params, (&[plate], Grouping::Bodies), material)?;
    let [before, after] = sweep.ends();
    let blade = group.scene.add_blade(before);
    group.scene.move_blade(blade, after)?;
    group.step()?;
    if group.scene.stats().cuts == 0 {
        return Err(StressError::Invariant("the plate is not cut".to_owned()));
    }
    let (mut speed, mut error) = (0.0, 0.0);
    for frame in 0..FRAMES[0] + FRAMES[1] {
        group.step()?;
        if frame >= FRAMES[0] {
            speed = larger(speed, group.speed()?);
            error = larger(error, group.volume_error()?);
        }
    }
    Ok(vec![Some(speed), Some(error)])
}

fn hit(runner: &Runner) -> Result<Vec<Measured>, StressError> {
    let mut runs = Vec::new();
    for (name, grouping) in Grouping::ALL {
        for &speed in runner.pick(&[10.0_f32][..], &[2.0, 5.0, 10.0, 20.0]) {
            runs.push((name, grouping, speed));
        }
    }
    Ok(
        runner.each(&runs, |backend, &(name, grouping, speed)| Measured {
            at: format!("{speed} m/s, {name}"),
            quantities: hit_at(backend, grouping, speed),
        }),
    )
}

fn hit_at(
    backend: &BackendRequest,
    grouping: Grouping,
    speed: f32,
) -> Result<Quantities, StressError> {
    let plate = box_of([1.0, THICKNESS, 1.0], [10, 1, 10])?;
    let mut block = box_of([0.2; 3], [3; 3])?;
    place(&mut block, |p| p + Vec3::new(0.013, 0.15, 0.007));
    let params = touching(9.81, None);
    let material = Material::soft_body();
    let mut group = Group::new(backend, params, (&[plate, block], grouping), &material)?;
    group.pin(0, |p| p.x.abs() > 0.49 || p.z.abs() > 0.49)?;
    group.throw(1, [0.0, -speed, 0.0])?;
    let mut worst = 0.0;
    for _ in 0..120 {
        group.step()?;
        let below = group.center(0)?.y - group.center(1)?.y;
        worst = larger(worst, larger(group.depth()?, below) / THICKNESS);
    }
    Ok(vec![Some(worst)])
}
