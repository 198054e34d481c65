//! The scheme of a body: sweeps or the global step, chosen in every frame.

use super::Solver;
use crate::global::{
    Choice, Extent, FAILED_SEARCH_TIME, FREE_STRAIN, GlobalStats, MAX_ELASTIC, Obstacles,
    SETTLING_TIME,
};
use crate::material::Stiffness;
use crate::step::constants::StepConstants;
use crate::step::params::{Scheme, SolverParams};
use incise_mesh::Surface;

impl Solver {
    /// Chooses the scheme of a frame of `dt` \[s\], by contacts, the size of the body and its past.
    pub(crate) fn choose_scheme(
        &mut self,
        surface: &Surface,
        is_touched: bool,
        dt: f32,
        params: &SolverParams,
    ) -> Choice {
        if params.scheme == Scheme::Auto && self.step.extent.is_none() {
            let edge = self.mean_rest_length();
            self.step.extent = Some(Extent::new(surface, &self.particles.mass, edge));
        }
        let of_body = (self.step.extent, dt, self.step.was_global_chosen);
        if self.is_solid() {
            self.step.choice = Choice::Sweeps;
            return Choice::Sweeps;
        }
        self.step.was_global_chosen = crate::global::is_chosen(params, &self.material, of_body);
        if !self.step.was_global_chosen {
            self.record_sweeps();
            self.step.choice = Choice::Sweeps;
            return Choice::Sweeps;
        }
        let is_touched = is_touched
            || !self.constraints.contacts.is_empty()
            || self.may_touch_obstacles(surface, dt, params);
        let before = self.step.settling_time_left;
        (self.step.choice, self.step.settling_time_left) = if is_touched {
            (Choice::ShortSubsteps, SETTLING_TIME)
        } else if before > dt && !self.is_relaxed(surface, params) {
            let is_settling = before <= SETTLING_TIME;
            let choice = if is_settling {
                Choice::Settling
            } else {
                Choice::ShortSubsteps
            };
            (choice, before - dt)
        } else {
            (Choice::Global, 0.0)
        };
        self.step.choice
    }

    /// Returns whether the body has little elastic energy for its motion, weight and stiffness.
    fn is_relaxed(&mut self, surface: &Surface, params: &SolverParams) -> bool {
        let edge = self.known_mean_rest_length();
        let global = self.step.global.get_or_insert_default();
        let elastic = global.elastic_energy((&self.constraints, surface), &self.material);
        let squares = params.gravity.map(|g| f64::from(g) * f64::from(g));
        let gravity = squares.iter().sum::<f64>().sqrt();
        let mass: f64 = self.particles.mass.iter().map(|&m| f64::from(m)).sum();
        let weight = mass * gravity * surface.bounds().diagonal();
        let free = match self.material.stretch {
            Stiffness::Compliance(c) => {
                let edges = self.constraints.stretch.len() as f64;
                edges * (FREE_STRAIN * edge).powi(2) / (2.0 * f64::from(c))
            }
            Stiffness::Pbd(_) => 0.0,
        };
        elastic <= MAX_ELASTIC * (self.kinetic_energy() + weight) + free
    }

    /// Records a frame of sweeps, after which the body settles if it takes the global step.
    pub(crate) fn record_sweeps(&mut self) {
        self.step.settling_time_left = SETTLING_TIME;
    }

    /// Ends a frame: a body whose line search failed takes sweeps for some time.
    pub(crate) fn record_failed_search(&mut self) {
        let global = self.step.global.as_ref();
        if self.step.choice.is_global() && global.is_some_and(|global| global.line_search_failed())
        {
            self.step.settling_time_left = FAILED_SEARCH_TIME + SETTLING_TIME;
        }
    }

    /// Returns whether a collider may stop a vertex within a frame of `dt` \[s\].
    fn may_touch_obstacles(&mut self, surface: &Surface, dt: f32, params: &SolverParams) -> bool {
        if self.constraints.colliders.records().is_empty() {
            return false;
        }
        let edge = self.known_mean_rest_length();
        let obstacles = Obstacles {
            colliders: self.constraints.colliders.records(),
            gravity: params.gravity,
        };
        let body = (surface, &*self.particles.velocities);
        obstacles.may_touch(body, dt, edge)
    }

    /// Prepares the global step of a frame, or drops it from a body that no longer asks for it.
    pub(crate) fn prepare_global(
        &mut self,
        surface: &Surface,
        constants: &StepConstants,
        params: &SolverParams,
    ) {
        match self.step.choice {
            // One that chooses by the time step may take it again.
            Choice::Sweeps if params.scheme == Scheme::Auto => {}
            Choice::Sweeps => self.step.global = None,
            Choice::ShortSubsteps => {}
            Choice::Settling | Choice::Global => {
                let is_settling = self.step.choice == Choice::Settling;
                let size = is_settling.then(|| surface.bounds().diagonal());
                let global = self.step.global.get_or_insert_default();
                let body = (&self.particles, &self.constraints, surface);
                global.prepare(body, constants, params, size);
            }
        }
    }

    /// Returns memory and cost of the global step; zero for a body that never takes it.
    ///
    /// A body in contact or after a failed line search takes sweeps and keeps its factor, whose age
    /// stands still.
    #[must_use]
    pub fn global_stats(&self) -> GlobalStats {
        let global = self.step.global.as_ref();
        global.map(|global| global.stats()).unwrap_or_default()
    }
}
