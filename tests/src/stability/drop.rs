//! Models dropped and cut in flight, over mixes of constraints, sizes and planes.

use super::group::Group;
use super::motions::whole;
use super::runner::{Runner, Subject};
use super::{Case, Found, Outcome, Run, larger};
use incise_mesh::{Surface, Undo};
use incise_models::scenes::cuts::dropped;
use incise_models::scenes::{FRAME, RelativePlane};
use incise_pbd_gpu::{InteriorSprings, Material, Volume};
use incise_scene::ContactParams;
use incise_test_support::energy::{elastic, mechanical};

pub(super) const CASES: [Case; 1] = [Case {
    id: "drop",
    stress: "models of 1 cm to 100 m, with and without volume, springs and contacts, dropped by \
             half their size and cut in flight",
    invariants: &[
        (
            "relative volume error of a piece from a second after the impact on",
            0.01,
        ),
        (
            "volume that a piece with volume or springs has lost at any time",
            INVERTED,
        ),
        (
            "distance of a vertex outside of what the fall can reach, in sizes",
            0.01,
        ),
        (
            "speed of a vertex, relative to a fall from the body's top",
            REBOUND,
        ),
        (
            "energy gained by undoing the cut 30 to 60 frames later, of that at the start",
            0.01,
        ),
    ],
    run: drops,
}];

/// A loss just below the whole volume: beyond it a piece is inverted.
const INVERTED: f64 = 1.0 - 1e-6;
/// A small mass on a large one rebounds at three times the speed of the fall.
const REBOUND: f64 = 3.0;

/// Triangles of the drops of one model, unless their number is given: large models drop less often.
const TRIANGLES: usize = 120_000;
/// Fewest drops of a model.
const FEWEST: usize = 4;
/// Number of drops of which one is repeated with an undo.
const UNDO_STRIDE: u32 = 3;
/// Simulated time \[s\].
const SECONDS: f32 = 5.0;
/// Gravitational acceleration [m/s^2].
const GRAVITY: f64 = 9.81;
/// Time after the impact from which volumes count \[s\].
const SETTLING: f64 = 1.0;

/// Largest sides of bodies \[m\].
const SIZES: [f64; 5] = [1.0, 0.01, 100.0, 0.1, 10.0];
/// Pairs of a mix and a size: the numbers of both are coprime. Also the most drops of a model.
const PAIRS: u32 = 40;
/// Planes, of which each model takes one per drop.
const PLANES: u32 = 20;
/// Seed of the planes.
const SEED: u64 = 17;

/// One drop.
#[derive(Debug, Clone, Copy)]
struct Sample<'a> {
    subject: &'a Subject,
    /// The number of the drop of this model: of its mix, size and plane.
    number: u32,
    plane: RelativePlane,
}

impl Sample<'_> {
    /// Returns whether the body has the first, second or third of volume, springs and contacts.
    fn has(&self, part: u32) -> bool {
        self.number & (1 << part) == 0
    }

    fn size(&self) -> f64 {
        SIZES[self.number as usize % SIZES.len()]
    }

    /// Returns the number of the plane of a drop.
    fn plane_number(number: u32) -> u32 {
        (number % PAIRS + number / PAIRS) % PLANES
    }

    /// Describes the drop for someone who wants to repeat it.
    fn describe(&self) -> String {
        let parts = ["volume", "springs", "contacts"].into_iter().zip(0..);
        let parts: Vec<&str> = parts
            .filter(|&(_, k)| self.has(k))
            .map(|(name, _)| name)
            .collect();
        let parts = match parts.is_empty() {
            true => "shell".to_owned(),
            false => parts.join("+"),
        };
        let (name, size, plane) = (
            &self.subject.name,
            self.size(),
            Self::plane_number(self.number),
        );
        format!("{name}, {size} m, {parts}, plane {plane}")
    }
}

/// Returns the first drops of a model, at most [`PAIRS`] times [`PLANES`].
///
/// The first 40 have every mix in every size; every plane is taken as often as the others.
fn samples(subject: &Subject, count: u32) -> Vec<Sample<'_>> {
    let planes = RelativePlane::seeded(SEED, PLANES);
    let numbered = |number| Sample {
        subject,
        number,
        plane: planes[Sample::plane_number(number) as usize],
    };
    (0..count.min(PAIRS * PLANES)).map(numbered).collect()
}

/// Drops all models, the largest first.
fn drops(runner: &Runner) -> Vec<Run> {
    let mut all = Vec::new();
    for subject in runner.subjects().iter().rev() {
        let usual = (TRIANGLES / subject.triangles().max(1)).max(FEWEST);
        let usual = u32::try_from(usual).map_or(PAIRS, |count| count.min(PAIRS));
        all.extend(samples(subject, runner.samples.unwrap_or(usual)));
    }
    if let Some(text) = &runner.matching {
        all.retain(|sample| sample.describe().contains(text));
    }
    runner.each(&all, |sample| {
        let mut at = sample.describe();
        let found = fall(runner, sample, &mut at);
        Run::new(at, found)
    })
}

/// A dropped body in its scene.
struct Dropped<'a> {
    sample: &'a Sample<'a>,
    group: Group,
    /// Height of the body's top at the start \[m\].
    top: f64,
    /// Time of the impact \[s\].
    impact: f64,
    /// Largest horizontal distance from the axis at the start \[m\].
    radius: f64,
    /// Rest volumes of pieces after the cut \[m^3\]; 0 for sheets and unused numbers.
    rest: Vec<f64>,
}

/// What a fall did to a body.
#[derive(Debug, Default)]
struct Fall {
    /// Largest relative volume error of a piece from a second after the impact on.
    volume_error: Option<f64>,
    /// Largest loss of a piece's volume at any time, relative to rest; 1 and more is inverted.
    loss: Option<f64>,
    /// Triangles of the piece with the largest loss, and its part of the body's volume.
    loser: Option<(usize, f64)>,
    /// Largest distance of a vertex outside of the box that the fall can reach \[sizes\].
    outside: f64,
    /// Largest speed of a vertex, relative to that of a fall from the body's top.
    speed: f64,
}

/// The energies of a body \[J\], and its mass \[kg\].
struct Energies {
    kinetic: f64,
    /// The kinetic and potential energy.
    mechanical: f64,
    elastic: f64,
    mass: f64,
}

impl<'a> Dropped<'a> {
    fn new(runner: &Runner, sample: &'a Sample<'a>) -> Found<Self> {
        let size = sample.size();
        let material = Material {
            volume: sample.has(0).then(Volume::default),
            interior_springs: sample.has(1).then(InteriorSprings::default),
            ..Material::default()
        };
        let contacts = sample.has(2).then(ContactParams::default);
        let surface = sample.subject.surface.clone();
        let group = Group::new(dropped(&runner.backend, surface, &material, contacts, size))?;
        let surface = group.body(0)?.surface();
        let all = surface.topology().vertices();
        let radius = all
            .map(|v| surface.position(v).xz().norm())
            .fold(0.0, f64::max);
        let top = f64::from(surface.bounds().max[1]);
        Ok(Self {
            sample,
            group,
            top,
            impact: (size / GRAVITY).sqrt(),
            radius,
            rest: Vec::new(),
        })
    }

    /// Falls half the way and cuts; returns the number of frames and the cut's undo.
    fn cut(&mut self) -> Found<(u32, Option<Undo>)> {
        #[expect(clippy::cast_possible_truncation, reason = "a number of frames")]
        let frames = whole(FRAME.recip() * self.impact as f32 / 2.0) - 1;
        self.group.step(frames)?;
        let (sweep, _) = self.sample.plane.sweep(self.group.body(0)?.surface())?;
        let [before, after] = sweep.ends();
        let scene = self.group.scene();
        let blade = scene.add_blade(before);
        scene.move_blade(blade, after)?;
        self.group.step(1)?;
        let scene = self.group.scene();
        if let Some(failed) = scene.failed_cuts().first() {
            return Err(failed.error.into());
        }
        let cut = (scene.cuts().iter()).find_map(|result| result.cut.as_ref());
        let undo = cut.and_then(|(_, outcome)| outcome.undo.clone());
        self.rest = rest_volumes(self.group.body(0)?.surface());
        Ok((frames + 1, undo))
    }

    /// Measures the state at a time \[s\].
    fn measure(&self, time: f64, fall: &mut Fall) -> Found<()> {
        let body = self.group.body(0)?;
        let (surface, solver) = (body.surface(), body.solver());
        let fastest = (2.0 * GRAVITY * self.top).sqrt();
        let reach = self.radius + fastest * time;
        let (mut outside, mut speed) = (0.0, 0.0);
        for v in surface.topology().vertices() {
            let p = surface.position(v);
            let beside = p.xz().norm() - reach;
            outside = larger(outside, beside.max(-p.y).max(p.y - self.top));
            let squares = solver.velocity(v).map(|c| f64::from(c).powi(2));
            speed = larger(speed, squares.iter().sum::<f64>().sqrt());
        }
        fall.outside = larger(fall.outside, outside / self.sample.size());
        fall.speed = larger(fall.speed, speed / fastest);
        let [has_volume, has_springs] = [0, 1].map(|part| self.sample.has(part));
        let whole: f64 = self.rest.iter().sum();
        let volumes = surface.piece_volumes().into_iter().zip(&self.rest);
        for ((volume, &rest), piece) in volumes.zip(0..) {
            if rest == 0.0 {
                continue;
            }
            // The wall of a cavity has two negative volumes.
            let ratio = volume / rest;
            let loss = 1.0 - ratio;
            if (has_volume || has_springs) && fall.loss.is_none_or(|most| loss > most) {
                fall.loss = Some(loss);
                fall.loser = Some((surface.piece_triangles(piece), rest / whole));
            }
            if has_volume && time >= self.impact + SETTLING {
                let error = (ratio - 1.0).abs();
                fall.volume_error = Some(larger(fall.volume_error.unwrap_or(0.0), error));
            }
        }
        Ok(())
    }

    fn energies(&mut self) -> Found<Energies> {
        let params = self.group.scene().params.solver;
        let body = self.group.body(0)?;
        let (surface, solver) = (body.surface(), body.solver());
        Ok(Energies {
            kinetic: solver.kinetic_energy(),
            mechanical: mechanical(surface, solver, &params, 0.0),
            elastic: elastic(surface, solver),
            mass: solver.total_mass(),
        })
    }
}

/// Returns the rest volumes of all piece numbers; 0 for sheets and unused numbers.
fn rest_volumes(surface: &Surface) -> Vec<f64> {
    let is_open = surface.open_pieces();
    let rest = |piece: u32| match is_open[piece as usize] {
        true => 0.0,
        false => {
            let all = surface.topology().triangles();
            surface.rest_volume_of(all.filter(|&t| surface.piece(t) == piece))
        }
    };
    (0..surface.piece_bound()).map(rest).collect()
}

/// Drops, cuts and measures a body; adds the piece that loses most volume to its description.
fn fall(runner: &Runner, sample: &Sample<'_>, at: &mut String) -> Found<Outcome> {
    let mut dropped = Dropped::new(runner, sample)?;
    let mut fall = Fall::default();
    let (first, _) = dropped.cut()?;
    for frame in first..whole(SECONDS / FRAME) {
        dropped.group.step(1)?;
        dropped.measure(f64::from(frame + 1) * f64::from(FRAME), &mut fall)?;
    }
    if let Some((triangles, part)) = fall.loser {
        *at += &format!(", piece of {triangles} triangles and {part:.1e} volumes");
    }
    let gain = match sample.number.is_multiple_of(UNDO_STRIDE) {
        true => undo(runner, sample, 30 + sample.number % 31)?,
        false => None,
    };
    let (outside, speed) = (Some(fall.outside), Some(fall.speed));
    Ok(vec![fall.volume_error, fall.loss, outside, speed, gain].into())
}

/// Drops and cuts a body, undoes the cut after some frames, and returns the energy that it gains
/// in a second, relative to that at the start; `None` if the plane misses.
///
/// Joining the pieces may lift them, which counts as no gain, but must not throw them: in the first
/// frame the kinetic energy is limited, afterwards the mechanical one.
fn undo(runner: &Runner, sample: &Sample<'_>, frames: u32) -> Found<Option<f64>> {
    let mut dropped = Dropped::new(runner, sample)?;
    let start = dropped.energies()?.mechanical;
    let (_, undo) = dropped.cut()?;
    let Some(undo) = undo else {
        return Ok(None);
    };
    dropped.group.step(frames)?;
    let before = dropped.energies()?;
    let body = dropped.group.only();
    dropped.group.scene().undo(body, undo)?;
    dropped.group.step(1)?;
    let joined = dropped.energies()?;
    // What gravity may add to the kinetic energy in a frame.
    let fall = GRAVITY * f64::from(FRAME) * (before.mass / 2.0).sqrt();
    let allowed = ((before.kinetic + before.elastic).sqrt() + fall).powi(2);
    let mut gain = larger(0.0, joined.kinetic - allowed);
    for _ in 0..whole(FRAME.recip()) {
        dropped.group.step(1)?;
        let now = dropped.energies()?;
        gain = larger(gain, now.mechanical - joined.mechanical - before.elastic);
    }
    Ok(Some(gain / start))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn forty_drops_have_all_mixes_in_all_sizes_and_all_are_different() {
        let subjects = Subject::built_in();
        let described = |count| -> Vec<String> {
            let samples = samples(&subjects[0], count);
            samples.iter().map(Sample::describe).collect()
        };
        let pairs: HashSet<String> = (described(40).iter())
            .map(|text| text.rsplit_once(", plane").unwrap().0.to_owned())
            .collect();
        assert_eq!(pairs.len(), 40, "{pairs:?}");
        let all: HashSet<String> = described(u32::MAX).into_iter().collect();
        assert_eq!(all.len(), 800, "{all:?}");
    }
}
