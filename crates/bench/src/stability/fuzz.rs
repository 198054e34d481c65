//! Bodies, materials, steps and edits at random, the same in every run.

use super::audit::{EnergyLaw, Rule, total};
use super::case::{Case, Found, Worst};
use super::cuts::{below, cut, pieces, through};
use super::failure::Failure;
use super::scenes::{GROUND, ball, double_cone, place, whole};
use super::sound::{followed, sound};
use super::stage::Stage;
use crate::directions::Directions;
use incise_cut::{CutParams, Cutter};
use incise_mesh::{Surface, Vec3, VertexId, cube_sphere, torus};
use incise_pbd_gpu::{Density, Material, SolverParams, Stiffness};

pub(super) const CASES: [Case; 2] = [
    Case {
        id: "T18",
        torture: "bodies, materials, steps, pins and cuts at random",
        law: "topology, colors, tree; change of mass, momentum, volume",
        bound: 1e-5,
        run: fuzz,
    },
    Case {
        id: "T18",
        torture: "bodies and compliances at random, without damping, let move for seconds",
        law: "energy of the most in any second before",
        bound: 1.01,
        run: trend,
    },
];

/// A number between two, its logarithm at random.
#[expect(
    clippy::cast_possible_truncation,
    reason = "a number is rounded to storage"
)]
pub(super) fn log(directions: &mut Directions, low: f64, high: f64) -> f32 {
    let part = f64::midpoint(directions.next(), 1.0);
    (low * (high / low).powf(part)) as f32
}

fn shape(directions: &mut Directions) -> Result<Surface, Failure> {
    let mut surface = match below(directions, 5) {
        0 => ball(0, 0.0),
        1 => ball(2, 0.0),
        2 => torus(0.35, 0.15, 12, 6),
        3 => cube_sphere(4, 0.5),
        _ => double_cone(70)?,
    };
    let scale = f64::from(log(directions, 0.1, 10.0));
    let axes = Vec3::from_fn(|_, _| 1.0 + 0.5 * directions.next()) * scale;
    let up = Vec3::new(0.0, 1.5 * scale, 0.0);
    place(&mut surface, |p| p.component_mul(&axes) + up);
    Ok(surface)
}

fn stiffness(directions: &mut Directions) -> Stiffness {
    if directions.next() > 0.0 {
        Stiffness::Pbd(log(directions, 0.1, 1.0))
    } else {
        Stiffness::Compliance(log(directions, 1e-9, 1e-1))
    }
}

fn material(directions: &mut Directions) -> Material {
    Material {
        density: Density::Area(log(directions, 1e-2, 1e2)),
        stretch: stiffness(directions),
        bending: (directions.next() > -0.5).then(|| stiffness(directions)),
        volume: None,
        struts: None,
        damping: log(directions, 1e-3, 1.0),
        friction: log(directions, 1e-3, 1.0),
    }
}

fn steps(directions: &mut Directions) -> (f32, SolverParams) {
    let params = SolverParams {
        iterations: if directions.next() > 0.0 { 1 } else { 10 },
        substeps: if directions.next() > 0.0 { 1 } else { 5 },
        ground: (directions.next() > 0.0).then_some(0.0),
        ..GROUND
    };
    (log(directions, 1e-3, 1.0 / 30.0), params)
}

/// One body: the largest change of a sum by a cut.
fn one(stage: &mut Stage, directions: &mut Directions) -> Result<f64, Failure> {
    let (surface, material) = (shape(directions)?, material(directions));
    let (dt, params) = steps(directions);
    let mut mover = stage.enter(surface, &material)?;
    crate::motion::start(&mut mover.solver, &mover.surface)?;
    let mut cutter = Cutter::new(&mover.surface);
    let mut most: f64 = 0.0;
    for _ in 0..3 {
        if directions.next() > 0.3 {
            let slots = mover.surface.topology().vertex_slots();
            let v = VertexId::from_index(below(directions, slots));
            if !mover.surface.topology().outgoing(v).is_null() {
                mover.solver.pin(&mut mover.surface, v)?;
            }
        }
        mover.advance(dt, &params, 10)?;
        let all = pieces(&mover.surface);
        let piece = all[below(directions, all.len())];
        let sweep = through(&mover.surface, piece, directions)?;
        most = most.max(cut(&mut mover, &mut cutter, &sweep, &CutParams::default())?);
    }
    mover.advance(dt, &params, 10)?;
    sound(&mover.surface)?;
    cutter.refit(&mover.surface);
    followed(&mover.surface, &mover.solver, &cutter)?;
    Ok(most)
}

fn fuzz(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    for seed in 0..stage.pick(20, 500) {
        let found = one(stage, &mut Directions(seed));
        worst.judge(found, || format!("seed {seed}"));
    }
    Ok(worst)
}

/// One body without damping: the most energy in any second of what there was in a second before. Energy
/// is only known of materials with compliance.
fn undamped(stage: &mut Stage, directions: &mut Directions) -> Result<Found, Failure> {
    let surface = shape(directions)?;
    let compliance =
        |directions: &mut Directions| Stiffness::Compliance(log(directions, 1e-9, 1e-1));
    let material = Material {
        stretch: compliance(directions),
        bending: (directions.next() > -0.5).then(|| compliance(directions)),
        damping: 0.0,
        ..material(directions)
    };
    let (dt, params) = steps(directions);
    let seconds = stage.pick(2, 3);
    let mut mover = stage.enter(surface, &material)?;
    crate::motion::start(&mut mover.solver, &mover.surface)?;
    let mut law = EnergyLaw::start(&mover, &params, Rule::above(0.0));
    for _ in 0..seconds {
        let mut most = f64::NEG_INFINITY;
        for _ in 0..whole(1.0 / dt) {
            mover.step(dt, &params)?;
            law.look(&mover, &params);
            most = most.max(total(&mover, &params, 0.0));
        }
        law.lower(most);
    }
    Ok(law.found())
}

fn trend(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    for seed in 1000..1000 + stage.pick(2, 40) {
        let found = undamped(stage, &mut Directions(seed));
        worst.judge(found, || format!("seed {seed}"));
    }
    Ok(worst)
}
