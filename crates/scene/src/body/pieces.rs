//! The pieces of a body, and their rigid motion.

use super::Body;
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3, VertexId};
use incise_pbd_gpu::ConstraintError;

/// Returns the number of a vertex' piece; `None` for a vertex that no triangle uses.
pub(crate) fn piece_of(surface: &Surface, v: VertexId) -> Option<u32> {
    let h = surface.topology().outgoing(v);
    (!h.is_null()).then(|| surface.piece(h.triangle()))
}

/// Returns the vertices of a piece, ascending.
pub(crate) fn vertices_of(surface: &Surface, number: u32) -> impl Iterator<Item = VertexId> {
    let vertices = surface.topology().vertices();
    vertices.filter(move |&v| piece_of(surface, v) == Some(number))
}

impl Body {
    /// Returns the numbers of the body's pieces, ascending.
    #[must_use]
    pub fn pieces(&self) -> Vec<u32> {
        let surface = &self.surface;
        let triangles = surface.topology().triangles();
        let mut pieces: Vec<u32> = triangles.map(|t| surface.piece(t)).collect();
        pieces.sort_unstable();
        pieces.dedup();
        pieces
    }

    /// Returns the piece of every vertex slot; none for unused ones.
    pub(super) fn piece_of_vertices(&self) -> Vec<Option<u32>> {
        let slots = 0..self.surface.topology().vertex_slots();
        slots
            .map(|slot| piece_of(&self.surface, VertexId::from_index(slot)))
            .collect()
    }

    /// Returns the velocity of the center of mass of a piece [m/s].
    pub(crate) fn piece_velocity(&self, number: u32) -> Vec3 {
        let (mut momentum, mut mass) = (Vec3::zeros(), 0.0);
        for v in vertices_of(&self.surface, number) {
            let of_vertex = f64::from(self.solver.masses()[v.index()]);
            momentum += Vec3::from(self.solver.velocity(v).map(f64::from)) * of_vertex;
            mass += of_vertex;
        }
        if mass > 0.0 {
            momentum / mass
        } else {
            momentum
        }
    }

    /// Adds a velocity to those of all vertices of a piece [m/s].
    ///
    /// # Errors
    /// [`ConstraintError`] for a velocity that is not finite.
    pub(crate) fn add_piece_velocity(
        &mut self,
        number: u32,
        by: Vec3,
    ) -> Result<(), ConstraintError> {
        let (surface, solver) = (&self.surface, &mut self.solver);
        vertices_of(surface, number).try_for_each(|v| {
            let velocity = Vec3::from(solver.velocity(v).map(f64::from));
            solver.set_velocity(v, to_f32(velocity + by))
        })
    }

    /// Moves a piece by a displacement \[m\], without a change of velocities.
    pub(crate) fn move_piece(&mut self, number: u32, shift: Vec3) {
        let (surface, _) = self.moved_parts();
        for slot in 0..surface.positions().len() {
            let v = VertexId::from_index(slot);
            if piece_of(surface, v) == Some(number) {
                let [x, y, z] = to_f32(surface.position(v) + shift);
                let p = &mut surface.positions_mut()[slot];
                *p = [x, y, z, p[3]];
            }
        }
    }
}
