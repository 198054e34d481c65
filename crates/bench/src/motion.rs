//! Material and initial motion of the bodies of most benches.

use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, VertexId};
use incise_pbd_gpu::{ConstraintError, Material, Solver, Stiffness};

/// Length of a frame \[s\].
pub(crate) const DT: f32 = incise_models::scenes::FRAME;
/// Angular velocity about the vertical axis \[1/s\].
const SPIN: f64 = 1.0;
/// Rate at which the body is squeezed along its vertical axis \[1/s\].
const SQUEEZE: f64 = 0.25;

/// A surface with its solver.
#[derive(Debug, Clone)]
pub(crate) struct Body {
    pub(crate) surface: Surface,
    pub(crate) solver: Solver,
}

impl Body {
    /// Returns a body that spins and is squeezed.
    ///
    /// # Errors
    /// The error of `new_solver`.
    pub(crate) fn moving(
        mut surface: Surface,
        new_solver: impl FnOnce(&mut Surface) -> Result<Solver, ConstraintError>,
    ) -> Result<Self, ConstraintError> {
        let mut solver = new_solver(&mut surface)?;
        start(&mut solver, &surface)?;
        Ok(Self { surface, solver })
    }
}

/// Returns the material of a shell that does not stretch and resists bending.
pub(crate) fn material() -> Material {
    Material {
        bending: Some(Stiffness::Pbd(0.5)),
        ..Material::default()
    }
}

/// Sets the velocities of a spin and a squeeze.
///
/// # Errors
/// None for a surface and its solver.
pub(crate) fn start(solver: &mut Solver, surface: &Surface) -> Result<(), ConstraintError> {
    let center = surface.bounds().center();
    let vertices: Vec<VertexId> = surface.topology().vertices().collect();
    for v in vertices {
        let r = surface.position(v) - center;
        let velocity = Vec3::new(SPIN * r.z, -SQUEEZE * r.y, -SPIN * r.x);
        solver.set_velocity(v, to_f32(velocity))?;
    }
    Ok(())
}
