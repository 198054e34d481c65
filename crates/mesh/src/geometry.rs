//! Formulas on points, in 64 bits: coordinates are stored in 32 bits and computed in 64.

use nalgebra::Vector3;

/// A point or direction in f64 \[m\].
pub type Vec3 = Vector3<f64>;

/// Converts a stored point to 64 bits.
#[must_use]
#[inline]
pub fn to_f64(p: [f32; 3]) -> Vec3 {
    Vec3::new(f64::from(p[0]), f64::from(p[1]), f64::from(p[2]))
}

/// Rounds a point once to 32-bit storage.
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    reason = "this is the one rounding of a computed coordinate"
)]
#[inline]
pub fn to_f32(p: Vec3) -> [f32; 3] {
    [p.x as f32, p.y as f32, p.z as f32]
}

/// Rounds a number once to 32-bit storage; a number that is too large becomes infinite.
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    reason = "this is the one rounding of a computed number"
)]
#[inline]
pub const fn round_to_f32(x: f64) -> f32 {
    x as f32
}

/// Returns a position relative to `origin` in the coordinates of the origin, rounded to 32 bits.
#[must_use]
pub fn to_file(origin: [f64; 3], p: [f32; 3]) -> [f32; 3] {
    // Adding zero would lose the sign of -0.
    if origin == [0.0; 3] {
        return p;
    }
    [0, 1, 2].map(|k| round_to_f32(origin[k] + f64::from(p[k])))
}

/// Returns the outward normal of a triangle, with twice its area as length \[m^2\].
#[must_use]
#[inline]
pub fn area_vector([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(&(c - a))
}

/// Returns the outward unit normal of a triangle; zero if it has no area.
#[must_use]
pub(crate) fn unit_normal(corners: [Vec3; 3]) -> [f32; 3] {
    let normal = area_vector(corners).try_normalize(0.0);
    to_f32(normal.unwrap_or_default())
}

/// Returns whether a triangle has no area within the rounding of stored positions.
///
/// Its height is then at most that share of its longest side.
#[must_use]
pub fn is_flat([a, b, c]: [Vec3; 3]) -> bool {
    let sides = [b - a, c - b, a - c].map(|side| side.norm_squared());
    let longest = sides.into_iter().fold(0.0, f64::max);
    area_vector([a, b, c]).norm() <= f64::from(f32::EPSILON) * longest
}

/// Returns the angle between two vectors \[rad\], 0 if either is zero.
///
/// The arctangent keeps its digits near 0 and pi, where the arccosine loses half of them.
#[must_use]
pub fn angle_between(u: Vec3, v: Vec3) -> f64 {
    u.cross(&v).norm().atan2(u.dot(&v))
}

/// Returns the angles at a triangle's corners \[rad\]; 0 beside an edge of zero length.
#[must_use]
pub fn corner_angles([a, b, c]: [Vec3; 3]) -> [f64; 3] {
    [
        angle_between(b - a, c - a),
        angle_between(c - b, a - b),
        angle_between(a - c, b - c),
    ]
}

/// An axis-aligned bounding box. The default is empty.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Aabb {
    /// Minimum coordinates.
    pub min: [f32; 3],
    /// Maximum coordinates.
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
    /// Returns the bounding box of `points`.
    #[must_use]
    pub fn around(points: impl IntoIterator<Item = [f32; 3]>) -> Self {
        let mut out = Self::default();
        for p in points {
            out.grow(p);
        }
        out
    }

    /// Extends the box to contain `p`.
    #[inline]
    pub fn grow(&mut self, p: [f32; 3]) {
        for (k, x) in p.into_iter().enumerate() {
            self.min[k] = self.min[k].min(x);
            self.max[k] = self.max[k].max(x);
        }
    }

    /// Returns the bounding box of both boxes.
    #[must_use]
    #[inline]
    pub fn union(mut self, other: Self) -> Self {
        self.grow(other.min);
        self.grow(other.max);
        self
    }

    /// Returns whether the boxes share a point; contact counts.
    #[must_use]
    #[inline]
    pub fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|k| self.min[k] <= other.max[k] && other.min[k] <= self.max[k])
    }

    /// Returns the center of the box \[m\].
    #[must_use]
    #[inline]
    pub fn center(&self) -> Vec3 {
        (to_f64(self.min) + to_f64(self.max)) / 2.0
    }

    /// Returns the length of the diagonal \[m\]; 0 for an empty box.
    #[must_use]
    #[inline]
    pub fn diagonal(&self) -> f64 {
        if self.min[0] > self.max[0] {
            return 0.0;
        }
        (to_f64(self.max) - to_f64(self.min)).norm()
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
