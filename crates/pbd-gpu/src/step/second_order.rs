//! Second-order substeps (BDF2), composed of first-order substeps.
//!
//! The second backward difference formula is `(3 x' - 4 x + x0) / 2h = v'`, and the same for
//! velocities. It equals a substep of implicit Euler of length `2h / 3` from `(4 x - x0) / 3` and
//! `(4 v - v0) / 3`. Only the start of a substep changes, so kernels and plans are the same.

#[cfg(feature = "serde")]
use crate::error::InvalidSolver;
use crate::particles::Pin;
use crate::step::body::Body;
use crate::step::constants::StepConstants;
use crate::step::params::StepStats;

/// Length of the first-order substep relative to the second-order one that it is part of.
pub(crate) const SUBSTEP_RATIO: f32 = 2.0 / 3.0;

/// The motion of a body over the last two substeps.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    #[cfg_attr(feature = "serde", serde(skip))]
    pins: Vec<Pin>,
}

/// Constants of single substeps of first and second order.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Orders {
    pub(crate) first: StepConstants,
    pub(crate) second: StepConstants,
}

impl History {
    /// Checks a history that was read with serde, of a body with `slots` vertex slots.
    ///
    /// # Errors
    /// [`InvalidSolver::Array`].
    #[cfg(feature = "serde")]
    pub(crate) fn validate(&self, slots: usize) -> Result<(), InvalidSolver> {
        let is_finite = |array: &[[f32; 4]]| array.as_flattened().iter().all(|c| c.is_finite());
        let mut arrays = self.before.iter().chain(&self.end);
        let fits = arrays.all(|array| array.len() == slots && is_finite(array));
        let array = "velocities of the last substep";
        // Nothing reads an invalid history.
        (fits || !self.is_valid)
            .then_some(())
            .ok_or(InvalidSolver::Array { array })
    }

    /// Makes the next substep one of first order.
    pub(crate) fn forget(&mut self) {
        self.is_valid = false;
    }

    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        let arrays = self.before.iter().chain(&self.end);
        arrays.map(Vec::capacity).sum::<usize>() + self.pins.capacity()
    }

    /// Returns the pins with their targets of the current substep.
    pub(crate) fn pins(&self) -> &[Pin] {
        &self.pins
    }

    /// Begins a frame of substeps of `h` \[s\].
    ///
    /// Any change of position, mass, pin or topology since the last one makes the next substep one
    /// of first order.
    pub(crate) fn begin_frame(&mut self, h: f32, body: &Body<'_>) {
        let is_continued = self.h.to_bits() == h.to_bits()
            && self.end[0] == *body.positions
            && self.end[1] == *body.velocities;
        self.is_valid &= is_continued;
        self.h = h;
    }

    /// Moves positions, velocities and pins to the start of a substep.
    ///
    /// Returns its constants and an upper bound of the change of a coordinate \[m\].
    pub(crate) fn begin_substep(
        &mut self,
        orders: &Orders,
        body: &mut Body<'_>,
        substeps_left: u32,
    ) -> (StepConstants, f32) {
        let positions = &*body.positions;
        self.pins.clear();
        let pins = body.pins.iter();
        self.pins
            .extend(pins.map(|pin| advance_pin(pin, positions, substeps_left)));
        if self.is_valid {
            let extrapolated = extrapolate(body.positions, &mut self.before[0]);
            extrapolate(body.velocities, &mut self.before[1]);
            (orders.second, extrapolated)
        } else {
            copy(&mut self.before[0], body.positions);
            copy(&mut self.before[1], body.velocities);
            (orders.first, 0.0)
        }
    }

    /// Ends a substep. A collision is not smooth.
    pub(crate) fn end_substep(&mut self, is_finite: bool, meets_collider: bool) {
        self.is_valid = is_finite && !meets_collider;
    }

    /// Ends a frame with these positions and velocities.
    pub(crate) fn end_frame(&mut self, positions: &[[f32; 4]], velocities: &[[f32; 4]]) {
        copy(&mut self.end[0], positions);
        copy(&mut self.end[1], velocities);
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

/// Adds the statistics of a substep to those of a frame.
pub(crate) fn add(sum: &mut StepStats, stats: &StepStats) {
    sum.substeps += stats.substeps;
    sum.passes += stats.passes;
    sum.cell_projections += stats.cell_projections;
    sum.stretch_projections += stats.stretch_projections;
    sum.bending_projections += stats.bending_projections;
    sum.interior_spring_projections += stats.interior_spring_projections;
    sum.contact_projections += stats.contact_projections;
    sum.volume_projections += stats.volume_projections;
    sum.iterations_skipped += stats.iterations_skipped;
    sum.max_displacement += stats.max_displacement;
    sum.max_substep_displacement =
        (sum.max_substep_displacement).max(stats.max_substep_displacement);
}

/// Copies without allocation if the capacity suffices.
fn copy(to: &mut Vec<[f32; 4]>, from: &[[f32; 4]]) {
    to.clear();
    to.extend_from_slice(from);
}
