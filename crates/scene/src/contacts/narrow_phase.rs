//! Narrow phase: the nearest triangle of each vertex, in parallel over rows of vertices.
//!
//! Called by [`super::ContactDetection`] after the broad phase. Rows are concatenated in order, so
//! that the result does not depend on the number of threads.

use super::broad_phase::{Piece, Pieces};
use super::edges::{MovingEdge, SharpEdge, find_edge_pairs};
use super::motion::Motion;
use super::near_bodies::grow;
use super::persistent::{PersistentContact, contact_kind, outward_normal};
use super::{ContactFrame, SPEED_MARGIN};
use crate::body::Body;
use crate::scene::Bodies;
use incise_mesh::{HalfEdge, MovingPoint, Surface, TriangleId, Vec3, VertexId, index_u32};
use incise_pbd_gpu::{Contact, ContactKind};
use rayon::prelude::*;

/// Number of vertex slots of a row.
const ROW: usize = 512;

/// Minimum number of rows for threads: waking one takes about ten microseconds.
const MIN_PARALLEL_ROWS: usize = 4;

/// Maximum depth of a contact [thicknesses].
const MAX_DEPTH: f64 = 2.0;

/// A contact of a vertex of one body with a triangle of the same or another one, or with a plane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyContact {
    /// Index of the triangle's body.
    pub(crate) other: u32,
    /// The vertices of its first feature are those of the searched body.
    pub(crate) contact: Contact,
}

/// The contacts of one row, in memory reused between frames.
#[derive(Debug, Clone, Default)]
pub(super) struct Row {
    contacts: Vec<BodyContact>,
    persistent: Vec<PersistentContact>,
    /// Scratch memory: the current vertex and its neighbors, excluded from self-collision.
    one_ring: Vec<VertexId>,
    /// Scratch memory: the bodies that the current vertex may touch.
    near: Vec<u32>,
    /// Sharp edges near other bodies, until they are tested.
    edges: Vec<MovingEdge>,
}

/// The contacts of the vertices of one body, in memory reused between frames.
#[derive(Debug, Clone, Default)]
pub(super) struct BodyRows {
    rows: Vec<Row>,
    /// Contacts of its edges with those of later bodies.
    edge_contacts: Vec<BodyContact>,
    /// The persistent contacts of the previous frame, ascending by vertex.
    previous: Vec<PersistentContact>,
    /// By vertex slot: first index into `previous`, or `u32::MAX`.
    previous_of_vertex: Vec<u32>,
}

impl BodyRows {
    /// Returns the contacts in the order of vertices, then those of edges.
    pub(super) fn contacts(&self) -> impl Iterator<Item = &BodyContact> {
        let of_vertices = self.rows.iter().flat_map(|row| &row.contacts);
        of_vertices.chain(&self.edge_contacts)
    }

    /// Removes all contacts; those of the last search become the previous ones.
    pub(super) fn begin_frame(&mut self, vertex_slots: usize) {
        self.previous.clear();
        for row in &mut self.rows {
            self.previous.append(&mut row.persistent);
            row.contacts.clear();
        }
        self.edge_contacts.clear();
        self.previous_of_vertex.clear();
        self.previous_of_vertex.resize(vertex_slots, u32::MAX);
        for (i, contact) in (0..).zip(&self.previous) {
            if let Some(first) = self.previous_of_vertex.get_mut(contact.vertex.index()) {
                *first = i.min(*first);
            }
        }
    }

    /// Sets the number of vertex slots that are searched.
    fn resize(&mut self, vertex_slots: usize) {
        (self.rows).resize_with(vertex_slots.div_ceil(ROW), Row::default);
    }
}

/// Memory of the search for pairs of edges.
#[derive(Debug, Clone, Default)]
pub(super) struct EdgeScratch {
    edges: Vec<MovingEdge>,
    pairs: Vec<(u32, u32)>,
}

/// The input of a search, shared by all rows.
pub(super) struct Search<'a> {
    pub(super) bodies: &'a Bodies,
    pub(super) motions: &'a [Motion],
    pub(super) pieces: &'a Pieces,
    pub(super) frame: &'a ContactFrame<'a>,
}

/// The body whose vertices are searched.
#[derive(Clone, Copy)]
struct Searched<'a> {
    index: u32,
    body: &'a Body,
    motion: &'a Motion,
    previous: &'a [PersistentContact],
    previous_of_vertex: &'a [u32],
}

impl Search<'_> {
    /// Finds the contacts of all vertices and edges of active bodies.
    pub(super) fn run(&self, all: &mut [BodyRows], edges: &mut EdgeScratch) {
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
            if self.pieces.get(piece).is_near_others {
                for h in surface.topology().outgoing_fan(v) {
                    self.collect_edge(of, h, piece, row);
                }
            }
        }
    }

    /// Adds an edge to those of the row, if it is sharp and near other bodies.
    fn collect_edge(&self, of: Searched<'_>, h: HalfEdge, piece: u32, row: &mut Row) {
        let (surface, motion) = (of.body.surface(), of.motion);
        if surface.topology().twin(h) < h {
            return;
        }
        let ends = [surface.topology().origin(h), surface.topology().target(h)];
        let displacement = ends.map(|v| motion.max_displacement(v));
        let displacement = f64::max(displacement[0], displacement[1]);
        let reach = motion.thickness + self.frame.speed_gain * self.frame.dt + displacement;
        let tight = SharpEdge::bounds(surface, h);
        let is_near = |other: &Piece| {
            let mut bounds = tight;
            grow(&mut bounds, reach + other.max_displacement());
            other.body != of.index && other.bounds.overlaps(&bounds)
        };
        if !self.pieces.neighbors(piece).any(is_near) {
            return;
        }
        if let Some(edge) = SharpEdge::new(surface, h) {
            // Edges of very fast pieces would search whole bodies.
            let reach = reach.min(motion.thickness + edge.length());
            let mut bounds = tight;
            grow(&mut bounds, reach);
            row.edges.push(MovingEdge {
                body: of.index,
                edge,
                reach,
                bounds,
            });
        }
    }

    /// Finds the contacts of all collected edges.
    fn find_edge_contacts(&self, all: &mut [BodyRows], scratch: &mut EdgeScratch) {
        let EdgeScratch { edges, pairs } = scratch;
        edges.clear();
        for of_body in &mut *all {
            of_body.edge_contacts.clear();
            for row in &mut of_body.rows {
                edges.append(&mut row.edges);
            }
        }
        find_edge_pairs(edges, pairs);
        for &(a, b) in &*pairs {
            let [a, b] = [a, b].map(|i| &edges[i as usize]);
            let bodies = [a, b].map(|edge| self.bodies[edge.body as usize].as_ref());
            let [Some(body), Some(other)] = bodies else {
                continue;
            };
            let thickness = [a, b].map(|edge| self.motions[edge.body as usize].thickness);
            let gap = thickness[0].min(thickness[1]);
            if let Some((normal, distance)) = a.edge.distance(&b.edge)
                && distance <= a.reach + b.reach
                && distance >= -MAX_DEPTH * gap
            {
                let ends = [a.edge.ends, b.edge.ends];
                all[a.body as usize].edge_contacts.push(BodyContact {
                    other: b.body,
                    contact: edge_edge(ends, normal, gap, friction(body, other)),
                });
            }
        }
    }

    /// Returns a vertex and its motion within the frame, for searches of triangles.
    fn moving_point(&self, of: Searched<'_>, v: VertexId, piece: u32) -> MovingPoint {
        let gain = self.frame.speed_gain * self.frame.dt;
        MovingPoint {
            position: of.body.surface().position(v),
            displacement: of.motion.displacements[v.index()],
            margin: of.motion.thickness + gain,
            outward: outward_normal(of.body.surface(), v),
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
        let thickness = of.motion.thickness;
        let thickness = thickness.min(self.motions[other as usize].thickness);
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
            let first = previous.map(|contact| contact.triangle);
            self.nearest(
                of,
                (v, point),
                (other, other_body),
                first,
                &mut row.one_ring,
            )
        });
        let Some(contact) = contact else { return };
        // Within a piece at most half of the rest distance, so that a thin fold stays as it is.
        let mut gap = thickness;
        if is_fold(contact.triangle) {
            gap = gap.min(contact.rest_distance(surface) / 2.0);
        }
        row.contacts.push(BodyContact {
            other,
            contact: vertex_face(&contact, gap, friction(of.body, other_body)),
        });
        row.persistent.push(contact);
    }

    /// Finds the nearest triangle of a body within reach of a vertex, other than those around it.
    ///
    /// `first` is the triangle of the previous frame, where the search starts.
    fn nearest(
        &self,
        of: Searched<'_>,
        (v, point): (VertexId, &MovingPoint),
        (other, body): (u32, &Body),
        first: Option<TriangleId>,
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
        let is_candidate = |t| {
            let corners = other_surface.topology().triangle(t);
            one_ring.is_empty() || !corners.iter().any(|c| one_ring.contains(c))
        };
        let excluded_piece = point.excluded_piece.filter(|_| other == of.index);
        let point = MovingPoint {
            excluded_piece,
            ..*point
        };
        let (bvh, bounds) = (body.bvh(), &motion.bounds);
        let found = bvh.nearest_in_reach(other_surface, &point, bounds, first, is_candidate)?;
        // A deeper vertex has passed the triangle, whose plane would hold the two together.
        let thickness = of.motion.thickness.min(motion.thickness);
        let is_shallow = found.distance >= -MAX_DEPTH * thickness;
        if !is_shallow {
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
            contact_kind(other_surface, at, &found, relative)
        };
        let target = (other, other_surface);
        Some(PersistentContact::new(target, (v, at), &found, kind))
    }

    /// Adds the contacts of a vertex with blade faces.
    fn find_blade_face_contacts(&self, of: Searched<'_>, v: VertexId, row: &mut Row) {
        let (frame, thickness) = (self.frame, of.motion.thickness);
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

/// Returns the solver's contact of two edges at a distance \[m\].
#[expect(
    clippy::cast_possible_truncation,
    reason = "the solver stores contacts in 32 bits"
)]
fn edge_edge(ends: [[VertexId; 2]; 2], normal: Vec3, gap: f64, friction: f32) -> Contact {
    let normal = [0, 1, 2].map(|k: usize| normal[k] as f32);
    Contact {
        friction,
        ..Contact::edge_edge(ends, normal, gap as f32)
    }
}

/// Returns the solver's contact at a distance \[m\].
#[expect(
    clippy::cast_possible_truncation,
    reason = "the solver stores contacts in 32 bits"
)]
fn vertex_face(contact: &PersistentContact, gap: f64, friction: f32) -> Contact {
    Contact {
        kind: contact.kind,
        friction,
        ..Contact::vertex_face(contact.vertex, contact.corners, gap as f32)
    }
}

/// Returns whether a triangle belongs to the piece of a vertex of the same body.
fn is_own(surface: &Surface, v: VertexId, t: TriangleId) -> bool {
    surface.piece(surface.topology().outgoing(v).triangle()) == surface.piece(t)
}

/// Returns the friction between two materials: the geometric mean of both.
fn friction(a: &Body, b: &Body) -> f32 {
    let [a, b] = [a, b].map(|body| body.solver().material().friction);
    if a.to_bits() == b.to_bits() {
        a
    } else {
        (a * b).sqrt()
    }
}
