//! Cuts of sleeping bodies, which wake and sleep again.

use super::case::{Case, Worst};
use super::cuts::{below, pieces, through};
use super::error::StressError;
use super::runner::Runner;
use super::scenes::{FRAME, GROUND, ball, materials};
use crate::directions::Directions;
use incise_cut::Sweep;
use incise_mesh::Surface;
use incise_pbd_gpu::Material;
use incise_scene::{BladeId, BodyId, Scene, SceneParams};

pub(super) const CASES: [Case; 1] = [Case {
    id: "T12",
    stress: "cuts through a sleeping body on the ground, which wakes and sleeps again",
    invariant: "time until it sleeps again [s]",
    bound: 60.0,
    run: cut_asleep,
}];

/// Longest wait for a body to sleep \[frames\]: a second beyond the bound.
const MAX_FRAMES: u32 = 3660;

/// The blade's position between cuts, far above.
const AWAY: [[f32; 3]; 2] = [[-1.0, 90.0, 0.0], [1.0, 90.0, 0.0]];

/// Returns a scene with one body on the ground and a blade far away.
fn lay_down(
    runner: &Runner,
    surface: Surface,
    material: &Material,
) -> Result<(Scene, BodyId, BladeId), StressError> {
    let params = SceneParams {
        dt: FRAME,
        solver: GROUND,
        ..SceneParams::default()
    };
    let mut scene = runner.scene(params)?;
    let body = scene.add_body(surface, material)?;
    let blade = scene.add_blade(AWAY);
    Ok((scene, body, blade))
}

/// Steps until a body sleeps, at most for [`MAX_FRAMES`]; returns the time \[s\].
fn settle(scene: &mut Scene, body: BodyId) -> Result<f64, StressError> {
    let mut frames = 0;
    while !scene.is_asleep(body)? && frames < MAX_FRAMES {
        scene.step()?;
        frames += 1;
    }
    Ok(f64::from(frames) * f64::from(FRAME))
}

/// Moves a blade along a sweep in the next frame.
fn swing(scene: &mut Scene, blade: BladeId, sweep: &Sweep) -> Result<(), StressError> {
    let [before, after] = sweep.ends();
    scene.teleport_blade(blade, before)?;
    Ok(scene.move_blade(blade, after)?)
}

/// Cuts a random piece of a sleeping body, which must wake.
///
/// # Errors
/// [`StressError::Invariant`] when the body sleeps on after a cut.
fn cut_once(
    scene: &mut Scene,
    body: BodyId,
    blade: BladeId,
    directions: &mut Directions,
) -> Result<(), StressError> {
    scene.read_back(body)?;
    let surface = scene.body(body)?.surface();
    let all = pieces(surface);
    let piece = all[below(directions, all.len())];
    let sweep = through(surface, Some(piece), directions)?;
    scene.set_blade_piece(blade, Some(piece))?;
    swing(scene, blade, &sweep)?;
    let was_cut = scene.cut()?.failed_cuts == 0;
    if was_cut && scene.is_asleep(body)? {
        let why = "the body sleeps on after a cut".to_owned();
        return Err(StressError::Invariant(why));
    }
    scene.advance()?;
    Ok(scene.teleport_blade(blade, AWAY)?)
}

fn cut_asleep(runner: &mut Runner) -> Result<Worst, StressError> {
    let mut worst = Worst::default();
    let (kinds, cuts) = runner.pick((1, 6), (3, 8));
    for (name, material) in materials().into_iter().take(kinds) {
        let (mut scene, body, blade) = lay_down(runner, ball(0, 0.6), &material)?;
        let mut directions = Directions(13);
        for number in 1..=cuts {
            let context = || format!("{name}, cut {number}");
            let seconds = settle(&mut scene, body)?;
            worst.judge(Ok(seconds), context);
            // The next cut needs a sleeping body.
            if !scene.is_asleep(body)? {
                break;
            }
            if let Err(error) = cut_once(&mut scene, body, blade, &mut directions) {
                worst.judge(Err::<f64, _>(error), context);
                break;
            }
        }
    }
    Ok(worst)
}
