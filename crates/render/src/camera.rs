//! A perspective camera that orbits a target: framing, projection and picking rays.

use incise_mesh::{Aabb, Vec3};
use nalgebra::{Matrix4, RowVector4};

/// Distance of the near plane, relative to the distance to the target. The projection is infinite
/// with reversed depth, which suits 32-bit floats.
const NEAR: f64 = 1e-3;

/// Scale of the frame around a fitted body, so that it does not touch the edge of the image.
const MARGIN: f64 = 1.08;

/// Minimum distance from a fitted camera to the nearest corner, relative to the diagonal.
const CLEARANCE: f64 = 0.1;

/// A perspective camera on a sphere around its target. The y axis points up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Point at the center of the image \[m\].
    pub target: [f64; 3],
    /// Distance from the camera to the target \[m\].
    pub distance: f64,
    /// Angle around the y axis \[rad\]: 0 looks from positive z, a quarter turn from positive x.
    pub azimuth: f64,
    /// Angle above the horizon \[rad\], at most a quarter turn, which looks straight down.
    pub elevation: f64,
    /// Vertical field of view \[rad\].
    pub field_of_view: f64,
}

/// A ray from the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Start of the ray \[m\].
    pub origin: Vec3,
    /// Unit direction.
    pub direction: Vec3,
}

impl Default for Camera {
    /// Looks at the origin from the right and a little above.
    fn default() -> Self {
        Self::from_angles(30_f64.to_radians(), 18_f64.to_radians())
    }
}

impl Camera {
    /// Returns a camera that looks at the origin from these angles \[rad\].
    ///
    /// The distance is 3 m and the field of view 28 degrees.
    #[must_use]
    pub fn from_angles(azimuth: f64, elevation: f64) -> Self {
        Self {
            target: [0.0; 3],
            distance: 3.0,
            azimuth,
            elevation,
            field_of_view: 28_f64.to_radians(),
        }
    }

    /// Returns this camera moved so that all of a box is in the image, its center at the center.
    ///
    /// `aspect` is width over height of the image. An empty box changes nothing.
    #[must_use]
    pub fn fit(mut self, bounds: &Aabb, aspect: f64) -> Self {
        let is_box = bounds.min.iter().zip(bounds.max).all(|(a, b)| *a <= b);
        let diagonal = bounds.diagonal();
        if !is_box || !diagonal.is_finite() {
            return self;
        }
        let center = bounds.center();
        let [right, up, back] = self.axes();
        let [across, along] = self.tangents(aspect).map(|t| t / MARGIN);
        let mut distance = 0.0_f64;
        for corner in corners(bounds) {
            let p = corner - center;
            let depth = p.dot(&back);
            let away = (p.dot(&right).abs() / across).max(p.dot(&up).abs() / along);
            distance = distance.max(depth + away).max(depth + CLEARANCE * diagonal);
        }
        self.target = center.into();
        self.distance = if distance > 0.0 { distance } else { 1.0 };
        self
    }

    /// Returns this camera moved as close as possible with all points in the image, centered.
    ///
    /// The frame is tighter than that of [`Camera::fit`], and its target depends on the direction.
    /// Without finite points nothing changes.
    #[must_use]
    pub fn frame(mut self, points: impl IntoIterator<Item = [f32; 3]>, aspect: f64) -> Self {
        let [right, up, back] = self.axes();
        let [across, along] = self.tangents(aspect).map(|t| t / MARGIN);
        // Distance of the camera behind the origin that each side of the frame requires, and the
        // range of depths.
        let mut sides = [f64::NEG_INFINITY; 4];
        let (mut nearest, mut farthest) = (f64::NEG_INFINITY, f64::INFINITY);
        for p in points {
            let p = incise_mesh::geometry::to_f64(p);
            let (x, y, z) = (p.dot(&right), p.dot(&up), p.dot(&back));
            let need = [x + across * z, across * z - x, y + along * z, along * z - y];
            sides = [0, 1, 2, 3].map(|i| sides[i].max(need[i]));
            (nearest, farthest) = (nearest.max(z), farthest.min(z));
        }
        let [to_right, to_left, to_top, to_bottom] = sides;
        let (x, y) = ((to_right - to_left) / 2.0, (to_top - to_bottom) / 2.0);
        let eye = ((to_right + to_left) / (2.0 * across)).max((to_top + to_bottom) / (2.0 * along));
        let eye = eye.max(nearest + CLEARANCE * (nearest - farthest));
        let z = f64::midpoint(nearest, farthest);
        if ![x, y, z, eye].iter().all(|x| x.is_finite()) {
            return self;
        }
        self.target = (right * x + up * y + back * z).into();
        self.distance = if eye > z { eye - z } else { 1.0 };
        self
    }

    /// Returns the axes of the image: right, up, and toward the camera.
    #[must_use]
    pub fn axes(&self) -> [Vec3; 3] {
        let (sin_a, cos_a) = self.azimuth.sin_cos();
        let (sin_e, cos_e) = self.elevation.sin_cos();
        let right = Vec3::new(cos_a, 0.0, -sin_a);
        let back = Vec3::new(cos_e * sin_a, sin_e, cos_e * cos_a);
        [right, back.cross(&right), back]
    }

    /// Returns the position of the camera \[m\].
    #[must_use]
    pub fn eye(&self) -> Vec3 {
        let [_, _, back] = self.axes();
        Vec3::from(self.target) + back * self.distance
    }

    /// Returns the distance of the near plane \[m\].
    #[must_use]
    pub fn near(&self) -> f64 {
        NEAR * self.distance
    }

    /// Returns the matrix from points relative to the target to clip space.
    ///
    /// `aspect` is width over height. Depth is 1 at [`Camera::near`] and approaches 0 at infinity.
    #[must_use]
    pub fn projection_from_target(&self, aspect: f64) -> Matrix4<f64> {
        let [right, up, back] = self.axes();
        let [across, along] = self.tangents(aspect);
        let row = |v: Vec3, w: f64| RowVector4::new(v.x, v.y, v.z, w);
        Matrix4::from_rows(&[
            row(right / across, 0.0),
            row(up / along, 0.0),
            RowVector4::new(0.0, 0.0, 0.0, self.near()),
            row(-back, self.distance),
        ])
    }

    /// Returns the matrix from points \[m\] to clip space, as [`Camera::projection_from_target`].
    #[must_use]
    pub fn view_projection(&self, aspect: f64) -> Matrix4<f64> {
        let to_target = Matrix4::new_translation(&-Vec3::from(self.target));
        self.projection_from_target(aspect) * to_target
    }

    /// Projects a point \[m\] to an image of `size` pixels (width, height).
    ///
    /// Returns pixels from the left and the upper edge, or `None` for a point behind the near
    /// plane.
    #[must_use]
    pub fn project(&self, point: Vec3, size: [u32; 2]) -> Option<[f64; 2]> {
        let [width, height] = size.map(f64::from);
        let p = point - Vec3::from(self.target);
        let clip = self.projection_from_target(width / height) * p.push(1.0);
        let is_seen = clip.w >= self.near();
        is_seen.then(|| {
            let (x, y) = (clip.x / clip.w, clip.y / clip.w);
            [width * (1.0 + x) / 2.0, height * (1.0 - y) / 2.0]
        })
    }

    /// Returns the ray through a point of an image of `size` pixels (width, height).
    ///
    /// The point is in pixels from the left and the upper edge; the center of the first pixel is
    /// at (0.5, 0.5).
    #[must_use]
    pub fn ray(&self, [x, y]: [f64; 2], size: [u32; 2]) -> Ray {
        let [width, height] = size.map(f64::from);
        let [across, along] = self.tangents(width / height);
        let [right, up, back] = self.axes();
        let x = (2.0 * x / width - 1.0) * across;
        let y = (1.0 - 2.0 * y / height) * along;
        Ray {
            origin: self.eye(),
            direction: (right * x + up * y - back).normalize(),
        }
    }

    /// Returns half of the width and height of the image at unit distance from the camera.
    fn tangents(&self, aspect: f64) -> [f64; 2] {
        let along = (self.field_of_view / 2.0).tan();
        [along * aspect, along]
    }
}

fn corners(bounds: &Aabb) -> impl Iterator<Item = Vec3> {
    let [low, high] = [bounds.min, bounds.max].map(incise_mesh::geometry::to_f64);
    (0..8).map(move |i| {
        let side = |k: usize| if i >> k & 1 == 0 { low[k] } else { high[k] };
        Vec3::new(side(0), side(1), side(2))
    })
}

#[cfg(test)]
mod tests;
