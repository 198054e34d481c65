//! A body that a blade cuts step by step, as a body of a scene.

use super::strokes::turned;
use crate::cut::body::StageTimes;
use crate::measure;
use incise_cut::{CutError, CutParams, Cutter, Incision};
use incise_mesh::Surface;
use incise_models::pose;
use incise_pbd_gpu::{Material, Solver};
use std::error::Error;
use std::time::Instant;

/// Angle by which a turning body turns per step about the vertical axis \[rad\].
const TURN: f64 = 0.003;
/// Calls with the same pose that are timed together.
const STANDING_CALLS: u32 = 100;

/// A body with its cutter, its solver and the incision of one blade.
pub(super) struct IncisedBody {
    pub(super) surface: Surface,
    cutter: Cutter,
    solver: Solver,
    incision: Incision,
    pose: [[f32; 3]; 2],
    /// Whether it has moved since the BVH was fitted.
    has_moved: bool,
    /// Angle by which the body has turned about the vertical axis \[rad\].
    pub(super) angle: f64,
    /// Mean edge length of the uncut body \[m\].
    pub(super) step_length: f64,
}

/// A step that cut.
#[derive(Debug)]
pub(super) struct Step {
    pub(super) times: StageTimes,
    pub(super) wall_triangles: usize,
}

impl IncisedBody {
    /// Returns a body of a material.
    ///
    /// # Errors
    /// An error of the solver.
    pub(super) fn new(mut surface: Surface, material: &Material) -> Result<Self, Box<dyn Error>> {
        let solver = Solver::new(&mut surface, material)?;
        Ok(Self {
            cutter: Cutter::new(&surface),
            step_length: solver.mean_rest_length(),
            surface,
            solver,
            incision: Incision::default(),
            pose: [[0.0; 3]; 2],
            has_moved: false,
            angle: 0.0,
        })
    }

    /// Moves the blade to a pose and times it; none for a step that cuts nothing.
    ///
    /// The inner error is a refused cut. A new incision then starts at the pose, as in a scene.
    ///
    /// # Errors
    /// An error of the solver.
    pub(super) fn advance(
        &mut self,
        pose: &[[f32; 3]; 2],
        params: &CutParams,
    ) -> Result<Result<Option<Step>, CutError>, Box<dyn Error>> {
        self.pose = *pose;
        let begin = Instant::now();
        if !self.has_moved {
            // The solver has changed inverse masses, which share an array with positions.
            self.cutter.refit_moved(&self.surface, &[]);
        }
        let refit = begin.elapsed();
        let (surface, incision) = (&mut self.surface, &mut self.incision);
        let outcome = match self.cutter.advance(surface, incision, pose, params) {
            Ok(outcome) => outcome,
            Err(error) => {
                self.incision.restart(pose);
                return Ok(Err(error));
            }
        };
        if outcome.is_miss() {
            return Ok(Ok(None));
        }
        let follow = Instant::now();
        self.solver.apply_delta(&mut self.surface, &outcome.delta)?;
        let (constraints, total) = (follow.elapsed(), begin.elapsed());
        Ok(Ok(Some(Step {
            times: StageTimes::new(&outcome.report, constraints).with_refit(refit, total),
            wall_triangles: outcome.cap.len(),
        })))
    }

    /// Returns the time of a call with the blade's last pose \[us\], if the blade is inside.
    ///
    /// The body stands still meanwhile.
    ///
    /// # Errors
    /// An error of the solver or of the cutter, or a message if a blade that stands cuts.
    pub(super) fn standing_time(
        &mut self,
        params: &CutParams,
    ) -> Result<Option<f64>, Box<dyn Error>> {
        let pose = self.pose;
        // A body that turned after the last step may be cut once more.
        let is_refused = self.incision.is_inside() && self.advance(&pose, params)?.is_err();
        if is_refused || !self.incision.is_inside() {
            return Ok(None);
        }
        let mut times = measure::Times::default();
        times.time_frames(STANDING_CALLS, || -> Result<(), Box<dyn Error>> {
            for _ in 0..STANDING_CALLS {
                self.cutter.refit_moved(&self.surface, &[]);
                let (surface, incision) = (&mut self.surface, &mut self.incision);
                let outcome = self.cutter.advance(surface, incision, &pose, params)?;
                if !outcome.is_miss() {
                    return Err("a blade that stands has cut".into());
                }
            }
            Ok(())
        })?;
        Ok(Some(times.median() * 1e6))
    }

    /// Ends the incision.
    pub(super) fn lift_blade(&mut self) {
        self.incision = Incision::default();
    }

    /// Turns the body about the vertical axis.
    pub(super) fn turn(&mut self) {
        pose(&mut self.surface, |p| turned(p, TURN));
        self.angle += TURN;
        self.has_moved = true;
    }

    /// Validates the surface and the BVH.
    ///
    /// # Errors
    /// The first broken invariant.
    pub(super) fn validate(&mut self) -> Result<(), Box<dyn Error>> {
        self.surface.validate_closed()?;
        if std::mem::take(&mut self.has_moved) {
            self.cutter.refit(&self.surface);
        }
        Ok(self.cutter.bvh().validate(&self.surface)?)
    }
}
