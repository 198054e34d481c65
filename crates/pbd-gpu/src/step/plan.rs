//! [`StepPlan`]: the passes of one body's substep.
//!
//! The CPU executes it pass by pass; the GPU backend merges the plans of several bodies.

use crate::constraints::batches::{BatchId, BendingSet, ConstraintSet, StretchSet};
use crate::constraints::cells::CellSet;
use crate::step::pass::{ConstraintKind, Pass};

/// Inputs of the plan, besides the constraint sets.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct PlanKey {
    pub(crate) iterations: u32,
    /// Rounds of contacts and volumes per iteration, at least 1.
    pub(crate) contact_rounds: u32,
    pub(crate) pins: bool,
    pub(crate) attachments: bool,
    pub(crate) volumes: bool,
    pub(crate) contacts: bool,
    pub(crate) colliders: bool,
    pub(crate) multipliers: bool,
}

/// The passes of one substep: prologue, repeated iterations, epilogue.
///
/// Each list is ascending. It is rebuilt when topology or parameters change.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StepPlan {
    #[cfg_attr(feature = "serde", serde(skip))]
    prologue: Vec<Pass>,
    #[cfg_attr(feature = "serde", serde(skip))]
    iteration: Vec<Pass>,
    #[cfg_attr(feature = "serde", serde(skip))]
    epilogue: Vec<Pass>,
    key: PlanKey,
    is_current: bool,
    #[cfg_attr(feature = "serde", serde(skip))]
    generation: u64,
}

impl StepPlan {
    /// Returns the passes before the iterations, ascending.
    #[must_use]
    pub fn prologue(&self) -> &[Pass] {
        &self.prologue
    }

    /// Returns the passes of one iteration, ascending, with one [round](Self::contact_round).
    #[must_use]
    pub fn iteration(&self) -> &[Pass] {
        &self.iteration
    }

    /// Returns the number of iterations of a substep.
    #[must_use]
    pub fn iterations(&self) -> u32 {
        self.key.iterations
    }

    /// Returns the last passes of an iteration, from contacts before volumes on.
    ///
    /// They run [`Self::contact_rounds`] times in each iteration.
    #[must_use]
    pub fn contact_round(&self) -> &[Pass] {
        let first = (self.iteration).partition_point(|pass| *pass < Pass::ContactsBeforeVolumes);
        &self.iteration[first..]
    }

    /// Returns the number of rounds of contacts and volumes in an iteration.
    #[must_use]
    pub fn contact_rounds(&self) -> u32 {
        self.key.contact_rounds
    }

    /// Returns the passes after the iterations, ascending.
    #[must_use]
    pub fn epilogue(&self) -> &[Pass] {
        &self.epilogue
    }

    /// Returns all passes of one substep in order of execution.
    pub fn passes(&self) -> impl Iterator<Item = Pass> {
        let last = self.key.iterations + 1;
        let passes = (0..=last).flat_map(move |i| {
            let is_iteration = (1..last).contains(&i);
            let rounds = if is_iteration {
                self.key.contact_rounds
            } else {
                1
            };
            let more = (1..rounds).flat_map(|_| self.contact_round());
            self.part(i).iter().chain(more)
        });
        passes.copied()
    }

    /// Returns the prologue for part 0, then the iterations, then the epilogue.
    pub(crate) fn part(&self, i: u32) -> &[Pass] {
        match i {
            0 => &self.prologue,
            i if i <= self.key.iterations => &self.iteration,
            _ => &self.epilogue,
        }
    }

    /// Returns a number that changes whenever the lists are rebuilt.
    ///
    /// A backend that derives data from the lists rebuilds it then.
    #[must_use]
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        self.prologue.capacity() + self.iteration.capacity() + self.epilogue.capacity()
    }

    /// Returns whether constraints are the same as at the last [`StepPlan::update`].
    pub(crate) fn is_current(&self) -> bool {
        self.is_current
    }

    /// Makes the lists of a plan that was read with serde, if it is current.
    #[cfg(feature = "serde")]
    pub(crate) fn finish_load(
        &mut self,
        stretch: &StretchSet,
        bending: Option<&BendingSet>,
        interior_springs: Option<&StretchSet>,
        cells: Option<&CellSet>,
    ) {
        if std::mem::take(&mut self.is_current) {
            self.update(self.key, stretch, bending, interior_springs, cells);
        }
    }

    /// Makes the next [`StepPlan::update`] rebuild the lists, after a change of constraints.
    pub(crate) fn invalidate(&mut self) {
        self.is_current = false;
    }

    /// Rebuilds the lists if their inputs have changed.
    pub(crate) fn update(
        &mut self,
        key: PlanKey,
        stretch: &StretchSet,
        bending: Option<&BendingSet>,
        interior_springs: Option<&StretchSet>,
        cells: Option<&CellSet>,
    ) {
        if self.is_current && self.key == key {
            return;
        }
        self.key = key;
        self.is_current = true;
        self.generation += 1;
        self.prologue.clear();
        self.prologue.push(Pass::Predict);
        push_if(&mut self.prologue, key.pins && cells.is_none(), Pass::Pins);
        push_if(&mut self.prologue, key.contacts, Pass::ContactFeatures);
        push_if(&mut self.prologue, key.multipliers, Pass::ResetMultipliers);
        self.iteration.clear();
        let list = &mut self.iteration;
        push_if(list, key.attachments, Pass::LongRangeAttachments);
        push_batches(list, ConstraintKind::Stretch, Some(stretch));
        push_batches(list, ConstraintKind::Bending, bending);
        push_batches(list, ConstraintKind::InteriorSpring, interior_springs);
        let is_supported = (key.pins || key.colliders) && cells.is_some();
        push_if(list, is_supported, Pass::SolidSupports);
        for number in cells.into_iter().flat_map(CellSet::numbers) {
            let batch = BatchId::from_number(number);
            list.push(Pass::Cells(batch));
        }
        push_if(list, key.pins && cells.is_some(), Pass::SolidPins);
        for i in 0..list.len() {
            if let Pass::Project { kind, batch } = list[i] {
                list.push(Pass::ProjectBack { kind, batch });
            }
        }
        let before_volumes = key.contacts && key.volumes;
        push_if(list, before_volumes, Pass::ContactsBeforeVolumes);
        let colliders_before_volumes = key.colliders && key.volumes;
        push_if(list, colliders_before_volumes, Pass::CollidersBeforeVolumes);
        push_if(list, key.volumes, Pass::Volumes);
        push_if(list, key.contacts, Pass::Contacts);
        push_if(list, key.colliders, Pass::Colliders);
        self.epilogue.clear();
        push_if(&mut self.epilogue, key.contacts, Pass::ContactRecovery);
        self.epilogue.push(Pass::Integrate);
        for list in [&mut self.prologue, &mut self.iteration, &mut self.epilogue] {
            list.sort_unstable();
        }
    }
}

fn push_if(passes: &mut Vec<Pass>, is_needed: bool, pass: Pass) {
    if is_needed {
        passes.push(pass);
    }
}

/// Adds a pass for every batch that has constraints.
fn push_batches<const N: usize>(
    passes: &mut Vec<Pass>,
    kind: ConstraintKind,
    set: Option<&ConstraintSet<N>>,
) {
    let batches = set.into_iter().flat_map(ConstraintSet::numbered);
    let filled = batches.filter(|(_, batch)| !batch.is_empty());
    passes.extend(filled.map(|(number, _)| Pass::Project {
        kind,
        batch: BatchId::from_number(number),
    }));
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise_mesh::VertexId;

    /// More constraints at one vertex than there are colors, so that all batches are in use.
    fn sets() -> (StretchSet, BendingSet, StretchSet) {
        let (mut stretch, mut bending) = (StretchSet::new(100), BendingSet::new(100));
        let mut interior_springs = StretchSet::new(100);
        for i in 1..70 {
            interior_springs.insert([VertexId(i), VertexId(0)], 1.0);
            stretch.insert([VertexId(0), VertexId(i)], 1.0);
            bending.insert([0, i, i + 10, i + 20].map(VertexId), 0.0);
        }
        (stretch, bending, interior_springs)
    }

    #[test]
    fn the_lists_are_ascending_and_make_up_the_substep() {
        let (stretch, bending, interior_springs) = sets();
        let mut plan = StepPlan::default();
        let key = PlanKey {
            iterations: 3,
            contact_rounds: 2,
            pins: true,
            attachments: true,
            volumes: true,
            contacts: true,
            colliders: true,
            multipliers: true,
        };
        plan.update(key, &stretch, Some(&bending), Some(&interior_springs), None);
        let [prologue, iteration, epilogue] = [plan.prologue(), plan.iteration(), plan.epilogue()];
        let once: Vec<Pass> = [prologue, iteration, epilogue].concat();
        assert!(once.is_sorted_by(|a, b| a < b), "{once:?}");
        assert_eq!(iteration.len(), 1 + 6 * (64 + 1) + 5);
        let sweep = |is_back: bool| {
            let batches = iteration.iter().filter_map(move |pass| match *pass {
                Pass::Project { kind, batch } => (!is_back).then_some((kind, batch)),
                Pass::ProjectBack { kind, batch } => is_back.then_some((kind, batch)),
                _ => None,
            });
            batches.collect::<Vec<_>>()
        };
        let mut back = sweep(true);
        back.reverse();
        assert_eq!(back, sweep(false), "an iteration is symmetric");
        let all: Vec<Pass> = plan.passes().collect();
        let iteration = [iteration, plan.contact_round()].concat();
        let iterations = iteration.repeat(3);
        let expected = [prologue, &*iterations, epilogue].concat();
        assert_eq!(all, expected);
        let without_volumes = PlanKey {
            volumes: false,
            ..key
        };
        plan.update(
            without_volumes,
            &stretch,
            Some(&bending),
            Some(&interior_springs),
            None,
        );
        for pass in [Pass::ContactsBeforeVolumes, Pass::CollidersBeforeVolumes] {
            let is_there = plan.iteration().contains(&pass);
            assert!(!is_there, "there is no volume to restore");
        }
    }

    #[test]
    fn the_generation_changes_with_the_lists() {
        let (stretch, bending, interior_springs) = sets();
        let mut plan = StepPlan::default();
        let key = PlanKey {
            iterations: 2,
            contact_rounds: 1,
            ..PlanKey::default()
        };
        plan.update(key, &stretch, Some(&bending), Some(&interior_springs), None);
        let first = plan.generation();
        plan.update(key, &stretch, Some(&bending), Some(&interior_springs), None);
        assert_eq!(plan.generation(), first, "nothing has changed");
        plan.invalidate();
        plan.update(key, &stretch, None, None, None);
        assert!(plan.generation() > first, "constraints were removed");
        let second = plan.generation();
        plan.update(PlanKey { pins: true, ..key }, &stretch, None, None, None);
        assert!(plan.generation() > second, "pins were added");
    }
}
