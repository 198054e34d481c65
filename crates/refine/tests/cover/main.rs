//! Covers of cross-sections: what holds for all of them, and cases with a known answer.

mod cases;
mod law;
mod paper;
mod properties;
mod sections;
mod sizes;
