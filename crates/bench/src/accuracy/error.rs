//! Errors of a motion against a reference motion.

use super::scene::Scene;
use crate::motion::{Body, DT};
use incise_reference::{Model, ReferenceError, State};
use nalgebra::Vector3;
use serde::Serialize;

/// Errors over all frame ends.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Errors {
    /// Mass-weighted root mean square position error, over the mean rest length.
    pub(super) position: f64,
    /// Largest vertex error of all frames, over the mean rest length.
    pub(super) farthest: f64,
    /// Relative error of the force on the pins over all frames; none without pins.
    pub(super) force: Option<f64>,
    /// Error of the root mean square strain, in the worst frame.
    pub(super) strain: f64,
    /// Error of the largest edge strain, in the worst frame.
    pub(super) largest_strain: f64,
    /// Error of the enclosed volume, over that at the start; none for open surfaces.
    pub(super) volume: Option<f64>,
    /// Energy error at the end per second, over the largest kinetic energy.
    pub(super) energy: f64,
    /// Relative error of the sag; none without pins or gravity.
    pub(super) sag: Option<f64>,
}

/// Computes errors of one scene.
pub(super) struct ErrorMeasure {
    pub(super) model: Model,
    pub(super) start: State,
    /// Triangles of a closed surface, empty for an open one.
    triangles: Vec<[usize; 3]>,
    /// Whether the body has pins.
    is_held: bool,
}

impl ErrorMeasure {
    /// Returns the measure of a scene and its body at the start.
    pub(super) fn new(scene: &Scene, body: &Body) -> Result<Self, ReferenceError> {
        let topology = body.surface.topology();
        let corners = |t| topology.triangle(t).map(|v| v.index());
        Ok(Self {
            model: Model::of(&body.solver, &body.surface, &scene.params(1, 1))?,
            start: State::of(&body.solver, &body.surface),
            triangles: match topology.is_closed() {
                true => topology.triangles().map(corners).collect(),
                false => Vec::new(),
            },
            is_held: !scene.pins.is_empty(),
        })
    }

    /// Returns the errors of a motion.
    pub(super) fn errors(&self, found: &[State], reference: &[State]) -> Errors {
        let model = &self.model;
        let length = mean_length(model);
        let pairs = || found.iter().zip(reference);
        let farthest = pairs()
            .flat_map(|(a, b)| a.x.iter().zip(&b.x))
            .fold(0.0, |far: f64, (a, b)| far.max((a - b).norm()));
        let worst = |quantity: &dyn Fn(&State) -> f64| {
            let changes = pairs().map(|(a, b)| (quantity(a) - quantity(b)).abs());
            changes.fold(0.0, f64::max)
        };
        let mean_strain = |state: &State| {
            let strains = model.strains(state);
            let sum: f64 = strains.iter().map(|s| s * s).sum();
            (sum / strains.len().max(1) as f64).sqrt()
        };
        let largest_strain = |state: &State| {
            let strains = model.strains(state);
            strains.iter().fold(0.0, |far: f64, s| far.max(s.abs()))
        };
        let volume = |state: &State| volume(&self.triangles, state);
        let is_closed = !self.triangles.is_empty();
        Errors {
            position: distance(model, found, reference),
            farthest: farthest / length,
            force: self.force(found, reference),
            strain: worst(&mean_strain),
            largest_strain: worst(&largest_strain),
            volume: is_closed.then(|| worst(&volume) / volume(&self.start).abs()),
            energy: self.energy(found, reference),
            sag: (self.sag(found).zip(self.sag(reference)))
                .map(|(found, reference)| (found / reference - 1.0).abs()),
        }
    }

    /// Returns the largest way of a vertex along gravity in any frame \[m\]; the phase of an
    /// oscillation does not matter. None without pins or gravity.
    pub(super) fn sag(&self, states: &[State]) -> Option<f64> {
        let down = self.model.gravity.try_normalize(0.0)?;
        let way = |(x, start): (&Vector3<f64>, &Vector3<f64>)| down.dot(&(x - start));
        let ways = (states.iter()).flat_map(|state| state.x.iter().zip(&self.start.x).map(way));
        let farthest = ways.fold(0.0, f64::max);
        (self.is_held && farthest > 0.0).then_some(farthest)
    }

    /// Returns the relative error of the pin force, which follows from the momentum of the rest.
    fn force(&self, found: &[State], reference: &[State]) -> Option<f64> {
        let model = &self.model;
        if !self.is_held {
            return None;
        }
        let weight = model.gravity * model.mass.iter().sum::<f64>();
        let forces = |states: &[State]| -> Vec<_> {
            let mut before = model.momentum(&self.start);
            let of = |state: &State| {
                let now = model.momentum(state);
                let force = (now - before) / f64::from(DT) - weight;
                before = now;
                force
            };
            states.iter().map(of).collect()
        };
        let (found, reference) = (forces(found), forces(reference));
        let off: f64 = (found.iter().zip(&reference))
            .map(|(a, b)| (a - b).norm_squared())
            .sum();
        let all: f64 = reference.iter().map(|f| f.norm_squared()).sum();
        Some((off / all).sqrt())
    }

    fn energy(&self, found: &[State], reference: &[State]) -> f64 {
        let model = &self.model;
        let (Some(a), Some(b)) = (found.last(), reference.last()) else {
            return 0.0;
        };
        let total = |s: &State| model.kinetic_energy(s) + model.potential_energy(s);
        let motion = |most: f64, s| most.max(model.kinetic_energy(s));
        let largest = reference.iter().fold(0.0, motion);
        let seconds = f64::from(DT) * reference.len() as f64;
        (total(a) - total(b)).abs() / largest / seconds
    }
}

/// Returns the mass-weighted root mean square distance of all positions in all frames, over the
/// mean rest length.
pub(super) fn distance(model: &Model, found: &[State], reference: &[State]) -> f64 {
    let mass: f64 = model.mass.iter().sum();
    let mut sum = 0.0;
    for (a, b) in found.iter().zip(reference) {
        let each = a.x.iter().zip(&b.x).zip(&model.mass);
        sum += each
            .map(|((a, b), m)| m * (a - b).norm_squared())
            .sum::<f64>()
            / mass;
    }
    (sum / reference.len() as f64).sqrt() / mean_length(model)
}

fn mean_length(model: &Model) -> f64 {
    model.stretch.rest.iter().sum::<f64>() / model.stretch.rest.len() as f64
}

fn volume(triangles: &[[usize; 3]], state: &State) -> f64 {
    let cone = |t: &[usize; 3]| {
        let [a, b, c] = t.map(|v| state.x[v]);
        a.dot(&b.cross(&c)) / 6.0
    };
    triangles.iter().map(cone).sum()
}
