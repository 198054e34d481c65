//! The step as a list: what runs in which order. Backends only execute it, so they cannot differ in
//! order.

use crate::colliders::ColliderRecord;
use crate::coloring::{LAYERS, MAX_COLORS};
use crate::constraints::{BendingSet, ConstraintSet, StretchSet};
use crate::contacts::ContactSet;
use crate::error::StepError;
use crate::material::{Projection, VolumeProjection};
use crate::tethers::Tether;
use crate::volumes::VolumeSet;
use incise_mesh::{Topology, VertexId};
use std::cmp::Ordering;

/// One pass over vertices or over the constraints of one batch. Passes are ordered as they run in a
/// substep, so the lists of several bodies can be merged: the iteration begins with the tethers, goes
/// through the layers of colors, in each first stretch, then bending, goes on with struts, volumes and contacts, and ends
/// at colliders and on the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Pass {
    /// Velocities take up gravity and damping, displacements follow; the lowest vertex is noted
    /// (Algorithm 1, lines 5 to 8).
    Predict,
    /// Pinned vertices move towards their targets.
    Pins,
    /// Multipliers become zero.
    ResetMultipliers,
    /// What is too far from where it is held is pulled back.
    Tethers,
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
    /// Struts of one color get their lengths back.
    Struts {
        /// The batch.
        color: usize,
    },
    /// Struts without a color, one by one.
    StrutsOverflow,
    /// What touches is pushed apart in a body that has volumes too: what this takes from a piece it gets back within the
    /// substep. Were contacts to come after volumes alone, it would be an old error in the next one, and pieces that lie on
    /// each other would lose more than `kernels/volume.rs` returns of those.
    ContactsBeforeVolumes,
    /// Closed pieces get their volumes back.
    Volumes,
    /// Vertices and triangles that touch are pushed apart, color by color.
    Contacts,
    /// What is in a collider is pushed out and held back by friction.
    Colliders,
    /// What sank below the ground is lifted and held back by friction. Skipped in a substep in which
    /// the body is predicted above the ground.
    Ground,
    /// Velocities and positions follow from displacements (Algorithm 1, lines 10 to 13).
    Integrate,
}

impl Pass {
    /// The stage of the substep, the kind in it and the color.
    fn rank(self) -> (usize, usize, usize) {
        match self {
            Self::Predict => (0, 0, 0),
            Self::Pins => (0, 1, 0),
            Self::ResetMultipliers => (0, 2, 0),
            Self::Tethers => (0, 3, 0),
            Self::Stretch { color } => (1 + color / MAX_COLORS, 0, color),
            Self::StretchOverflow => (1, 0, MAX_COLORS),
            Self::Bending { color } => (1 + color / MAX_COLORS, 1, color),
            Self::BendingOverflow => (1, 1, MAX_COLORS),
            Self::Struts { color } => (1 + LAYERS, 0, color),
            Self::StrutsOverflow => (1 + LAYERS, 0, MAX_COLORS),
            Self::ContactsBeforeVolumes => (1 + LAYERS, 1, 0),
            Self::Volumes => (1 + LAYERS, 2, 0),
            Self::Contacts => (1 + LAYERS, 3, 0),
            Self::Colliders => (1 + LAYERS, 4, 0),
            Self::Ground => (1 + LAYERS, 5, 0),
            Self::Integrate => (1 + LAYERS, 6, 0),
        }
    }
}

impl Ord for Pass {
    fn cmp(&self, other: &Self) -> Ordering {
        self.rank().cmp(&other.rank())
    }
}

impl PartialOrd for Pass {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// What the order of passes depends on beside the constraints.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct PlanKey {
    pub(crate) iterations: u32,
    pub(crate) pins: bool,
    pub(crate) tethers: bool,
    pub(crate) volumes: bool,
    pub(crate) contacts: bool,
    pub(crate) colliders: bool,
    pub(crate) ground: bool,
    pub(crate) multipliers: bool,
}

/// The passes of one substep: a prologue, the passes of an iteration so many times, an epilogue. Each
/// list is ascending. Built once a topology and set of parameters.
#[derive(Debug, Clone, Default)]
pub struct StepPlan {
    prologue: Vec<Pass>,
    iteration: Vec<Pass>,
    epilogue: Vec<Pass>,
    key: PlanKey,
    is_current: bool,
    generation: u64,
}

impl StepPlan {
    /// The passes before the iterations, ascending.
    #[must_use]
    pub fn prologue(&self) -> &[Pass] {
        &self.prologue
    }

    /// The passes of one iteration, ascending.
    #[must_use]
    pub fn iteration(&self) -> &[Pass] {
        &self.iteration
    }

    /// How many iterations a substep has.
    #[must_use]
    pub fn iterations(&self) -> u32 {
        self.key.iterations
    }

    /// The passes after the iterations, ascending.
    #[must_use]
    pub fn epilogue(&self) -> &[Pass] {
        &self.epilogue
    }

    /// All passes of one substep, in the order in which they run.
    pub fn passes(&self) -> impl Iterator<Item = Pass> {
        let parts = 0..=self.key.iterations + 1;
        parts.flat_map(|i| self.part(i)).copied()
    }

    /// The prologue is part 0, every iteration is a part, the epilogue is the last one.
    pub(crate) fn part(&self, i: u32) -> &[Pass] {
        match i {
            0 => &self.prologue,
            i if i <= self.key.iterations => &self.iteration,
            _ => &self.epilogue,
        }
    }

    /// How often the lists were built. A backend that made something of them has to do so again when
    /// this has changed.
    #[must_use]
    pub fn generation(&self) -> u64 {
        self.generation
    }

    pub(crate) fn capacity(&self) -> usize {
        self.prologue.capacity() + self.iteration.capacity() + self.epilogue.capacity()
    }

    /// Makes the next [`StepPlan::update`] build anew: constraints came or went.
    pub(crate) fn invalidate(&mut self) {
        self.is_current = false;
    }

    /// Builds the lists again if anything that they depend on has changed.
    pub(crate) fn update(
        &mut self,
        key: PlanKey,
        stretch: &StretchSet,
        bending: Option<&BendingSet>,
        struts: Option<&StretchSet>,
    ) {
        if self.is_current && self.key == key {
            return;
        }
        self.key = key;
        self.is_current = true;
        self.generation += 1;
        self.prologue.clear();
        self.prologue.push(Pass::Predict);
        if key.pins {
            self.prologue.push(Pass::Pins);
        }
        if key.multipliers {
            self.prologue.push(Pass::ResetMultipliers);
        }
        self.iteration.clear();
        if key.tethers {
            self.iteration.push(Pass::Tethers);
        }
        let color = |color| Pass::Stretch { color };
        add_batches(&mut self.iteration, stretch, color, Pass::StretchOverflow);
        if let Some(bending) = bending {
            let color = |color| Pass::Bending { color };
            add_batches(&mut self.iteration, bending, color, Pass::BendingOverflow);
        }
        if let Some(struts) = struts {
            let color = |color| Pass::Struts { color };
            add_batches(&mut self.iteration, struts, color, Pass::StrutsOverflow);
        }
        self.iteration.sort_unstable();
        if key.volumes {
            if key.contacts {
                self.iteration.push(Pass::ContactsBeforeVolumes);
            }
            self.iteration.push(Pass::Volumes);
        }
        if key.contacts {
            self.iteration.push(Pass::Contacts);
        }
        if key.colliders {
            self.iteration.push(Pass::Colliders);
        }
        if key.ground {
            self.iteration.push(Pass::Ground);
        }
        self.epilogue.clear();
        self.epilogue.push(Pass::Integrate);
    }
}

/// Adds a pass for every batch of a set that has constraints.
fn add_batches<const N: usize>(
    passes: &mut Vec<Pass>,
    set: &ConstraintSet<N>,
    pass: impl Fn(usize) -> Pass,
    overflow: Pass,
) {
    let full = set
        .batches()
        .iter()
        .enumerate()
        .filter(|(_, b)| !b.is_empty());
    passes.extend(full.map(|(color, _)| pass(color)));
    if !set.overflow().is_empty() {
        passes.push(overflow);
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
    /// How struts are projected.
    pub struts: Projection,
    /// How volume constraints are projected.
    pub volume: VolumeProjection,
    /// Height of the ground \[m\], negative infinity without one.
    pub ground: f32,
    /// Coulomb's coefficient.
    pub friction: f32,
    /// The iterations of a substep end when one moves no vertex by this or more along any axis \[m\].
    pub residual: Option<f32>,
}

impl StepConstants {
    /// Whether kernels can reckon with them.
    ///
    /// # Errors
    /// [`StepError::TooShort`].
    pub(crate) fn check(&self) -> Result<(), StepError> {
        let projections = [&self.stretch, &self.bending, &self.struts];
        let alphas = projections.map(|projection| projection.alpha);
        if alphas.iter().all(|alpha| alpha.is_finite()) && self.volume.alpha.is_finite() {
            return Ok(());
        }
        Err(StepError::TooShort { h: self.h })
    }

    /// Whether any kind of constraint remembers its multipliers.
    pub(crate) fn keeps_multipliers(&self) -> bool {
        self.stretch.keeps || self.bending.keeps || self.struts.keeps || self.volume.keeps
    }

    /// Has rigid constraints leave a part of old errors. What is compliant has stored what it gives back.
    pub(crate) fn keep(&mut self, old: f32) {
        for projection in [&mut self.stretch, &mut self.bending, &mut self.struts] {
            projection.old = if projection.alpha > 0.0 { 0.0 } else { old };
        }
        self.volume.old = if self.volume.alpha > 0.0 { 0.0 } else { old };
    }
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
    /// Struts, if the body may have them.
    pub struts: Option<&'a mut StretchSet>,
    /// Volume constraints, none if the body has no volume.
    pub volumes: &'a mut VolumeSet,
    /// Contacts of the frame.
    pub contacts: &'a mut ContactSet,
    /// What vertices stay out of.
    pub(crate) colliders: &'a [ColliderRecord],
    /// The surface that volumes are enclosed by.
    pub topology: &'a Topology,
    /// Pinned vertices, ascending.
    pub pins: &'a [Pin],
    /// How far vertices may be from pinned ones.
    pub tethers: &'a [Tether],
}

#[cfg(test)]
mod tests {
    use super::*;

    /// More constraints at one vertex than there are colors, so that every kind of pass comes.
    fn sets() -> (StretchSet, BendingSet, StretchSet) {
        let (mut stretch, mut bending) = (StretchSet::new(100), BendingSet::new(100));
        let mut struts = StretchSet::new(100);
        for i in 1..70 {
            struts.insert([VertexId(i), VertexId(0)], 1.0);
            stretch.insert([VertexId(0), VertexId(i)], 1.0);
            bending.insert([0, i, i + 10, i + 20].map(VertexId), 0.0);
        }
        (stretch, bending, struts)
    }

    #[test]
    fn the_lists_are_ascending_and_together_make_the_substep() {
        let (stretch, bending, struts) = sets();
        let mut plan = StepPlan::default();
        let key = PlanKey {
            iterations: 3,
            pins: true,
            tethers: true,
            volumes: true,
            contacts: true,
            colliders: true,
            ground: true,
            multipliers: true,
        };
        plan.update(key, &stretch, Some(&bending), Some(&struts));
        let [prologue, iteration, epilogue] = [plan.prologue(), plan.iteration(), plan.epilogue()];
        let once: Vec<Pass> = [prologue, iteration, epilogue].concat();
        assert!(once.is_sorted_by(|a, b| a < b), "{once:?}");
        assert_eq!(iteration.len(), 1 + 3 * (64 + 1) + 1 + 1 + 1 + 1 + 1);
        let all: Vec<Pass> = plan.passes().collect();
        let expected = [prologue, iteration, iteration, iteration, epilogue].concat();
        assert_eq!(all, expected);
        let hollow = PlanKey {
            volumes: false,
            ..key
        };
        plan.update(hollow, &stretch, Some(&bending), Some(&struts));
        let before = plan.iteration().contains(&Pass::ContactsBeforeVolumes);
        assert!(!before, "nothing is to be given back");
    }

    #[test]
    fn a_new_generation_means_new_lists() {
        let (stretch, bending, struts) = sets();
        let mut plan = StepPlan::default();
        let key = PlanKey {
            iterations: 2,
            ..PlanKey::default()
        };
        plan.update(key, &stretch, Some(&bending), Some(&struts));
        let first = plan.generation();
        plan.update(key, &stretch, Some(&bending), Some(&struts));
        assert_eq!(plan.generation(), first, "nothing has changed");
        plan.invalidate();
        plan.update(key, &stretch, None, None);
        assert!(plan.generation() > first, "constraints went");
        let second = plan.generation();
        plan.update(PlanKey { pins: true, ..key }, &stretch, None, None);
        assert!(plan.generation() > second, "pins came");
    }
}
