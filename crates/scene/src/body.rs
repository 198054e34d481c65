//! A soft body: surface, solver and cutter in step with each other.

use crate::error::SceneError;
use incise_cut::{CutError, CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::Surface;
use incise_pbd_gpu::{ConstraintError, Material, Solver};
use std::time::{Duration, Instant};

/// A body of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BodyId(pub(crate) usize);

/// A soft body. Cut into pieces it stays one body, of one material.
#[derive(Debug, Clone)]
pub struct Body {
    surface: Surface,
    solver: Solver,
    cutter: Cutter,
    /// Whether vertices moved since the search tree was fitted.
    stale: bool,
}

/// What became of a sweep, and how long the constraints took to follow.
pub(crate) struct SweepResult {
    pub(crate) cut: Result<CutOutcome, CutError>,
    pub(crate) constraints: Duration,
}

impl Body {
    pub(crate) fn new(mut surface: Surface, material: &Material) -> Result<Self, ConstraintError> {
        let solver = Solver::new(&mut surface, material)?;
        let cutter = Cutter::new(&surface);
        Ok(Self {
            surface,
            solver,
            cutter,
            stale: false,
        })
    }

    /// Where everything is.
    #[must_use]
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Masses, velocities and constraints.
    #[must_use]
    pub fn solver(&self) -> &Solver {
        &self.solver
    }

    /// The solver and the surface together: to pin vertices and set velocities.
    pub fn solver_mut(&mut self) -> (&mut Solver, &mut Surface) {
        // A pin moves vertices, so the search tree may no longer fit.
        self.stale = true;
        (&mut self.solver, &mut self.surface)
    }

    /// The numbers of the body's pieces, ascending.
    #[must_use]
    pub fn pieces(&self) -> Vec<u32> {
        let mut pieces: Vec<u32> = self
            .surface
            .topology()
            .triangles()
            .map(|t| self.surface.piece(t))
            .collect();
        pieces.sort_unstable();
        pieces.dedup();
        pieces
    }

    /// Fits the search tree if anything moved; tells whether it did.
    pub(crate) fn refit(&mut self) -> bool {
        if self.stale {
            self.cutter.refit(&self.surface);
        }
        std::mem::replace(&mut self.stale, false)
    }

    /// Cuts; constraints and masses follow. The search tree must fit.
    pub(crate) fn cut(
        &mut self,
        sweep: &Sweep,
        params: &CutParams,
    ) -> Result<SweepResult, SceneError> {
        let cut = self.cutter.cut(&mut self.surface, sweep, params);
        let begin = Instant::now();
        if let Ok(outcome) = &cut
            && !outcome.delta.is_empty()
        {
            self.solver.apply_delta(&mut self.surface, &outcome.delta)?;
        }
        Ok(SweepResult {
            cut,
            constraints: begin.elapsed(),
        })
    }

    pub(crate) fn step(
        &mut self,
        dt: f32,
        params: &incise_pbd_gpu::SolverParams,
    ) -> Result<(), incise_pbd_gpu::StepError> {
        self.stale = true;
        self.solver.step(&mut self.surface, dt, params)?;
        Ok(())
    }
}
