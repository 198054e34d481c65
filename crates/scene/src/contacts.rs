//! Which vertices touch which triangles: what the pieces of a body have to do with each other and with the flats of blades,
//! found anew in every frame.
//!
//! Boxes first: a piece whose box, grown by what may move in a frame, meets no other one is not looked at. Of the others
//! every vertex in such a box gets the nearest triangle within reach that faces it, so that nothing is pushed out through the
//! other side of a thin piece. A vertex stays on its side of what it was nearest
//! to when the frame began, as far as anything of it gets no more than [`SAFETY`] times as fast within the frame. Pieces that lie in each
//! other a little part slowly, since to push them apart at once would throw them; deep in each other they stay.

mod flat;
mod pieces;
mod search;
mod touch;

use crate::error::SceneError;
use incise_cut::{Bvh, NodeReaches};
use incise_mesh::Surface;
use incise_pbd_gpu::{Collider, Contact, Pin, Solver};
use pieces::Pieces;
use search::{Row, Search};
use touch::Touch;

pub(crate) use flat::Flat;

/// How much faster than at its beginning something may get within a frame: what hits something else is bent, and
/// parts of it are then faster than it was.
const SAFETY: f64 = 2.0;

/// How fast what is too near parts: by this part of what is missing [1/s]. What lies in each other by more than a thickness
/// does not part any faster.
const APART: f64 = 5.0;

/// A contact is the same still if its vertex has moved no farther than this along the triangle and off it, in thicknesses,
/// and the triangle has turned by no more than that angle \[rad\].
const AGAIN: f64 = 0.1;
const TURNED: f64 = 0.02;

/// How pieces touch. Friction is the material's. A surface has one outside: open sheets touch each
/// other only where those meet, and a vertex is compared with triangles, not edges with edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactParams {
    /// How far surfaces stay from each other, in mean lengths of the body's edges at rest; at most [`ContactParams::THICKEST`].
    pub thickness: f32,
    /// Whether a piece touches itself: what looks at each other across a fold.
    pub own: bool,
}

impl Default for ContactParams {
    /// A tenth of an edge, and no piece touches itself.
    fn default() -> Self {
        Self {
            thickness: 0.1,
            own: false,
        }
    }
}

impl ContactParams {
    /// What is thicker would touch everything, and find no nearest triangle in any time.
    pub const THICKEST: f32 = 100.0;

    /// Checks every number.
    ///
    /// # Errors
    /// [`SceneError::BadContacts`].
    pub fn check(&self) -> Result<(), SceneError> {
        let value = self.thickness;
        if value > 0.0 && value <= Self::THICKEST {
            Ok(())
        } else {
            Err(SceneError::BadContacts { value })
        }
    }
}

/// What a search found and needs, kept from frame to frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct Touching {
    pieces: Pieces,
    reaches: NodeReaches,
    rows: Vec<Row>,
    contacts: Vec<Contact>,
    /// What was found, by contact, and in the frame before.
    found: Vec<Touch>,
    before: Vec<Touch>,
    /// By vertex: its place in `before`.
    known: Vec<u32>,
    /// Velocities of a body that has pins, by vertex.
    velocities: Vec<[f32; 4]>,
}

/// The frame that contacts are found for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reach<'a> {
    pub(crate) params: ContactParams,
    /// \[s\]
    pub(crate) dt: f64,
    /// How fast anything may get within the frame by itself [m/s].
    pub(crate) gained: f64,
    /// What may stop a piece: the height of the ground \[m\], colliders.
    pub(crate) ground: Option<f32>,
    pub(crate) colliders: &'a [Collider],
    /// The flats of blades.
    pub(crate) flats: &'a [Flat],
}

/// How fast vertices are.
#[derive(Debug, Clone, Copy)]
struct Velocities<'a> {
    /// Shape [vertex slots].
    all: &'a [[f32; 4]],
    pins: &'a [Pin],
}

impl Touching {
    /// Finds the contacts of a body for the next frame and hands them to its solver. The search tree must fit if pieces may touch.
    /// Returns how many there are.
    pub(crate) fn find(
        &mut self,
        surface: &Surface,
        solver: &mut Solver,
        bvh: &Bvh,
        reach: &Reach<'_>,
    ) -> Result<usize, SceneError> {
        let thickness = f64::from(reach.params.thickness) * solver.mean_rest_length();
        self.contacts.clear();
        self.remember(surface.positions.len());
        let velocities = Velocities {
            all: velocities(&mut self.velocities, surface, solver, reach.dt),
            pins: solver.pins(),
        };
        self.pieces.find(surface, &velocities, (thickness, reach));
        if self.pieces.meet() || reach.params.own || !reach.flats.is_empty() {
            let ways = self.pieces.ways();
            if self.pieces.meet() || reach.params.own {
                self.reaches.find(bvh, surface, |t| {
                    let corners = surface.topology().triangle(t).into_iter();
                    corners.map(|c| ways[c.index()]).fold(0.0, f64::max)
                });
            }
            let search = Search {
                surface,
                velocities,
                bvh,
                reaches: &self.reaches,
                pieces: &self.pieces,
                ways,
                before: &self.before,
                known: &self.known,
                thickness,
                reach,
            };
            search.run(&mut self.rows);
            for row in &self.rows {
                self.contacts.extend_from_slice(&row.contacts);
                self.found.extend_from_slice(&row.found);
            }
        }
        solver.set_contacts(&self.contacts)?;
        Ok(self.contacts.len())
    }

    /// Makes what was found what was found before.
    fn remember(&mut self, vertex_slots: usize) {
        std::mem::swap(&mut self.found, &mut self.before);
        self.found.clear();
        self.known.clear();
        self.known.resize(vertex_slots, u32::MAX);
        for (i, touch) in (0..).zip(&self.before) {
            if let Some(known) = self.known.get_mut(touch.vertex.index()) {
                *known = i;
            }
        }
    }
}

/// How fast vertices are, and those that are pinned have to be to get to their targets [m/s].
#[expect(
    clippy::cast_possible_truncation,
    reason = "velocities are stored in 32 bits"
)]
fn velocities<'a>(
    room: &'a mut Vec<[f32; 4]>,
    surface: &Surface,
    solver: &'a Solver,
    dt: f64,
) -> &'a [[f32; 4]] {
    if solver.pins().is_empty() {
        return solver.velocities();
    }
    room.clear();
    room.extend_from_slice(solver.velocities());
    for pin in solver.pins() {
        let at = surface.positions[pin.vertex.index()];
        let way = |k: usize| f64::from(pin.target[k]) - f64::from(at[k]);
        room[pin.vertex.index()] =
            [0, 1, 2, 3].map(|k| if k < 3 { (way(k) / dt) as f32 } else { 0.0 });
    }
    room
}

fn narrow(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}
