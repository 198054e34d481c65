//! Contact detection: between bodies, their pieces and blade faces, and within a piece.
//!
//! `frame.rs` runs it once per frame for the awake bodies; the solver then projects the contacts.
//!
//! 1. [`near_bodies`] finds the bodies whose boxes, grown by the motion of a frame, overlap.
//! 2. [`broad_phase`] finds the pairs of their pieces.
//! 3. [`narrow_phase`] finds for each vertex of such a piece the nearest triangle within reach on
//!    whose outer side it lies, so that no vertex is pushed through a thin piece, and
//!    [`edge_pairs`] finds the sharp edges that cross each other. [`folds`] tells contacts within
//!    a piece from sides that face each other through it.
//! 4. [`persistent`] keeps a contact from frame to frame while the vertex hardly moves.
//! 5. [`carriers`] finds which piece of a contact carries the other one above a plane.
//! 6. [`press`] finds how heavy pieces press thin ones.
//! 7. [`overlaps`] finds pieces deep in each other, which the next frames move apart.
//!
//! The solver finds nearest points and normals in every substep. A vertex stays in front of a
//! triangle in whose reach it started the frame, provided that its speed grows at most
//! [`SPEED_MARGIN`]-fold within the frame. Penetrations are resolved at a limited speed and leave
//! no velocity.

mod axes;
mod blade_face;
mod body_rows;
mod broad_phase;
mod carriers;
mod depth;
mod edge_pairs;
mod edges;
mod folds;
mod free_way;
mod motion;
mod narrow_phase;
mod near_bodies;
mod outside;
mod overlaps;
mod persistent;
mod press;
mod sheets;

use crate::body::Body;
#[cfg(feature = "serde")]
use crate::save::LoadError;
use crate::scene::Bodies;
use body_rows::BodyRows;
use broad_phase::Pieces;
use carriers::Carriers;
use edge_pairs::EdgePairs;
use incise_mesh::geometry::to_f64;
use incise_mesh::{Aabb, MovingPoint, Vec3};
use incise_params::Range;
use incise_pbd_gpu::{Collider, MovingCollider};
use motion::Motion;
use narrow_phase::Search;
use near_bodies::{NearBodies, reachable_bounds};
use overlaps::Overlaps;

pub(crate) use blade_face::BladeFace;
pub(crate) use body_rows::BodyContact;
pub(crate) use overlaps::PieceId;

/// Factor by which a velocity may grow within a frame: an impact bends the body.
const SPEED_MARGIN: f64 = MovingPoint::SPEED_MARGIN as f64;

incise_params::params! {
    /// Parameters of contact detection. Friction is a parameter of the material.
    ///
    /// Vertices are tested against triangles, and sharp edges against those of other bodies. Sheets
    /// collide on both sides, closed pieces on the outer one. Between two bodies friction is the
    /// geometric mean of both. Closed pieces deep in each other are moved apart, each pair at most
    /// by a diagonal of the smaller one per second, and lose the velocity of their approach.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct ContactParams {
        /// Minimum distance between surfaces, relative to edges of the finer body.
        ///
        /// From a closed piece it is at most half of its volume by its area, a quarter of a plate.
        /// With a thickness beyond the range every triangle would be a candidate.
        thickness: f32 = 0.1, range: Range::POSITIVE.up_to(100.0), unit: "mean rest edge lengths";
        /// Whether the triangles of one piece collide with each other.
        self_collision: bool = false;
    }
}

/// The parameters and obstacles of the frame for which contacts are found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactFrame<'a> {
    pub(crate) params: ContactParams,
    /// Duration of the frame \[s\].
    pub(crate) dt: f64,
    /// Acceleration by gravity [m/s^2].
    pub(crate) gravity: Vec3,
    /// Maximum speed that gravity adds within the frame [m/s].
    pub(crate) speed_gain: f64,
    pub(crate) colliders: &'a [MovingCollider],
    pub(crate) blade_faces: &'a [BladeFace],
}

impl ContactFrame<'_> {
    /// Returns a point \[m\] and the unit normal of each plane.
    fn planes(&self) -> impl Iterator<Item = (Vec3, Vec3)> {
        self.colliders.iter().filter_map(|c| match c.start {
            Collider::Plane { point, normal } => Some((to_f64(point), to_f64(normal).normalize())),
            _ => None,
        })
    }

    /// Returns the minimum distance of other surfaces from a body's thickest pieces \[m\].
    fn thickness(&self, body: &Body) -> f64 {
        f64::from(self.params.thickness) * body.solver().mean_rest_length()
    }
}

/// The contact detection of a scene, in memory reused between frames.
#[derive(Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ContactDetection {
    #[cfg_attr(feature = "serde", serde(skip))]
    near: NearBodies,
    #[cfg_attr(feature = "serde", serde(skip))]
    pieces: Pieces,
    /// By body index.
    #[cfg_attr(feature = "serde", serde(skip))]
    motions: Vec<Motion>,
    rows: Vec<BodyRows>,
    edges: EdgePairs,
    #[cfg_attr(feature = "serde", serde(skip))]
    carriers: Carriers,
    overlaps: Overlaps,
}

impl ContactDetection {
    /// Checks a state that was read with serde, of a number of bodies, removed ones included.
    ///
    /// The search ignores a contact with a triangle that does not exist.
    ///
    /// # Errors
    /// [`LoadError::Array`].
    #[cfg(feature = "serde")]
    pub(crate) fn validate(&self, bodies: usize) -> Result<(), LoadError> {
        let is_valid =
            self.rows.len() <= bodies && self.edges.are_finite() && self.overlaps.is_valid();
        let array = "contacts";
        is_valid.then_some(()).ok_or(LoadError::Array { array })
    }

    /// Begins a frame without contacts.
    pub(crate) fn begin_frame(&mut self, bodies: &Bodies) {
        self.motions.resize_with(bodies.len(), Motion::default);
        self.rows.resize_with(bodies.len(), BodyRows::default);
        for (body, rows) in bodies.iter().zip(&mut self.rows) {
            let slots = body
                .as_ref()
                .map_or(0, |body| body.surface().positions().len());
            rows.begin_frame(slots);
        }
        self.edges.begin_frame();
        self.overlaps.begin_frame(bodies);
        self.begin_search(bodies.len());
    }

    /// Forgets the overlaps of a body, which is edited.
    pub(crate) fn forget_overlaps(&mut self, body: usize) {
        self.overlaps.forget(body);
    }

    /// Returns the number of pairs of pieces that are moved apart before the frame.
    pub(crate) fn overlaps(&self) -> usize {
        self.overlaps.len()
    }

    /// Returns the pieces of a pair that is moved apart and displacements that separate it by 1.
    pub(crate) fn shifts(&self, n: usize) -> [(PieceId, Vec3); 2] {
        self.overlaps.shifts(n)
    }

    /// Finds the pieces that are moved before the frame, and returns their number.
    pub(crate) fn find_moves(&mut self, bodies: &Bodies, frame: &ContactFrame<'_>) -> usize {
        self.overlaps.find_moves(bodies, frame)
    }

    /// Returns a piece that is moved and its displacement \[m\].
    pub(crate) fn piece_move(&self, n: usize) -> (PieceId, Vec3) {
        self.overlaps.piece_move(n)
    }

    /// Begins a search for near bodies.
    pub(crate) fn begin_search(&mut self, bodies: usize) {
        self.near.clear(bodies);
        for motion in &mut self.motions {
            motion.is_active = false;
        }
    }

    /// Adds a body of which only the box, grown by its motion in the frame, is known.
    pub(crate) fn add_box(&mut self, body: usize, bounds: Aabb, is_asleep: bool) {
        self.near.push(body, bounds, is_asleep);
    }

    /// Adds an awake body whose positions are known.
    pub(crate) fn add_body(&mut self, i: usize, body: &Body, frame: &ContactFrame<'_>) {
        let bounds = reachable_bounds(body, frame);
        self.near.push(i, bounds, false);
    }

    /// Finds the pairs of added bodies whose boxes overlap.
    pub(crate) fn find_near(&mut self) {
        self.near.find();
    }

    /// Returns whether a body may collide with another one.
    pub(crate) fn is_near(&self, body: usize) -> bool {
        self.near.is_near(body)
    }

    /// Makes a body, whose BVH is refitted, part of the search.
    pub(crate) fn activate(&mut self, i: usize, body: &Body, frame: &ContactFrame<'_>) {
        self.motions[i].begin_frame(body, frame);
    }

    /// Finds the contacts of all active bodies.
    pub(crate) fn find(&mut self, bodies: &Bodies, frame: &ContactFrame<'_>) {
        self.pieces.update(bodies, &mut self.motions, frame);
        for (body, motion) in bodies.iter().zip(&mut self.motions) {
            if let (true, Some(body)) = (motion.is_active, body) {
                motion.find_bounds(body);
            }
        }
        let search = Search {
            bodies,
            motions: &self.motions,
            pieces: &self.pieces,
            frame,
        };
        search.run(&mut self.rows, &mut self.edges);
        self.carriers.mark(search, &mut self.rows);
        self.overlaps.find(search);
    }

    /// Returns the contacts of the vertices of a body, in the order of vertices.
    pub(crate) fn contacts(&self, body: usize) -> impl Iterator<Item = &BodyContact> {
        self.rows.get(body).into_iter().flat_map(BodyRows::contacts)
    }
}
