//! [`SavedCutter`]: the state of a cutter that later cuts depend on, for files.

use super::Cutter;
use crate::exact::Exact;
use incise_mesh::{Bvh, InvalidBvh, SavedBvh, Surface};
use serde::{Deserialize, Serialize};

/// A motion version that no surface has.
const NO_MOTION: u64 = u64::MAX;

/// The state of a [`Cutter`], as it is saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SavedCutter<'a> {
    /// `None` if the surface was edited by something else, so that it is built again.
    bvh: Option<SavedBvh<'a>>,
    /// Whether the BVH fits the present positions.
    is_fitted: bool,
    has_sheets: bool,
    has_walls: bool,
    has_cavities: Option<bool>,
}

impl Cutter {
    /// Returns the state as plain data for a file; `surface` is the one that is cut.
    #[must_use]
    pub fn to_saved(&self, surface: &Surface) -> SavedCutter<'_> {
        let is_current = self.version.topology == surface.fingerprint();
        SavedCutter {
            bvh: is_current.then(|| self.bvh.to_saved()),
            is_fitted: self.version.motion == surface.motion_version(),
            has_sheets: self.has_sheets,
            has_walls: self.has_walls,
            has_cavities: self.exact.has_cavities(),
        }
    }

    /// Returns a saved cutter for its surface, which must be valid. O(n).
    ///
    /// # Errors
    /// [`InvalidBvh`] if it is not a cutter of the surface.
    pub fn from_saved(saved: SavedCutter<'_>, surface: &Surface) -> Result<Self, InvalidBvh> {
        let Some(bvh) = saved.bvh else {
            return Ok(Self::new(surface));
        };
        let mut cutter = Self::with_bvh(Bvh::from_saved(bvh, surface)?, surface);
        if !saved.is_fitted {
            cutter.version.motion = NO_MOTION;
        }
        cutter.has_sheets = saved.has_sheets;
        cutter.has_walls = saved.has_walls;
        cutter.exact = Exact::with_cavities(saved.has_cavities);
        Ok(cutter)
    }
}
