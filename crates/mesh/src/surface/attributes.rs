//! Access to the per-vertex and per-corner arrays of a [`Surface`], which callers cannot resize.

use super::Surface;
use crate::geometry::{Vec3, to_f64};
use crate::ids::VertexId;
use std::sync::atomic::{AtomicU64, Ordering};

/// Texture coordinates and normals of corners.
///
/// A seam is an edge or vertex at which corners of one vertex differ; it never splits the vertex.
/// Each array is empty or has three entries for each triangle slot.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CornerAttributes {
    /// Texture coordinates, shape \[3 x triangle slots\].
    pub uv: Vec<[f32; 2]>,
    /// Shading normals, shape \[3 x triangle slots\].
    pub normal: Vec<[f32; 3]>,
}

impl CornerAttributes {
    /// Extends non-empty arrays by zeros for new triangle slots.
    pub(crate) fn fit(&mut self, triangle_slots: usize) {
        if !self.uv.is_empty() {
            self.uv.resize(3 * triangle_slots, [0.0; 2]);
        }
        if !self.normal.is_empty() {
            self.normal.resize(3 * triangle_slots, [0.0; 3]);
        }
    }
}

/// The error of an array of corner attributes with the wrong length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "{found} corner attributes do not fit the surface: pass none or {expected}, three per triangle \
     slot"
)]
#[non_exhaustive]
pub struct AttributeLengthError {
    /// Number of corners of all triangle slots.
    pub expected: usize,
    /// Length of the array.
    pub found: usize,
}

/// Returns a number that no other call in this process returns.
fn next_stamp() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

impl Surface {
    /// Returns positions \[m\] and inverse masses \[1/kg\] (0 = pinned), shape \[vertex slots\].
    #[must_use]
    #[inline]
    pub fn positions(&self) -> &[[f32; 4]] {
        &self.positions
    }

    /// Returns [`Self::positions`] for writing.
    #[must_use]
    #[inline]
    pub fn positions_mut(&mut self) -> &mut [[f32; 4]] {
        self.motion = next_stamp();
        &mut self.positions
    }

    /// Returns the largest coordinate without its sign \[m\], NaN or infinite if one is. O(n).
    ///
    /// Vertex slots that are not in use count, too.
    #[must_use]
    pub fn largest_coordinate(&self) -> f32 {
        // As integers, without signs, NaN exceeds infinity, which exceeds all others.
        let bits = self.positions.iter().fold([0; 3], |largest, p| {
            [0, 1, 2].map(|k| p[k].abs().to_bits().max(largest[k]))
        });
        f32::from_bits(bits.into_iter().fold(0, u32::max))
    }

    /// Returns a number that differs after each access to positions for writing. O(1).
    ///
    /// Equal numbers of a surface and its clone mean equal positions, except for edits, which
    /// [`Surface::fingerprint`] covers.
    #[must_use]
    #[inline]
    pub fn motion_version(&self) -> u64 {
        self.motion
    }

    /// Returns rest positions \[m\], shape \[vertex slots\].
    #[must_use]
    #[inline]
    pub fn rest_positions(&self) -> &[[f32; 3]] {
        &self.rest
    }

    /// Returns [`Self::rest_positions`] for writing.
    #[must_use]
    #[inline]
    pub fn rest_positions_mut(&mut self) -> &mut [[f32; 3]] {
        &mut self.rest
    }

    /// Returns the position of `v` \[m\].
    #[must_use]
    #[inline]
    pub fn position(&self, v: VertexId) -> Vec3 {
        let [x, y, z, _] = self.positions[v.index()];
        to_f64([x, y, z])
    }

    /// Returns the rest position of `v` \[m\].
    #[must_use]
    #[inline]
    pub fn rest_position(&self, v: VertexId) -> Vec3 {
        to_f64(self.rest[v.index()])
    }

    /// Returns texture coordinates per corner: empty, or of shape \[3 x triangle slots\].
    #[must_use]
    #[inline]
    pub fn corner_uvs(&self) -> &[[f32; 2]] {
        &self.corners.uv
    }

    /// Returns [`Self::corner_uvs`] for writing.
    #[must_use]
    #[inline]
    pub fn corner_uvs_mut(&mut self) -> &mut [[f32; 2]] {
        &mut self.corners.uv
    }

    /// Replaces all texture coordinates; an empty array removes them.
    ///
    /// # Errors
    /// [`AttributeLengthError`] unless the array is empty or has an entry per corner.
    pub fn set_corner_uvs(&mut self, uvs: Vec<[f32; 2]>) -> Result<(), AttributeLengthError> {
        self.check_corner_count(uvs.len())?;
        self.corners.uv = uvs;
        Ok(())
    }

    /// Returns shading normals per corner: empty, or of shape \[3 x triangle slots\].
    #[must_use]
    #[inline]
    pub fn corner_normals(&self) -> &[[f32; 3]] {
        &self.corners.normal
    }

    /// Returns [`Self::corner_normals`] for writing.
    #[must_use]
    #[inline]
    pub fn corner_normals_mut(&mut self) -> &mut [[f32; 3]] {
        &mut self.corners.normal
    }

    /// Replaces all shading normals; an empty array removes them.
    ///
    /// # Errors
    /// [`AttributeLengthError`] unless the array is empty or has an entry per corner.
    pub fn set_corner_normals(
        &mut self,
        normals: Vec<[f32; 3]>,
    ) -> Result<(), AttributeLengthError> {
        self.check_corner_count(normals.len())?;
        self.corners.normal = normals;
        Ok(())
    }

    fn check_corner_count(&self, found: usize) -> Result<(), AttributeLengthError> {
        let expected = 3 * self.topology.triangle_slots();
        if found == 0 || found == expected {
            Ok(())
        } else {
            Err(AttributeLengthError { expected, found })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::AttributeLengthError;
    use crate::shapes::icosphere;

    #[test]
    fn corner_attributes_of_another_length_are_refused() {
        let mut surface = icosphere(0, 1.0);
        let before = surface.clone();
        let error = AttributeLengthError {
            expected: 60,
            found: 59,
        };
        assert_eq!(surface.set_corner_uvs(vec![[0.0; 2]; 59]), Err(error));
        assert_eq!(surface.set_corner_normals(vec![[0.0; 3]; 59]), Err(error));
        assert_eq!(surface, before, "nothing changes");
        surface.set_corner_uvs(vec![[0.0; 2]; 60]).unwrap();
        surface.set_corner_uvs(Vec::new()).unwrap();
        assert_eq!(surface, before);
    }
}
