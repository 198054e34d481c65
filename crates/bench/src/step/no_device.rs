//! No device: a build without the feature `gpu`.

use super::ScheduleChoice;
use super::case::Case;
use super::row::Row;
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

    pub(super) fn describe(&self) -> String {
        match *self {}
    }

    pub(super) fn faster_from(&mut self, _params: &SolverParams) -> Result<Option<usize>, String> {
        match *self {}
    }

    pub(super) fn rows(&mut self, _case: &Case<'_>, _asked: &[ScheduleChoice]) -> Vec<Row> {
        match *self {}
    }
}
