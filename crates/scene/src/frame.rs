//! One frame, in order.

use crate::blade::Blade;
use crate::body::BodyId;
use crate::contacts::Reach;
use crate::error::SceneError;
use crate::params::SceneParams;
use crate::scene::{Refusal, Scene};
use crate::stats::FrameStats;
use incise_cut::{CutParams, Sweep};
use incise_mesh::Aabb;
use incise_pbd_gpu::{Collider, ConstraintError, Integrator, StepError};
use std::time::Instant;

impl Scene {
    /// Steps by one frame: [`Scene::cut`], then [`Scene::advance`]. Allocates nothing in a frame
    /// without a cut, once warm.
    ///
    /// # Errors
    /// [`SceneError`] when a body cannot be stepped or the device fails.
    pub fn step(&mut self) -> Result<&FrameStats, SceneError> {
        self.cut()?;
        self.advance()
    }

    /// The first half of a frame: cuts along the blades' sweeps. A cut that cannot be done is no
    /// error, see [`Scene::refusals`].
    ///
    /// # Errors
    /// [`SceneError::Constraint`] when a body's constraints cannot follow its cut. What went wrong with
    /// the device or with a body on it, before the blade at hand has cut anything: called again, this
    /// goes on with that blade.
    pub fn cut(&mut self) -> Result<&FrameStats, SceneError> {
        self.stats = FrameStats::default();
        self.refusals.clear();
        self.outcomes.clear();
        for i in 0..self.blades.len() {
            let blade = self.blades[i];
            self.cut_with(&blade)?;
            self.blades[i].end_sweep();
        }
        let bodies = count(self.bodies.iter().flatten());
        self.stats.refits_skipped = bodies.saturating_sub(self.stats.refits);
        if let Some(device) = &self.device {
            let on_device = count((0..self.bodies.len()).filter(|&i| device.holds(i)));
            self.stats.readbacks_skipped = on_device.saturating_sub(self.stats.readbacks);
        }
        Ok(&self.stats)
    }

    /// The second half of a frame: moves the bodies. Those on a device go on moving when this returns.
    ///
    /// # Errors
    /// [`SceneError::Frame`] and [`SceneError::BadSleep`] when a parameter is out of range; nothing has moved or woken then.
    /// [`SceneError::Step`] when a body cannot be stepped, [`SceneError::Gpu`] when the device fails.
    pub fn advance(&mut self) -> Result<&FrameStats, SceneError> {
        let begin = Instant::now();
        self.check_frame()?;
        self.wake_at_colliders();
        self.find_flats();
        self.sleep.begin_frame(&self.params);
        self.stats.woken = self.sleep.take_woken();
        self.stats.asleep = self.sleep.sleepers();
        self.hand_out_colliders()?;
        self.find_contacts()?;
        self.step_device()?;
        for (i, body) in self.bodies.iter_mut().enumerate() {
            let on_device = self.device.as_ref().is_some_and(|d| d.holds(i));
            if on_device || self.sleep.is_asleep(i) {
                continue;
            }
            let Some(body) = body else { continue };
            let done = body.step(self.params.dt, &self.params.solver);
            let done = done.map_err(|error| SceneError::Step {
                body: BodyId(i),
                error,
            })?;
            self.stats.iterations_skipped += done.iterations_skipped;
            self.stats.ground_passes_skipped += done.ground_passes_skipped;
            if let Some(sleep) = &self.params.sleep
                && let Some(farthest) = self.sleep.note(i, done.farthest_substep)
            {
                let edge = body.solver().mean_rest_length();
                let h = f64::from(self.params.dt) / f64::from(done.substeps);
                let limit = sleep.limit(edge, &body.surface().bounds(), h);
                self.sleep.judge(i, f64::from(farthest) <= limit);
            }
        }
        self.let_sleep();
        self.stats.fell_back = self.backend.take_news();
        let others = self.stats.update + self.stats.contact_detection;
        self.stats.solver = begin.elapsed().saturating_sub(others);
        Ok(&self.stats)
    }

    /// Finds what touches in every body that is awake. Those on a device are brought home for it.
    fn find_contacts(&mut self) -> Result<(), SceneError> {
        let begin = Instant::now();
        let params = self.params.contacts;
        for i in 0..self.bodies.len() {
            let Some(body) = &mut self.bodies[i] else {
                continue;
            };
            if self.sleep.is_asleep(i) {
                continue;
            }
            let own = params.is_some_and(|params| body.may_touch(&params));
            let Some(params) = params.filter(|_| own || !self.flats.is_empty()) else {
                body.drop_contacts()?;
                continue;
            };
            if let Some(device) = &mut self.device
                && let Err(error) = device.read(i, body)
            {
                self.recover(None, error)?;
            }
            let Some(body) = &mut self.bodies[i] else {
                continue;
            };
            let SceneParams { dt, solver, .. } = &self.params;
            let g = solver.gravity.map(f64::from);
            let pull = g.iter().map(|g| g * g).sum::<f64>().sqrt();
            let reach = Reach {
                params,
                dt: f64::from(*dt),
                gained: pull * f64::from(*dt),
                ground: solver.ground,
                colliders: &self.colliders,
                flats: &self.flats,
            };
            if own {
                let refit = u32::from(body.refit());
                self.stats.refits += refit;
                self.stats.refits_skipped = self.stats.refits_skipped.saturating_sub(refit);
            }
            self.stats.contact_searches += 1;
            self.stats.contacts += body.find_contacts(&reach)?;
        }
        self.stats.contact_detection = begin.elapsed();
        Ok(())
    }

    /// What is wrong with the frame itself is the fault of no body and of no device.
    fn check_frame(&self) -> Result<(), SceneError> {
        let SceneParams {
            dt,
            solver,
            sleep,
            contacts,
            ..
        } = &self.params;
        solver.check(*dt).map_err(SceneError::Frame)?;
        if let Some(sleep) = sleep {
            sleep.check()?;
        }
        if let Some(contacts) = contacts {
            contacts.check()?;
        }
        let is_bad = |collider: &Collider| !collider.is_sound();
        if let Some(number) = self.colliders.iter().position(is_bad) {
            return Err(ConstraintError::BadCollider { number }.into());
        }
        if let Some(device) = &self.device
            && solver.integrator != Integrator::Euler
            && (0..self.bodies.len()).any(|i| device.holds(i))
        {
            return Err(SceneError::Frame(StepError::NotOnDevice));
        }
        Ok(())
    }

    /// Lets bodies sleep that have been at rest for long enough.
    fn let_sleep(&mut self) {
        if self.params.sleep.is_none() {
            return;
        }
        for (i, body) in self.bodies.iter_mut().enumerate() {
            if self.sleep.is_asleep(i) || !self.sleep.is_due(i) {
                continue;
            }
            let Some(body) = body else { continue };
            let on_device = self.device.as_ref().is_some_and(|d| d.holds(i));
            // The device's box is on its way, if anybody should ask for it.
            let bounds = (!on_device).then(|| body.bounds(&mut self.stats.boxes));
            self.sleep.fall_asleep(i, bounds);
            self.stats.fell_asleep += 1;
        }
    }

    /// Has the device begin with its bodies' frame.
    fn step_device(&mut self) -> Result<(), SceneError> {
        if self.device.is_none() {
            return Ok(());
        }
        let begin = Instant::now();
        for i in 0..self.bodies.len() {
            if let (Some(device), Some(body)) = (&mut self.device, &mut self.bodies[i])
                && let Err(error) = device.send_edits(i, body)
            {
                self.recover(Some(i), error)?;
            }
        }
        self.stats.update = begin.elapsed();
        if let Some(device) = &mut self.device
            && let Err(error) = device.step(
                &mut self.bodies,
                &self.params,
                &mut self.sleep,
                &mut self.stats,
            )
        {
            self.recover(None, error)?;
            return Ok(());
        }
        if let (Some(device), Some(_)) = (&self.device, &self.params.sleep) {
            for i in 0..self.bodies.len() {
                if device.holds(i) && !self.sleep.is_asleep(i) {
                    self.sleep.count(i);
                }
            }
        }
        Ok(())
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
                    if self.bodies[i].is_some() {
                        self.refuse(BodyId(i), error);
                    }
                }
                return Ok(());
            }
        };
        self.stats.sweeps += 1;
        while let Err(error) = self.approach(&sweep) {
            // Without the device the bodies may be elsewhere: all are looked at again.
            self.recover(None, error)?;
        }
        self.stats.detections_skipped +=
            count(self.bodies.iter().flatten()) - count(self.near.iter());
        self.stats.detection += begin.elapsed();
        for n in 0..self.near.len() {
            self.cut_body(self.near[n], &sweep, &params)?;
        }
        Ok(())
    }

    /// Finds the bodies that a sweep comes to, and brings them up to date.
    fn approach(&mut self, sweep: &Sweep) -> Result<(), SceneError> {
        let reach = sweep.bounds();
        self.near.clear();
        for (i, body) in self.bodies.iter_mut().enumerate() {
            if self.params.skip_far_sweeps && self.sleep.is_far(i, &reach) {
                continue;
            }
            let Some(body) = body else { continue };
            if self.params.skip_far_sweeps {
                let near = match &mut self.device {
                    Some(device) if device.holds(i) => {
                        let bounds = match device.bounds(i)? {
                            Some(bounds) => bounds,
                            None => body.bounds(&mut self.stats.boxes),
                        };
                        if inflated(bounds).overlaps(&reach) {
                            device.want(i);
                        }
                        self.sleep.know(i, bounds);
                        bounds.overlaps(&reach)
                    }
                    _ => body.comes_to(&reach, &mut self.stats.boxes),
                };
                if !near {
                    continue;
                }
            }
            if let Some(device) = &mut self.device {
                self.stats.readbacks += u32::from(device.read(i, body)?);
            }
            self.near.push(i);
        }
        Ok(())
    }

    /// Cuts a body that is up to date, if the sweep passes through it.
    fn cut_body(&mut self, i: usize, sweep: &Sweep, params: &CutParams) -> Result<(), SceneError> {
        let Some(body) = &mut self.bodies[i] else {
            return Ok(());
        };
        let begin = Instant::now();
        self.stats.refits += u32::from(body.refit());
        self.stats.detections += 1;
        self.stats.detection += begin.elapsed();
        let begin = Instant::now();
        let result = body.cut(sweep, params)?;
        self.stats.constraints += result.constraints;
        match result.cut {
            Ok(outcome) => {
                let report = outcome.report;
                self.stats.candidates += report.candidates;
                self.stats.hits += report.hits;
                self.stats.detection += report.detection;
                self.stats.topology +=
                    report.split + report.separation + report.commit + report.search_tree;
                self.stats.refinement += report.cap + report.refinement;
                if !outcome.delta.is_empty() {
                    self.stats.cuts += 1;
                    self.sleep.wake(i);
                    self.outcomes.push((BodyId(i), outcome));
                    if let Some(device) = &mut self.device {
                        device.note_cut(i);
                    }
                    // Caps may have made it large enough for the device.
                    self.settle(i)?;
                }
            }
            Err(error) => {
                self.stats.detection += begin.elapsed();
                self.refuse(BodyId(i), error);
            }
        }
        Ok(())
    }

    fn refuse(&mut self, body: BodyId, error: incise_cut::CutError) {
        self.stats.refused += 1;
        self.refusals.push(Refusal { body, error });
    }
}

/// A box and half of itself around: a blade in there may reach the body in the next frame.
fn inflated(bounds: Aabb) -> Aabb {
    let mut out = bounds;
    for k in 0..3 {
        let half = (bounds.max[k] - bounds.min[k]) / 2.0;
        out.min[k] -= half;
        out.max[k] += half;
    }
    out
}

fn count<T>(items: impl Iterator<Item = T>) -> u32 {
    u32::try_from(items.count()).unwrap_or(u32::MAX)
}
