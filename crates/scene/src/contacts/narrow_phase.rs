//! Narrow phase: the nearest triangle of each vertex, in parallel over rows of vertices.
//!
//! Called by [`super::ContactDetection`] after the broad phase. Rows are concatenated in order, so
//! that the result does not depend on the number of threads.

use super::body_rows::{BodyContact, BodyRows, ROW, Row};
use super::broad_phase::Pieces;
use super::edge_pairs::EdgePairs;
use super::folds::is_from_outside;
use super::motion::Motion;
use super::outside::{Touching, faces, is_outside, outward_normal, shared_by};
use super::persistent::{PersistentContact, contact_kind};
use super::sheets::{SideLimits, is_behind};
use super::{ContactFrame, SPEED_MARGIN};
use crate::body::Body;
use crate::scene::Bodies;
use incise_mesh::{MovingPoint, Surface, TriangleId, Vec3, VertexId, index_u32};
use incise_pbd_gpu::{Contact, ContactKind, LoadRatio};
use rayon::prelude::*;

/// Minimum number of rows for threads: waking one takes about ten microseconds.
const MIN_PARALLEL_ROWS: usize = 4;

/// Maximum distance of a resting vertex from the triangle of a contact [thicknesses].
///
/// Others may push it within the frame, and its distance is a thickness up to rounding. Vertices
/// with a larger maximum displacement in the frame count as fast.
pub(super) const MARGIN: f64 = 1.5;

/// Maximum depth of a contact [thicknesses].
pub(super) const MAX_DEPTH: f64 = 2.0;

/// The input of a search, shared by all rows.
#[derive(Clone, Copy)]
pub(super) struct Search<'a> {
    pub(super) bodies: &'a Bodies,
    pub(super) motions: &'a [Motion],
    pub(super) pieces: &'a Pieces,
    pub(super) frame: &'a ContactFrame<'a>,
}

/// The body whose vertices are searched.
#[derive(Clone, Copy)]
pub(super) struct Searched<'a> {
    pub(super) index: u32,
    pub(super) body: &'a Body,
    pub(super) motion: &'a Motion,
    previous: &'a [PersistentContact],
    previous_of_vertex: &'a [u32],
}

impl Searched<'_> {
    /// Returns the minimum distance of other surfaces from the piece of a vertex \[m\].
    fn thickness(&self, v: VertexId) -> f64 {
        let surface = self.body.surface();
        let t = surface.topology().outgoing(v).triangle();
        self.motion.thickness(surface, t)
    }
}

impl Search<'_> {
    /// Finds the contacts of all vertices and edges of active bodies.
    pub(super) fn run(&self, all: &mut [BodyRows], edges: &mut EdgePairs) {
        self.find_vertex_contacts(all);
        self.find_edge_contacts(all, edges);
    }

    /// Finds the contacts of all vertices, and collects the edges.
    fn find_vertex_contacts(&self, all: &mut [BodyRows]) {
        let mut rows = 0;
        for ((body, motion), of_body) in self.bodies.iter().zip(self.motions).zip(&mut *all) {
            if let Some(body) = body.as_ref().filter(|_| motion.is_active) {
                of_body.resize(body.surface().positions().len());
                rows += of_body.rows.len();
            }
        }
        if rows < MIN_PARALLEL_ROWS {
            let bodies = all.iter_mut().enumerate();
            bodies.for_each(|(i, of_body)| self.fill_body(i, of_body, false));
        } else {
            let bodies = all.par_iter_mut().enumerate();
            bodies.for_each(|(i, of_body)| self.fill_body(i, of_body, true));
        }
    }

    /// Finds the contacts of the vertices of one body.
    fn fill_body(&self, i: usize, of_body: &mut BodyRows, is_parallel: bool) {
        let body = self.bodies[i].as_ref();
        let Some(body) = body.filter(|_| self.motions[i].is_active) else {
            return;
        };
        let searched = Searched {
            index: index_u32(i),
            body,
            motion: &self.motions[i],
            previous: &of_body.previous,
            previous_of_vertex: &of_body.previous_of_vertex,
        };
        if is_parallel && of_body.rows.len() > 1 {
            let rows = of_body.rows.par_iter_mut().enumerate();
            rows.for_each(|(i, row)| self.fill(searched, i, row));
        } else {
            let rows = of_body.rows.iter_mut().enumerate();
            rows.for_each(|(i, row)| self.fill(searched, i, row));
        }
    }

    /// Finds the contacts of one row.
    fn fill(&self, of: Searched<'_>, i: usize, row: &mut Row) {
        row.contacts.clear();
        row.persistent.clear();
        row.edges.clear();
        let surface = of.body.surface();
        let slots = surface.positions().len();
        for slot in i * ROW..slots.min((i + 1) * ROW) {
            let v = VertexId(index_u32(slot));
            if surface.topology().outgoing(v).is_null() {
                continue;
            }
            let number = surface.piece(surface.topology().outgoing(v).triangle());
            let piece = of.motion.pieces[number as usize];
            let point = self.moving_point(of, v, number);
            self.find_near(of, piece, &point, &mut row.near);
            for n in 0..row.near.len() {
                self.find_contact(of, (v, &point), row.near[n], row);
            }
            self.find_blade_face_contacts(of, v, row);
            if self.frame.params.self_collision || self.pieces.neighbors(piece).next().is_some() {
                for h in surface.topology().outgoing_fan(v) {
                    self.collect_edge(of, h, piece, row);
                }
            }
        }
    }

    /// Returns a vertex and its motion within the frame, for searches of triangles.
    fn moving_point(&self, of: Searched<'_>, v: VertexId, piece: u32) -> MovingPoint {
        let gain = self.frame.speed_gain * self.frame.dt;
        MovingPoint {
            position: of.body.surface().position(v),
            displacement: of.motion.displacements[v.index()],
            margin: MARGIN * of.thickness(v) + gain,
            excluded_piece: (!self.frame.params.self_collision).then_some(piece),
        }
    }

    /// Finds the bodies that a vertex may touch within the frame, ascending.
    fn find_near(&self, of: Searched<'_>, piece: u32, point: &MovingPoint, near: &mut Vec<u32>) {
        near.clear();
        if self.frame.params.self_collision {
            near.push(of.index);
        }
        for other in self.pieces.neighbors(piece) {
            if !near.contains(&other.body) && other.is_near(point) {
                near.push(other.body);
            }
        }
        near.sort_unstable();
    }

    /// Adds the contact of a vertex with the nearest triangle of a body, if there is one.
    fn find_contact(
        &self,
        of: Searched<'_>,
        (v, point): (VertexId, &MovingPoint),
        other: u32,
        row: &mut Row,
    ) {
        let Some(other_body) = &self.bodies[other as usize] else {
            return;
        };
        let (surface, other_surface) = (of.body.surface(), other_body.surface());
        let of_other = &self.motions[other as usize];
        let thickness =
            |t: TriangleId| f64::min(of.thickness(v), of_other.thickness(other_surface, t));
        let at = point.position;
        let first = of.previous_of_vertex[v.index()] as usize;
        let previous = of.previous.get(first..).unwrap_or_default();
        let mut of_vertex = previous.iter().take_while(|contact| contact.vertex == v);
        let previous = of_vertex.find(|contact| contact.other == other).copied();
        let is_fold = |t: TriangleId| other == of.index && is_own(surface, v, t);
        let self_collision = self.frame.params.self_collision;
        let kept = previous.filter(|contact| {
            contact.persists(other_surface, at, thickness)
                && (self_collision || !is_fold(contact.triangle))
        });
        let contact = kept.or_else(|| {
            let target = (other, other_body.as_ref());
            self.nearest_from_outside(of, (v, point), target, previous, row)
        });
        let Some(contact) = contact else { return };
        // Within a piece at most half of the rest distance, so that a thin fold stays as it is.
        let mut gap = thickness(contact.triangle);
        let is_fold = is_fold(contact.triangle);
        if is_fold {
            gap = gap.min(contact.rest_distance(surface) / 2.0);
        }
        row.contacts.push(BodyContact {
            other,
            contact: Contact {
                press: if is_fold {
                    LoadRatio::NONE
                } else {
                    self.press(of, (&contact, at), gap)
                },
                ..vertex_face(&contact, gap, friction(of.body, other_body))
            },
        });
        row.persistent.push(contact);
    }

    /// Finds the nearest triangle of a body that a vertex touches [from outside](is_from_outside).
    fn nearest_from_outside(
        &self,
        of: Searched<'_>,
        (v, point): (VertexId, &MovingPoint),
        (other, body): (u32, &Body),
        previous: Option<PersistentContact>,
        row: &mut Row,
    ) -> Option<PersistentContact> {
        let target = (other, body);
        let found = self.nearest(of, (v, point), target, previous, &mut row.one_ring)?;
        let surface = of.body.surface();
        let is_fold = other == of.index && is_own(surface, v, found.triangle);
        let contact = (&found, point.position);
        if !is_fold || is_from_outside(body, contact, of.thickness(v)) {
            return Some(found);
        }
        let others = MovingPoint {
            excluded_piece: Some(surface.piece(found.triangle)),
            ..*point
        };
        self.nearest(of, (v, &others), target, previous, &mut row.one_ring)
    }

    /// Finds the nearest triangle of a body within reach of a vertex, other than those around it.
    ///
    /// The search starts at the triangle of the previous frame's contact. Sheets are touched from
    /// both sides, the other triangles from [outside](is_outside).
    fn nearest(
        &self,
        of: Searched<'_>,
        (v, point): (VertexId, &MovingPoint),
        (other, body): (u32, &Body),
        previous: Option<PersistentContact>,
        one_ring: &mut Vec<VertexId>,
    ) -> Option<PersistentContact> {
        let (surface, other_surface) = (of.body.surface(), body.surface());
        let motion = &self.motions[other as usize];
        let self_collision = self.frame.params.self_collision;
        let topology = surface.topology();
        let at = point.position;
        one_ring.clear();
        if other == of.index && self_collision {
            one_ring.push(v);
            for h in topology.outgoing_fan(v) {
                one_ring.extend([topology.target(h), topology.origin(h.prev())]);
            }
        }
        let is_around = |t| {
            let corners = other_surface.topology().triangle(t);
            !one_ring.is_empty() && corners.iter().any(|c| one_ring.contains(c))
        };
        let shapes = body.piece_shapes();
        let is_in_sheet = |t: TriangleId| shapes.get(other_surface.piece(t)).is_sheet;
        let number = surface.piece(topology.outgoing(v).triangle());
        let of_sheet = of.body.piece_shapes().get(number).is_sheet;
        let is_own = |t| other == of.index && other_surface.piece(t) == number;
        let has_two_sides = |t| (of_sheet || is_in_sheet(t)) && !is_own(t);
        // A deeper vertex has passed the triangle, whose plane would hold the two together.
        let thickness = of.thickness(v);
        let max_depth = |t| MAX_DEPTH * thickness.min(motion.thickness(other_surface, t));
        let outward = outward_normal(surface, v);
        let is_fast = of.motion.max_displacement(v) > MARGIN * thickness;
        let is_candidate = |t| {
            let vertex = Touching {
                at,
                outward,
                must_be_faced: !is_fast || is_own(t),
                max_depth: max_depth(t),
            };
            let is_on_side = has_two_sides(t)
                || is_in_sheet(t) && faces(other_surface, outward, t)
                || is_outside(other_surface, t, vertex);
            is_on_side && !is_around(t)
        };
        let point = MovingPoint {
            excluded_piece: point.excluded_piece.filter(|_| other == of.index),
            ..*point
        };
        let first = previous.map(|contact| contact.triangle);
        let (bvh, bounds) = (body.bvh(), &motion.bounds);
        let found = bvh.nearest_in_reach(other_surface, &point, bounds, first, is_candidate)?;
        let is_preferred = |t| {
            let is_faced = has_two_sides(t) || faces(other_surface, outward, t);
            is_faced && !is_around(t)
        };
        let found = shared_by(other_surface, found, is_preferred);
        let max_depth = max_depth(found.triangle);
        let is_behind = if is_in_sheet(found.triangle) {
            // The sides of a cut through a sheet start in one plane.
            let apart = if other == of.index {
                max_depth / MAX_DEPTH
            } else {
                0.0
            };
            let limits = SideLimits { apart, max_depth };
            let (previous, nearest) = (previous.as_ref(), (at, &found));
            is_behind(other_surface, nearest, previous, limits)?
        } else {
            false
        };
        let side = if is_behind { -1.0 } else { 1.0 };
        if side * found.distance < -max_depth {
            return None;
        }
        // The motion of the vertex relative to the nearest point.
        let corners = other_surface.topology().triangle(found.triangle);
        let weighted = corners.into_iter().zip(found.weights);
        let of_point: Vec3 = weighted.map(|(c, w)| motion.velocity(c) * w).sum();
        let relative = (of.motion.velocity(v) - of_point) * self.frame.dt;
        let is_inside = found.weights.iter().all(|&w| w > 0.0);
        let kind = if is_inside {
            ContactKind::VertexFace
        } else {
            contact_kind(other_surface, at, (&found, is_behind), relative)
        };
        let target = (other, other_surface);
        Some(PersistentContact::new(
            target,
            (v, at),
            &found,
            (kind, is_behind),
        ))
    }

    /// Adds the contacts of a vertex with blade faces.
    fn find_blade_face_contacts(&self, of: Searched<'_>, v: VertexId, row: &mut Row) {
        let (frame, thickness) = (self.frame, of.thickness(v));
        for face in frame.blade_faces {
            let speed = of.motion.velocity(v).norm();
            let radius = thickness + (SPEED_MARGIN * speed + frame.speed_gain) * frame.dt;
            if let Some(contact) = face.contact((of.body.surface(), v), radius, thickness, frame.dt)
            {
                row.contacts.push(BodyContact {
                    other: of.index,
                    contact: Contact {
                        friction: of.body.solver().material().friction,
                        ..contact
                    },
                });
            }
        }
    }
}

/// Returns the solver's contact at a distance \[m\].
#[expect(
    clippy::cast_possible_truncation,
    reason = "the solver stores contacts in 32 bits"
)]
fn vertex_face(contact: &PersistentContact, gap: f64, friction: f32) -> Contact {
    let [a, b, c] = contact.corners;
    let corners = if contact.is_behind {
        [a, c, b]
    } else {
        [a, b, c]
    };
    Contact {
        kind: contact.kind,
        friction,
        ..Contact::vertex_face(contact.vertex, corners, gap as f32)
    }
}

/// Returns whether a triangle belongs to the piece of a vertex of the same body.
fn is_own(surface: &Surface, v: VertexId, t: TriangleId) -> bool {
    surface.piece(surface.topology().outgoing(v).triangle()) == surface.piece(t)
}

/// Returns the friction between two materials: the geometric mean of both.
pub(super) fn friction(a: &Body, b: &Body) -> f32 {
    let [a, b] = [a, b].map(|body| body.solver().material().friction);
    if a.to_bits() == b.to_bits() {
        a
    } else {
        (a * b).sqrt()
    }
}
