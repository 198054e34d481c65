//! The origin of a surface in the coordinates of its file.

use super::Surface;
use crate::geometry::{Vec3, to_f32, to_f64};

impl Surface {
    /// Returns the origin of positions in the coordinates of the surface's file \[m\].
    ///
    /// Zero unless the file is far from its origin compared to its size. Writers add it to
    /// positions. Edits, copies and extracted pieces keep it.
    #[must_use]
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Sets [`Self::origin`] without a change of positions, which moves the surface in its file.
    pub fn set_origin(&mut self, origin: [f64; 3]) {
        self.origin = origin;
    }

    /// Changes [`Self::origin`] and positions, so that the surface stays in place in its file.
    ///
    /// Positions and rest positions are rounded once. Surfaces of one scene need the same origin.
    pub fn move_origin(&mut self, origin: [f64; 3]) {
        if origin == self.origin {
            return;
        }
        let by = Vec3::from(self.origin) - Vec3::from(origin);
        for p in self.positions_mut() {
            let [x, y, z] = to_f32(to_f64([p[0], p[1], p[2]]) + by);
            *p = [x, y, z, p[3]];
        }
        for p in &mut self.rest {
            *p = to_f32(to_f64(*p) + by);
        }
        self.origin = origin;
    }

    /// Returns a position in the file's coordinates, or none if they are the surface's own.
    #[cfg(feature = "io")]
    pub(crate) fn file_position(&self, p: [f32; 3]) -> Option<[f64; 3]> {
        let p = [0, 1, 2].map(|k| self.origin[k] + f64::from(p[k]));
        (self.origin != [0.0; 3]).then_some(p)
    }
}
