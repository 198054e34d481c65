//! [`RigidFrame`]: the rigid motion from rest that is closest to the motion of points.

use incise_mesh::Vec3;
use nalgebra::Matrix3;

/// A rigid motion from rest positions to present positions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RigidFrame {
    /// \[kg\]
    pub(crate) mass: f64,
    /// Center of mass \[m\].
    pub(crate) center: Vec3,
    /// Center of mass at rest \[m\].
    rest_center: Vec3,
    pub(crate) rotation: Matrix3<f64>,
}

impl RigidFrame {
    /// Returns the motion of points, each given by its position \[m\], its rest position \[m\] and
    /// its mass \[kg\].
    pub(crate) fn of(points: impl Iterator<Item = (Vec3, Vec3, f64)> + Clone) -> Self {
        let mass: f64 = points.clone().map(|(.., m)| m).sum();
        let center = points.clone().map(|(x, _, m)| x * m).sum::<Vec3>() / mass;
        let rest_center = points.clone().map(|(_, rest, m)| rest * m).sum::<Vec3>() / mass;
        let terms = points.map(|(x, rest, m)| (x - center) * (rest - rest_center).transpose() * m);
        Self {
            mass,
            center,
            rest_center,
            rotation: nearest_rotation(terms.sum()),
        }
    }

    pub(crate) fn to_rest(self, at: Vec3) -> Vec3 {
        self.rotation.transpose() * (at - self.center) + self.rest_center
    }

    pub(crate) fn to_present(self, at: Vec3) -> Vec3 {
        self.rotation * (at - self.rest_center) + self.center
    }
}

/// Returns the rotation nearest to a covariance (Kabsch 1976).
fn nearest_rotation(covariance: Matrix3<f64>) -> Matrix3<f64> {
    let svd = covariance.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return Matrix3::identity();
    };
    let smallest = svd.singular_values.imin();
    let mut signs = Vec3::repeat(1.0);
    signs[smallest] = (u * v_t).determinant().signum();
    u * Matrix3::from_diagonal(&signs) * v_t
}
