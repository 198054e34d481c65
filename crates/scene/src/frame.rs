//! One frame, in order.

use crate::blade::Blade;
use crate::body::BodyId;
use crate::error::SceneError;
use crate::scene::{Refusal, Scene};
use crate::stats::FrameStats;
use incise_cut::CutParams;
use std::time::Instant;

impl Scene {
    /// Steps by one frame: [`Scene::cut`], then [`Scene::advance`]. Allocates nothing in a frame
    /// without a cut, once warm.
    ///
    /// # Errors
    /// [`SceneError`] when a body cannot be stepped.
    pub fn step(&mut self) -> Result<&FrameStats, SceneError> {
        self.cut()?;
        self.advance()
    }

    /// The first half of a frame: cuts along the blades' sweeps. A cut that cannot be done is no
    /// error, see [`Scene::refusals`].
    ///
    /// # Errors
    /// [`SceneError::Constraint`] when a body's constraints cannot follow its cut.
    pub fn cut(&mut self) -> Result<&FrameStats, SceneError> {
        self.stats = FrameStats::default();
        self.refusals.clear();
        self.outcomes.clear();
        for i in 0..self.blades.len() {
            let blade = self.blades[i];
            self.cut_with(&blade)?;
            self.blades[i].end_sweep();
        }
        let bodies = u32::try_from(self.bodies.len()).unwrap_or(u32::MAX);
        self.stats.refits_skipped = bodies.saturating_sub(self.stats.refits);
        Ok(&self.stats)
    }

    /// The second half of a frame: moves the bodies.
    ///
    /// # Errors
    /// [`SceneError::Step`] when a body cannot be stepped.
    pub fn advance(&mut self) -> Result<&FrameStats, SceneError> {
        let begin = Instant::now();
        for (i, body) in self.bodies.iter_mut().enumerate() {
            body.step(self.params.dt, &self.params.solver)
                .map_err(|error| SceneError::Step {
                    body: BodyId(i),
                    error,
                })?;
        }
        self.stats.solver = begin.elapsed();
        Ok(&self.stats)
    }

    /// Tests one blade's sweep against every body, cuts where it passes.
    fn cut_with(&mut self, blade: &Blade) -> Result<(), SceneError> {
        let begin = Instant::now();
        let params = CutParams {
            only_piece: blade.only_piece.or(self.params.cut.only_piece),
            ..self.params.cut
        };
        let sweep = match blade.sweep() {
            Ok(Some(sweep)) => sweep,
            Ok(None) => {
                self.stats.sweeps_skipped += 1;
                return Ok(());
            }
            Err(error) => {
                for i in 0..self.bodies.len() {
                    self.refuse(BodyId(i), error);
                }
                return Ok(());
            }
        };
        self.stats.sweeps += 1;
        self.stats.detection += begin.elapsed();
        let reach = sweep.bounds();
        for i in 0..self.bodies.len() {
            let body = &mut self.bodies[i];
            let begin = Instant::now();
            if self.params.skip_far_sweeps && !body.surface().bounds().overlaps(&reach) {
                self.stats.detections_skipped += 1;
                self.stats.detection += begin.elapsed();
                continue;
            }
            self.stats.refits += u32::from(body.refit());
            self.stats.detections += 1;
            self.stats.detection += begin.elapsed();
            let begin = Instant::now();
            let result = body.cut(&sweep, &params)?;
            self.stats.constraints += result.constraints;
            match result.cut {
                Ok(outcome) => {
                    let report = outcome.report;
                    self.stats.candidates += report.candidates;
                    self.stats.hits += report.hits;
                    self.stats.detection += report.detection;
                    self.stats.topology += report.topology;
                    self.stats.refinement += report.refinement;
                    if !outcome.delta.is_empty() {
                        self.stats.cuts += 1;
                        self.outcomes.push((BodyId(i), outcome));
                    }
                }
                Err(error) => {
                    self.stats.detection += begin.elapsed();
                    self.refuse(BodyId(i), error);
                }
            }
        }
        Ok(())
    }

    fn refuse(&mut self, body: BodyId, error: incise_cut::CutError) {
        self.stats.refused += 1;
        self.refusals.push(Refusal { body, error });
    }
}
