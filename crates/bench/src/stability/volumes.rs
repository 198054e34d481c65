//! Bodies that keep their volumes: at rest and cut, under pressure, turned inside out, opened.

use super::audit::{Rule, energy_watched};
use super::case::{Case, Found, Worst, larger};
use super::cuts::{cut, pieces, through};
use super::failure::Failure;
use super::impacts::squeeze;
use super::scenes::{FRAME, GROUND, WEIGHTLESS, ball, materials, shift, whole};
use super::stage::{Mover, Stage};
use crate::directions::Directions;
use incise_cut::{CutParams, Cutter};
use incise_mesh::{Model, Surface, TriangleId, Vec3, build_model};
use incise_pbd_gpu::{Material, PieceVolume, SolverParams, Stiffness, Volume};

pub(super) const CASES: [Case; 8] = [
    Case {
        id: "volume",
        torture: "a ball, a bunny and an armadillo that keep their volumes lie on the ground for 15 s",
        law: "change of a piece's volume in the last second, of that at rest",
        bound: 0.01,
        run: |stage| at_rest(stage, &GROUND),
    },
    Case {
        id: "volume",
        torture: "the same, cut twice meanwhile",
        law: "change of a piece's volume in the last second, of that at rest",
        bound: 0.01,
        run: |stage| cut_twice(stage, &GROUND),
    },
    Case {
        id: "volume",
        torture: "the ball, the bunny and the armadillo on the ground by the default's substeps",
        law: "change of a piece's volume in the last second, of that at rest",
        bound: 0.01,
        run: |stage| at_rest(stage, &SUBSTEPS),
    },
    Case {
        id: "volume",
        torture: "these cut twice meanwhile",
        law: "change of a piece's volume in the last second, of that at rest",
        bound: 0.01,
        run: |stage| cut_twice(stage, &SUBSTEPS),
    },
    Case {
        id: "T10",
        torture: "pressure of 0 to 100 volumes leaps in a ball on the ground",
        law: "farthest vertex from the middle, of the radius of the most volume so far",
        bound: 2.0,
        run: pressure,
    },
    Case {
        id: "T10",
        torture: "the same without weight in a ball that nothing else holds",
        law: "volume before the next leap, off what is asked, of that or of that at rest",
        bound: 0.01,
        run: pressure_alone,
    },
    Case {
        id: "T10",
        torture: "ball that keeps its volume turned inside out between pins, then let go",
        law: "farthest vertex from the middle in 10 s, of the radius",
        bound: 3.0,
        run: inside_out,
    },
    Case {
        id: "T10",
        torture: "a piece under pressure loses a triangle",
        law: "constraints of what is open, lost ones of what is not, vertices elsewhere than without",
        bound: 0.0,
        run: opened,
    },
];

/// Of balls \[m\].
const RADIUS: f64 = 0.5;
/// How many times the volume at rest is asked for, one after the other: by steps, and from one end to the other.
const PRESSURES: [f32; 11] = [0.0, 0.1, 1.0, 5.0, 100.0, 1.0, 100.0, 0.0, 5.0, 0.1, 1.0];
/// How fast an incompressible piece changes its volume at most [1/s]: the solver's own number.
const SPEED: f32 = 3.0;
/// What is left for it to settle after that \[s\].
const SETTLING: f32 = 2.0;
/// Frames of a second.
const SECOND: u32 = 60;
/// Planes tried for one cut: some pass by a piece.
const TRIES: u32 = 20;

/// Shells that keep their volume.
fn kept() -> [(&'static str, Material); 3] {
    materials().map(|(name, material)| (name, with(material, Volume::default())))
}

fn with(material: Material, volume: Volume) -> Material {
    Material {
        volume: Some(volume),
        ..material
    }
}

fn asking(pressure: f32) -> Volume {
    Volume {
        pressure,
        ..Volume::default()
    }
}

/// The farthest that any piece's volume is from that at rest, over that.
///
/// # Errors
/// A law that is broken: a piece without a constraint.
fn error(mover: &Mover<'_>) -> Result<f64, Failure> {
    let volumes = mover.surface.piece_volumes();
    let (all, kept) = (pieces(&mover.surface), mover.solver.volumes().pieces());
    if !kept.iter().map(PieceVolume::piece).eq(all.iter().copied()) {
        let why = format!("{} constraints for {} pieces", kept.len(), all.len());
        return Err(Failure::Law(why));
    }
    let off = |piece: &PieceVolume| {
        let is = volumes[piece.piece() as usize];
        (is / f64::from(piece.rest()) - 1.0).abs()
    };
    Ok(kept.iter().map(off).fold(0.0, larger))
}

/// The farthest vertex from the middle of the box around all \[m\].
fn spread(surface: &Surface) -> f64 {
    let middle = surface.bounds().center();
    let all = surface.topology().vertices();
    all.map(|v| (surface.position(v) - middle).norm())
        .fold(0.0, larger)
}

/// Runs every body in every shell.
fn bodies(
    stage: &mut Stage,
    judge: impl Fn(&mut Mover<'_>) -> Result<Found, Failure>,
) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let all = [Model::Sphere768, Model::Bunny, Model::Armadillo];
    for &model in stage.pick(&all[..2], &all) {
        let mut surface = build_model(model);
        let lift = -f64::from(surface.bounds().min[1]);
        shift(&mut surface, Vec3::new(0.0, lift, 0.0));
        for (name, material) in kept() {
            let mut mover = stage.enter(surface.clone(), &material)?;
            let found = judge(&mut mover);
            worst.judge(found, || format!("{}, {name}", model.name()));
        }
    }
    Ok(worst)
}

/// What the solver does unless it is told otherwise, on the ground.
const SUBSTEPS: SolverParams = SolverParams {
    iterations: 1,
    substeps: 16,
    ..GROUND
};

/// Nothing that lies on the ground comes farther.
const LYING: Rule = Rule::above(0.0).within(5.0).recovering();

/// Lets a body lie; judged by energy, with the largest error of the last second beside it.
fn lies(
    mover: &mut Mover<'_>,
    params: &SolverParams,
    frames: u32,
) -> Result<(Found, f64), Failure> {
    let mut most = 0.0;
    let found = energy_watched(mover, (FRAME, params), frames, LYING, |mover, frame| {
        if frame + SECOND >= frames {
            most = larger(most, error(mover)?);
        }
        Ok(())
    })?;
    Ok((found, most))
}

fn at_rest(stage: &mut Stage, params: &SolverParams) -> Result<Worst, Failure> {
    let frames = SECOND * stage.pick(3, 15);
    bodies(stage, |mover| {
        let (found, most) = lies(mover, params, frames)?;
        Ok(found.with_energy().by(most))
    })
}

/// A cut that is none leaves as many pieces, and another plane is tried.
fn cut_through(
    mover: &mut Mover<'_>,
    cutter: &mut Cutter,
    directions: &mut Directions,
) -> Result<(), Failure> {
    let before = pieces(&mover.surface);
    let size = |p: &u32| mover.surface.piece_triangles(*p);
    let largest = before.iter().copied().max_by_key(size).unwrap_or(0);
    let params = CutParams {
        only_piece: Some(largest),
        ..CutParams::default()
    };
    for _ in 0..TRIES {
        let sweep = through(&mover.surface, largest, directions)?;
        cut(mover, cutter, &sweep, &params)?;
        if pieces(&mover.surface).len() > before.len() {
            return Ok(());
        }
    }
    let why = format!("none of {TRIES} planes cut piece {largest}");
    Err(Failure::Law(why))
}

fn cut_twice(stage: &mut Stage, params: &SolverParams) -> Result<Worst, Failure> {
    let third = SECOND * stage.pick(2, 5);
    bodies(stage, |mover| {
        let mut cutter = Cutter::new(&mover.surface);
        let mut directions = Directions(23);
        for _ in 0..2 {
            mover.advance(FRAME, params, third)?;
            cut_through(mover, &mut cutter, &mut directions)?;
        }
        // What was out of shape when it was cut has a volume to get back, so energy is no law.
        let (found, most) = lies(mover, params, third)?;
        Ok(found.by(most))
    })
}

/// Asks for one volume after the other; `watch` is shown every frame's end, and whether it is the last before the next
/// leap.
fn leaps(
    mover: &mut Mover<'_>,
    params: &SolverParams,
    mut watch: impl FnMut(&Mover<'_>, f32, bool),
) -> Result<(), Failure> {
    let mut before = 1.0;
    for next in PRESSURES {
        let volume = Some(asking(next));
        mover.solver.set_volume(&mover.surface, volume)?;
        let frames = whole(((next - before).abs() / SPEED + SETTLING) / FRAME);
        for frame in 1..=frames {
            mover.step(FRAME, params)?;
            watch(mover, next, frame == frames);
        }
        before = next;
    }
    Ok(())
}

fn pressure(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let subdivisions = stage.pick(1, 3);
    for (name, material) in kept() {
        let mut mover = stage.enter(ball(subdivisions, RADIUS), &material)?;
        let (mut most, mut largest) = (0.0, 1.0_f32);
        let moved = leaps(&mut mover, &GROUND, |mover, asked, _| {
            largest = largest.max(asked);
            let radius = RADIUS * f64::from(largest).cbrt();
            most = larger(most, spread(&mover.surface) / radius);
        });
        worst.judge(moved.map(|()| most), || name.to_owned());
    }
    Ok(worst)
}

fn pressure_alone(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let limp = Material {
        stretch: Stiffness::Pbd(0.0),
        bending: None,
        ..Material::default()
    };
    let surface = ball(stage.pick(1, 3), 0.0);
    let rest = surface.volume();
    let mut mover = stage.enter(surface, &with(limp, Volume::default()))?;
    let moved = leaps(&mut mover, &WEIGHTLESS, |mover, asked, is_last| {
        if is_last {
            let asked = f64::from(asked);
            let off = (mover.surface.volume() / rest - asked).abs();
            worst.judge(Ok(off / asked.max(1.0)), || format!("{asked} volumes"));
        }
    });
    if let Err(failure) = moved {
        worst.judge(Err::<f64, _>(failure), || "on the way".to_owned());
    }
    Ok(worst)
}

fn inside_out(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    for (name, material) in kept() {
        let mut mover = stage.enter(ball(2, 1.0), &material)?;
        let mut run = || -> Result<f64, Failure> {
            squeeze(&mut mover)?;
            let mut most = 0.0;
            for _ in 0..10 * SECOND {
                mover.step(FRAME, &GROUND)?;
                most = larger(most, spread(&mover.surface) / RADIUS);
            }
            Ok(most)
        };
        let found = run();
        worst.judge(found, || name.to_owned());
    }
    Ok(worst)
}

/// What came of a piece that was opened.
struct Opened {
    /// Volume constraints of open pieces, and closed ones that have none.
    wrong: usize,
    /// Where the opened piece is in the end.
    places: Vec<[f32; 4]>,
}

/// Takes a triangle from a ball under pressure, or from one of its two pieces. `is_asked`: whether its volume is still
/// asked for then.
fn open(
    stage: &mut Stage,
    material: &Material,
    is_cut: bool,
    is_asked: bool,
) -> Result<Opened, Failure> {
    let on_device = stage.device.is_some();
    let mut mover = stage.enter(ball(2, 0.8), material)?;
    if is_cut {
        let mut cutter = Cutter::new(&mover.surface);
        cut_through(&mut mover, &mut cutter, &mut Directions(5))?;
    }
    mover.advance(FRAME, &GROUND, SECOND)?;
    let all = pieces(&mover.surface);
    let Some((&piece, closed)) = all.split_last() else {
        return Err(Failure::Law("no piece is left".to_owned()));
    };
    let topology = mover.surface.topology();
    let triangles: Vec<TriangleId> = (topology.triangles())
        .filter(|&t| mover.surface.piece(t) == piece)
        .collect();
    let vertices: Vec<usize> = (triangles.iter())
        .flat_map(|&t| topology.triangle(t).map(|v| v.index()))
        .collect();
    if !is_asked {
        mover.solver.set_volume(&mover.surface, None)?;
    }
    let mut edit = mover.surface.edit();
    triangles
        .first()
        .into_iter()
        .for_each(|&t| edit.remove_triangle(t));
    let (delta, _) = edit.finish();
    mover.follow(&delta)?;
    mover.step(FRAME, &GROUND)?;
    let kept = mover.solver.volumes().pieces();
    let kept: Vec<u32> = kept.iter().map(|piece| piece.piece()).collect();
    let expected = if is_asked { closed } else { &[] };
    let mut wrong = usize::from(kept != expected);
    // A device counts elsewhere.
    if !on_device {
        let iterations = u64::from(GROUND.iterations * GROUND.substeps);
        let projections = expected.len() as u64 * iterations;
        wrong += usize::from(mover.solver.stats().volume_projections != projections);
    }
    mover.advance(FRAME, &GROUND, SECOND)?;
    let places = vertices.iter().map(|&v| mover.surface.positions[v]);
    Ok(Opened {
        wrong,
        places: places.collect(),
    })
}

fn opened(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    for (name, material) in materials() {
        let material = with(material, asking(5.0));
        for is_cut in [false, true] {
            let mut run = || -> Result<f64, Failure> {
                let [with, without] =
                    [true, false].map(|is_asked| open(stage, &material, is_cut, is_asked));
                let (with, without) = (with?, without?);
                let both = with.places.iter().zip(&without.places);
                let apart = both.filter(|(a, b)| a != b).count();
                Ok((apart + with.wrong + without.wrong) as f64)
            };
            let found = run();
            let whole = if is_cut { "one of two pieces" } else { "whole" };
            worst.judge(found, || format!("{name}, {whole}"));
        }
    }
    Ok(worst)
}
