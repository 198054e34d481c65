//! The body of every measurement: of what it is made and how it moves at the start.

use incise_mesh::geometry::round;
use incise_mesh::{Surface, Vec3, VertexId};
use incise_pbd_gpu::{ConstraintError, Material, Solver, Stiffness};

/// Angular velocity about the vertical axis \[1/s\].
const SPIN: f64 = 1.0;
/// Rate at which the body is squeezed along its vertical axis \[1/s\].
const SQUEEZE: f64 = 0.25;

/// A skin that does not stretch and resists bending.
pub(crate) fn material() -> Material {
    Material {
        bending: Some(Stiffness::Pbd(0.5)),
        ..Material::default()
    }
}

/// Gives a body its spin and squeeze.
///
/// # Errors
/// None for a surface and its solver.
pub(crate) fn start(solver: &mut Solver, surface: &Surface) -> Result<(), ConstraintError> {
    let center = surface.bounds().center();
    let vertices: Vec<VertexId> = surface.topology().vertices().collect();
    for v in vertices {
        let r = surface.position(v) - center;
        let velocity = Vec3::new(SPIN * r.z, -SQUEEZE * r.y, -SPIN * r.x);
        solver.set_velocity(v, round(velocity))?;
    }
    Ok(())
}
