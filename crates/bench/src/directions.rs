//! Directions at random.

use incise_mesh::Vec3;

/// The direction of a plane through the middle of a model: along no axis and no edge.
pub(crate) const GENERIC: [f64; 3] = [0.32, 0.91, 0.26];
/// How far from the middle seeded planes lie at most, of the way to where the body ends.
pub(crate) const SPREAD: f64 = 0.8;

/// Seeded directions (splitmix64, Steele et al. 2014).
#[derive(Debug, Clone)]
pub(crate) struct Directions(pub(crate) u64);

impl Directions {
    /// A number from -1 to 1.
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        f64::from(u32::try_from(z >> 32).unwrap_or(u32::MAX)) / f64::from(u32::MAX) * 2.0 - 1.0
    }

    /// A direction, all equally likely.
    pub(crate) fn next_unit(&mut self) -> Vec3 {
        loop {
            let v = Vec3::new(self.next(), self.next(), self.next());
            let length = v.norm();
            if length > 0.1 && length <= 1.0 {
                return v / length;
            }
        }
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
