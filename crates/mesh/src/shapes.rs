//! Parametric shapes of any resolution: boxes, spheres, tori and sheets.

mod cuboid;
mod sheet;
mod sphere;
mod torus;

pub use cuboid::cuboid;
pub use sheet::sheet;
pub use sphere::{cube_sphere, icosphere};
pub use torus::torus;
