//! [`BodyId`]: the name of a body in one scene.

use crate::scene::SceneNumber;
use std::fmt;

/// The id of a body in one scene. Shown as the body's index.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BodyId {
    pub(crate) scene: SceneNumber,
    pub(crate) index: usize,
}

impl BodyId {
    /// Returns the number of bodies that were added to the scene before this one.
    #[must_use]
    pub const fn index(self) -> usize {
        self.index
    }
}

impl fmt::Display for BodyId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.index.fmt(f)
    }
}
