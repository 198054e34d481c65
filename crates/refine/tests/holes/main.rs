//! Hole filling: invariants of all patches, known answers, fairing and errors.

mod cases;
mod errors;
#[cfg(feature = "fair")]
mod fairing;
mod properties;
mod punched;
