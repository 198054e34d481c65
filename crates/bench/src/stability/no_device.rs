//! No device: a build without the feature `gpu`.

use super::failure::Failure;
use super::stage::Way;
use incise_mesh::Surface;
use incise_pbd_gpu::{Solver, SolverParams};
use incise_scene::BackendRequest;

/// What there is none of.
#[derive(Debug)]
pub(super) enum Device {}

/// A body on it.
#[derive(Debug, Clone, Copy)]
pub(super) enum Place {}

impl Device {
    /// Says that there is none.
    ///
    /// # Errors
    /// Always.
    pub(super) fn open(_adapter: Option<&str>) -> Result<Self, Failure> {
        let why = "this build has no GPU support; build it with the feature gpu";
        Err(Failure::Device(why.to_owned()))
    }

    pub(super) fn again(&self) -> Result<Self, Failure> {
        match *self {}
    }

    pub(super) fn portable(&self) -> Result<Self, Failure> {
        match *self {}
    }

    pub(super) fn backend(&self) -> BackendRequest {
        match *self {}
    }

    pub(super) fn reserved(&self) -> u64 {
        match *self {}
    }

    pub(super) fn describe(&self) -> String {
        match *self {}
    }

    pub(super) fn force(&mut self, _: Way) {
        match *self {}
    }

    pub(super) fn lose(&self) {
        match *self {}
    }

    pub(super) fn add(&mut self, _: &Surface, _: &mut Solver) -> Result<Place, Failure> {
        match *self {}
    }

    pub(super) fn remove(&mut self, _: Place) {
        match *self {}
    }

    pub(super) fn step(
        &mut self,
        _: Place,
        _: &mut Solver,
        _: f32,
        _: &SolverParams,
    ) -> Result<(), Failure> {
        match *self {}
    }

    pub(super) fn update(&mut self, _: Place, _: &Surface, _: &mut Solver) -> Result<(), Failure> {
        match *self {}
    }

    pub(super) fn read(
        &mut self,
        _: Place,
        _: &mut Surface,
        _: &mut Solver,
    ) -> Result<(), Failure> {
        match *self {}
    }
}
