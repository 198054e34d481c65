//! Where the body was when a cut was made: who takes the cut back, or does it again, goes back there.

use super::Session;
use incise_mesh::VertexId;
use incise_pbd_gpu::Pin;
use incise_scene::SceneError;

/// Where every vertex was \[m\] and how fast [m/s], shape [vertex slots].
#[derive(Debug)]
pub(super) struct Moment {
    places: Vec<[f32; 3]>,
    velocities: Vec<[f32; 3]>,
}

impl Session {
    /// Where everything is now.
    pub(super) fn moment(&mut self) -> Result<Moment, SceneError> {
        self.read()?;
        let body = self.scene.body(self.body);
        let first = |&[x, y, z, _]: &[f32; 4]| [x, y, z];
        Ok(Moment {
            places: body.surface().positions.iter().map(first).collect(),
            velocities: body.solver().velocities().iter().map(first).collect(),
        })
    }

    /// Puts everything back to where it was; the body has the triangles of then. Pins are where their vertices were.
    pub(super) fn go_back(&mut self, moment: &Moment) -> Result<(), SceneError> {
        let (solver, surface) = self.scene.edit(self.body)?.solver_mut();
        let vertices: Vec<VertexId> = surface.topology().vertices().collect();
        for v in vertices {
            surface.positions[v.index()][..3].copy_from_slice(&moment.places[v.index()]);
            solver.set_velocity(v, moment.velocities[v.index()])?;
        }
        let pins: Vec<Pin> = solver.pins().to_vec();
        for pin in pins {
            solver.pin(surface, pin.vertex)?;
        }
        self.positions += 1;
        Ok(())
    }
}
