//! Contact detection for one body: between its pieces, within a piece, and with blade faces.
//!
//! `frame.rs` runs it once per frame for each awake body; the solver then projects the contacts.
//!
//! 1. [`broad_phase`] finds pairs of pieces whose boxes, grown by the motion of a frame, overlap.
//! 2. [`narrow_phase`] finds for each vertex of such a piece the nearest triangle within reach that
//!    faces it, so that no vertex is pushed through a thin piece.
//! 3. [`persistent`] keeps a contact from frame to frame while the vertex hardly moves.
//!
//! A vertex stays on the side of a triangle on which it started the frame, provided that its speed
//! grows at most [`SPEED_MARGIN`]-fold within the frame. Penetrations are resolved at a limited
//! speed, since resolving them at once would throw the pieces apart; deep ones remain.

mod blade_face;
mod broad_phase;
mod narrow_phase;
mod persistent;

use crate::error::SceneError;
use broad_phase::Pieces;
use incise_mesh::{Bvh, SearchRadii, Surface};
use incise_pbd_gpu::{Collider, Contact, Pin, Solver};
use narrow_phase::{Row, Search};
use persistent::PersistentContact;

pub(crate) use blade_face::BladeFace;

/// Factor by which a vertex may become faster within a frame: an impact bends the body.
const SPEED_MARGIN: f64 = 2.0;

/// Rate at which a gap below the thickness opens, relative to the missing gap [1/s].
///
/// The speed is that of at most one thickness of penetration.
const SEPARATION_RATE: f64 = 5.0;

/// Maximum motion of a vertex relative to the triangle of a persistent contact [thicknesses].
const MOTION_TOLERANCE: f64 = 0.1;

/// Maximum rotation of the triangle of a persistent contact \[rad\].
const ROTATION_TOLERANCE: f64 = 0.02;

/// Parameters of contact detection. Friction is a parameter of the material.
///
/// Vertices are tested against triangles, not edges against edges. Triangles face one side: two
/// open sheets collide only where their outer sides meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactParams {
    /// Minimum distance between surfaces [mean rest edge lengths], at most
    /// [`ContactParams::MAX_THICKNESS`].
    pub thickness: f32,
    /// Whether the triangles of one piece collide with each other.
    pub self_collision: bool,
}

impl Default for ContactParams {
    /// Returns a thickness of a tenth of an edge length and no self-collision.
    fn default() -> Self {
        Self {
            thickness: 0.1,
            self_collision: false,
        }
    }
}

impl ContactParams {
    /// Maximum thickness: with a larger one every triangle would be a candidate.
    pub const MAX_THICKNESS: f32 = 100.0;

    /// Validates every parameter.
    ///
    /// # Errors
    /// [`SceneError::InvalidContactThickness`].
    pub fn check(&self) -> Result<(), SceneError> {
        let value = self.thickness;
        if value > 0.0 && value <= Self::MAX_THICKNESS {
            Ok(())
        } else {
            Err(SceneError::InvalidContactThickness { value })
        }
    }
}

/// The contact detection of one body: persistent contacts, and memory reused between frames.
#[derive(Debug, Clone, Default)]
pub(crate) struct ContactSearch {
    pieces: Pieces,
    radii: SearchRadii,
    rows: Vec<Row>,
    contacts: Vec<Contact>,
    /// The persistent contacts of this frame and of the previous one.
    current: Vec<PersistentContact>,
    previous: Vec<PersistentContact>,
    /// By vertex slot: index into `previous`, or `u32::MAX`.
    previous_of_vertex: Vec<u32>,
    /// Scratch memory: velocities of a body with pins, by vertex slot.
    velocities: Vec<[f32; 4]>,
}

/// The parameters and obstacles of the frame for which contacts are found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactFrame<'a> {
    pub(crate) params: ContactParams,
    /// Duration of the frame \[s\].
    pub(crate) dt: f64,
    /// Maximum speed that gravity adds within the frame [m/s].
    pub(crate) speed_gain: f64,
    pub(crate) colliders: &'a [Collider],
    pub(crate) blade_faces: &'a [BladeFace],
}

/// Velocities of a body's vertices in the frame.
#[derive(Debug, Clone, Copy)]
struct Velocities<'a> {
    /// Shape [vertex slots]; of pinned vertices the motion to their targets [m/s].
    all: &'a [[f32; 4]],
    pins: &'a [Pin],
}

impl ContactSearch {
    /// Finds the contacts of the next frame, passes them to the solver and returns their number.
    ///
    /// The BVH must be refitted if pieces may collide.
    pub(crate) fn find(
        &mut self,
        surface: &Surface,
        solver: &mut Solver,
        bvh: &Bvh,
        frame: &ContactFrame<'_>,
    ) -> Result<usize, SceneError> {
        let thickness = f64::from(frame.params.thickness) * solver.mean_rest_length();
        self.contacts.clear();
        self.begin_frame(surface.positions().len());
        let velocities = Velocities {
            all: velocities(&mut self.velocities, surface, solver, frame.dt),
            pins: solver.pins(),
        };
        self.pieces.update(surface, &velocities, (thickness, frame));
        let pieces_collide = self.pieces.has_pairs() || frame.params.self_collision;
        if pieces_collide || !frame.blade_faces.is_empty() {
            let displacements = self.pieces.displacements();
            if pieces_collide {
                self.radii.find(bvh, surface, |t| {
                    let corners = surface.topology().triangle(t).into_iter();
                    corners
                        .map(|c| displacements[c.index()])
                        .fold(0.0, f64::max)
                });
            }
            let search = Search {
                surface,
                velocities,
                bvh,
                radii: &self.radii,
                pieces: &self.pieces,
                displacements,
                previous: &self.previous,
                previous_of_vertex: &self.previous_of_vertex,
                thickness,
                friction: solver.material().friction,
                frame,
            };
            search.run(&mut self.rows);
            for row in &self.rows {
                self.contacts.extend_from_slice(&row.contacts);
                self.current.extend_from_slice(&row.persistent);
            }
        }
        solver.set_contacts(&self.contacts)?;
        Ok(self.contacts.len())
    }

    /// Makes the contacts of the last frame the previous ones.
    fn begin_frame(&mut self, vertex_slots: usize) {
        std::mem::swap(&mut self.current, &mut self.previous);
        self.current.clear();
        self.previous_of_vertex.clear();
        self.previous_of_vertex.resize(vertex_slots, u32::MAX);
        for (i, contact) in (0..).zip(&self.previous) {
            if let Some(entry) = self.previous_of_vertex.get_mut(contact.vertex.index()) {
                *entry = i;
            }
        }
    }
}

/// Returns the vertices' velocities; of pinned ones the motion to their targets [m/s].
#[expect(
    clippy::cast_possible_truncation,
    reason = "velocities are stored in 32 bits"
)]
fn velocities<'a>(
    scratch: &'a mut Vec<[f32; 4]>,
    surface: &Surface,
    solver: &'a Solver,
    dt: f64,
) -> &'a [[f32; 4]] {
    if solver.pins().is_empty() {
        return solver.velocities();
    }
    scratch.clear();
    scratch.extend_from_slice(solver.velocities());
    for pin in solver.pins() {
        let at = surface.positions()[pin.vertex.index()];
        let motion = |k: usize| f64::from(pin.target[k]) - f64::from(at[k]);
        scratch[pin.vertex.index()] =
            [0, 1, 2, 3].map(|k| if k < 3 { (motion(k) / dt) as f32 } else { 0.0 });
    }
    scratch
}
