//! Ten million substeps.

use super::audit::mechanical;
use super::case::{Case, Worst};
use super::failure::Failure;
use super::scenes::{HANGING, WEIGHTLESS, ball, elastic_shell};
use super::stage::Stage;
use incise_mesh::{Vec3, VertexId};
use incise_pbd_gpu::{Material, SolverParams};

pub(super) const CASES: [Case; 3] = [
    Case {
        id: "T14",
        torture: "a body hangs for 1e7 substeps",
        law: "way of its middle after the first tenth [m]",
        bound: 1e-4,
        run: hangs,
    },
    Case {
        id: "T14",
        torture: "a body flies and spins for 1e7 substeps",
        law: "change of momentum, of the first",
        bound: 1e-3,
        run: keeps_momentum,
    },
    Case {
        id: "T14",
        torture: "a body flies and spins for 1e7 substeps",
        law: "energy of what there was",
        bound: 1.01,
        run: keeps_energy,
    },
];

/// The time step of a substep \[s\].
const STEP: f32 = 1.0 / 600.0;
/// Substeps of a frame: devices are asked less often.
const SUBSTEPS: u32 = 1000;

fn params(of: SolverParams) -> SolverParams {
    SolverParams {
        iterations: 1,
        substeps: SUBSTEPS,
        ..of
    }
}

/// Frames of a run; of a device, which may be software, a tenth.
fn frames(stage: &Stage) -> u32 {
    let full = if stage.device.is_some() { 1000 } else { 10_000 };
    stage.pick(60, full)
}

fn middle(surface: &incise_mesh::Surface) -> Vec3 {
    let all = surface.topology().vertices();
    let sum: Vec3 = all.map(|v| surface.position(v)).sum();
    sum / surface.topology().vertex_count() as f64
}

fn hangs(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let frames = frames(stage);
    let material = Material {
        damping: 5.0,
        ..elastic_shell(1e-4, 1e-2)
    };
    let mut mover = stage.enter(ball(0, 0.0), &material)?;
    mover.solver.pin(&mut mover.surface, VertexId(0))?;
    let params = params(HANGING);
    let dt = STEP * SUBSTEPS as f32;
    mover.advance(dt, &params, frames / 10)?;
    let settled = middle(&mover.surface);
    let mut run = || -> Result<f64, Failure> {
        let mut most: f64 = 0.0;
        for _ in 0..9 {
            mover.advance(dt, &params, frames / 10)?;
            most = most.max((middle(&mover.surface) - settled).norm());
        }
        Ok(most)
    };
    let found = run();
    worst.judge(found, || format!("{} substeps", frames * SUBSTEPS));
    Ok(worst)
}

/// The largest energy of a spinning body, of the first, and the largest change of its momentum.
fn spin(stage: &mut Stage) -> Result<[f64; 2], Failure> {
    if let Some(known) = stage.spun {
        return Ok(known);
    }
    let found = spin_anew(stage)?;
    stage.spun = Some(found);
    Ok(found)
}

fn spin_anew(stage: &mut Stage) -> Result<[f64; 2], Failure> {
    let frames = frames(stage);
    let mut mover = stage.enter(ball(0, 0.0), &elastic_shell(1e-4, 1e-2))?;
    let vertices: Vec<VertexId> = mover.surface.topology().vertices().collect();
    for v in vertices {
        let [x, y, z, _] = mover.surface.positions[v.index()];
        // Slow enough to stay near: a meter in four hours.
        let to = [1e-4 + 2.0 * z, 0.1 * x, -2.0 * x + 0.2 * y];
        mover.solver.set_velocity(v, to)?;
    }
    let params = params(WEIGHTLESS);
    let energy = mechanical(&mover.surface, &mover.solver, &params, 0.0);
    let momentum = Vec3::from(mover.solver.momentum());
    let scale = mover.solver.total_mass() * super::audit::fastest(&mover.solver);
    let mut most = [0.0_f64; 2];
    for _ in 0..10 {
        mover.advance(STEP * SUBSTEPS as f32, &params, frames / 10)?;
        let now = mechanical(&mover.surface, &mover.solver, &params, 0.0);
        let change = (Vec3::from(mover.solver.momentum()) - momentum).norm();
        most = [most[0].max(now / energy), most[1].max(change / scale)];
    }
    Ok(most)
}

fn keeps_momentum(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let found = spin(stage).map(|[_, momentum]| momentum);
    worst.judge(found, || format!("{} substeps", frames(stage) * SUBSTEPS));
    Ok(worst)
}

fn keeps_energy(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let found = spin(stage).map(|[energy, _]| energy);
    worst.judge(found, || format!("{} substeps", frames(stage) * SUBSTEPS));
    Ok(worst)
}
