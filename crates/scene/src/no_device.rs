//! The device of a build without devices: there is none, so nothing can be asked of it.

use crate::backend::BackendRequest;
use crate::body::Body;
use crate::error::SceneError;
use crate::params::SceneParams;
use crate::scene::Bodies;
use crate::sleep::Sleep;
use crate::stats::FrameStats;
use incise_mesh::{Aabb, Surface};

/// A device that does not exist.
#[derive(Debug)]
pub(crate) enum Device {}

impl Device {
    pub(crate) fn open(_request: &BackendRequest) -> Result<Self, SceneError> {
        Err(SceneError::NoGpuBackend)
    }

    pub(crate) fn open_faster(
        _request: &BackendRequest,
        _params: &SceneParams,
    ) -> Result<Self, String> {
        Err(SceneError::NoGpuBackend.to_string())
    }

    pub(crate) fn name(&self) -> &str {
        match *self {}
    }

    pub(crate) fn takes_from(&self) -> usize {
        match *self {}
    }

    pub(crate) fn holds(&self, _i: usize) -> bool {
        match *self {}
    }

    pub(crate) fn add(&mut self, _i: usize, _body: &mut Body) -> Result<(), SceneError> {
        match *self {}
    }

    pub(crate) fn remove(&mut self, _i: usize) {
        match *self {}
    }

    pub(crate) fn is_fresh(&self, _i: usize) -> bool {
        match *self {}
    }

    pub(crate) fn read(&mut self, _i: usize, _body: &mut Body) -> Result<bool, SceneError> {
        match *self {}
    }

    pub(crate) fn bounds(&mut self, _i: usize) -> Result<Option<Aabb>, SceneError> {
        match *self {}
    }

    pub(crate) fn want(&mut self, _i: usize) {
        match *self {}
    }

    pub(crate) fn note_cut(&mut self, _i: usize) {
        match *self {}
    }

    pub(crate) fn hand_out(&mut self, _i: usize, _surface: &Surface) {
        match *self {}
    }

    pub(crate) fn send_edits(&mut self, _i: usize, _body: &mut Body) -> Result<(), SceneError> {
        match *self {}
    }

    pub(crate) fn step(
        &mut self,
        _bodies: &mut Bodies,
        _params: &SceneParams,
        _sleep: &mut Sleep,
        _stats: &mut FrameStats,
    ) -> Result<(), SceneError> {
        match *self {}
    }

    pub(crate) fn wait(&self) -> Result<(), SceneError> {
        match *self {}
    }

    pub(crate) fn save(&mut self, _bodies: &mut Bodies) {
        match *self {}
    }
}
