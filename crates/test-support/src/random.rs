//! Seeded random numbers: the same sequence on every machine.

/// The generator splitmix64 (Steele, Lea and Flood 2014).
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// Creates a generator from a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Returns 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number from 0 to 1 from the upper 32 bits.
    pub fn unit(&mut self) -> f64 {
        f64::from(u32::try_from(self.bits() >> 32).unwrap_or(u32::MAX)) / f64::from(u32::MAX)
    }

    /// Returns a number from -1 to 1.
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Returns a number between two.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Returns a number between two; its logarithm is uniform.
    #[expect(clippy::cast_possible_truncation, reason = "a number of storage")]
    pub fn log(&mut self, low: f64, high: f64) -> f32 {
        (low * (high / low).powf(self.unit())) as f32
    }

    /// Returns an index below `count`.
    ///
    /// # Panics
    /// If `count` is 0.
    pub fn below(&mut self, count: usize) -> usize {
        usize::try_from(self.bits() % count as u64).expect("it is below a usize")
    }

    /// Returns a number from 0.1 to 0.9.
    #[expect(clippy::cast_possible_truncation, reason = "a number of storage")]
    pub fn fraction(&mut self) -> f32 {
        self.between(0.1, 0.9) as f32
    }
}

/// Returns a number from -1 to 1 that depends on `seed` only.
#[must_use]
pub fn noise(seed: u64) -> f32 {
    let mut x = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    ((x >> 40) as f32) / 8_388_608.0 - 1.0
}
