//! [`Motion`]: how far the vertices of one body may move within the frame.

use super::{ContactFrame, SPEED_MARGIN};
use crate::body::Body;
use incise_mesh::geometry::{to_f32, to_f64};
use incise_mesh::{MotionBounds, Surface, TriangleId, Vec3, VertexId};

/// Maximum minimum distance from a piece [distances between its sides].
///
/// With a larger one the far sides of two plates would push each other too.
const MAX_THICKNESS: f64 = 0.25;

/// Velocities and displacements of a body's vertices, in memory reused between frames.
#[derive(Debug, Clone, Default)]
pub(super) struct Motion {
    /// Whether the body is searched for contacts in this frame.
    pub(super) is_active: bool,
    /// Maximum of the minimum distances from its pieces \[m\].
    pub(super) thickness: f64,
    /// By piece number: minimum distance of other surfaces \[m\].
    thicknesses: Vec<f64>,
    /// Velocities; of pinned vertices the motion to their targets [m/s], shape [vertex slots].
    velocities: Vec<[f32; 4]>,
    /// Displacements at the velocities relative to their group of pieces \[m\].
    ///
    /// Shape [vertex slots].
    pub(super) displacements: Vec<[f32; 3]>,
    /// Boxes and displacements of the nodes of the body's BVH.
    pub(super) bounds: MotionBounds,
    /// By piece number: index in the broad phase, or `u32::MAX`.
    pub(super) pieces: Vec<u32>,
}

impl Motion {
    /// Begins a frame in which the body is searched.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "velocities are stored in 32 bits"
    )]
    pub(super) fn begin_frame(&mut self, body: &Body, frame: &ContactFrame<'_>) {
        let (surface, solver) = (body.surface(), body.solver());
        self.is_active = true;
        self.thickness = frame.thickness(body);
        self.velocities.clear();
        self.velocities.extend_from_slice(solver.velocities());
        for pin in solver.pins() {
            let at = surface.positions()[pin.vertex.index()];
            let motion = |k: usize| f64::from(pin.target[k]) - f64::from(at[k]);
            self.velocities[pin.vertex.index()] = [0, 1, 2, 3].map(|k| {
                if k < 3 {
                    (motion(k) / frame.dt) as f32
                } else {
                    0.0
                }
            });
        }
        self.displacements.clear();
        self.displacements.resize(self.velocities.len(), [0.0; 3]);
        self.thicknesses.clear();
        self.thicknesses
            .extend((0..surface.piece_bound()).map(|piece| {
                let shape = body.piece_shapes().get(piece);
                if shape.is_sheet {
                    self.thickness
                } else {
                    self.thickness.min(MAX_THICKNESS * shape.thickness)
                }
            }));
        self.pieces.clear();
        self.pieces.resize(surface.piece_bound() as usize, u32::MAX);
    }

    /// Returns the minimum distance of other surfaces from the piece of a triangle \[m\].
    pub(super) fn thickness(&self, surface: &Surface, t: TriangleId) -> f64 {
        self.piece_thickness(surface.piece(t))
    }

    /// Returns the minimum distance of other surfaces from a piece \[m\].
    pub(super) fn piece_thickness(&self, piece: u32) -> f64 {
        self.thicknesses[piece as usize]
    }

    /// Returns the velocity of a vertex [m/s].
    pub(super) fn velocity(&self, v: VertexId) -> Vec3 {
        let [x, y, z, _] = self.velocities[v.index()];
        to_f64([x, y, z])
    }

    /// Sets the displacement of a vertex relative to a common velocity [m/s], and returns it.
    pub(super) fn set_displacement(&mut self, v: VertexId, common: Vec3, dt: f64) -> [f32; 3] {
        let displacement = to_f32((self.velocity(v) - common) * dt);
        self.displacements[v.index()] = displacement;
        displacement
    }

    /// Returns the maximum displacement of a vertex whose velocity grows \[m\].
    pub(super) fn max_displacement(&self, v: VertexId) -> f64 {
        SPEED_MARGIN * to_f64(self.displacements[v.index()]).norm()
    }

    /// Finds the bounds of all nodes of a BVH, which must be refitted.
    pub(super) fn find_bounds(&mut self, body: &Body) {
        let displacements = &self.displacements;
        self.bounds.find(body.bvh(), body.surface(), displacements);
    }
}
