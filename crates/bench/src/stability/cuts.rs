//! Cuts of bodies in motion, one after the other.

use super::case::{Case, Worst, larger};
use super::failure::Failure;
use super::scenes::{FRAME, GROUND, WEIGHTLESS, ball, elastic_shell, pose};
use super::sound::{Sums, followed, sound};
use super::stage::{Mover, Stage};
use crate::directions::Directions;
use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, Vec3, VertexId};
use incise_pbd_gpu::{Material, SolverParams};

pub(super) const CASES: [Case; 5] = [
    Case {
        id: "1000 cuts",
        torture: "a falling body is cut by a plane at random, piece by piece, frame by frame",
        law: "topology, colors, tree; change of mass, momentum, volume",
        bound: 1e-5,
        run: thousand,
    },
    Case {
        id: "T12",
        torture: "cuts in every substep, down to pieces of a few triangles",
        law: "topology, colors, tree; change of mass, momentum, volume",
        bound: 1e-5,
        run: every_substep,
    },
    Case {
        id: "T12",
        torture: "the same plane up to 50 times or 50,000 triangles, the body moving between",
        law: "topology, colors, tree; change of mass, momentum, volume",
        bound: 1e-5,
        run: same_plane,
    },
    Case {
        id: "T12",
        torture: "cuts through a body stretched to 4 times its length, then let go",
        law: "mean strain after 10 s",
        bound: 0.05,
        run: stretched,
    },
    Case {
        id: "T12",
        torture: "cuts through pins",
        law: "topology, colors, tree; way of pins that stay [m]",
        bound: 0.0,
        run: through_pins,
    },
];

/// Shell, thrown and spinning.
fn thrown<'a>(stage: &'a mut Stage, material: &Material) -> Result<Mover<'a>, Failure> {
    let mut mover = stage.enter(ball(1, 0.8), material)?;
    crate::motion::start(&mut mover.solver, &mover.surface)?;
    Ok(mover)
}

/// The pieces of a surface.
pub(super) fn pieces(surface: &Surface) -> Vec<u32> {
    let numbers = 0..surface.piece_bound();
    numbers
        .filter(|&p| surface.piece_triangles(p) > 0)
        .collect()
}

/// A whole number below `count`, at random.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a saturating cast of a number that is not negative"
)]
pub(super) fn below(directions: &mut Directions, count: usize) -> usize {
    let part = f64::midpoint(directions.next(), 1.0);
    ((part * count as f64) as usize).min(count.saturating_sub(1))
}

/// A plane at random through the middle half of a piece.
pub(super) fn through(
    surface: &Surface,
    piece: u32,
    directions: &mut Directions,
) -> Result<Sweep, Failure> {
    let triangles = (surface.topology().triangles()).filter(|&t| surface.piece(t) == piece);
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for p in triangles.flat_map(|t| surface.triangle_positions(t)) {
        low = low.inf(&p);
        high = high.sup(&p);
    }
    let normal = directions.next_unit();
    let off = Vec3::from_fn(|_, _| directions.next()).component_mul(&(high - low)) / 4.0;
    let point = (low + high) / 2.0 + off;
    Ok(Sweep::across_box(
        normal.into(),
        normal.dot(&point),
        &surface.bounds(),
    )?)
}

/// Cuts once; a refusal must leave the surface as it was. Returns the largest change of a sum.
pub(super) fn cut(
    mover: &mut Mover<'_>,
    cutter: &mut Cutter,
    sweep: &Sweep,
    params: &CutParams,
) -> Result<f64, Failure> {
    cutter.refit(&mover.surface);
    let before = Sums::of(&mover.surface, &mover.solver);
    let kept = (
        mover.surface.topology().clone(),
        mover.surface.positions.clone(),
    );
    match cutter.cut(&mut mover.surface, sweep, params) {
        Ok(outcome) => {
            if !outcome.delta.is_empty() {
                mover.follow(&outcome.delta)?;
            }
            let (surface, solver) = (&mover.surface, &mover.solver);
            let (sound, followed) =
                rayon::join(|| sound(surface), || followed(surface, solver, cutter));
            sound.and(followed)?;
            Ok(before.change(&Sums::of(surface, solver), outcome.report.moved_volume))
        }
        Err(error) => {
            let same = *mover.surface.topology() == kept.0 && mover.surface.positions == kept.1;
            if same {
                Ok(0.0)
            } else {
                Err(Failure::Law(format!("a refused cut left a trace: {error}")))
            }
        }
    }
}

/// Cuts random pieces by random planes, a step between one and the next.
fn at_random(
    mover: &mut Mover<'_>,
    cuts: u32,
    dt: f32,
    params: &SolverParams,
    worst: &mut Worst,
) -> Result<(), Failure> {
    let mut directions = Directions(12);
    let mut cutter = Cutter::new(&mover.surface);
    for number in 1..=cuts {
        mover.step(dt, params)?;
        let all = pieces(&mover.surface);
        // Large pieces first: of two at random the larger.
        let two = [0, 1].map(|_| all[below(&mut directions, all.len())]);
        let size = |p: u32| mover.surface.piece_triangles(p);
        let piece = if size(two[0]) > size(two[1]) {
            two[0]
        } else {
            two[1]
        };
        let sweep = through(&mover.surface, piece, &mut directions)?;
        let cut_params = CutParams {
            only_piece: Some(piece),
            ..CutParams::default()
        };
        let found = cut(mover, &mut cutter, &sweep, &cut_params);
        let broken = found.is_err();
        worst.judge(found, || {
            format!("cut {number}, {} pieces", pieces(&mover.surface).len())
        });
        if broken {
            break;
        }
    }
    Ok(())
}

fn thousand(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let cuts = stage.pick(30, 1000);
    let mut mover = thrown(stage, &crate::motion::material())?;
    at_random(&mut mover, cuts, FRAME, &GROUND, &mut worst)?;
    Ok(worst)
}

fn every_substep(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let cuts = stage.pick(20, 200);
    let mut mover = thrown(stage, &elastic_shell(1e-5, 1e-2))?;
    let params = SolverParams {
        iterations: 1,
        ..GROUND
    };
    at_random(&mut mover, cuts, FRAME / 20.0, &params, &mut worst)?;
    Ok(worst)
}

fn same_plane(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let times = stage.pick(5, 50);
    let mut mover = thrown(stage, &crate::motion::material())?;
    let mut cutter = Cutter::new(&mover.surface);
    for number in 1..=times {
        let middle = mover.surface.bounds().center();
        let normal = Vec3::new(0.3, 0.2, 1.0);
        let bounds = mover.surface.bounds();
        let sweep = Sweep::across_box(normal.into(), normal.dot(&middle), &bounds)?;
        let found = cut(&mut mover, &mut cutter, &sweep, &CutParams::default());
        let broken = found.is_err();
        worst.judge(found, || format!("cut {number}"));
        // Pieces are no obstacles to each other, so all of them lie across the plane again: they double.
        if broken || mover.surface.topology().triangle_count() > 50_000 {
            break;
        }
        mover.step(FRAME, &WEIGHTLESS)?;
    }
    Ok(worst)
}

fn stretched(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let mut directions = Directions(4);
    let subdivisions = stage.pick(1, 2);
    for (name, material) in [
        ("compliance 0", elastic_shell(0.0, 0.0)),
        ("compliance 1e-4", elastic_shell(1e-4, 1e-1)),
    ] {
        let mut mover = stage.enter(ball(subdivisions, 0.8), &material)?;
        pose(&mut mover.surface, |p| Vec3::new(4.0 * p.x, p.y, p.z));
        mover.moved()?;
        let mut run = || -> Result<f64, Failure> {
            let mut cutter = Cutter::new(&mover.surface);
            for _ in 0..CUTS_IN_STRETCH {
                let all = pieces(&mover.surface);
                let piece = all[below(&mut directions, all.len())];
                let sweep = through(&mover.surface, piece, &mut directions)?;
                cut(&mut mover, &mut cutter, &sweep, &CutParams::default())?;
            }
            mover.advance(FRAME, &GROUND, 600)?;
            Ok(mover.strain())
        };
        let found = run();
        worst.judge(found, || name.to_owned());
    }
    Ok(worst)
}

/// Cuts of the stretched body.
const CUTS_IN_STRETCH: u32 = 5;

fn through_pins(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let cuts = stage.pick(3, 20);
    let mut mover = stage.enter(ball(2, 0.8), &crate::motion::material())?;
    let top: Vec<VertexId> = (mover.surface.topology().vertices())
        .filter(|&v| mover.surface.position(v).y > 1.0)
        .collect();
    for &v in &top {
        mover.solver.pin(&mut mover.surface, v)?;
    }
    let places = mover.surface.positions.clone();
    let mut cutter = Cutter::new(&mover.surface);
    let mut directions = Directions(9);
    for number in 1..=cuts {
        let place = top[below(&mut directions, top.len())];
        let [x, y, z, _] = places[place.index()].map(f64::from);
        let normal = directions.next_unit();
        let d = normal.dot(&Vec3::new(x, y, z));
        let sweep = Sweep::across_box(normal.into(), d, &mover.surface.bounds())?;
        let found = cut(&mut mover, &mut cutter, &sweep, &CutParams::default());
        let found = found.and_then(|_| {
            mover.step(FRAME, &GROUND)?;
            let way = |v: VertexId| {
                let (now, then) = (mover.surface.positions[v.index()], places[v.index()]);
                (0..3)
                    .map(|k| f64::from((now[k] - then[k]).abs()))
                    .fold(0.0, larger)
            };
            let pins = mover.solver.pins().iter().map(|pin| pin.vertex);
            // Pins beyond the first vertices are none: new vertices are not pinned.
            Ok(pins.map(way).fold(0.0, larger))
        });
        let broken = found.is_err();
        worst.judge(found, || {
            format!("cut {number}, {} pins left", mover.solver.pins().len())
        });
        if broken {
            break;
        }
    }
    Ok(worst)
}
