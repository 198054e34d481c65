//! Snapshots of positions and velocities, which undo and redo of cuts restore.

use super::Session;
use incise_mesh::VertexId;
use incise_pbd_gpu::{Pin, SolidState};
use incise_scene::SceneError;

/// Positions \[m\] and velocities [m/s] of all vertices, shape [vertex slots].
#[derive(Debug)]
pub(super) struct Snapshot {
    positions: Vec<[f32; 3]>,
    velocities: Vec<[f32; 3]>,
    /// The inside of a solid.
    solid: Option<SolidState>,
}

impl Session {
    /// Returns a snapshot of the current state.
    pub(super) fn snapshot(&mut self) -> Result<Snapshot, SceneError> {
        self.read()?;
        let body = self.scene.body(self.body)?;
        let first = |&[x, y, z, _]: &[f32; 4]| [x, y, z];
        Ok(Snapshot {
            positions: body.surface().positions().iter().map(first).collect(),
            velocities: body.solver().velocities().iter().map(first).collect(),
            solid: body.solver().solid_state(),
        })
    }

    /// Restores a snapshot of the same connectivity and moves the pins to their vertices.
    pub(super) fn restore(&mut self, snapshot: &Snapshot) -> Result<(), SceneError> {
        let (solver, surface) = self.scene.edit(self.body)?.solver_mut();
        let vertices: Vec<VertexId> = surface.topology().vertices().collect();
        for v in vertices {
            surface.positions_mut()[v.index()][..3].copy_from_slice(&snapshot.positions[v.index()]);
            solver.set_velocity(v, snapshot.velocities[v.index()])?;
        }
        if let Some(solid) = &snapshot.solid {
            solver.set_solid_state(surface, solid);
        }
        let pins: Vec<Pin> = solver.pins().to_vec();
        for pin in pins {
            solver.pin(surface, pin.vertex)?;
        }
        self.positions += 1;
        Ok(())
    }
}
