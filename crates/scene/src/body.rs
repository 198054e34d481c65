//! A soft body: surface, solver and cutter in step with each other.

use crate::contacts::{ContactParams, Reach, Touching};
use crate::error::SceneError;
use crate::struts::Strutting;
use incise_cut::{CutError, CutOutcome, CutParams, Cutter, RayHit, Sweep};
use incise_mesh::{Aabb, Surface, Undo, Vec3};
use incise_pbd_gpu::{
    ConstraintError, Material, PatchParams, Solver, SolverParams, StepError, StepStats,
};
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
    strutting: Strutting,
    touching: Touching,
    /// Whether vertices moved since the search tree was fitted.
    stale: bool,
    /// The body's box when it was last known, if it can be told how far anything moved since.
    known: Option<Known>,
}

/// A box, and by how much the body may have left it since.
#[derive(Debug, Clone, Copy)]
struct Known {
    bounds: Aabb,
    /// \[m\]
    drift: f64,
}

/// What became of a sweep, and how long the constraints took to follow.
pub(crate) struct SweepResult {
    pub(crate) cut: Result<CutOutcome, CutError>,
    pub(crate) constraints: Duration,
}

impl Body {
    pub(crate) fn new(
        mut surface: Surface,
        material: &Material,
        patches: Option<&PatchParams>,
    ) -> Result<Self, ConstraintError> {
        let mut solver = match patches {
            Some(patches) => Solver::with_patches(&mut surface, material, patches)?,
            None => Solver::new(&mut surface, material)?,
        };
        let cutter = Cutter::new(&surface);
        let mut strutting = Strutting::default();
        strutting.fill(&surface, &mut solver, cutter.bvh())?;
        Ok(Self {
            surface,
            solver,
            cutter,
            strutting,
            touching: Touching::default(),
            stale: false,
            known: None,
        })
    }

    /// Where everything is; of a body on a device, where it was when it was last read, see
    /// [`crate::Scene::read`].
    #[must_use]
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Masses, velocities and constraints. Velocities are as old as the surface's positions.
    #[must_use]
    pub fn solver(&self) -> &Solver {
        &self.solver
    }

    /// The solver and the surface together: to pin vertices, set velocities, put vertices elsewhere. The topology is to stay
    /// what it is, since a search tree hangs on it; [`crate::Scene::undo`] takes cuts back.
    pub fn solver_mut(&mut self) -> (&mut Solver, &mut Surface) {
        // Whatever is done, the search tree may no longer fit.
        self.stale = true;
        self.known = None;
        (&mut self.solver, &mut self.surface)
    }

    /// Stretch and bending constraints and struts together.
    #[cfg(feature = "gpu")]
    pub(crate) fn constraints(&self) -> usize {
        let struts = self.solver.struts().map_or(0, |set| set.len());
        self.solver.stretch().len() + self.solver.bending().map_or(0, |set| set.len()) + struts
    }

    /// The surface and the solver, for who moves no vertex.
    pub(crate) fn parts(&mut self) -> (&mut Surface, &mut Solver) {
        (&mut self.surface, &mut self.solver)
    }

    /// The surface and the solver, for who moves vertices.
    #[cfg(feature = "gpu")]
    pub(crate) fn moved_parts(&mut self) -> (&mut Surface, &mut Solver) {
        self.stale = true;
        self.known = None;
        self.parts()
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

    /// Whether the body's box comes to `reach`. What is known of it answers without a look at any vertex
    /// where that is enough; else all are looked at and `measured` goes up by one.
    pub(crate) fn comes_to(&mut self, reach: &Aabb, measured: &mut u32) -> bool {
        if let Some(known) = &self.known
            && !known.overlaps(reach)
        {
            return false;
        }
        self.bounds(measured).overlaps(reach)
    }

    /// The body's box. Vertices are looked at only if any may have moved.
    pub(crate) fn bounds(&mut self, measured: &mut u32) -> Aabb {
        if !self.stale {
            return self.cutter.bvh().bounds();
        }
        if let Some(Known { bounds, drift: 0.0 }) = self.known {
            return bounds;
        }
        *measured += 1;
        let bounds = self.surface.bounds();
        self.known = Some(Known { bounds, drift: 0.0 });
        bounds
    }

    /// Fits the search tree if anything moved; tells whether it did.
    pub(crate) fn refit(&mut self) -> bool {
        if self.stale {
            self.cutter.refit(&self.surface);
            self.know();
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
            self.know();
            let Self {
                surface,
                solver,
                strutting,
                cutter,
                ..
            } = self;
            strutting.cross(surface, solver, sweep);
            solver.apply_delta(surface, &outcome.delta)?;
            strutting.renew(surface, solver, cutter.bvh(), &outcome.delta)?;
        }
        Ok(SweepResult {
            cut,
            constraints: begin.elapsed(),
        })
    }

    /// The first triangle that a ray meets. The search tree must fit.
    pub(crate) fn cast(&self, origin: Vec3, direction: Vec3) -> Option<RayHit> {
        let bvh = self.cutter.bvh();
        bvh.cast(&self.surface, origin, direction, |_| true)
    }

    /// Takes a cut back; constraints and masses follow. The search tree must fit.
    pub(crate) fn undo(&mut self, undo: Undo) -> Result<(), SceneError> {
        let delta = self.cutter.undo(&mut self.surface, undo)?;
        self.know();
        self.solver.apply_delta(&mut self.surface, &delta)?;
        let (surface, bvh) = (&self.surface, self.cutter.bvh());
        self.strutting.fill(surface, &mut self.solver, bvh)?;
        Ok(())
    }

    /// Whether anything of the body may touch anything else of it.
    pub(crate) fn may_touch(&self, params: &ContactParams) -> bool {
        params.own || self.surface.piece_count() > 1
    }

    /// Finds the contacts of the next frame; says how many there are. The search tree must fit if [`Body::may_touch`].
    pub(crate) fn find_contacts(&mut self, reach: &Reach<'_>) -> Result<usize, SceneError> {
        let Self {
            surface,
            solver,
            touching,
            cutter,
            ..
        } = self;
        touching.find(surface, solver, cutter.bvh(), reach)
    }

    /// Has no contacts any more.
    pub(crate) fn drop_contacts(&mut self) -> Result<(), SceneError> {
        Ok(self.solver.set_contacts(&[])?)
    }

    pub(crate) fn step(&mut self, dt: f32, params: &SolverParams) -> Result<StepStats, StepError> {
        if !self.stale {
            self.know();
        }
        self.stale = true;
        match self.solver.step(&mut self.surface, dt, params) {
            Ok(stats) => {
                if let Some(known) = &mut self.known {
                    known.drifts(stats.farthest, stats.substeps);
                }
                Ok(*stats)
            }
            Err(error) => {
                self.known = None;
                Err(error)
            }
        }
    }

    /// Takes the box of the search tree, which fits.
    fn know(&mut self) {
        self.known = Some(Known {
            bounds: self.cutter.bvh().bounds(),
            drift: 0.0,
        });
    }
}

impl Known {
    /// Whether the body may come to `reach`.
    fn overlaps(&self, reach: &Aabb) -> bool {
        (0..3).all(|k| {
            f64::from(self.bounds.min[k]) - self.drift <= f64::from(reach.max[k])
                && f64::from(reach.min[k]) <= f64::from(self.bounds.max[k]) + self.drift
        })
    }

    /// Vertices moved by up to `farthest` \[m\] along each axis, in so many steps that each rounded.
    fn drifts(&mut self, farthest: f32, steps: u32) {
        let corners = self.bounds.min.into_iter().chain(self.bounds.max);
        let largest = corners.map(f32::abs).fold(0.0, f32::max);
        self.drift += f64::from(farthest) * (1.0 + 1e-6);
        self.drift +=
            (f64::from(largest) + self.drift) * f64::from(f32::EPSILON) * f64::from(steps);
    }
}
