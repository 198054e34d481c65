//! Fuzz cases of progressive cuts: a body and the path of a blade through it.

use super::case::{body, vector};
use super::run::{Done, bend, undo_cut};
use crate::{Body, assert_closed_manifold, assert_no_fold_added, assert_same_bits};
use arbitrary::{Arbitrary, Result, Unstructured};
use incise_cut::{Caps, CutError, CutParams, Cutter, Incision};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Undo, Vec3};

/// Maximum number of steps of a case.
const MAX_STEPS: usize = 16;

/// A body and the path of a blade.
#[derive(Debug, Clone)]
pub struct PathCase {
    /// The body, of about size 1.
    pub body: Body,
    /// Snapping distance, relative to the local edge length.
    pub snap: f64,
    /// Curves along which walls and caps close the cut.
    pub caps: Caps,
    /// The points of the blade's first pose around the body's center, relative to its diagonal.
    pub start: Vec<[f64; 3]>,
    /// The operations in order.
    pub steps: Vec<PathStep>,
}

/// An operation on the blade or the body.
#[derive(Debug, Clone)]
pub enum PathStep {
    /// A motion of the blade's points, relative to the body's diagonal.
    Move(Vec<[f64; 3]>),
    /// Ends the incision; the blade stays where it is.
    Restart,
    /// Undoes the last cut that is not undone and puts back the incision from before it.
    Undo,
    /// Bends the body by a wave of this amplitude, relative to its diagonal; rest positions stay.
    Bend([f64; 3]),
}

impl<'a> Arbitrary<'a> for PathCase {
    fn arbitrary(u: &mut Unstructured<'a>) -> Result<Self> {
        let body = body(u)?;
        let snap = [0.0, 0.1, 0.3][u.choose_index(3)?];
        let caps = [Caps::Bodies, Caps::Bodies, Caps::AllLoops, Caps::None][u.choose_index(4)?];
        let count = [2, 2, 3, 5][u.choose_index(4)?];
        let start = (0..count).map(|_| vector(u)).collect::<Result<_>>()?;
        let mut steps = Vec::new();
        while steps.len() < MAX_STEPS && !u.is_empty() {
            steps.push(step(u, count)?);
        }
        Ok(Self {
            body,
            snap,
            caps,
            start,
            steps,
        })
    }
}

fn step(u: &mut Unstructured<'_>, count: usize) -> Result<PathStep> {
    Ok(match u.int_in_range(0..=9)? {
        0..=3 => {
            // All points move alike: the blade stays in one plane.
            let motion = vector(u)?.map(|x| 0.3 * x);
            PathStep::Move(vec![motion; count])
        }
        4..=6 => {
            let motion = |u: &mut Unstructured<'_>| Ok(vector(u)?.map(|x| 0.3 * x));
            PathStep::Move((0..count).map(|_| motion(u)).collect::<Result<_>>()?)
        }
        7 => PathStep::Undo,
        8 => PathStep::Restart,
        _ => PathStep::Bend(vector(u)?.map(|x| 0.05 * x)),
    })
}

/// A body under a blade.
struct Run {
    surface: Surface,
    cutter: Cutter,
    incision: Incision,
    /// The cuts that can be undone, each with the incision from before it.
    done: Vec<(Done, Incision)>,
    is_closed: bool,
}

impl PathCase {
    /// Runs all steps, then undoes all cuts.
    ///
    /// # Panics
    /// If an invariant does not hold.
    pub fn run(&self) {
        let surface = self.body.build();
        assert_closed_manifold(&surface);
        let bounds = surface.bounds();
        let (center, size) = (bounds.center(), bounds.diagonal());
        let mut blade: Vec<Vec3> = self.start.iter().map(|&p| Vec3::from(p)).collect();
        let mut run = Run {
            cutter: Cutter::new(&surface),
            surface,
            incision: Incision::default(),
            done: Vec::new(),
            is_closed: true,
        };
        let params = CutParams {
            snap: self.snap,
            caps: self.caps,
            ..CutParams::default()
        };
        let pose = |blade: &[Vec3]| -> Vec<[f32; 3]> {
            blade.iter().map(|p| to_f32(center + p * size)).collect()
        };
        run.advance(&pose(&blade), &params);
        for step in &self.steps {
            match step {
                PathStep::Move(motion) => {
                    for (point, &by) in blade.iter_mut().zip(motion) {
                        *point += Vec3::from(by);
                    }
                    run.advance(&pose(&blade), &params);
                }
                PathStep::Restart => run.incision.restart(&pose(&blade)),
                PathStep::Undo => run.undo(),
                PathStep::Bend(by) => {
                    bend(&mut run.surface, *by);
                    run.cutter.refit(&run.surface);
                    run.done.iter_mut().for_each(|(cut, _)| cut.moved = true);
                }
            }
        }
        while !run.done.is_empty() {
            run.undo();
        }
    }
}

impl Run {
    /// Moves the blade on; a refused step changes nothing and ends the incision.
    fn advance(&mut self, pose: &[[f32; 3]], params: &CutParams) {
        let (before, incision) = (self.surface.clone(), self.incision.clone());
        let result = (self.cutter).advance(&mut self.surface, &mut self.incision, pose, params);
        let undo: Option<Undo> = match result {
            Ok(outcome) => {
                assert_no_fold_added(&before, &self.surface, params, &outcome);
                outcome.undo
            }
            Err(CutError::Refine(error)) => panic!("the section cannot be refined: {error}"),
            Err(_) => {
                self.incision.restart(pose);
                None
            }
        };
        if let Some(undo) = undo {
            self.is_closed &= params.caps != Caps::None;
            let done = Done {
                before,
                undo,
                moved: false,
            };
            self.done.push((done, incision));
        } else {
            assert_same_bits(&before, &self.surface);
        }
        if self.is_closed {
            assert_closed_manifold(&self.surface);
        } else {
            self.surface.validate().expect("a manifold");
        }
        let bvh = self.cutter.bvh().validate(&self.surface);
        bvh.expect("the BVH matches the surface");
    }

    fn undo(&mut self) {
        if let Some((done, incision)) = self.done.pop() {
            self.is_closed |= done.before.topology().is_closed();
            undo_cut(&mut self.surface, &mut self.cutter, done);
            self.incision = incision;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzz::random_bytes;

    /// Runs cases from random bytes, which checks the harness without a fuzzer.
    #[test]
    fn random_paths_keep_the_invariants() {
        let mut moves = 0;
        for bytes in random_bytes(400).take(100) {
            let case = PathCase::arbitrary(&mut Unstructured::new(&bytes));
            let case = case.expect("bytes for a case");
            let is_move = |step: &&PathStep| matches!(step, PathStep::Move(_));
            moves += case.steps.iter().filter(is_move).count();
            case.run();
        }
        assert!(moves > 500, "only {moves} steps were tried");
    }
}
