//! Runs stress cases on the CPU or a GPU, quick or full.

use super::device::{Device, Place};
use super::error::StressError;
use super::map::Cell;
use super::measured::Measured;
use super::subjects::Subject;
use super::workers::side_by_side;
use incise_mesh::{Surface, TopologyDelta};
use incise_pbd_gpu::{Material, Solver, SolverParams};
use incise_scene::{BackendRequest, Scene, SceneParams};
use std::sync::Arc;

/// How much of a case runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Effort {
    /// A part of the runs.
    Quick,
    /// All runs.
    Full,
}

/// The size of the cases, and their models.
#[derive(Debug, Clone)]
pub(super) struct Setting {
    pub(super) effort: Effort,
    /// The models of cases over models, smallest first.
    pub(super) subjects: Arc<[Subject]>,
    /// Runs per model of cases over models; `None` leaves it to the case.
    pub(super) samples: Option<u32>,
    /// Text that the descriptions of these runs contain; others are left out.
    pub(super) matching: Option<String>,
}

/// The backend and setting of the cases.
#[derive(Debug)]
pub(super) struct Runner {
    pub(super) setting: Setting,
    /// The GPU; none for the CPU.
    pub(super) device: Option<Device>,
    /// The stability map, for `--plot`.
    pub(super) map: Option<Vec<Cell>>,
    /// The runs that the cases of a group share, once they are made.
    pub(super) measured: Option<Vec<Measured>>,
}

impl Runner {
    pub(super) fn new(setting: Setting, device: Option<Device>) -> Self {
        Self {
            setting,
            device,
            map: None,
            measured: None,
        }
    }

    /// Returns one value in a quick run, another in a full one.
    pub(super) fn pick<T>(&self, quick: T, full: T) -> T {
        match self.setting.effort {
            Effort::Quick => quick,
            Effort::Full => full,
        }
    }

    /// Runs every item: side by side on the CPU, one after the other on a GPU.
    pub(super) fn each<T: Sync, R: Send>(
        &self,
        items: &[T],
        run: impl Fn(&BackendRequest, &T) -> R + Sync,
    ) -> Vec<R> {
        match &self.device {
            Some(device) => {
                let backend = device.backend();
                items.iter().map(|item| run(&backend, item)).collect()
            }
            None => side_by_side(items, |item| run(&BackendRequest::default(), item)),
        }
    }

    /// Returns an empty scene on the backend.
    ///
    /// # Errors
    /// [`StressError`] when the GPU cannot be opened again.
    pub(super) fn scene(&self, params: SceneParams) -> Result<Scene, StressError> {
        Ok(match &self.device {
            Some(device) => Scene::with_backend(params, &device.backend())?,
            None => Scene::new(params),
        })
    }

    /// Sets up a body, which may be deformed.
    ///
    /// # Errors
    /// [`StressError`] when the solver or the device refuses it.
    pub(super) fn enter(
        &mut self,
        mut surface: Surface,
        material: &Material,
    ) -> Result<Body<'_>, StressError> {
        let solver = Solver::new(&mut surface, material)?;
        self.enter_with(surface, solver)
    }

    /// As [`Runner::enter`], with a given solver.
    ///
    /// # Errors
    /// [`StressError`] when the device refuses it.
    pub(super) fn enter_with(
        &mut self,
        surface: Surface,
        mut solver: Solver,
    ) -> Result<Body<'_>, StressError> {
        let device = match &mut self.device {
            Some(device) => {
                let place = device.add(&surface, &mut solver)?;
                Some((device, place))
            }
            None => None,
        };
        Ok(Body {
            surface,
            solver,
            device,
        })
    }
}

/// A body in motion; dropping it removes it from the GPU.
#[derive(Debug)]
pub(super) struct Body<'a> {
    pub(super) surface: Surface,
    pub(super) solver: Solver,
    device: Option<(&'a mut Device, Place)>,
}

impl Body<'_> {
    /// Steps by one frame of `dt` \[s\]; surface and solver are up to date after it.
    ///
    /// # Errors
    /// [`StressError`] when the step is refused or a position stops being a number.
    pub(super) fn step(&mut self, dt: f32, params: &SolverParams) -> Result<(), StressError> {
        self.advance(dt, params, 1)
    }

    /// Steps by several frames and reads back the last state.
    ///
    /// # Errors
    /// As [`Body::step`].
    pub(super) fn advance(
        &mut self,
        dt: f32,
        params: &SolverParams,
        frames: u32,
    ) -> Result<(), StressError> {
        let Self {
            surface,
            solver,
            device,
        } = self;
        match device {
            Some((device, place)) => {
                for _ in 0..frames {
                    device.step(*place, solver, dt, params)?;
                }
                device.read(*place, surface, solver)
            }
            None => {
                for _ in 0..frames {
                    solver.step(surface, dt, params)?;
                }
                Ok(())
            }
        }
    }

    /// Returns the mean strain of edges.
    pub(super) fn strain(&self) -> f64 {
        self.solver.stretch_error(&self.surface)
    }

    /// Returns the largest strain of an edge.
    pub(super) fn largest_strain(&self) -> f64 {
        let set = self.solver.stretch();
        let mut largest = 0.0_f64;
        for batch in set.batches().iter().chain([set.overflow()]) {
            for (&[a, b], &rest) in batch.vertices().iter().zip(batch.rest()) {
                let length = (self.surface.position(a) - self.surface.position(b)).norm();
                largest = largest.max((length / f64::from(rest) - 1.0).abs());
            }
        }
        largest
    }

    /// Follows an edit of the surface.
    ///
    /// # Errors
    /// [`StressError`] when solver or device cannot.
    pub(super) fn follow(&mut self, delta: &TopologyDelta) -> Result<(), StressError> {
        let Self {
            surface,
            solver,
            device,
        } = self;
        solver.apply_delta(surface, delta)?;
        match device {
            Some((device, place)) => device.update(*place, surface, solver),
            None => Ok(()),
        }
    }
}

impl Drop for Body<'_> {
    fn drop(&mut self) {
        if let Some((device, place)) = &mut self.device {
            device.remove(*place);
        }
    }
}
