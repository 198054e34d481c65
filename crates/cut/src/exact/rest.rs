//! Rest positions inside a cap, the same for both lips.
//!
//! What the rim is at rest need not lie in a plane. Its rest positions are carried on into the cap by a harmonic
//! function: interpolated over the rim's own triangulation they would leave creases in the rest shape, which
//! bending constraints hold on to.

use incise_mesh::geometry::round;
use incise_mesh::{Surface, VertexId};
use incise_refine::{Cover, HarmonicScratch, Section, harmonic};

/// By how much stored positions of a flat rim may be off a plane [of the largest coordinate].
const ROUNDING: f64 = 8.0 * f32::EPSILON as f64;

/// Rest positions of a cover's points.
#[derive(Debug, Clone, Default)]
pub(super) struct CapRest {
    rim: Vec<[f64; 3]>,
    inner: Vec<[f32; 3]>,
    /// By coordinate, whether rest positions are their parents' mean.
    is_mean: [bool; 3],
    scratch: HarmonicScratch,
}

impl CapRest {
    /// Finds those of the inner points from those of the section's points, which are these vertices on
    /// one lip and have the same on the other.
    pub(super) fn find(
        &mut self,
        surface: &Surface,
        vertices: impl Iterator<Item = VertexId>,
        cover: &Cover,
        section: &Section<'_>,
    ) {
        self.rim.clear();
        self.inner.clear();
        let mut largest = 0.0_f64;
        for v in vertices {
            let (rest, position) = (surface.rest_position(v), surface.position(v));
            largest = largest.max(rest.amax()).max(position.amax());
            self.rim.push(rest.into());
        }
        let rounding = ROUNDING * largest;
        let found = harmonic(cover, section, &self.rim, rounding, &mut self.scratch);
        self.is_mean = [true; 3];
        if let Some(found) = found {
            self.is_mean = found.is_affine;
            (self.inner).extend(found.values.iter().map(|&rest| round(rest.into())));
        }
    }

    /// The rest position of an inner point with this mean of its parents', which it is in every coordinate in
    /// which the rim is as at rest.
    pub(super) fn of(&self, inner: usize, mean: [f32; 3]) -> [f32; 3] {
        let found = self.inner.get(inner).copied().unwrap_or(mean);
        [0, 1, 2].map(|k| if self.is_mean[k] { mean[k] } else { found[k] })
    }
}
