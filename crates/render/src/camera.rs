//! An eye that circles what it looks at.

use incise_mesh::{Aabb, Vec3};
use nalgebra::{Matrix4, RowVector4};

/// The nearest that is seen, as a part of the distance to the target. Nothing is too far: depth is that of a
/// projection without an end, stored the other way round, which 32-bit floats suit.
const NEAR: f64 = 1e-3;

/// How much more than it needs a fitted body has of the frame, so that it does not touch the picture's edge.
const MARGIN: f64 = 1.08;

/// A fitted eye keeps this part of the diagonal between itself and the nearest corner.
const CLEARANCE: f64 = 0.1;

/// An eye on a sphere around its target. The y axis points up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// What the middle of the picture shows \[m\].
    pub target: [f64; 3],
    /// From the eye to the target \[m\].
    pub distance: f64,
    /// Around the y axis \[rad\]: 0 looks from positive z, a quarter turn from positive x.
    pub azimuth: f64,
    /// Above the horizon \[rad\], up to a quarter turn, where the view is from straight above.
    pub elevation: f64,
    /// The angle between the picture's upper and lower edge \[rad\].
    pub field_of_view: f64,
}

/// A half-line from the eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it begins \[m\].
    pub origin: Vec3,
    /// Where it goes, of length 1.
    pub direction: Vec3,
}

impl Default for Camera {
    /// From the right and a little above, as products are photographed, at the origin.
    fn default() -> Self {
        Self::looking(30_f64.to_radians(), 18_f64.to_radians())
    }
}

impl Camera {
    /// A camera from this azimuth and elevation \[rad\] at the origin, 3 m away, with a field of view of 28 degrees.
    #[must_use]
    pub fn looking(azimuth: f64, elevation: f64) -> Self {
        Self {
            target: [0.0; 3],
            distance: 3.0,
            azimuth,
            elevation,
            field_of_view: 28_f64.to_radians(),
        }
    }

    /// The same direction with all of the box in a picture that is `aspect` times as wide as high, the box's middle in
    /// the picture's. An empty box changes nothing.
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

    /// The same direction, as near as it goes with all of the points in the picture, and they in its middle: closer than
    /// [`Camera::fit`], and around another target for every direction. Without finite points nothing changes.
    #[must_use]
    pub fn frame(mut self, points: impl IntoIterator<Item = [f32; 3]>, aspect: f64) -> Self {
        let [right, up, back] = self.axes();
        let [across, along] = self.tangents(aspect).map(|t| t / MARGIN);
        // How far the eye must be back of the origin for each of the frame's four sides, and how deep all is.
        let mut sides = [f64::NEG_INFINITY; 4];
        let (mut nearest, mut farthest) = (f64::NEG_INFINITY, f64::INFINITY);
        for p in points {
            let p = incise_mesh::geometry::widen(p);
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

    /// The picture's axes: to the right, up, and toward the eye.
    #[must_use]
    pub fn axes(&self) -> [Vec3; 3] {
        let (sin_a, cos_a) = self.azimuth.sin_cos();
        let (sin_e, cos_e) = self.elevation.sin_cos();
        let right = Vec3::new(cos_a, 0.0, -sin_a);
        let back = Vec3::new(cos_e * sin_a, sin_e, cos_e * cos_a);
        [right, back.cross(&right), back]
    }

    /// Where the eye is \[m\].
    #[must_use]
    pub fn eye(&self) -> Vec3 {
        let [_, _, back] = self.axes();
        Vec3::from(self.target) + back * self.distance
    }

    /// The nearest that is seen \[m\].
    #[must_use]
    pub fn near(&self) -> f64 {
        NEAR * self.distance
    }

    /// From points relative to the target to clip space, for a picture `aspect` times as wide as high. Depth is 1 at
    /// [`Camera::near`] and falls to 0 without end.
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

    /// From points \[m\] to clip space, as [`Camera::projection_from_target`].
    #[must_use]
    pub fn view_projection(&self, aspect: f64) -> Matrix4<f64> {
        let to_target = Matrix4::new_translation(&-Vec3::from(self.target));
        self.projection_from_target(aspect) * to_target
    }

    /// Where a picture of `size` pixels, across and along, shows a point \[m\]: pixels from its left and its upper edge.
    /// None of a point that is not in front of the eye.
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

    /// The ray through a place of a picture of `size` pixels, across and along: pixels from its left and its upper edge,
    /// so that the first pixel's middle is at 0.5, 0.5.
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

    /// Half of the picture's width and height, a unit away from the eye.
    fn tangents(&self, aspect: f64) -> [f64; 2] {
        let along = (self.field_of_view / 2.0).tan();
        [along * aspect, along]
    }
}

fn corners(bounds: &Aabb) -> impl Iterator<Item = Vec3> {
    let [low, high] = [bounds.min, bounds.max].map(incise_mesh::geometry::widen);
    (0..8).map(move |i| {
        let side = |k: usize| if i >> k & 1 == 0 { low[k] } else { high[k] };
        Vec3::new(side(0), side(1), side(2))
    })
}

#[cfg(test)]
mod tests;
