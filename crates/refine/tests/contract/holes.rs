//! Hole filling: invariants of all patches, known answers, fairing and errors.

mod cases;
mod errors;
mod fairing;
mod properties;
mod punched;
