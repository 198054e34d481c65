//! Steps of islands, in parallel.

use super::{Islands, NONE};
use crate::body::{Body, BodyId};
use crate::error::SceneError;
use crate::scene::{Bodies, Scene};
use incise_mesh::index_u32;
use incise_pbd_gpu::{Contact, Island, IslandBody, IslandError, SolverParams};
use rayon::prelude::*;

/// Minimum number of constraints of all stepped bodies for several threads.
///
/// Below it, waking a thread takes longer than the step.
const MIN_PARALLEL: usize = 4096;

/// The bodies of an island, owned from grouping to the end of the step.
#[derive(Debug, Default)]
pub(super) struct BodyIsland {
    /// Indices in the scene, ascending.
    pub(super) members: Vec<usize>,
    bodies: Vec<Box<Body>>,
    /// The same, borrowed for a step; empty between frames.
    borrowed: Vec<IslandBody<'static>>,
    pub(super) vertices: u32,
    pub(super) contacts: Vec<Contact>,
    pub(super) solver: Island,
    pub(super) done: Option<IslandError>,
}

impl BodyIsland {
    fn constraints(&self) -> usize {
        self.bodies.iter().map(|body| body.constraints()).sum()
    }

    /// Steps the bodies by one frame.
    fn step(&mut self, dt: f32, params: &SolverParams) {
        for body in &mut self.bodies {
            body.begin_step();
        }
        let done = match self.bodies.as_mut_slice() {
            [body] => {
                let (surface, solver) = body.parts();
                let done = solver.step(surface, dt, params).map(|_| ());
                done.map_err(|error| IslandError { body: 0, error })
            }
            bodies => {
                let mut borrowed: Vec<IslandBody<'_>> = std::mem::take(&mut self.borrowed);
                borrowed.extend(bodies.iter_mut().map(|body| {
                    let (surface, solver) = body.parts();
                    (solver, surface)
                }));
                let done = self.solver.step(&mut borrowed, dt, params);
                borrowed.clear();
                // Reuses the allocation for the borrows of the next frame.
                self.borrowed = borrowed.into_iter().map_while(|_| None).collect();
                done
            }
        };
        for body in &mut self.bodies {
            body.end_step(done.is_ok());
        }
        self.done = done.err();
    }
}

impl Islands {
    /// Adds islands for bodies that fell back from the GPU since the grouping.
    fn add_fallen_back(&mut self, bodies: &mut Bodies, is_stepped: impl Fn(usize) -> bool) {
        for (i, body) in bodies.iter().enumerate() {
            if self.island_of[i] == NONE && body.is_some() && is_stepped(i) {
                self.island_of[i] = index_u32(self.count);
                self.begin_island();
                self.list[self.count - 1].members.push(i);
            }
        }
        self.take(bodies);
    }

    /// Takes the bodies of all islands out of the scene.
    fn take(&mut self, bodies: &mut Bodies) {
        for island in &mut self.list[..self.count] {
            let all = island.members.iter().filter_map(|&i| bodies[i].take());
            island.bodies.extend(all);
        }
    }

    /// Returns the bodies of all islands to the scene.
    fn give_back(&mut self, bodies: &mut Bodies) {
        for island in &mut self.list[..self.count] {
            for (&i, body) in island.members.iter().zip(island.bodies.drain(..)) {
                bodies[i] = Some(body);
            }
        }
    }

    /// Steps all islands, which are independent of each other, in parallel.
    fn step(&mut self, dt: f32, params: &SolverParams) {
        let islands = &mut self.list[..self.count];
        let constraints: usize = islands.iter().map(BodyIsland::constraints).sum();
        let one_thread = params.threads.is_some_and(|threads| threads.get() == 1);
        if one_thread || islands.len() < 2 || constraints < MIN_PARALLEL {
            islands
                .iter_mut()
                .for_each(|island| island.step(dt, params));
        } else {
            // One island a task: sizes differ, and idle threads take the next one.
            let islands = islands.par_iter_mut().with_max_len(1);
            islands.for_each(|island| island.step(dt, params));
        }
    }

    /// Returns the error of the first body that could not be stepped.
    fn error(&self) -> Option<(usize, IslandError)> {
        let islands = self.list[..self.count].iter();
        let errors = islands.filter_map(|island| {
            let error = island.done?;
            Some((island.members[error.body], error))
        });
        errors.min_by_key(|(body, _)| *body)
    }
}

impl Scene {
    /// Steps the frame of all awake bodies, on the GPU and on the CPU.
    ///
    /// # Errors
    /// [`SceneError::Step`] with the first body that cannot be stepped; those of other islands are
    /// stepped. [`SceneError`] of the GPU when it fails.
    pub(crate) fn step_islands(&mut self) -> Result<(), SceneError> {
        self.islands.take(&mut self.bodies);
        // Bodies that an island took are not in the scene, so the GPU does not step them.
        let on_gpu = self.step_gpu();
        if on_gpu.is_ok() {
            let Self {
                bodies,
                islands,
                sleep,
                gpu,
                ..
            } = self;
            let is_on_gpu = |i: usize| gpu.as_ref().is_some_and(|gpu| gpu.holds(i));
            islands.add_fallen_back(bodies, |i| !sleep.is_asleep(i) && !is_on_gpu(i));
            self.islands.step(self.params.dt, &self.params.solver);
        }
        self.islands.give_back(&mut self.bodies);
        self.islands.store_friction_anchors(&self.bodies);
        on_gpu?;
        if let Some((index, IslandError { error, .. })) = self.islands.error() {
            let scene = self.number;
            let body = BodyId { scene, index };
            return Err(SceneError::Step { body, error });
        }
        for island in &self.islands.list[..self.islands.count] {
            self.sleep.join(&island.members);
        }
        for i in 0..self.bodies.len() {
            if self.islands.members(i).is_some() {
                self.observe_step(i);
            }
        }
        Ok(())
    }

    /// Adds the step of a body to the statistics and to its time at rest.
    fn observe_step(&mut self, i: usize) {
        let Some(body) = &mut self.bodies[i] else {
            return;
        };
        let done = *body.solver().stats();
        self.stats.iterations_skipped += done.iterations_skipped;
        if let Some(sleep) = &self.params.sleep
            && let Some(displacement) = self.sleep.observe(i, done.max_substep_displacement)
        {
            let edge = body.solver().resolution();
            let h = body.solver().substep();
            let limit = sleep.limit(edge, &body.surface().bounds(), h.into());
            self.sleep.set_at_rest(i, f64::from(displacement) <= limit);
        }
    }
}
