//! No device: a build without the feature `gpu`.

use super::{Effort, Measurement};
use std::error::Error;

/// What there is none of.
#[derive(Debug)]
pub(super) enum Device {}

impl Device {
    /// Says that there is none.
    ///
    /// # Errors
    /// Always.
    pub(super) fn open(_adapter: Option<&str>) -> Result<Self, Box<dyn Error>> {
        Err("this build has no GPU support; build it with the feature gpu".into())
    }

    pub(super) fn describe(&self) -> String {
        match *self {}
    }

    pub(super) fn measurements(&self, _: Effort) -> Vec<Measurement<'_>> {
        match *self {}
    }
}
