//! Random bodies and cuts for the tests of the workspace, and the invariants of every cut.

mod blades;
mod bodies;
pub mod fuzz;
mod invariants;
mod planes;
mod reference_table;

pub use blades::{Blade, any_blade, any_level, flat_blade};
pub use bodies::{
    Body, Deformation, Shape, any_body, large_body, self_intersecting_body, shells, small_body,
};
pub use invariants::{
    assert_caps_cover_section, assert_closed_manifold, assert_same_bits, cut_and_check,
    euler_characteristics, exact_params,
};
pub use planes::{LARGE, Planes};
pub use reference_table::{Reference, reference_cuts, shared_folder};

use proptest::test_runner::{Config, RngSeed};

/// Returns a configuration of properties with the same cases in every run.
///
/// `PROPTEST_CASES` and `PROPTEST_RNG_SEED` change number and seed.
#[must_use]
pub fn cases(count: u32) -> Config {
    let mut config = Config {
        failure_persistence: None,
        ..Config::default()
    };
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = count;
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
