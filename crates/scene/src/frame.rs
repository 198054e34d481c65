//! One frame of a [`Scene`] in order: sweeps and cuts, then contacts, then the solver.

use crate::blade::{Blade, BladeId};
use crate::body::{Body, BodyCut, BodyId};
use crate::error::SceneError;
use crate::gpu_bodies::GpuBodies;
use crate::scene::{FailedCut, Scene, SweepResult};
use crate::stats::FrameStats;
use incise_cut::{CutError, CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::{Aabb, Surface};
use incise_pbd_gpu::{Collider, ConstraintError, StepError};
use web_time::Instant;

impl Scene {
    /// Steps by one frame: [`Scene::cut`], then [`Scene::advance`].
    ///
    /// A frame without a cut allocates no memory after the first ones, except one job of the thread
    /// pool per thread that helps with a large body or an island.
    ///
    /// # Errors
    /// As [`Scene::cut`] and [`Scene::advance`].
    pub fn step(&mut self) -> Result<&FrameStats, SceneError> {
        self.cut()?;
        self.advance()
    }

    /// Cuts along the blades' sweeps: the first half of a frame.
    ///
    /// [`Scene::cuts`] has the result of each sweep. A cut that fails is no error of the frame, see
    /// [`Scene::failed_cuts`].
    ///
    /// # Errors
    /// [`SceneError::PositionNotFinite`] and [`SceneError::TopologyEdited`] for an edit of a body;
    /// [`SceneError::Constraint`] when a body's constraints cannot follow its cut;
    /// [`SceneError`] of the GPU or of a body on it. A second call continues with the blade at
    /// which the first one failed.
    pub fn cut(&mut self) -> Result<&FrameStats, SceneError> {
        self.validate_edits()?;
        self.stats = FrameStats::default();
        self.failed_cuts.clear();
        self.cuts.clear();
        for i in 0..self.blades.len() {
            self.cut_with_blade(i)?;
            self.blades[i].end_sweep();
        }
        let bodies = count(self.bodies.iter().flatten());
        self.stats.bvh_refits_skipped = bodies.saturating_sub(self.stats.bvh_refits);
        if let Some(gpu) = &self.gpu {
            let on_gpu = count((0..self.bodies.len()).filter(|&i| gpu.holds(i)));
            self.stats.readbacks_skipped = on_gpu.saturating_sub(self.stats.readbacks);
        }
        Ok(&self.stats)
    }

    /// Moves the bodies: the second half of a frame. The GPU may still work when this returns.
    ///
    /// # Errors
    /// [`SceneError::Parameter`] and [`SceneError::Frame`] for a parameter out of range; nothing
    /// has moved then. [`SceneError::PositionNotFinite`] and [`SceneError::TopologyEdited`] for an
    /// edit of a body, [`SceneError::Step`] when a body cannot be stepped, [`SceneError`] of the
    /// GPU when it fails.
    pub fn advance(&mut self) -> Result<&FrameStats, SceneError> {
        let begin = Instant::now();
        self.check_params()?;
        self.validate_edits()?;
        self.begin_colliders();
        self.update_blade_faces();
        self.sleep.begin_frame(&self.params);
        self.find_contacts()?;
        self.stats.woken = self.sleep.take_woken();
        self.stats.sleeping_bodies = self.sleep.sleeping_bodies();
        self.assign_colliders()?;
        self.step_islands()?;
        self.put_to_sleep();
        self.stats.fell_back = self.backend.take_fallback();
        let others = self.stats.gpu_upload + self.stats.contact_detection;
        self.stats.solver = begin.elapsed().saturating_sub(others);
        Ok(&self.stats)
    }

    /// Validates the bodies that were handed out for edits.
    pub(crate) fn validate_edits(&mut self) -> Result<(), SceneError> {
        let scene = self.number;
        for (index, body) in self.bodies.iter_mut().enumerate() {
            if let Some(body) = body {
                body.validate_edit(BodyId { scene, index })?;
            }
        }
        Ok(())
    }

    /// Validates the parameters of the frame.
    fn check_params(&self) -> Result<(), SceneError> {
        self.params.check_motion()?;
        let is_bad = |collider: &Collider| !collider.is_valid();
        if let Some(number) = self.colliders.iter().position(is_bad) {
            return Err(ConstraintError::BadCollider { number }.into());
        }
        if let Some(gpu) = &self.gpu
            && !self.params.solver.is_supported_on_gpu()
            && (0..self.bodies.len()).any(|i| gpu.holds(i))
        {
            return Err(SceneError::Frame(StepError::UnsupportedOnGpu));
        }
        Ok(())
    }

    /// Puts bodies to sleep that have been at rest for long enough.
    fn put_to_sleep(&mut self) {
        if self.params.sleep.is_none() {
            return;
        }
        for i in 0..self.bodies.len() {
            let single = [i];
            let members = self.islands.members(i).unwrap_or(&single);
            // The first body of an island decides for all.
            if self.sleep.is_asleep(i) || members[0] != i || !self.sleep.take_decision(members) {
                continue;
            }
            for &member in members {
                let Some(body) = &mut self.bodies[member] else {
                    continue;
                };
                let is_gpu_ahead = |gpu: &dyn GpuBodies| !gpu.residency(member).is_cpu_current();
                let is_gpu_ahead = self.gpu.as_deref().is_some_and(is_gpu_ahead);
                // The box of a GPU body is being read back.
                let bounds = (!is_gpu_ahead).then(|| body.bounds(&mut self.stats.aabbs_computed));
                self.sleep.fall_asleep(member, members[0], bounds);
                self.stats.fell_asleep += 1;
            }
        }
    }

    /// Uploads edits and submits the frame of all GPU bodies.
    pub(crate) fn step_gpu(&mut self) -> Result<(), SceneError> {
        if self.gpu.is_none() {
            return Ok(());
        }
        let begin = Instant::now();
        for i in 0..self.bodies.len() {
            if let (Some(gpu), Some(body)) = (&mut self.gpu, &mut self.bodies[i])
                && let Err(error) = gpu.upload_edits(i, body)
            {
                self.recover(Some(i), error)?;
            }
        }
        self.stats.gpu_upload = begin.elapsed();
        if let Some(gpu) = &mut self.gpu
            && let Err(error) = gpu.step(
                &mut self.bodies,
                &self.params,
                &mut self.sleep,
                &mut self.stats,
            )
        {
            self.recover(None, error)?;
            return Ok(());
        }
        if let (Some(gpu), Some(_)) = (&self.gpu, &self.params.sleep) {
            for i in 0..self.bodies.len() {
                if gpu.holds(i) && self.islands.members(i).is_none() && !self.sleep.is_asleep(i) {
                    self.sleep.count_frame(i);
                }
            }
        }
        Ok(())
    }

    /// Cuts along one blade's sweep and records the result.
    fn cut_with_blade(&mut self, index: usize) -> Result<(), SceneError> {
        let begin = Instant::now();
        let (blade, id) = (self.blades[index], self.blade_id(index));
        let params = CutParams {
            only_piece: blade.only_piece.or(self.params.cut.only_piece),
            ..self.params.cut
        };
        let sweep = match blade.sweep() {
            Ok(Some(sweep)) => sweep,
            Ok(None) => {
                self.stats.resting_blades += 1;
                return Ok(());
            }
            Err(error) => {
                for i in 0..self.bodies.len() {
                    if self.bodies[i].is_some() {
                        self.record_failed_cut(id, i, error);
                    }
                }
                return Ok(());
            }
        };
        self.stats.sweeps += 1;
        while let Err(error) = self.find_near_bodies(index, &sweep) {
            // After a fallback the CPU copies are the bodies: the broad phase starts again.
            self.recover(None, error)?;
        }
        self.stats.broad_phase_rejections +=
            count(self.bodies.iter().flatten()) - count(self.near.iter());
        self.stats.detection += begin.elapsed();
        let results = self.cuts.len() + self.failed_cuts.len();
        for n in 0..self.near.len() {
            self.cut_body(self.near[n], id, &blade, &sweep, &params)?;
        }
        if self.cuts.len() + self.failed_cuts.len() == results {
            self.stats.missed_sweeps += 1;
            self.cuts.push(SweepResult {
                blade: id,
                cut: None,
            });
        }
        Ok(())
    }

    /// Finds the bodies whose bounding boxes overlap a sweep's, and reads them back.
    ///
    /// So is a body that the blade is inside.
    fn find_near_bodies(&mut self, blade: usize, sweep: &Sweep) -> Result<(), SceneError> {
        let swept = sweep.bounds();
        self.near.clear();
        for (i, body) in self.bodies.iter_mut().enumerate() {
            let is_inside = body.as_ref().is_some_and(|body| body.has_incision(blade));
            if !is_inside && self.params.skip_far_sweeps && self.sleep.is_far(i, &swept) {
                continue;
            }
            let Some(body) = body else { continue };
            if !is_inside && self.params.skip_far_sweeps {
                let is_near = match &mut self.gpu {
                    Some(gpu) if gpu.holds(i) => {
                        let bounds = match gpu.bounds(i)? {
                            Some(bounds) => bounds,
                            None => body.bounds(&mut self.stats.aabbs_computed),
                        };
                        if inflated(bounds).overlaps(&swept) {
                            gpu.request_prefetch(i);
                        }
                        self.sleep.set_bounds(i, bounds);
                        bounds.overlaps(&swept)
                    }
                    _ => body.overlaps(&swept, &mut self.stats.aabbs_computed),
                };
                if !is_near {
                    continue;
                }
            }
            if let Some(gpu) = &mut self.gpu {
                self.stats.readbacks += u32::from(gpu.read_back(i, body)?);
            }
            self.near.push(i);
        }
        Ok(())
    }

    /// Cuts a body, whose CPU copy is up to date, along a sweep.
    fn cut_body(
        &mut self,
        i: usize,
        id: BladeId,
        blade: &Blade,
        sweep: &Sweep,
        params: &CutParams,
    ) -> Result<(), SceneError> {
        let threads = self.params.solver.threads;
        let cut = |body: &mut Body| body.cut(id.index, blade, sweep, params, threads);
        match self.cut_prepared(i, self.may_search_contacts(i), cut)? {
            Some(Ok(outcome)) if !outcome.is_miss() => {
                self.cuts.push(SweepResult {
                    blade: id,
                    cut: Some((self.body_id(i), outcome)),
                });
                // New triangles may make it large enough for the GPU.
                self.move_to_gpu(i)
            }
            Some(Err(error)) => {
                self.record_failed_cut(id, i, error);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Cuts a body along `sweep` by a method of the caller instead of a blade.
    ///
    /// `cut` gets the cutter, whose BVH fits the surface, and the surface; its outcome must be that
    /// of the one edit that it makes. Constraints, masses, BVH and GPU follow, as of a blade's cut.
    /// Counters and times add to [`Scene::stats`], so call this between [`Scene::cut`] and
    /// [`Scene::advance`]. [`Scene::cuts`] does not list the cut.
    ///
    /// # Errors
    /// As [`Scene::read_back`] and [`Scene::cut`]. The inner error is that of `cut`.
    pub fn cut_with<E>(
        &mut self,
        id: BodyId,
        sweep: &Sweep,
        cut: impl FnOnce(&mut Cutter, &mut Surface) -> Result<CutOutcome, E>,
    ) -> Result<Result<CutOutcome, E>, SceneError> {
        self.validate_edits()?;
        self.read_back(id)?;
        let threads = self.params.solver.threads;
        let cut = |body: &mut Body| body.cut_with(sweep, cut, threads);
        let result = self.cut_prepared(id.index, true, cut)?;
        let result = result.ok_or(SceneError::UnknownBody { body: id })?;
        match &result {
            Ok(outcome) if !outcome.is_miss() => self.move_to_gpu(id.index)?,
            Ok(_) => {}
            Err(_) => self.stats.failed_cuts += 1,
        }
        Ok(result)
    }

    /// Returns whether the search for contacts in this frame is expected to ask the BVH of a body.
    ///
    /// A wrong guess costs time alone.
    fn may_search_contacts(&self, i: usize) -> bool {
        let body = self.bodies[i].as_ref();
        self.params.contacts.is_some_and(|params| {
            self.detection.is_near(i)
                || !self.blade_faces.is_empty()
                || body.is_some_and(|body| body.may_collide(&params))
        })
    }

    /// Cuts a body, whose CPU copy is up to date, and records counters and times. Returns nothing
    /// for a removed body.
    ///
    /// Refits the BVH first if something else in the frame queries it, too.
    fn cut_prepared<E>(
        &mut self,
        i: usize,
        is_queried: bool,
        cut: impl FnOnce(&mut Body) -> Result<BodyCut<E>, SceneError>,
    ) -> Result<Option<Result<CutOutcome, E>>, SceneError> {
        let Some(body) = &mut self.bodies[i] else {
            return Ok(None);
        };
        let begin = Instant::now();
        self.stats.bvh_refits += u32::from(body.prepare_cut(is_queried));
        self.stats.narrow_phase_queries += 1;
        self.stats.detection += begin.elapsed();
        let begin = Instant::now();
        let result = cut(body)?;
        self.stats.constraint_update += result.constraints;
        match &result.cut {
            Ok(outcome) => {
                let report = outcome.report;
                self.stats.candidate_triangles += report.candidates;
                self.stats.hit_triangles += report.hits;
                self.stats.detection += report.detection;
                self.stats.topology +=
                    report.split + report.separation + report.commit + report.bvh_update;
                self.stats.refinement += report.cap + report.refinement;
                if !outcome.is_miss() {
                    self.stats.cuts += 1;
                    self.sleep.wake(i);
                    if let Some(gpu) = &mut self.gpu {
                        gpu.record_cut(i);
                    }
                }
            }
            Err(_) => self.stats.detection += begin.elapsed(),
        }
        Ok(Some(result.cut))
    }

    fn record_failed_cut(&mut self, blade: BladeId, i: usize, error: CutError) {
        self.stats.failed_cuts += 1;
        let body = self.body_id(i);
        self.failed_cuts.push(FailedCut { blade, body, error });
    }
}

/// Grows a box on all sides by half of its longest side: a flat box has no height.
///
/// Objects that overlap it may reach the content of the box in the next frame.
pub(crate) fn inflated(bounds: Aabb) -> Aabb {
    let extents = [0, 1, 2].map(|k| bounds.max[k] - bounds.min[k]);
    let half = extents.into_iter().fold(0.0, f32::max) / 2.0;
    Aabb {
        min: bounds.min.map(|c| c - half),
        max: bounds.max.map(|c| c + half),
    }
}

fn count<T>(items: impl Iterator<Item = T>) -> u32 {
    u32::try_from(items.count()).unwrap_or(u32::MAX)
}
