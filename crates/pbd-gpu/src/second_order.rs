//! Substeps of second order, made of the first-order ones that backends execute.
//!
//! The second backward difference formula is `(3 x' - 4 x + x0) / 2h = v'` and the same of velocities. That is a substep
//! of implicit Euler, `2h / 3` long, from `(4 x - x0) / 3` and `(4 v - v0) / 3`: what is new is the state from which a substep
//! starts, so kernels and plans stay what they are.

use crate::backend::Backend;
use crate::error::StepError;
use crate::params::StepStats;
use crate::plan::{Body, Pin, StepConstants, StepPlan};

/// The length of the first-order substep that a second-order one is made of, over its own.
pub(crate) const SHORTER: f32 = 2.0 / 3.0;

/// What a body's motion was before.
#[derive(Debug, Clone, Default)]
pub(crate) struct History {
    /// Positions and velocities a substep ago, shape [vertex slots].
    before: [Vec<[f32; 4]>; 2],
    /// Positions and velocities that the last frame left, shape [vertex slots].
    left: [Vec<[f32; 4]>; 2],
    /// The substep that they are of \[s\].
    h: f32,
    /// Whether the last substep can be built on.
    is_known: bool,
    /// Where pins are to be at the end of a substep.
    pins: Vec<Pin>,
}

/// The numbers of a frame, of one substep each.
pub(crate) struct Orders {
    pub(crate) first: StepConstants,
    pub(crate) second: StepConstants,
}

impl History {
    /// What is remembered is not where the next frame begins.
    pub(crate) fn forget(&mut self) {
        self.is_known = false;
    }

    /// Room taken, in elements.
    pub(crate) fn capacity(&self) -> usize {
        let arrays = self.before.iter().chain(&self.left);
        arrays.map(Vec::capacity).sum::<usize>() + self.pins.capacity()
    }

    /// Steps a body by a frame of `substeps`, of second order where there is a substep to build on.
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
        // Whoever moves, pins, cuts or weighs a vertex changes one of these numbers.
        let is_continued = self.h.to_bits() == h.to_bits()
            && self.left[0] == *body.positions
            && self.left[1] == *body.velocities;
        self.is_known &= is_continued;
        self.h = h;
        let goals = body.pins;
        let mut pins = std::mem::take(&mut self.pins);
        let mut sum = StepStats::default();
        let mut done = Ok(());
        for substep in 0..substeps {
            let left = substeps - substep;
            pins.clear();
            pins.extend(
                goals
                    .iter()
                    .map(|pin| on_the_way(pin, body.positions, left)),
            );
            let mut farthest = 0.0;
            let constants = if self.is_known {
                farthest = advance(body.positions, &mut self.before[0]);
                advance(body.velocities, &mut self.before[1]);
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
                struts: body.struts.as_deref_mut(),
                colliders: body.colliders,
                contacts: &mut *body.contacts,
                volumes: &mut *body.volumes,
                topology: body.topology,
                pins: &pins,
                tethers: body.tethers,
            };
            match backend.execute(plan, constants, &mut part) {
                Ok(stats) => {
                    // A push of the ground is not smooth: nothing is to be told from it.
                    self.is_known = stats.ground_passes == 0;
                    add(&mut sum, &stats, farthest);
                }
                Err(error) => {
                    done = Err(of_substep(error, substep));
                    self.is_known = false;
                    break;
                }
            }
        }
        self.pins = pins;
        copy(&mut self.left[0], body.positions);
        copy(&mut self.left[1], body.velocities);
        done.map(|()| sum)
    }
}

/// Where a pin is to be after the next of so many substeps that are left.
fn on_the_way(pin: &Pin, positions: &[[f32; 4]], left: u32) -> Pin {
    let mut target = pin.target;
    if left > 1 {
        let share = 1.0 / left as f32;
        for (to, from) in target.iter_mut().zip(positions[pin.vertex.index()]) {
            *to = from + (*to - from) * share;
        }
    }
    Pin {
        vertex: pin.vertex,
        target,
    }
}

/// Puts `(4 x - x0) / 3` in the place of every `x`, and `x` in that of every `x0`. Returns the largest change of a
/// coordinate.
fn advance(now: &mut [[f32; 4]], before: &mut [[f32; 4]]) -> f32 {
    let mut farthest: f32 = 0.0;
    for (now, before) in now.iter_mut().zip(before) {
        let of = *now;
        for k in 0..3 {
            let change = (of[k] - before[k]) * (1.0 / 3.0);
            now[k] += change;
            farthest = farthest.max(change.abs());
        }
        *before = of;
    }
    farthest
}

fn add(sum: &mut StepStats, stats: &StepStats, farthest: f32) {
    sum.substeps += stats.substeps;
    sum.passes += stats.passes;
    sum.stretch_projections += stats.stretch_projections;
    sum.bending_projections += stats.bending_projections;
    sum.strut_projections += stats.strut_projections;
    sum.contact_projections += stats.contact_projections;
    sum.volume_projections += stats.volume_projections;
    sum.ground_passes += stats.ground_passes;
    sum.ground_passes_skipped += stats.ground_passes_skipped;
    sum.iterations_skipped += stats.iterations_skipped;
    sum.farthest += stats.farthest + farthest;
    sum.farthest_substep = sum.farthest_substep.max(stats.farthest_substep + farthest);
}

fn of_substep(error: StepError, substep: u32) -> StepError {
    match error {
        StepError::NonFinitePosition { vertex, .. } => {
            StepError::NonFinitePosition { vertex, substep }
        }
        other => other,
    }
}

/// Copies; allocates only where there is no room.
fn copy(to: &mut Vec<[f32; 4]>, of: &[[f32; 4]]) {
    to.clear();
    to.extend_from_slice(of);
}
