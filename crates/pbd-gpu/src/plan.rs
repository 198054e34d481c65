//! The step as a list: what runs in which order. Backends only execute it, so they cannot differ in
//! order.

use crate::constraints::{BendingSet, StretchSet};
use crate::material::Projection;
use incise_mesh::VertexId;

/// One pass over vertices or over the constraints of one batch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pass {
    /// Velocities take up gravity and damping, displacements follow; the lowest vertex is noted
    /// (Algorithm 1, lines 5 to 8).
    Predict,
    /// Pinned vertices move towards their targets.
    Pins,
    /// Multipliers become zero.
    ResetMultipliers,
    /// Edges of one color get their lengths back.
    Stretch {
        /// The batch.
        color: usize,
    },
    /// Edges without a color, one by one.
    StretchOverflow,
    /// Angles of one color are brought back.
    Bending {
        /// The batch.
        color: usize,
    },
    /// Angles without a color, one by one.
    BendingOverflow,
    /// What sank below the ground is lifted and held back by friction. Skipped in a substep in which
    /// the body is predicted above the ground.
    Ground,
    /// Velocities and positions follow from displacements (Algorithm 1, lines 10 to 13).
    Integrate,
}

/// What the order of passes depends on beside the constraints.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct PlanKey {
    pub(crate) iterations: u32,
    pub(crate) pins: bool,
    pub(crate) ground: bool,
    pub(crate) multipliers: bool,
}

/// The passes of one substep, in order. Built once a topology and set of parameters.
#[derive(Debug, Clone, Default)]
pub struct StepPlan {
    passes: Vec<Pass>,
    key: Option<PlanKey>,
}

impl StepPlan {
    /// The passes of one substep.
    #[must_use]
    pub fn passes(&self) -> &[Pass] {
        &self.passes
    }

    pub(crate) fn capacity(&self) -> usize {
        self.passes.capacity()
    }

    /// Makes the next [`StepPlan::update`] build anew: constraints came or went.
    pub(crate) fn invalidate(&mut self) {
        self.key = None;
    }

    /// Builds the list again if anything that it depends on has changed.
    pub(crate) fn update(
        &mut self,
        key: PlanKey,
        stretch: &StretchSet,
        bending: Option<&BendingSet>,
    ) {
        if self.key == Some(key) {
            return;
        }
        self.key = Some(key);
        self.passes.clear();
        self.passes.push(Pass::Predict);
        if key.pins {
            self.passes.push(Pass::Pins);
        }
        if key.multipliers {
            self.passes.push(Pass::ResetMultipliers);
        }
        for _ in 0..key.iterations {
            let full = |(color, empty): (usize, bool)| (!empty).then_some(color);
            let colors = stretch.batches().iter().map(|b| b.is_empty()).enumerate();
            let passes = colors.filter_map(full).map(|color| Pass::Stretch { color });
            self.passes.extend(passes);
            if !stretch.overflow().is_empty() {
                self.passes.push(Pass::StretchOverflow);
            }
            if let Some(bending) = bending {
                let colors = bending.batches().iter().map(|b| b.is_empty()).enumerate();
                let passes = colors.filter_map(full).map(|color| Pass::Bending { color });
                self.passes.extend(passes);
                if !bending.overflow().is_empty() {
                    self.passes.push(Pass::BendingOverflow);
                }
            }
            if key.ground {
                self.passes.push(Pass::Ground);
            }
        }
        self.passes.push(Pass::Integrate);
    }
}

/// A vertex held at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pin {
    /// The vertex.
    pub vertex: VertexId,
    /// Where it is to be at the end of the frame \[m\].
    pub target: [f32; 3],
}

/// The numbers of a frame that kernels read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepConstants {
    /// Time step of a substep \[s\].
    pub h: f32,
    /// Substeps of the frame.
    pub substeps: u32,
    /// Change of velocity a substep [m/s].
    pub gravity_step: [f32; 3],
    /// What is left of a velocity after a substep's damping.
    pub kept_velocity: f32,
    /// How stretch constraints are projected.
    pub stretch: Projection,
    /// How bending constraints are projected.
    pub bending: Projection,
    /// Height of the ground \[m\], negative infinity without one.
    pub ground: f32,
    /// Coulomb's coefficient.
    pub friction: f32,
}

/// The arrays of a body that kernels read and write.
#[derive(Debug)]
pub struct Body<'a> {
    /// Position at the start of the substep \[m\] and inverse mass [1/kg], shape [vertex slots].
    pub positions: &'a mut [[f32; 4]],
    /// Velocity [m/s], shape [vertex slots], last entry 0.
    pub velocities: &'a mut [[f32; 4]],
    /// Stretch constraints.
    pub stretch: &'a mut StretchSet,
    /// Bending constraints, if the body has them.
    pub bending: Option<&'a mut BendingSet>,
    /// Pinned vertices, ascending.
    pub pins: &'a [Pin],
}
