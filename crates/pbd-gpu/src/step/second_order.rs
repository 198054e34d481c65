//! Second-order substeps (BDF2), composed of the first-order substeps of a backend.
//!
//! The second backward difference formula is `(3 x' - 4 x + x0) / 2h = v'`, and the same for
//! velocities. It equals a substep of implicit Euler of length `2h / 3` from `(4 x - x0) / 3` and
//! `(4 v - v0) / 3`. Only the start of a substep changes, so kernels and plans are the same.

use crate::error::StepError;
use crate::particles::Pin;
use crate::step::backend::Backend;
use crate::step::body::Body;
use crate::step::constants::StepConstants;
use crate::step::params::StepStats;
use crate::step::plan::StepPlan;

/// Length of the first-order substep relative to the second-order one that it is part of.
pub(crate) const SUBSTEP_RATIO: f32 = 2.0 / 3.0;

/// The motion of a body over the last two substeps.
#[derive(Debug, Clone, Default)]
pub(crate) struct History {
    /// Positions and velocities one substep ago, shape [vertex slots].
    before: [Vec<[f32; 4]>; 2],
    /// Positions and velocities at the end of the last frame, shape [vertex slots].
    end: [Vec<[f32; 4]>; 2],
    /// Length of its substeps \[s\].
    h: f32,
    /// True if `before` precedes the current state by one smooth substep.
    is_valid: bool,
    /// Pins with their targets of a substep.
    pins: Vec<Pin>,
}

/// Constants of single substeps of first and second order.
pub(crate) struct Orders {
    pub(crate) first: StepConstants,
    pub(crate) second: StepConstants,
}

impl History {
    /// Makes the next substep one of first order.
    pub(crate) fn forget(&mut self) {
        self.is_valid = false;
    }

    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        let arrays = self.before.iter().chain(&self.end);
        arrays.map(Vec::capacity).sum::<usize>() + self.pins.capacity()
    }

    /// Steps a body by a frame of `substeps`, with second order where the history is valid.
    ///
    /// # Errors
    /// As [`Backend::execute`].
    pub(crate) fn execute(
        &mut self,
        backend: &mut impl Backend,
        plan: &StepPlan,
        orders: &Orders,
        substeps: u32,
        body: &mut Body<'_>,
    ) -> Result<StepStats, StepError> {
        let h = orders.first.h;
        // Any change of position, mass, pin or topology changes one of these numbers.
        let is_continued = self.h.to_bits() == h.to_bits()
            && self.end[0] == *body.positions
            && self.end[1] == *body.velocities;
        self.is_valid &= is_continued;
        self.h = h;
        let targets = body.pins;
        let mut pins = std::mem::take(&mut self.pins);
        let mut sum = StepStats::default();
        let mut done = Ok(());
        for substep in 0..substeps {
            let substeps_left = substeps - substep;
            let positions = &*body.positions;
            pins.clear();
            pins.extend(
                targets
                    .iter()
                    .map(|pin| advance_pin(pin, positions, substeps_left)),
            );
            let mut extrapolated = 0.0;
            let constants = if self.is_valid {
                extrapolated = extrapolate(body.positions, &mut self.before[0]);
                extrapolate(body.velocities, &mut self.before[1]);
                &orders.second
            } else {
                copy(&mut self.before[0], body.positions);
                copy(&mut self.before[1], body.velocities);
                &orders.first
            };
            let mut part = Body {
                positions: &mut *body.positions,
                velocities: &mut *body.velocities,
                stretch: &mut *body.stretch,
                bending: body.bending.as_deref_mut(),
                interior_springs: body.interior_springs.as_deref_mut(),
                colliders: body.colliders,
                contacts: &mut *body.contacts,
                volumes: &mut *body.volumes,
                topology: body.topology,
                patches: &mut *body.patches,
                pins: &pins,
                attachments: body.attachments,
            };
            match backend.execute(plan, constants, &mut part) {
                Ok(stats) => {
                    // A collision with the ground is not smooth.
                    self.is_valid = stats.ground_passes == 0;
                    add(&mut sum, &stats, extrapolated);
                }
                Err(error) => {
                    done = Err(with_substep(error, substep));
                    self.is_valid = false;
                    break;
                }
            }
        }
        self.pins = pins;
        copy(&mut self.end[0], body.positions);
        copy(&mut self.end[1], body.velocities);
        done.map(|()| sum)
    }
}

/// Returns the pin with its target after the next of `substeps_left` substeps.
fn advance_pin(pin: &Pin, positions: &[[f32; 4]], substeps_left: u32) -> Pin {
    let mut target = pin.target;
    if substeps_left > 1 {
        let share = 1.0 / substeps_left as f32;
        for (to, from) in target.iter_mut().zip(positions[pin.vertex.index()]) {
            *to = from + (*to - from) * share;
        }
    }
    Pin {
        vertex: pin.vertex,
        target,
    }
}

/// Replaces every `x` by `(4 x - x0) / 3` and every `x0` by `x`.
///
/// Returns the largest change of a coordinate.
fn extrapolate(now: &mut [[f32; 4]], before: &mut [[f32; 4]]) -> f32 {
    let mut max_change: f32 = 0.0;
    for (now, before) in now.iter_mut().zip(before) {
        let x = *now;
        for k in 0..3 {
            let change = (x[k] - before[k]) * (1.0 / 3.0);
            now[k] += change;
            max_change = max_change.max(change.abs());
        }
        *before = x;
    }
    max_change
}

/// Adds the statistics of a substep, whose start was moved by up to `extrapolated` \[m\].
fn add(sum: &mut StepStats, stats: &StepStats, extrapolated: f32) {
    sum.substeps += stats.substeps;
    sum.passes += stats.passes;
    sum.stretch_projections += stats.stretch_projections;
    sum.bending_projections += stats.bending_projections;
    sum.interior_spring_projections += stats.interior_spring_projections;
    sum.contact_projections += stats.contact_projections;
    sum.volume_projections += stats.volume_projections;
    sum.ground_passes += stats.ground_passes;
    sum.ground_passes_skipped += stats.ground_passes_skipped;
    sum.iterations_skipped += stats.iterations_skipped;
    sum.max_displacement += stats.max_displacement + extrapolated;
    sum.max_substep_displacement = sum
        .max_substep_displacement
        .max(stats.max_substep_displacement + extrapolated);
}

fn with_substep(error: StepError, substep: u32) -> StepError {
    match error {
        StepError::NonFinitePosition { vertex, .. } => {
            StepError::NonFinitePosition { vertex, substep }
        }
        other => other,
    }
}

/// Copies without allocation if the capacity suffices.
fn copy(to: &mut Vec<[f32; 4]>, from: &[[f32; 4]]) {
    to.clear();
    to.extend_from_slice(from);
}
