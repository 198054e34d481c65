//! What a device does, beside what the processor does. Without a device there is nothing to compare.

use super::alike::apart;
use super::case::{Case, Worst};
use super::cuts::{below, cut, pieces, through};
use super::device::Device;
use super::failure::Failure;
use super::scenes::{FRAME, GROUND, HANGING, ball, elastic_shell};
use super::stage::{Stage, Way};
use crate::directions::Directions;
use incise_cut::{CutParams, Cutter};
use incise_mesh::Surface;
use incise_pbd_gpu::{Material, PatchParams, Solver, Stiffness};

pub(super) const CASES: [Case; 3] = [
    Case {
        id: "T16",
        torture: "every way of stepping, beside the processor's own",
        law: "way from the processor's after half a second [m]",
        bound: 1e-4,
        run: beside_the_processor,
    },
    Case {
        id: "T16",
        torture: "the same with the limits that every WebGPU device has",
        law: "way from the processor's after half a second [m]",
        bound: 1e-4,
        run: with_portable_limits,
    },
    Case {
        id: "T16",
        torture: "cuts of a moving body that outgrow the buffers, with a device's own limits and with any WebGPU device's",
        law: "way from the processor's in any of 10 frames after each, from one state [m]",
        bound: 1e-4,
        run: outgrown,
    },
];

/// Bodies in two materials, every way.
fn every_way(stage: &mut Stage, worst: &mut Worst) {
    let materials = [
        ("compliance 1e-4", elastic_shell(1e-4, 1e-1)),
        ("PBD", Material::default()),
    ];
    // Bodies that fit a workgroup and one that does not.
    for subdivisions in [1, 2, stage.pick(2, 4)] {
        for (name, material) in materials {
            for way in [Way::Own, Way::WholeBody, Way::Colors, Way::Patches] {
                let found = beside(stage, ball(subdivisions, 0.6), &material, way);
                let triangles = 20 << (2 * subdivisions);
                worst.judge(found, || {
                    format!("{triangles} triangles, {name}, {}", way.name())
                });
            }
        }
    }
}

fn beside_the_processor(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    if stage.device.is_some() {
        every_way(stage, &mut worst);
    }
    Ok(worst)
}

fn with_portable_limits(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    if let Some(device) = &stage.device {
        let mut stage = Stage::new(stage.effort, Some(device.portable()?));
        every_way(&mut stage, &mut worst);
    }
    Ok(worst)
}

/// How far a body that goes one way is from the same body on the processor after half a second \[m\].
fn beside(
    stage: &mut Stage,
    mut surface: Surface,
    material: &Material,
    way: Way,
) -> Result<f64, Failure> {
    let mut solver = match way {
        Way::Patches => Solver::with_patches(&mut surface, material, &PatchParams::default())?,
        _ => Solver::new(&mut surface, material)?,
    };
    crate::motion::start(&mut solver, &surface)?;
    let own = surface.clone();
    if let Some(device) = &mut stage.device {
        device.force(way);
    }
    let mut mover = stage.enter_with(own, solver.clone())?;
    let moved = mover.advance(FRAME, &HANGING, 30);
    let there = mover.surface.positions.clone();
    drop(mover);
    if let Some(device) = &mut stage.device {
        device.force(Way::Own);
    }
    moved?;
    for _ in 0..30 {
        solver.step(&mut surface, FRAME, &HANGING)?;
    }
    Ok(apart(&there, &surface.positions))
}

fn outgrown(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    if let Some(device) = &stage.device {
        let effort = stage.effort;
        // New ones: buffers that other bodies have made larger stay so.
        let fresh: [(&str, Device); 2] = [
            ("its own limits", device.again()?),
            ("portable limits", device.portable()?),
        ];
        for (limits, device) in fresh {
            outgrow(
                &mut Stage::new(effort, Some(device)),
                limits,
                Way::Own,
                &mut worst,
            )?;
        }
        let mut stage = Stage::new(effort, Some(device.again()?));
        outgrow(&mut stage, "patches", Way::Patches, &mut worst)?;
    }
    Ok(worst)
}

/// Cuts a body until its buffers were replaced by larger ones, and some times more.
fn outgrow(stage: &mut Stage, name: &str, way: Way, worst: &mut Worst) -> Result<(), Failure> {
    let (cuts, frames) = stage.pick((8, 10), (30, 10));
    let material = Material {
        bending: Some(Stiffness::Compliance(1e-1)),
        ..elastic_shell(1e-4, 1e-1)
    };
    // Its vertices with their slack just fit the first buffers.
    let mut surface = ball(4, 0.6);
    let mut solver = match way {
        Way::Patches => Solver::with_patches(&mut surface, &material, &PatchParams::default())?,
        _ => Solver::new(&mut surface, &material)?,
    };
    crate::motion::start(&mut solver, &surface)?;
    let mut mover = stage.enter_with(surface, solver)?;
    let first = mover.reserved();
    let mut cutter = Cutter::new(&mover.surface);
    let mut directions = Directions(16);
    for number in 1..=cuts {
        let all = pieces(&mover.surface);
        let piece = all[below(&mut directions, all.len())];
        let sweep = through(&mover.surface, piece, &mut directions)?;
        let found = cut(&mut mover, &mut cutter, &sweep, &CutParams::default()).and_then(|_| {
            let mut farthest = 0.0_f64;
            for _ in 0..frames {
                // A hinge of a crumpled body that is half a turn off its rest goes back either way: rounding decides,
                // and a frame makes a thousand times as much of it. So every frame begins anew with the device's state. What
                // an edit failed to send is missing in the first one.
                let (mut surface, mut solver) = (mover.surface.clone(), mover.solver.clone());
                mover.step(FRAME, &GROUND)?;
                solver.step(&mut surface, FRAME, &GROUND)?;
                farthest = farthest.max(apart(&mover.surface.positions, &surface.positions));
            }
            Ok(farthest)
        });
        let broken = found.is_err();
        worst.judge(found, || format!("{name}, cut {number}"));
        if broken {
            return Ok(());
        }
    }
    if mover.reserved() > first {
        return Ok(());
    }
    let why = "the buffers had room for all, so this is no test of larger ones";
    Err(Failure::Law(why.to_owned()))
}
