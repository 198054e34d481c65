//! Where cases are run: the processor or a device, in short or in full.

use super::device::{Device, Place};
use super::failure::Failure;
use super::islands::Islands;
use super::map::Cell;
use super::sleep::CutAsleep;
use incise_mesh::{Surface, TopologyDelta};
use incise_pbd_gpu::{Material, Solver, SolverParams};
use incise_scene::{Scene, SceneParams};

/// How much of a case is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Effort {
    /// A part, for tests.
    Quick,
    /// All of it.
    Full,
}

/// How a device goes through the constraints of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Way {
    /// As it finds best.
    Own,
    /// A workgroup does a whole frame of a body that fits into its memory.
    WholeBody,
    /// Color by color.
    Colors,
    /// Patch by patch; for bodies that are divided into patches.
    Patches,
}

impl Way {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Own => "its own way",
            Self::WholeBody => "whole",
            Self::Colors => "by color",
            Self::Patches => "by patch",
        }
    }
}

/// What executes the cases, and how much of them.
#[derive(Debug)]
pub(super) struct Stage {
    pub(super) effort: Effort,
    /// None: the processor.
    pub(super) device: Option<Device>,
    /// What ten million substeps of a spinning body came to, once they were made: two laws look at it.
    pub(super) spun: Option<[f64; 2]>,
    /// What cuts of bodies that sleep came to, once they were made: two laws look at it.
    pub(super) cut_asleep: Option<CutAsleep>,
    /// What bodies that were cut down to islands came to, once they were: two laws look at it.
    pub(super) islands: Option<Islands>,
    /// The stability map, once it was made: it can be drawn.
    pub(super) map: Option<Vec<Cell>>,
}

impl Stage {
    pub(super) fn new(effort: Effort, device: Option<Device>) -> Self {
        Self {
            effort,
            device,
            spun: None,
            islands: None,
            cut_asleep: None,
            map: None,
        }
    }

    /// One number in short, another in full.
    pub(super) fn pick<T>(&self, quick: T, full: T) -> T {
        match self.effort {
            Effort::Quick => quick,
            Effort::Full => full,
        }
    }

    /// An empty scene on what executes the cases.
    ///
    /// # Errors
    /// [`Failure`] when the device is not opened a second time.
    pub(super) fn scene(&self, params: SceneParams) -> Result<Scene, Failure> {
        Ok(match &self.device {
            Some(device) => Scene::with_backend(params, &device.backend())?,
            None => Scene::new(params),
        })
    }

    /// Sets a body up. It may be posed already: rest positions are the surface's own.
    ///
    /// # Errors
    /// [`Failure`] when the solver or the device refuses it.
    pub(super) fn enter(
        &mut self,
        mut surface: Surface,
        material: &Material,
    ) -> Result<Mover<'_>, Failure> {
        let solver = Solver::new(&mut surface, material)?;
        self.enter_with(surface, solver)
    }

    /// As [`Stage::enter`], with a solver that is there.
    ///
    /// # Errors
    /// [`Failure`] when the device refuses it.
    pub(super) fn enter_with(
        &mut self,
        surface: Surface,
        mut solver: Solver,
    ) -> Result<Mover<'_>, Failure> {
        let device = match &mut self.device {
            Some(device) => {
                let place = device.add(&surface, &mut solver)?;
                Some((device, place))
            }
            None => None,
        };
        Ok(Mover {
            surface,
            solver,
            device,
        })
    }
}

/// A body in motion. On a device it is removed when it goes out of scope.
#[derive(Debug)]
pub(super) struct Mover<'a> {
    pub(super) surface: Surface,
    pub(super) solver: Solver,
    device: Option<(&'a mut Device, Place)>,
}

impl Mover<'_> {
    /// Steps by one frame of `dt` \[s\]; surface and solver are up to date after it.
    ///
    /// # Errors
    /// [`Failure`] when the step is refused or a position stops being a number.
    pub(super) fn step(&mut self, dt: f32, params: &SolverParams) -> Result<(), Failure> {
        self.advance(dt, params, 1)
    }

    /// Steps by so many frames and looks at the last only.
    ///
    /// # Errors
    /// As [`Mover::step`].
    pub(super) fn advance(
        &mut self,
        dt: f32,
        params: &SolverParams,
        frames: u32,
    ) -> Result<(), Failure> {
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

    /// How far edges are from their rest lengths, on average.
    pub(super) fn strain(&self) -> f64 {
        self.solver.stretch_error(&self.surface)
    }

    /// The farthest that any edge is from its rest length, over it.
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

    /// Tells that positions were set on the host.
    ///
    /// # Errors
    /// [`Failure`] when the device refuses it.
    pub(super) fn moved(&mut self) -> Result<(), Failure> {
        if let Some((device, place)) = &mut self.device {
            device.remove(*place);
            *place = device.add(&self.surface, &mut self.solver)?;
        }
        Ok(())
    }

    /// The bytes that bodies on the device have room for before buffers are replaced by larger ones; 0 without one.
    pub(super) fn reserved(&self) -> u64 {
        (self.device.as_ref()).map_or(0, |(device, _)| device.reserved())
    }

    /// Ends the device that the body is on.
    pub(super) fn lose_device(&self) {
        if let Some((device, _)) = &self.device {
            device.lose();
        }
    }

    /// Follows an edit of the surface.
    ///
    /// # Errors
    /// [`Failure`] when solver or device cannot.
    pub(super) fn follow(&mut self, delta: &TopologyDelta) -> Result<(), Failure> {
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

impl Drop for Mover<'_> {
    fn drop(&mut self) {
        if let Some((device, place)) = &mut self.device {
            device.remove(*place);
        }
    }
}
