//! [`AffineMap`]: the least-squares map between two shapes of a part of a surface.

use incise_mesh::Vec3;
use nalgebra::Matrix3;

/// The affine map that fits pairs of points in two shapes.
///
/// In a direction in which the pairs have no extent it is a rotation (Kabsch 1976).
#[derive(Debug, Clone, Copy)]
pub(crate) struct AffineMap {
    center: Vec3,
    image: Vec3,
    matrix: Matrix3<f64>,
    is_identity: bool,
}

/// Weight of the rotation in the fit [of the mean square extent].
const ROTATION_WEIGHT: f64 = 1e-3;

/// Minimum stretch of a map that is inverted.
///
/// Bodies are hardly compressed to a tenth; below, the fit sees a fold.
pub(crate) const MIN_STRETCH: f64 = 0.1;

impl AffineMap {
    /// Fits the map from the first to the second point of each pair.
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 pairs")]
    pub(crate) fn fit(pairs: &[(Vec3, Vec3)]) -> Self {
        let count = pairs.len().max(1) as f64;
        let center = pairs.iter().map(|pair| pair.0).sum::<Vec3>() / count;
        let image = pairs.iter().map(|pair| pair.1).sum::<Vec3>() / count;
        let (mut mixed, mut square) = (Matrix3::zeros(), Matrix3::zeros());
        for &(from, to) in pairs {
            let (p, r) = (from - center, to - image);
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
            image,
            matrix,
            is_identity: pairs.iter().all(|(from, to)| from == to),
        }
    }

    /// Returns the image of a point \[m\].
    pub(crate) fn at(&self, point: Vec3) -> Vec3 {
        if self.is_identity {
            return point;
        }
        self.image + self.matrix * (point - self.center)
    }

    /// Returns the inverse of the linear part, with stretches of at least [`MIN_STRETCH`].
    pub(crate) fn inverse_gradient(&self) -> Matrix3<f64> {
        if self.is_identity {
            return Matrix3::identity();
        }
        let svd = self.matrix.svd(true, true);
        let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
            return Matrix3::identity();
        };
        let inverse = svd.singular_values.map(|s| 1.0 / s.max(MIN_STRETCH));
        v_t.transpose() * Matrix3::from_diagonal(&inverse) * u.transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned(p: Vec3) -> Vec3 {
        Vec3::new(-1.5 * p.y, p.x, p.z) + Vec3::new(3.0, 0.0, 1.0)
    }

    #[test]
    fn a_rotation_and_a_stretch_are_found_from_flat_data() {
        let plane = (0..20).map(|i| Vec3::new(f64::from(i % 5), f64::from(i / 5), 0.0));
        let pairs: Vec<_> = plane.map(|p| (p, turned(p))).collect();
        let map = AffineMap::fit(&pairs);
        for p in [Vec3::new(1.0, 2.0, 0.0), Vec3::new(0.5, 0.5, 2.0)] {
            assert!((map.at(p) - turned(p)).norm() < 0.01, "{p} {}", map.at(p));
        }
    }

    #[test]
    fn the_inverse_gradient_leads_back() {
        let cube =
            (0..27).map(|i| Vec3::new(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9)));
        let pairs: Vec<_> = cube.map(|p| (p, turned(p))).collect();
        let back = AffineMap::fit(&pairs).inverse_gradient();
        let step = Vec3::new(0.3, -0.2, 0.5);
        let error = back * (turned(step) - turned(Vec3::zeros())) - step;
        assert!(error.norm() < 2e-3, "{error}");
    }
}
