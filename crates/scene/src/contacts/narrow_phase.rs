//! Narrow phase: the nearest triangle of each vertex, in parallel over rows of vertices.
//!
//! Called by [`super::ContactSearch`] after the broad phase. Rows are concatenated in order, so
//! that the result does not depend on the number of threads.

use super::broad_phase::{Piece, Pieces};
use super::persistent::{PersistentContact, contact_plane, faces, outward_normal};
use super::{BladeFace, ContactFrame, MOTION_TOLERANCE, SEPARATION_RATE, SPEED_MARGIN, Velocities};
use incise_mesh::geometry::to_f64;
use incise_mesh::{Bvh, SearchRadii, Surface, TriangleId, Vec3, VertexId, index_u32};
use incise_pbd_gpu::Contact;
use rayon::prelude::*;

/// Number of vertex slots of a row.
const ROW: usize = 512;

/// Minimum number of rows for threads: waking one takes about ten microseconds.
const MIN_PARALLEL_ROWS: usize = 4;

/// Maximum depth of a contact [thicknesses].
const MAX_DEPTH: f64 = 2.0;

/// The contacts of one row, in memory reused between frames.
#[derive(Debug, Clone, Default)]
pub(super) struct Row {
    pub(super) contacts: Vec<Contact>,
    pub(super) persistent: Vec<PersistentContact>,
    /// Scratch memory: the current vertex and its neighbors, excluded from self-collision.
    one_ring: Vec<VertexId>,
}

/// The input of a search, shared by all rows.
pub(super) struct Search<'a> {
    pub(super) surface: &'a Surface,
    pub(super) velocities: Velocities<'a>,
    pub(super) bvh: &'a Bvh,
    pub(super) radii: &'a SearchRadii,
    pub(super) pieces: &'a Pieces,
    /// Maximum displacements of vertices \[m\].
    pub(super) displacements: &'a [f64],
    /// The contacts of the previous frame, and their indices by vertex slot.
    pub(super) previous: &'a [PersistentContact],
    pub(super) previous_of_vertex: &'a [u32],
    /// Minimum distance between surfaces \[m\].
    pub(super) thickness: f64,
    /// Coulomb friction coefficient.
    pub(super) friction: f32,
    pub(super) frame: &'a ContactFrame<'a>,
}

impl Search<'_> {
    /// Finds the contacts of all vertices.
    pub(super) fn run(&self, rows: &mut Vec<Row>) {
        let slots = self.surface.positions().len();
        rows.resize_with(slots.div_ceil(ROW), Row::default);
        if rows.len() < MIN_PARALLEL_ROWS {
            rows.iter_mut()
                .enumerate()
                .for_each(|(i, row)| self.fill(i, row));
        } else {
            rows.par_iter_mut()
                .enumerate()
                .for_each(|(i, row)| self.fill(i, row));
        }
    }

    /// Finds the contacts of one row.
    fn fill(&self, i: usize, row: &mut Row) {
        row.contacts.clear();
        row.persistent.clear();
        let slots = self.surface.positions().len();
        for slot in i * ROW..slots.min((i + 1) * ROW) {
            let v = VertexId(index_u32(slot));
            if !self.surface.topology().outgoing(v).is_null() {
                self.find_piece_contact(v, row);
                self.find_blade_face_contacts(v, row);
            }
        }
    }

    /// Adds the contact of a vertex with the nearest triangle, if there is one.
    fn find_piece_contact(&self, v: VertexId, row: &mut Row) {
        let (surface, frame) = (self.surface, self.frame);
        let self_collision = frame.params.self_collision;
        if !(self_collision || self.pieces.has_pairs()) {
            return;
        }
        let number = surface.piece(surface.topology().outgoing(v).triangle());
        let index = self.pieces.index(number);
        let at = surface.position(v);
        let radius = self.thickness + frame.speed_gain * frame.dt + self.displacements[v.index()];
        let is_near = |other: &Piece| other.is_near(at, radius + other.max_displacement);
        if !self_collision && !self.pieces.neighbors(index).any(is_near) {
            return;
        }
        let previous = self.previous_of_vertex[v.index()] as usize;
        let previous = self.previous.get(previous).copied();
        let kept = previous
            .filter(|contact| contact.persists(surface, at, (self.thickness, self_collision)));
        let contact = kept.or_else(|| {
            let first = previous.map(|contact| contact.triangle);
            self.nearest(v, (number, radius), first, &mut row.one_ring)
        });
        // A deeper vertex has passed the triangle, whose plane would hold the two together.
        let is_shallow = |contact: &PersistentContact| {
            contact.height(surface, at) >= -MAX_DEPTH * self.thickness
        };
        if let Some(mut contact) = contact.filter(is_shallow) {
            let thickness = contact.thickness(surface, self.thickness);
            // A vertex that cannot follow its gap is not pushed harder in every frame.
            let reachable = contact.height(surface, at) + MOTION_TOLERANCE * thickness;
            contact.gap = contact.gap.min(reachable).min(thickness);
            let gap_rate = SEPARATION_RATE * (thickness - contact.gap).min(2.0 * thickness);
            row.contacts
                .push(contact.to_solver(gap_rate, self.friction));
            contact.gap += gap_rate * frame.dt;
            row.persistent.push(contact);
        }
    }

    /// Finds the nearest triangle of a vertex of a piece within a radius \[m\].
    ///
    /// `first` is the triangle of the previous frame, where the search starts.
    fn nearest(
        &self,
        v: VertexId,
        (number, radius): (u32, f64),
        first: Option<TriangleId>,
        one_ring: &mut Vec<VertexId>,
    ) -> Option<PersistentContact> {
        let (surface, self_collision) = (self.surface, self.frame.params.self_collision);
        let topology = surface.topology();
        let at = surface.position(v);
        one_ring.clear();
        if self_collision {
            one_ring.push(v);
            for h in topology.outgoing_fan(v) {
                one_ring.extend([topology.target(h), topology.origin(h.prev())]);
            }
        }
        let outward = outward_normal(surface, v);
        let faces = |t| faces(surface, outward, t);
        let is_in_ring = |t| topology.triangle(t).iter().any(|c| one_ring.contains(c));
        let is_fold = |t| self_collision && faces(t) && !is_in_ring(t);
        let is_other = |t| surface.piece(t) != number;
        let is_candidate = |t| is_other(t) && faces(t) || is_fold(t);
        let search = (self.radii, (!self_collision).then_some(number));
        let found =
            (self.bvh).nearest_in_reach(surface, (at, radius), search, first, is_candidate)?;
        // The motion of the vertex relative to the nearest point.
        let corners = topology.triangle(found.triangle).into_iter();
        let weighted = corners.zip(found.weights);
        let of_point: Vec3 = weighted.map(|(c, w)| self.velocities.of(c) * w).sum();
        let motion = (self.velocities.of(v) - of_point) * self.frame.dt;
        let plane = contact_plane(surface, at, &found, motion);
        Some(PersistentContact::new(surface, (v, at), &found, plane))
    }

    /// Adds the contacts of a vertex with blade faces.
    fn find_blade_face_contacts(&self, v: VertexId, row: &mut Row) {
        let frame = self.frame;
        let contact = |face: &BladeFace| {
            let speed = self.velocities.of(v).norm();
            let radius = self.thickness + (SPEED_MARGIN * speed + frame.speed_gain) * frame.dt;
            let contact = face.contact((self.surface, v), radius, self.thickness, frame.dt)?;
            Some(Contact {
                friction: self.friction,
                ..contact
            })
        };
        row.contacts
            .extend(frame.blade_faces.iter().filter_map(contact));
    }
}

impl Velocities<'_> {
    /// Returns the velocity of a vertex [m/s].
    pub(super) fn of(&self, v: VertexId) -> Vec3 {
        let [x, y, z, _] = self.all[v.index()];
        to_f64([x, y, z])
    }
}
