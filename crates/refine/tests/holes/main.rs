//! Holes of surfaces, closed: what holds for all of them, and cases with a known answer.

mod cases;
#[cfg(feature = "fair")]
mod fairing;
mod properties;
mod punched;
mod refusals;
