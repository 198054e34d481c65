//! Fuzz cases, decoded from bytes: a body with cuts, undos and deformations.
//!
//! A [`Case`] makes full cuts: after every step the invariants of this crate hold, and only sweeps
//! that end inside the body may fail. A [`PathCase`] moves a blade through the body step by step.

mod case;
mod path;
mod run;

pub use case::{Case, Step, SweepCase};
pub use path::{PathCase, PathStep};

/// Iterates over inputs of random bytes, the same in every run.
#[cfg(test)]
fn random_bytes(length: usize) -> impl Iterator<Item = Vec<u8>> {
    let mut state = 1_u64;
    std::iter::repeat_with(move || {
        let byte = |_| {
            // Knuth's linear congruence; the high bits are random.
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            state.to_be_bytes()[0]
        };
        (0..length).map(byte).collect()
    })
}
