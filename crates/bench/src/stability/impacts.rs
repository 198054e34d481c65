//! Falls, impacts and squeezing.

use super::audit::{Rule, energy_over, fastest, keeping};
use super::case::{Case, Found, Worst};
use super::failure::Failure;
use super::scenes::{FRAME, GROUND, HANGING, ball, materials, place};
use super::stage::{Mover, Stage};
use incise_mesh::{Vec3, VertexId, icosphere};
use incise_pbd_gpu::{Material, SolverParams};

pub(super) const CASES: [Case; 5] = [
    Case {
        id: "T13",
        torture: "falls on a face, an edge, a corner, the tip of a needle",
        law: "energy of what there was",
        bound: 1.01,
        run: falls,
    },
    Case {
        id: "T13",
        torture: "impact at 10 and 1000 m/s",
        law: "energy of what there was",
        bound: 1.01,
        run: impact_energy,
    },
    Case {
        id: "T13",
        torture: "impact at 10 and 1000 m/s",
        law: "depth below the ground [m]",
        bound: 0.0,
        run: impact_depth,
    },
    Case {
        id: "T10",
        torture: "ball squeezed through volume 0 to its opposite between pins, then let go",
        law: "mean strain after 10 s",
        bound: 0.05,
        run: squeezed,
    },
    Case {
        id: "T13",
        torture: "10 minutes at rest on the ground",
        law: "fastest vertex at the end [m/s]",
        bound: 1e-3,
        run: rest,
    },
];

/// An icosahedron half a meter around the origin that stands on a face, an edge or a corner, or is drawn
/// out to a needle of that height.
fn falling(name: &str) -> incise_mesh::Surface {
    let mut surface = icosphere(0, 0.5);
    let corner = |v: u32| surface.position(VertexId(v));
    let (a, twin) = (corner(0), {
        let topology = surface.topology();
        let h = topology.outgoing(VertexId(0));
        [topology.target(h), topology.origin(h.prev())]
    });
    let [b, c] = twin.map(|v| surface.position(v));
    let down = match name {
        "face" => a + b + c,
        "edge" => a + b,
        _ => a,
    };
    // Turns `down` to the ground: a reflection, twice.
    let from = down.normalize();
    let mirror = |p: Vec3, n: Vec3| p - n * (2.0 * p.dot(&n));
    let to = Vec3::new(0.0, -1.0, 0.0);
    let between = from + to;
    let stretch = if name == "needle" {
        Vec3::new(1e-2, 1.0, 1e-2)
    } else {
        Vec3::repeat(1.0)
    };
    let turn = |p: Vec3| {
        if between.norm() > 1e-6 {
            mirror(mirror(p, from), between.normalize())
        } else {
            Vec3::new(p.x, -p.y, -p.z)
        }
    };
    place(&mut surface, |p| {
        turn(p).component_mul(&stretch) + Vec3::new(0.0, 1.0, 0.0)
    });
    surface
}

fn falls(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let frames = stage.pick(60, 600);
    for name in ["face", "edge", "corner", "needle"] {
        for (kind, material) in materials() {
            let mut mover = stage.enter(falling(name), &material)?;
            let rule = Rule::above(0.0).within(5.0).recovering();
            let found = energy_over(&mut mover, FRAME, &GROUND, frames, rule);
            worst.judge(found, || format!("{name}, {kind}"));
        }
    }
    Ok(worst)
}

/// A ball that flies at the ground.
fn thrown<'a>(stage: &'a mut Stage, material: &Material, speed: f32) -> Result<Mover<'a>, Failure> {
    let mut mover = stage.enter(ball(2, 1.0), material)?;
    let vertices: Vec<VertexId> = mover.surface.topology().vertices().collect();
    for v in vertices {
        mover.solver.set_velocity(v, [0.3 * speed, -speed, 0.0])?;
    }
    Ok(mover)
}

fn impact_energy(stage: &mut Stage) -> Result<Worst, Failure> {
    impacts(stage, |mover, frames| {
        // As far as its speed carries it, and its fall.
        let seconds = f64::from(FRAME) * f64::from(frames);
        let way = 1.1 * fastest(&mover.solver) * seconds + 5.0 * seconds.powi(2);
        let rule = Rule::above(0.0).within(2.0 + way).recovering();
        energy_over(mover, FRAME, &GROUND, frames, rule)
    })
}

fn impact_depth(stage: &mut Stage) -> Result<Worst, Failure> {
    impacts(stage, |mover, frames| {
        let mut deepest = 0.0_f64;
        for _ in 0..frames {
            mover.step(FRAME, &GROUND)?;
            deepest = f64::max(deepest, -f64::from(mover.surface.bounds().min[1]));
        }
        Ok(deepest.into())
    })
}

/// Judges impacts at every speed, in every material.
fn impacts(
    stage: &mut Stage,
    judge: impl Fn(&mut Mover<'_>, u32) -> Result<Found, Failure>,
) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let frames = stage.pick(60, 300);
    for speed in [10.0, 1000.0] {
        for (name, material) in materials() {
            let mut mover = thrown(stage, &material, speed)?;
            let found = judge(&mut mover, frames);
            worst.judge(found, || format!("{speed} m/s, {name}"));
        }
    }
    Ok(worst)
}

/// Pins the ends of a ball at a height of 1 m, lets them pass each other in two seconds, and lets go.
///
/// # Errors
/// As [`Mover::step`].
pub(super) fn squeeze(mover: &mut Mover<'_>) -> Result<(), Failure> {
    let topology = mover.surface.topology();
    let ends: Vec<(VertexId, Vec3)> = topology
        .vertices()
        .map(|v| (v, mover.surface.position(v)))
        .filter(|(_, p)| (p.y - 1.0).abs() > 0.3)
        .collect();
    for &(v, _) in &ends {
        mover.solver.pin(&mut mover.surface, v)?;
    }
    for frame in 0..120_u8 {
        // From 1 to -1.
        let share = 1.0 - f64::from(frame) / 60.0;
        for &(v, p) in &ends {
            let to = Vec3::new(p.x, 1.0 + (p.y - 1.0) * share, p.z);
            (mover.solver).set_pin_target(v, incise_mesh::geometry::round(to))?;
        }
        mover.step(FRAME, &HANGING)?;
    }
    for &(v, _) in &ends {
        mover.solver.unpin(&mut mover.surface, v)?;
    }
    Ok(())
}

fn squeezed(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    for (name, material) in materials() {
        let mut mover = stage.enter(ball(2, 1.0), &material)?;
        let mut run = || -> Result<f64, Failure> {
            squeeze(&mut mover)?;
            mover.advance(FRAME, &GROUND, 600)?;
            Ok(mover.strain())
        };
        let found = run();
        worst.judge(found, || name.to_owned());
    }
    Ok(worst)
}

fn rest(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let minutes = stage.pick(1, 10);
    for (name, material) in materials() {
        let mut surface = ball(0, 0.5);
        place(&mut surface, |p| p);
        let mut mover = stage.enter(surface, &material)?;
        let params = SolverParams { ..GROUND };
        let rule = Rule::above(0.0).within(2.0).recovering();
        let found = keeping(&mut mover, FRAME, &params, minutes * 3600, rule);
        let found = found.map(|found| found.by(fastest(&mover.solver)));
        worst.judge(found, || name.to_owned());
    }
    Ok(worst)
}
