//! What the workspace's tests share: bodies and cuts at random, and the laws that every cut obeys.

mod blades;
mod bodies;
/// Tests that need a device: one file for this package and for `incise-pbd-gpu`, which is below it.
#[cfg(feature = "gpu")]
#[path = "../../crates/pbd-gpu/tests/common/gpu.rs"]
pub mod gpu;
mod laws;
mod planes;
mod reference;

pub use blades::{Blade, any_blade, any_level, flat_blade};
pub use bodies::{Body, Deformation, Shape, any_body, large_body, shells, small_body, wild_body};
pub use laws::{
    assert_same_bits, assert_section_is_covered, assert_sound, cut_and_check, euler_characteristics,
};
pub use planes::{LARGE, Planes};
pub use reference::{Reference, reference_cuts, shared_folder};

use proptest::test_runner::{Config, RngSeed};

/// A property's configuration: the same cases in every run, so that a failure is there again
/// tomorrow. `PROPTEST_CASES` and `PROPTEST_RNG_SEED` look further.
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
