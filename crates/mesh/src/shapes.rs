//! Parametric shapes: spheres and tori of any resolution.

mod sphere;
mod torus;

pub use sphere::{cube_sphere, icosphere};
pub use torus::torus;
