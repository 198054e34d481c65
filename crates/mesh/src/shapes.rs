//! Parametric shapes of any resolution: spheres, tori and sheets.

mod sheet;
mod sphere;
mod torus;

pub use sheet::sheet;
pub use sphere::{cube_sphere, icosphere};
pub use torus::torus;
