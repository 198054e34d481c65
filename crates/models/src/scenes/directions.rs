//! Seeded directions and planes.

use incise_cut::{CutError, Sweep};
use incise_mesh::{Surface, Vec3};

/// Normal of the plane through the middle of a model: along no axis and no edge.
const GENERIC: [f64; 3] = [0.32, 0.91, 0.26];
/// Largest distance of seeded planes from the middle, relative to the body's half extent.
const SPREAD: f64 = 0.8;

/// Seeded directions (splitmix64, Steele et al. 2014).
#[derive(Debug, Clone)]
pub struct Directions(pub u64);

impl Directions {
    /// Returns a number from -1 to 1.
    pub fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        f64::from(u32::try_from(z >> 32).unwrap_or(u32::MAX)) / f64::from(u32::MAX) * 2.0 - 1.0
    }

    /// Returns a direction, uniformly distributed.
    pub fn next_unit(&mut self) -> Vec3 {
        loop {
            let v = Vec3::new(self.signed(), self.signed(), self.signed());
            let length = v.norm();
            if length > 0.1 && length <= 1.0 {
                return v / length;
            }
        }
    }
}

/// A plane relative to a body.
#[derive(Debug, Clone, Copy)]
pub struct RelativePlane {
    /// The unit normal.
    pub normal: Vec3,
    /// -1 and 1 are the ends of the body along the normal.
    part: f64,
}

impl RelativePlane {
    /// Returns the plane through the middle of a body.
    pub fn middle() -> Self {
        let normal = Vec3::from(GENERIC).normalize();
        Self { normal, part: 0.0 }
    }

    /// Returns `count` seeded planes.
    pub fn seeded(seed: u64, count: u32) -> Vec<Self> {
        let mut directions = Directions(seed);
        let next = |_| Self {
            normal: directions.next_unit(),
            part: SPREAD * directions.signed(),
        };
        (0..count).map(next).collect()
    }

    /// Returns the sweep through a surface, and the plane's distance from the origin \[m\].
    ///
    /// # Errors
    /// As [`Sweep::from_plane`].
    pub fn sweep(&self, surface: &Surface) -> Result<(Sweep, f64), CutError> {
        let vertices = surface.topology().vertices();
        let heights = vertices.map(|v| self.normal.dot(&surface.position(v)));
        let [low, high] = heights
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| {
                [low.min(height), high.max(height)]
            });
        let d = f64::midpoint(low, high) + self.part * (high - low) / 2.0;
        let sweep = Sweep::from_plane(self.normal.into(), d, &surface.bounds())?;
        Ok((sweep, d))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_units_and_repeat_with_their_seed() {
        let mut directions = Directions(7);
        let all: Vec<Vec3> = (0..1000).map(|_| directions.next_unit()).collect();
        assert!(all.iter().all(|d| (d.norm() - 1.0).abs() < 1e-12));
        let mean = all.iter().sum::<Vec3>() / 1000.0;
        assert!(mean.norm() < 0.1, "no direction is preferred: {mean}");
        assert_eq!(Directions(7).next_unit(), all[0]);
    }
}
