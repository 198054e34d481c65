//! Small formulas on points, in f64: what is stored in f32 is summed and compared here.

use nalgebra::Vector3;

/// A point or direction in f64 \[m\].
pub type Vec3 = Vector3<f64>;

/// A stored point, widened.
#[must_use]
#[inline]
pub fn widen(p: [f32; 3]) -> Vec3 {
    Vec3::new(f64::from(p[0]), f64::from(p[1]), f64::from(p[2]))
}

/// A point rounded once to storage.
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    reason = "this is the one rounding of a computed coordinate"
)]
#[inline]
pub fn round(p: Vec3) -> [f32; 3] {
    [p.x as f32, p.y as f32, p.z as f32]
}

/// The vector along a triangle's outward normal, as long as twice its area \[m^2\].
#[must_use]
#[inline]
pub fn area_vector([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(&(c - a))
}

/// Whether a triangle has no area to the rounding of stored positions: its height is no more than that part of its
/// longest side.
#[must_use]
pub fn is_flat([a, b, c]: [Vec3; 3]) -> bool {
    let sides = [b - a, c - b, a - c].map(|side| side.norm_squared());
    let longest = sides.into_iter().fold(0.0, f64::max);
    area_vector([a, b, c]).norm() <= f64::from(f32::EPSILON) * longest
}

/// The angle between two vectors \[rad\], 0 when either has no length. The arctangent form keeps its
/// digits near 0 and pi, where the arccosine loses half of them.
#[must_use]
pub fn angle_between(u: Vec3, v: Vec3) -> f64 {
    u.cross(&v).norm().atan2(u.dot(&v))
}

/// The angles at a triangle's corners \[rad\]. A corner beside an edge of no length gets 0.
#[must_use]
pub fn corner_angles([a, b, c]: [Vec3; 3]) -> [f64; 3] {
    [
        angle_between(b - a, c - a),
        angle_between(c - b, a - b),
        angle_between(a - c, b - c),
    ]
}

/// An axis-aligned box. The default is empty: it holds nothing and leaves any box as it is.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Aabb {
    /// The smallest coordinates.
    pub min: [f32; 3],
    /// The largest coordinates.
    pub max: [f32; 3],
}

impl Default for Aabb {
    fn default() -> Self {
        Self {
            min: [f32::INFINITY; 3],
            max: [f32::NEG_INFINITY; 3],
        }
    }
}

impl Aabb {
    /// The smallest box around `points`.
    #[must_use]
    pub fn around(points: impl IntoIterator<Item = [f32; 3]>) -> Self {
        let mut out = Self::default();
        for p in points {
            out.grow(p);
        }
        out
    }

    /// Grows the box to hold `p`.
    #[inline]
    pub fn grow(&mut self, p: [f32; 3]) {
        for (k, x) in p.into_iter().enumerate() {
            self.min[k] = self.min[k].min(x);
            self.max[k] = self.max[k].max(x);
        }
    }

    /// The smallest box around both.
    #[must_use]
    #[inline]
    pub fn union(mut self, other: Self) -> Self {
        self.grow(other.min);
        self.grow(other.max);
        self
    }

    /// Whether the boxes share a point; touching counts.
    #[must_use]
    #[inline]
    pub fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|k| self.min[k] <= other.max[k] && other.min[k] <= self.max[k])
    }

    /// The middle of the box \[m\].
    #[must_use]
    #[inline]
    pub fn center(&self) -> Vec3 {
        (widen(self.min) + widen(self.max)) / 2.0
    }

    /// The length of the diagonal \[m\]; 0 for an empty box.
    #[must_use]
    #[inline]
    pub fn diagonal(&self) -> f64 {
        if self.min[0] > self.max[0] {
            return 0.0;
        }
        (widen(self.max) - widen(self.min)).norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_of_a_triangle_sum_to_pi() {
        let t = [
            Vec3::new(0.0, 0.0, 0.0),
            Vec3::new(3.0, 0.0, 1.0),
            Vec3::new(0.5, 2.0, 0.0),
        ];
        let sum: f64 = corner_angles(t).iter().sum();
        assert!((sum - std::f64::consts::PI).abs() < 1e-14);
        assert_eq!(corner_angles([t[0]; 3]), [0.0; 3]);
    }

    #[test]
    fn an_empty_box_holds_nothing() {
        let empty = Aabb::default();
        let unit = Aabb::around([[0.0; 3], [1.0; 3]]);
        assert!(!empty.overlaps(&unit));
        assert_eq!(empty.union(unit), unit);
        assert_eq!(empty.diagonal(), 0.0);
    }
}
