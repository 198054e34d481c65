//! Fixtures that the tests of several crates share. It is not published.
//!
//! - [`process`], [`random`], [`beams`]: tests in a process of their own, seeded numbers, closed
//!   forms.
//! - With the feature `mesh`: hashes of surfaces (`bits`).
//! - With the feature `solver`: small bodies and changes of them (`surfaces`, `edits`,
//!   `pieces`),
//!   `materials`, `params`, limits of every motion (`energy`), and solver results with a closed
//!   form (`closed_forms`, `single_steps`).
//! - With the feature `gpu`: tests that need a GPU (`gpu`, `external_device`, `cpu_gpu_pair`).

pub mod beams;
#[cfg(feature = "mesh")]
pub mod bits;
#[cfg(feature = "solver")]
pub mod closed_forms;
#[cfg(feature = "gpu")]
pub mod cpu_gpu_pair;
#[cfg(feature = "solver")]
pub mod edits;
#[cfg(feature = "solver")]
pub mod energy;
#[cfg(feature = "gpu")]
pub mod external_device;
#[cfg(feature = "gpu")]
pub mod gpu;
#[cfg(feature = "solver")]
pub mod materials;
#[cfg(feature = "solver")]
pub mod params;
#[cfg(feature = "solver")]
pub mod pieces;
pub mod process;
pub mod random;
#[cfg(feature = "solver")]
pub mod single_steps;
#[cfg(feature = "solver")]
pub mod surfaces;
