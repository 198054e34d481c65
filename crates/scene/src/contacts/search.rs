//! The search for what vertices touch, by all threads: each takes vertices in a row, and rows are put together in order.

use super::pieces::{Piece, Pieces};
use super::touch::{Touch, faces, outward, plane_of};
use super::{AGAIN, APART, Flat, Reach, SAFETY, Velocities, narrow};
use incise_cut::{Bvh, NodeReaches};
use incise_mesh::geometry::widen;
use incise_mesh::{Surface, TriangleId, Vec3, VertexId};
use incise_pbd_gpu::Contact;
use rayon::prelude::*;

/// So many vertex slots are one row.
const ROW: usize = 512;

/// Fewer rows than that are no work for two: threads take some ten microseconds to wake.
const SPREAD_FROM: usize = 4;

/// What one row found, kept from frame to frame for its room.
#[derive(Debug, Clone, Default)]
pub(super) struct Row {
    pub(super) contacts: Vec<Contact>,
    pub(super) found: Vec<Touch>,
    /// The vertex at hand and its neighbors, with whose triangles it does not touch.
    ring: Vec<VertexId>,
}

/// What is searched, the same for all rows.
pub(super) struct Search<'a> {
    pub(super) surface: &'a Surface,
    pub(super) velocities: Velocities<'a>,
    pub(super) bvh: &'a Bvh,
    pub(super) reaches: &'a NodeReaches,
    pub(super) pieces: &'a Pieces,
    /// How far each vertex may move \[m\].
    pub(super) ways: &'a [f64],
    /// What was found in the frame before, and by vertex its place there.
    pub(super) before: &'a [Touch],
    pub(super) known: &'a [u32],
    /// \[m\]
    pub(super) thickness: f64,
    pub(super) reach: &'a Reach<'a>,
}

impl Search<'_> {
    /// Searches for all vertices.
    pub(super) fn run(&self, rows: &mut Vec<Row>) {
        let slots = self.surface.positions.len();
        rows.resize_with(slots.div_ceil(ROW), Row::default);
        if rows.len() < SPREAD_FROM {
            rows.iter_mut()
                .enumerate()
                .for_each(|(i, row)| self.fill(i, row));
        } else {
            rows.par_iter_mut()
                .enumerate()
                .for_each(|(i, row)| self.fill(i, row));
        }
    }

    fn fill(&self, i: usize, row: &mut Row) {
        row.contacts.clear();
        row.found.clear();
        let slots = self.surface.positions.len();
        for slot in i * ROW..slots.min((i + 1) * ROW) {
            let v = VertexId(narrow(slot));
            if !self.surface.topology().outgoing(v).is_null() {
                self.touch_pieces(v, row);
                self.touch_flats(v, row);
            }
        }
    }

    /// Finds the triangle that a vertex touches, if any.
    fn touch_pieces(&self, v: VertexId, row: &mut Row) {
        let (surface, reach) = (self.surface, self.reach);
        if !(reach.params.own || self.pieces.meet()) {
            return;
        }
        let own = reach.params.own;
        let number = surface.piece(surface.topology().outgoing(v).triangle());
        let place = self.pieces.place(number);
        let at = surface.position(v);
        let within = self.thickness + reach.gained * reach.dt + self.ways[v.index()];
        let comes = |other: &Piece| other.is_near(at, within + other.way);
        if !own && !self.pieces.others(place).any(comes) {
            return;
        }
        let before = self.before.get(self.known[v.index()] as usize).copied();
        let kept = before.filter(|touch| touch.holds(surface, at, (self.thickness, own)));
        let touch = kept.or_else(|| {
            let first = before.map(|touch| touch.triangle);
            self.nearest(v, (number, within), first, &mut row.ring)
        });
        if let Some(mut touch) = touch {
            let thickness = touch.thickness(surface, self.thickness);
            // Who cannot follow is not pushed the harder for it.
            let near = touch.height(surface, at) + AGAIN * thickness;
            touch.goal = touch.goal.min(near).min(thickness);
            let rise = APART * (thickness - touch.goal).min(2.0 * thickness);
            row.contacts.push(touch.contact(rise));
            touch.goal += rise * reach.dt;
            row.found.push(touch);
        }
    }

    fn nearest(
        &self,
        v: VertexId,
        (number, within): (u32, f64),
        first: Option<TriangleId>,
        ring: &mut Vec<VertexId>,
    ) -> Option<Touch> {
        let (surface, own) = (self.surface, self.reach.params.own);
        let topology = surface.topology();
        let at = surface.position(v);
        ring.clear();
        if own {
            ring.push(v);
            for h in topology.outgoing_fan(v) {
                ring.extend([topology.target(h), topology.origin(h.prev())]);
            }
        }
        let outward = outward(surface, v);
        let faces = |t| faces(surface, outward, t);
        let is_fold = |t| own && faces(t) && !topology.triangle(t).iter().any(|c| ring.contains(c));
        let is_other = |t| surface.piece(t) != number;
        let facing = |t| is_other(t) && faces(t) || is_fold(t);
        let search = (self.reaches, (!own).then_some(number));
        let mut found =
            (self.bvh).nearest_in_reach(surface, (at, within), search, first, facing)?;
        if found.distance < 0.0 {
            // Inside of what faces it, or outside of what does not: a collapsed skin comes from behind.
            let all = |t| is_other(t) || is_fold(t);
            let (deep, first) = (-found.distance, Some(found.triangle));
            let any = (self.bvh).nearest_in_reach(surface, (at, deep), search, first, all);
            found = any.filter(|any| any.distance > 0.0).unwrap_or(found);
        }
        // How fast the vertex is as seen from where it is nearest.
        let corners = topology.triangle(found.triangle).into_iter();
        let weighted = corners.zip(found.weights);
        let of_point: Vec3 = weighted.map(|(c, w)| self.velocities.of(c) * w).sum();
        let moves = (self.velocities.of(v) - of_point) * self.reach.dt;
        let plane = plane_of(surface, at, &found, moves);
        Some(Touch::new(surface, (v, at), &found, plane))
    }

    /// Finds the flats of blades that a vertex touches.
    fn touch_flats(&self, v: VertexId, row: &mut Row) {
        let reach = self.reach;
        let touches = |flat: &Flat| {
            let speed = self.velocities.of(v).norm();
            let way = self.thickness + (SAFETY * speed + reach.gained) * reach.dt;
            flat.contact((self.surface, v), way, self.thickness, reach.dt)
        };
        row.contacts.extend(reach.flats.iter().filter_map(touches));
    }
}

impl Velocities<'_> {
    /// How fast a vertex is, or has to be to get where it is pinned [m/s].
    pub(super) fn of(&self, v: VertexId) -> Vec3 {
        let [x, y, z, _] = self.all[v.index()];
        widen([x, y, z])
    }
}
