//! [`Carriers`]: finds the piece that supports another one, as in shock propagation.
//!
//! Called by [`super::ContactDetection`] after the narrow phase. The level of a piece is its
//! distance from a plane below in the graph of contacts (Guendelman, Bridson and Fedkiw 2003,
//! "Nonconvex rigid bodies with stacking"). In a contact the piece of the lower level carries the
//! other one. Only contacts in columns of at least three pieces are marked, and only while one of
//! the two pieces falls. The solver handles other loads without marks, except for those of sheets:
//! they have no volume that keeps them apart.

use super::body_rows::{BodyContact, BodyRows};
use super::narrow_phase::Search;
use super::overlaps::PieceId;
use incise_mesh::geometry::to_f64;
use incise_mesh::{Vec3, VertexId};
use incise_pbd_gpu::{ContactKind, SupportedSide};
use std::cmp::Ordering;

/// Level of a piece without a path of contacts to a plane.
const NO_LEVEL: u32 = u32::MAX;

/// Minimum cosine of the slope of a plane that carries pieces: 60 degrees.
///
/// On a steeper plane pieces slide with any friction below tan(60 degrees) = 1.7.
const MIN_SLOPE_COSINE: f64 = 0.5;

/// Minimum speed of a piece that falls [speeds gained by gravity in a frame].
const MIN_FALL: f64 = 2.0;

/// Levels of pieces, in memory reused between frames.
#[derive(Debug, Clone, Default)]
pub(super) struct Carriers {
    /// By index of a piece in the broad phase.
    levels: Vec<u32>,
    /// Whether a piece carries another one, by the same index.
    carries: Vec<bool>,
    /// Pairs of pieces in contact, in both orders, ascending.
    pairs: Vec<[u32; 2]>,
    /// Pieces with a level, in breadth-first order.
    queue: Vec<u32>,
}

impl Carriers {
    /// Sets [`incise_pbd_gpu::Contact::carried`] of the contacts.
    pub(super) fn mark(&mut self, search: Search<'_>, rows: &mut [BodyRows]) {
        let Some(down) = search.frame.gravity.try_normalize(0.0) else {
            return;
        };
        self.find_levels(search, down, rows);
        for (i, rows) in rows.iter_mut().enumerate() {
            for found in rows.contacts_mut() {
                let Some(pair) = search.pieces_of(i, found) else {
                    continue;
                };
                let speed = pair.map(|piece| search.pieces.mean_velocity(piece).dot(&down));
                if pair.iter().any(|&piece| search.is_sheet(piece)) {
                    found.contact.carried = SupportedSide::Upper;
                } else if f64::max(speed[0], speed[1]) > MIN_FALL * search.frame.speed_gain {
                    found.contact.carried = self.carried(pair);
                }
            }
        }
    }

    /// Returns which of two pieces in contact is carried in a column.
    fn carried(&self, pair: [u32; 2]) -> SupportedSide {
        let [first, second] = pair.map(|piece| self.levels[piece as usize]);
        let (carried, upper) = match first.cmp(&second) {
            Ordering::Less => (SupportedSide::Second, pair[1]),
            Ordering::Equal => return SupportedSide::Neither,
            Ordering::Greater => (SupportedSide::First, pair[0]),
        };
        let is_in_column = first.max(second) > 1 || self.carries[upper as usize];
        if is_in_column {
            carried
        } else {
            SupportedSide::Neither
        }
    }

    /// Finds the levels of all pieces, breadth first.
    fn find_levels(&mut self, search: Search<'_>, down: Vec3, rows: &[BodyRows]) {
        self.levels.clear();
        self.queue.clear();
        for (piece, is_low) in (0..).zip(reach_planes(search, down)) {
            self.levels.push(if is_low { 0 } else { NO_LEVEL });
            self.queue.extend(is_low.then_some(piece));
        }
        self.carries.clear();
        self.carries.resize(self.levels.len(), false);
        if self.queue.is_empty() {
            return;
        }
        self.pairs.clear();
        for (i, rows) in rows.iter().enumerate() {
            for [a, b] in (rows.contacts()).filter_map(|found| search.pieces_of(i, found)) {
                if a != b && self.pairs.last() != Some(&[b, a]) {
                    self.pairs.extend([[a, b], [b, a]]);
                }
            }
        }
        self.pairs.sort_unstable();
        self.pairs.dedup();
        let mut next = 0;
        while let Some(&piece) = self.queue.get(next) {
            next += 1;
            let level = self.levels[piece as usize] + 1;
            let first = self.pairs.partition_point(|pair| pair[0] < piece);
            let pairs = self.pairs[first..].iter();
            for &[_, other] in pairs.take_while(|pair| pair[0] == piece) {
                if self.levels[other as usize] == NO_LEVEL {
                    self.levels[other as usize] = level;
                    self.queue.push(other);
                }
                self.carries[piece as usize] |= self.levels[other as usize] == level;
            }
        }
    }
}

impl Search<'_> {
    /// Returns whether a piece, by index in the broad phase, is a sheet.
    fn is_sheet(&self, piece: u32) -> bool {
        let PieceId { body, number } = self.pieces.get(piece).id();
        let body = self.bodies[body as usize].as_ref();
        body.is_some_and(|body| body.piece_shapes().get(number).is_sheet)
    }

    /// Returns the pieces of both features of a contact, by index in the broad phase.
    ///
    /// A plane has none.
    fn pieces_of(&self, body: usize, found: &BodyContact) -> Option<[u32; 2]> {
        let contact = &found.contact;
        let second = match contact.kind {
            ContactKind::Plane => return None,
            ContactKind::EdgeEdge => 2,
            ContactKind::VertexFace | ContactKind::VertexPoint => 1,
        };
        let of = |body: usize, v: VertexId| {
            let surface = self.bodies.get(body)?.as_ref()?.surface();
            let number = surface.piece(surface.topology().outgoing(v).triangle());
            self.motions[body].pieces.get(number as usize).copied()
        };
        let first = of(body, contact.vertices[0])?;
        Some([first, of(found.other as usize, contact.vertices[second])?])
    }
}

/// Returns for each piece whether it may touch a plane that faces up within the frame.
fn reach_planes(search: Search<'_>, down: Vec3) -> impl Iterator<Item = bool> + use<'_> {
    search.pieces.iter().map(move |piece| {
        let thickness = search.motions[piece.body as usize].thickness;
        let corners = [piece.bounds.min, piece.bounds.max].map(to_f64);
        (search.frame.planes()).any(|(point, normal)| {
            let least = |[min, max]: [Vec3; 2]| {
                let terms = min.zip_zip_map(&max, &normal, |a, b, n| f64::min(a * n, b * n));
                terms.sum()
            };
            let fall = least(piece.velocity_bounds).min(0.0) * search.frame.dt;
            normal.dot(&down) <= -MIN_SLOPE_COSINE
                && least(corners) + fall - thickness <= normal.dot(&point)
        })
    })
}
