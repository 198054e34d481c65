//! Rest positions inside the body: of caps and walls, the same for both sides, and of tips.
//!
//! The rim at rest need not be planar. A harmonic function extends its rest positions into the cap.
//! Linear interpolation over the rim's triangulation would leave creases in the rest shape, which
//! bending constraints would keep.

use super::open::Sides;
use super::rim::Rim;
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, VertexId};
use incise_refine::{HarmonicScratch, Section, SectionMesh, interpolate_harmonic};
use nalgebra::Matrix3;

/// Rounding error of stored positions of a planar rim [of the largest coordinate].
const ROUNDING: f64 = 8.0 * f32::EPSILON as f64;

/// Rest positions of the points of a section mesh.
#[derive(Debug, Clone, Default)]
pub(super) struct CapRest {
    rim: Vec<[f64; 3]>,
    inner: Vec<[f32; 3]>,
    /// By coordinate, whether rest positions are their parents' mean.
    is_mean: [bool; 3],
    scratch: HarmonicScratch,
}

impl CapRest {
    /// Interpolates the rest positions of the inner points.
    ///
    /// The section's points are `vertices` on one side; those on the other have equal rest
    /// positions.
    pub(super) fn find(
        &mut self,
        surface: &Surface,
        vertices: impl Iterator<Item = VertexId>,
        mesh: &SectionMesh,
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
        let found = interpolate_harmonic(mesh, section, &self.rim, rounding, &mut self.scratch);
        self.is_mean = [true; 3];
        if let Some(found) = found {
            self.is_mean = found.is_affine;
            (self.inner).extend(found.values.iter().map(|&rest| to_f32(rest.into())));
        }
    }

    /// Returns the rest position of an inner point, given the mean of its parents' rest positions.
    ///
    /// It is the mean in every coordinate in which the rim at rest is affine in the plane.
    pub(super) fn position(&self, inner: usize, mean: [f32; 3]) -> [f32; 3] {
        let found = self.inner.get(inner).copied().unwrap_or(mean);
        [0, 1, 2].map(|k| if self.is_mean[k] { mean[k] } else { found[k] })
    }
}

/// The affine map from positions to rest positions around an incision.
///
/// The least-squares fit to the neighborhood of the curves. In a direction in which that has no
/// extent the map is a rotation (Kabsch 1976).
#[derive(Debug, Clone, Copy)]
pub(super) struct RestMap {
    center: Vec3,
    rest_center: Vec3,
    matrix: Matrix3<f64>,
    is_identity: bool,
}

/// Weight of the rotation in the fit of the affine map [of the mean square extent].
const ROTATION_WEIGHT: f64 = 1e-3;

impl RestMap {
    /// Fits the map to the vertices of `curves` and their neighbors.
    pub(super) fn fit(
        surface: &Surface,
        rim: &Rim,
        sides: &Sides,
        curves: impl Iterator<Item = u32>,
    ) -> Self {
        let topology = surface.topology();
        let mut curves: Vec<u32> = curves.collect();
        curves.sort_unstable();
        curves.dedup();
        let mut pairs = Vec::new();
        for node in curves.into_iter().flat_map(|i| rim.ring(i as usize)) {
            for side in 0..2 {
                let v = sides.vertices[node as usize][side];
                let targets = rim
                    .fan(topology, sides, node, side)
                    .map(|h| topology.target(h));
                let near = [v].into_iter().chain(targets);
                pairs.extend(near.map(|v| (surface.position(v), surface.rest_position(v))));
            }
        }
        Self::from_pairs(&pairs)
    }

    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 pairs")]
    fn from_pairs(pairs: &[(Vec3, Vec3)]) -> Self {
        let count = pairs.len().max(1) as f64;
        let center = pairs.iter().map(|pair| pair.0).sum::<Vec3>() / count;
        let rest_center = pairs.iter().map(|pair| pair.1).sum::<Vec3>() / count;
        let (mut mixed, mut square) = (Matrix3::zeros(), Matrix3::zeros());
        for &(position, rest) in pairs {
            let (p, r) = (position - center, rest - rest_center);
            mixed += r * p.transpose();
            square += p * p.transpose();
        }
        let svd = mixed.svd(true, true);
        let mut matrix = Matrix3::identity();
        if let (Some(u), Some(v_t)) = (svd.u, svd.v_t) {
            let mirrored = Matrix3::from_diagonal(&Vec3::new(1.0, 1.0, (u * v_t).determinant()));
            let rotation = u * mirrored * v_t;
            let weight = ROTATION_WEIGHT * square.trace();
            let regular = square + Matrix3::identity() * weight;
            if let Some(inverse) = regular.try_inverse() {
                matrix = (mixed + rotation * weight) * inverse;
            }
        }
        Self {
            center,
            rest_center,
            matrix,
            is_identity: pairs.iter().all(|(position, rest)| position == rest),
        }
    }

    /// Returns the rest position of a point \[m\].
    pub(super) fn at(&self, position: Vec3) -> Vec3 {
        if self.is_identity {
            return position;
        }
        self.rest_center + self.matrix * (position - self.center)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_and_a_stretch_are_found_from_flat_data() {
        let turned = |p: Vec3| Vec3::new(-1.5 * p.y, p.x, p.z) + Vec3::new(3.0, 0.0, 1.0);
        let plane = (0..20).map(|i| Vec3::new(f64::from(i % 5), f64::from(i / 5), 0.0));
        let pairs: Vec<_> = plane.map(|p| (p, turned(p))).collect();
        let map = RestMap::from_pairs(&pairs);
        for p in [Vec3::new(1.0, 2.0, 0.0), Vec3::new(0.5, 0.5, 2.0)] {
            assert!((map.at(p) - turned(p)).norm() < 0.01, "{p} {}", map.at(p));
        }
    }
}
