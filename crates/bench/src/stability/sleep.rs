//! Bodies of a scene that come to rest, are cut in their sleep, fall asleep and wake.

use super::alike::apart;
use super::case::{Case, Worst};
use super::cuts::{below, pieces, through};
use super::failure::Failure;
use super::scenes::{FRAME, GROUND, ball, materials};
use super::sound::{Sums, followed, sound};
use super::stage::Stage;
use crate::directions::Directions;
use incise_cut::{Cutter, Sweep};
use incise_mesh::Surface;
use incise_pbd_gpu::{Material, SolverParams};
use incise_scene::{BladeId, BodyId, Scene, SceneParams, SleepParams};

pub(super) const CASES: [Case; 4] = [
    Case {
        id: "T12",
        torture: "cuts through a body that sleeps on the ground: it wakes, and sleeps again",
        law: "topology, colors; change of mass, momentum, volume",
        bound: 1e-5,
        run: |stage| Ok(cut_asleep(stage)?.sums),
    },
    Case {
        id: "T12",
        torture: "cuts through a body that sleeps on the ground: it wakes, and sleeps again",
        law: "time until it sleeps again [s]",
        bound: 60.0,
        run: |stage| Ok(cut_asleep(stage)?.seconds),
    },
    Case {
        id: "T13",
        torture: "10 minutes at rest on the ground, whole and in pieces",
        law: "time until it sleeps for good [s]",
        bound: 60.0,
        run: falls_asleep,
    },
    Case {
        id: "T14",
        torture: "a body falls asleep and is woken 1e5 times",
        law: "way of any vertex [m]",
        bound: 1e-4,
        run: sleeps_and_wakes,
    },
];

/// The longest that anybody waits for a body to fall asleep \[frames\]: a second more than the laws allow.
const PATIENCE: u32 = 3660;

/// Where a blade waits: far above.
const AWAY: [[f32; 3]; 2] = [[-1.0, 90.0, 0.0], [1.0, 90.0, 0.0]];

/// A scene with one body on the ground and a blade that is far away.
fn lay_down(
    stage: &Stage,
    surface: Surface,
    material: &Material,
) -> Result<(Scene, BodyId, BladeId), Failure> {
    let params = SceneParams {
        dt: FRAME,
        solver: GROUND,
        ..SceneParams::default()
    };
    let mut scene = stage.scene(params)?;
    let body = scene.add_body(surface, material)?;
    let blade = scene.add_blade(AWAY);
    Ok((scene, body, blade))
}

/// Steps until a body sleeps, or for [`PATIENCE`]; tells how long it took \[s\].
fn settle(scene: &mut Scene, body: BodyId) -> Result<f64, Failure> {
    let mut frames = 0;
    while !scene.is_asleep(body) && frames < PATIENCE {
        scene.step()?;
        frames += 1;
    }
    Ok(f64::from(frames) * f64::from(FRAME))
}

/// Steps until a body sleeps.
///
/// # Errors
/// [`Failure::Law`] when it does not.
fn wait(scene: &mut Scene, body: BodyId) -> Result<(), Failure> {
    let seconds = settle(scene, body)?;
    if scene.is_asleep(body) {
        return Ok(());
    }
    Err(Failure::Law(format!("no sleep within {seconds:.0} s")))
}

/// Moves a blade along a sweep in the next frame.
fn swing(scene: &mut Scene, blade: BladeId, sweep: &Sweep) {
    let [a, b, c, d] = sweep.corners();
    scene.jump_blade(blade, [a, b]);
    scene.move_blade(blade, [d, c]);
}

/// Where a body's vertices are, and how fast: it may not change while it sleeps.
fn state(scene: &mut Scene, body: BodyId) -> Result<Vec<[f32; 4]>, Failure> {
    scene.read(body)?;
    let body = scene.body(body);
    let (places, velocities) = (&body.surface().positions, body.solver().velocities());
    Ok(places.iter().chain(velocities).copied().collect())
}

/// Cuts a body that sleeps: the largest change of a sum.
fn cut_once(
    scene: &mut Scene,
    body: BodyId,
    blade: BladeId,
    directions: &mut Directions,
) -> Result<f64, Failure> {
    scene.read(body)?;
    let surface = scene.body(body).surface();
    let all = pieces(surface);
    let piece = all[below(directions, all.len())];
    let sweep = through(surface, piece, directions)?;
    let before = Sums::of(surface, scene.body(body).solver());
    scene.set_blade_piece(blade, Some(piece));
    swing(scene, blade, &sweep);
    let refused = scene.cut()?.refused;
    let moved = match scene.outcomes() {
        [(_, outcome)] => outcome.report.moved_volume,
        _ if refused > 0 => return Ok(0.0),
        _ => return Err(Failure::Law("the blade went through uncut".to_owned())),
    };
    if scene.is_asleep(body) {
        return Err(Failure::Law("what was cut sleeps on".to_owned()));
    }
    let (surface, solver) = (scene.body(body).surface(), scene.body(body).solver());
    sound(surface)?;
    followed(surface, solver, &Cutter::new(surface))?;
    let change = before.change(&Sums::of(surface, solver), moved);
    scene.advance()?;
    scene.jump_blade(blade, AWAY);
    Ok(change)
}

/// Cuts where a body that sleeps is not.
fn cut_elsewhere(scene: &mut Scene, body: BodyId, blade: BladeId) -> Result<(), Failure> {
    let at_rest = state(scene, body)?;
    scene.move_blade(blade, AWAY.map(|[x, y, z]| [x, y, z + 1.0]));
    scene.step()?;
    scene.jump_blade(blade, AWAY);
    if scene.is_asleep(body) && state(scene, body)? == at_rest {
        return Ok(());
    }
    Err(Failure::Law("a cut far away woke it".to_owned()))
}

/// What cuts of bodies that sleep came to, by two laws.
#[derive(Debug, Clone, Default)]
pub(super) struct CutAsleep {
    /// The largest change of a sum.
    sums: Worst,
    /// The longest time until the body slept \[s\].
    seconds: Worst,
}

fn cut_asleep(stage: &mut Stage) -> Result<CutAsleep, Failure> {
    if let Some(known) = &stage.cut_asleep {
        return Ok(known.clone());
    }
    let mut found = CutAsleep::default();
    let (kinds, cuts) = stage.pick((1, 6), (3, 8));
    for (name, material) in materials().into_iter().take(kinds) {
        let (mut scene, body, blade) = lay_down(stage, ball(0, 0.6), &material)?;
        let mut directions = Directions(13);
        for number in 1..=cuts {
            let told = || format!("{name}, cut {number}");
            let seconds = settle(&mut scene, body)?;
            found.seconds.judge(Ok(seconds), told);
            // One that does not sleep is none of those that this is about.
            if !scene.is_asleep(body) {
                break;
            }
            let change = cut_elsewhere(&mut scene, body, blade)
                .and_then(|()| cut_once(&mut scene, body, blade, &mut directions));
            let broken = change.is_err();
            found.sums.judge(change, told);
            if broken {
                break;
            }
        }
    }
    stage.cut_asleep = Some(found.clone());
    Ok(found)
}

/// After which time a body sleeps and does not wake again \[s\].
fn falls_asleep_once(
    stage: &Stage,
    cuts: u32,
    material: &Material,
    minutes: u32,
) -> Result<f64, Failure> {
    let (mut scene, body, blade) = lay_down(stage, ball(0, 0.5), material)?;
    let mut directions = Directions(14);
    for _ in 0..cuts {
        scene.read(body)?;
        let surface = scene.body(body).surface();
        let sweep = through(surface, pieces(surface)[0], &mut directions)?;
        swing(&mut scene, blade, &sweep);
        scene.step()?;
    }
    scene.jump_blade(blade, AWAY);
    let (mut awake, mut asleep) = (0, None);
    for frame in 1..=minutes * 3600 {
        scene.step()?;
        if !scene.is_asleep(body) {
            (awake, asleep) = (frame, None);
        } else if asleep.is_none() {
            asleep = Some(state(&mut scene, body)?);
        }
    }
    if let Some(then) = asleep
        && state(&mut scene, body)? != then
    {
        return Err(Failure::Law("it moved in its sleep".to_owned()));
    }
    Ok(f64::from(awake) * f64::from(FRAME))
}

fn falls_asleep(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let minutes = stage.pick(2, 10);
    for (name, material) in materials() {
        for cuts in [0, 2] {
            let found = falls_asleep_once(stage, cuts, &material, minutes);
            worst.judge(found, || format!("{name}, cut {cuts} times"));
        }
    }
    Ok(worst)
}

/// How far a body has come that fell asleep and was woken so often \[m\].
fn cycle(stage: &Stage, material: &Material, times: u32) -> Result<f64, Failure> {
    let (mut scene, body, _) = lay_down(stage, ball(0, 0.5), material)?;
    scene.params.solver = SolverParams {
        iterations: 1,
        ..GROUND
    };
    // Sleep stops whoever is slow. What is left of the way to rest is none of its doing, so it is gone first.
    scene.params.sleep = None;
    for _ in 0..PATIENCE {
        scene.step()?;
    }
    // As often as can be: it is looked at in a single frame.
    scene.params.sleep = Some(SleepParams {
        seconds: 0.0,
        ..SleepParams::default()
    });
    scene.step()?;
    wait(&mut scene, body)?;
    scene.read(body)?;
    let start = scene.body(body).surface().positions.clone();
    for _ in 0..times {
        scene.wake(body);
        wait(&mut scene, body)?;
    }
    scene.read(body)?;
    Ok(apart(&start, &scene.body(body).surface().positions))
}

fn sleeps_and_wakes(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let full = if stage.device.is_some() {
        1000
    } else {
        100_000
    };
    let times = stage.pick(full.min(1000), full);
    for (name, material) in materials() {
        let found = cycle(stage, &material, times);
        worst.judge(found, || format!("{name}, {times} times"));
    }
    Ok(worst)
}
