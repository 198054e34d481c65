//! No device: a build without the feature `gpu`.

use super::run::Run;
use super::scene::Body;
use incise_pbd_gpu::SolverParams;

/// What there is none of.
pub(super) enum Device {}

impl Device {
    /// Says that there is none.
    ///
    /// # Errors
    /// Always.
    pub(super) fn open(_adapter: Option<&str>) -> Result<Self, String> {
        Err("this build has no GPU support; build it with the feature gpu".to_owned())
    }

    pub(super) fn name(&self) -> &str {
        match *self {}
    }

    pub(super) fn run(
        &mut self,
        _body: &Body,
        _params: &SolverParams,
        _frames: u32,
    ) -> Result<Run, String> {
        match *self {}
    }
}
