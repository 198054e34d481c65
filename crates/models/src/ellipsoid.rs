//! Ellipsoids as implicit functions.

use crate::implicit::Sample;
use incise_mesh::Vec3;
use nalgebra::Matrix3;

/// An ellipsoid with `radii` along the rows of `frame`.
#[derive(Debug)]
pub(super) struct Ellipsoid {
    center: Vec3,
    radii: Vec3,
    frame: Matrix3<f64>,
}

impl Ellipsoid {
    /// Returns an ellipsoid with its second axis along `up` and its third as close to z as
    /// possible.
    pub(super) fn new(center: Vec3, radii: Vec3, up: Vec3) -> Self {
        let up = up.normalize();
        let right = up.cross(&Vec3::z()).normalize();
        let front = right.cross(&up);
        Self {
            center,
            radii,
            frame: Matrix3::from_rows(&[right.transpose(), up.transpose(), front.transpose()]),
        }
    }

    /// Evaluates |q| (|q| - 1) / |q / radii| for the point q in units of the radii.
    ///
    /// The value is exact to first order at the surface (after I. Quilez).
    pub(super) fn sample(&self, p: Vec3) -> Sample {
        let q = (self.frame * (p - self.center)).component_div(&self.radii);
        let q1 = q.component_div(&self.radii);
        let q3 = q1.component_div(&self.radii).component_div(&self.radii);
        let (level, slope) = (q.norm(), q1.norm());
        if slope == 0.0 {
            return Sample {
                value: -self.radii.min(),
                gradient: Vec3::zeros(),
            };
        }
        let value = level * (level - 1.0) / slope;
        let local = q1 * ((2.0 * level - 1.0) / (level * slope)) - q3 * (value / (slope * slope));
        Sample {
            value,
            gradient: self.frame.tr_mul(&local),
        }
    }

    /// Returns a bounding box.
    pub(super) fn bounds(&self) -> (Vec3, Vec3) {
        let half = Vec3::from_fn(|i, _| self.frame.column(i).component_mul(&self.radii).norm());
        (self.center - half, self.center + half)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tilted_ellipsoid_has_the_given_axis() {
        let e = Ellipsoid::new(
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(0.5, 2.0, 0.25),
            Vec3::new(3.0, 4.0, 0.0),
        );
        for (p, expected) in [
            ([2.2, 1.6, 0.0], 0.0),
            ([1.0, 0.0, 0.25], 0.0),
            ([2.8, 2.4, 0.0], 1.0),
            ([1.0, 0.0, 0.0], -0.25),
        ] {
            assert!((e.sample(p.into()).value - expected).abs() < 1e-12, "{p:?}");
        }
    }

    #[test]
    fn the_box_touches_the_ellipsoid() {
        let radii = Vec3::new(0.5, 2.0, 0.25);
        let e = Ellipsoid::new(Vec3::zeros(), radii, Vec3::new(3.0, 4.0, 0.0));
        let (low, high) = e.bounds();
        let exact = ((0.8_f64 * 0.5).powi(2) + (0.6_f64 * 2.0).powi(2)).sqrt();
        assert!((high.x - exact).abs() < 1e-12);
        assert!((high.z - 0.25).abs() < 1e-12);
        assert_eq!(low, -high);
    }
}
