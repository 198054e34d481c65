//! Random bodies and cuts for the tests of the workspace, and the invariants of every cut.

mod blades;
mod bodies;
pub mod fuzz;
mod invariants;
mod planes;
pub mod stability;
pub mod stress;

pub use blades::{Blade, any_blade, any_level, flat_blade};
pub use bodies::{
    Body, Deformation, Shape, any_body, large_body, self_intersecting_body, shells, small_body,
};
pub use invariants::{
    assert_caps_cover_section, assert_closed_manifold, assert_no_fold_added, assert_same_bits,
    cut_and_check, euler_characteristics, paper_cut_and_check,
};
pub use planes::{LARGE, Planes};

use proptest::test_runner::{Config, RngSeed};

/// Returns a configuration of properties with the same cases in every run.
///
/// `INCISE_CASES` multiplies the number of cases. `PROPTEST_CASES` replaces it, and
/// `PROPTEST_RNG_SEED` the seed.
#[must_use]
pub fn cases(count: u32) -> Config {
    let mut config = Config {
        failure_persistence: None,
        ..Config::default()
    };
    if std::env::var_os("PROPTEST_CASES").is_none() {
        let factor = std::env::var("INCISE_CASES").ok();
        let factor = factor.and_then(|factor| factor.parse().ok()).unwrap_or(1);
        config.cases = count.saturating_mul(factor);
    }
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(1);
    }
    config
}

/// The README's code, compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
