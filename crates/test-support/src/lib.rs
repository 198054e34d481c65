//! Fixtures that the tests of several crates share. It is not published.
//!
//! - [`surfaces`], [`edits`], [`materials`], [`random`]: small bodies and changes of them.
//! - [`closed_forms`], [`single_steps`]: solver results with a closed form, for any backend.
//! - `gpu`, `external_device`, `cpu_gpu_pair`: tests that need a GPU, with the feature `gpu`.

pub mod closed_forms;
#[cfg(feature = "gpu")]
pub mod cpu_gpu_pair;
pub mod edits;
#[cfg(feature = "gpu")]
pub mod external_device;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod materials;
pub mod random;
pub mod single_steps;
pub mod surfaces;
