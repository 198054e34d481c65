//! Steps the bodies that are on the CPU, which are independent of each other, in parallel.

use crate::body::BodyId;
use crate::error::SceneError;
use crate::scene::Scene;
use incise_pbd_gpu::StepError;
use rayon::prelude::*;

/// Minimum number of constraints of all stepped bodies for several threads.
///
/// Below it, waking a thread takes longer than the step.
const MIN_PARALLEL: usize = 4096;

impl Scene {
    /// Steps all awake bodies that are on the CPU.
    ///
    /// # Errors
    /// [`SceneError::Step`] with the first body that cannot be stepped. The others are stepped.
    pub(crate) fn step_bodies(&mut self) -> Result<(), SceneError> {
        self.step_all().map_err(|(index, error)| {
            let scene = self.number;
            let body = BodyId { scene, index };
            SceneError::Step { body, error }
        })?;
        for i in 0..self.bodies.len() {
            self.observe_step(i);
        }
        Ok(())
    }

    /// Steps the bodies; returns the first error with the index of its body.
    fn step_all(&mut self) -> Result<(), (usize, StepError)> {
        let (gpu, sleep) = (self.gpu.as_deref(), &self.sleep);
        let is_stepped = |i: usize| !gpu.is_some_and(|gpu| gpu.holds(i)) && !sleep.is_asleep(i);
        let (mut count, mut constraints) = (0, 0);
        for (i, body) in self.bodies.iter().enumerate() {
            if let (true, Some(body)) = (is_stepped(i), body) {
                count += 1;
                constraints += body.constraints();
            }
        }
        let (dt, solver) = (self.params.dt, &self.params.solver);
        let one_thread = solver.threads.is_some_and(|threads| threads.get() == 1);
        let bodies = &mut self.bodies;
        if one_thread || count < 2 || constraints < MIN_PARALLEL {
            let mut first = Ok(());
            for (i, body) in bodies.iter_mut().enumerate() {
                if let (true, Some(body)) = (is_stepped(i), body) {
                    first = first.and(body.step(dt, solver).map(|_| ()).map_err(|e| (i, e)));
                }
            }
            return first;
        }
        // One body a task: sizes differ, and idle threads take the next body.
        let bodies = bodies.par_iter_mut().enumerate().with_max_len(1);
        let errors = bodies.filter_map(|(i, body)| {
            let body = body.as_deref_mut().filter(|_| is_stepped(i))?;
            body.step(dt, solver).err().map(|error| (i, error))
        });
        errors.min_by_key(|&(i, _)| i).map_or(Ok(()), Err)
    }

    /// Adds the step of a body to the statistics and to its time at rest.
    fn observe_step(&mut self, i: usize) {
        let on_gpu = self.gpu.as_ref().is_some_and(|gpu| gpu.holds(i));
        let Some(body) = &mut self.bodies[i] else {
            return;
        };
        if on_gpu || self.sleep.is_asleep(i) {
            return;
        }
        let done = *body.solver().stats();
        self.stats.iterations_skipped += done.iterations_skipped;
        self.stats.ground_passes_skipped += done.ground_passes_skipped;
        if let Some(sleep) = &self.params.sleep
            && let Some(displacement) = self.sleep.observe(i, done.max_substep_displacement)
        {
            let edge = body.solver().mean_rest_length();
            let h = f64::from(self.params.dt) / f64::from(done.substeps);
            let limit = sleep.limit(edge, &body.surface().bounds(), h);
            self.sleep.set_at_rest(i, f64::from(displacement) <= limit);
        }
    }
}
