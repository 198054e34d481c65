//! Pairs of sharp edges in contact, and the sides on which they are.
//!
//! [`super::narrow_phase`] collects the edges of each row, then tests the pairs of near ones here.

use super::body_rows::{BodyContact, BodyRows, Row};
use super::broad_phase::{Piece, Pieces};
use super::edges::{EdgeDistance, MovingEdge, SharpEdge};
use super::narrow_phase::{MAX_DEPTH, Search, Searched, friction};
use super::near_bodies::grow;
use incise_mesh::{Aabb, HalfEdge, Surface, Vec3, VertexId, index_u32};
use incise_pbd_gpu::Contact;
use rayon::prelude::*;

/// Minimum number of near pairs for threads, each with half of it.
const MIN_PARALLEL_PAIRS: usize = 512;

/// The pairs of edges in contact, in memory reused between frames.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct EdgePairs {
    #[cfg_attr(feature = "serde", serde(skip))]
    edges: Vec<MovingEdge>,
    /// The boxes of `edges`, ascending by piece and place.
    #[cfg_attr(feature = "serde", serde(skip))]
    boxes: Vec<EdgeBox>,
    /// By index of a piece in the broad phase: its boxes, as a range, and a box around them.
    #[cfg_attr(feature = "serde", serde(skip))]
    of_pieces: Vec<EdgesOfPiece>,
    /// Pairs of indices into `edges`, each in the order of their keys.
    #[cfg_attr(feature = "serde", serde(skip))]
    near: Vec<(u32, u32)>,
    /// By pair: its normal and minimum distance \[m\], if the edges touch.
    #[cfg_attr(feature = "serde", serde(skip))]
    touches: Vec<Option<(Vec3, f64)>>,
    /// The contacts and minimum distances \[m\] of this search.
    #[cfg_attr(feature = "serde", serde(skip))]
    touching: Vec<(EdgePair, f64)>,
    /// By edge: index of the first previous contact that it begins.
    #[cfg_attr(feature = "serde", serde(skip))]
    known: Vec<u32>,
    /// The contacts of the last search, ascending.
    found: Vec<EdgePair>,
    /// The contacts of the previous frame, ascending.
    #[cfg_attr(feature = "serde", serde(skip))]
    previous: Vec<EdgePair>,
}

/// A contact of two edges and its side.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct EdgePair {
    /// Bodies and half-edges.
    pub(super) key: [(u32, HalfEdge); 2],
    pub(super) ends: [[VertexId; 2]; 2],
    /// Unit normal towards the first edge.
    pub(super) normal: Vec3,
}

/// The box of a collected edge.
#[derive(Debug, Clone, Copy)]
struct EdgeBox {
    bounds: Aabb,
    piece: u32,
    /// Index of the edge.
    edge: u32,
}

/// The collected edges of a piece.
#[derive(Debug, Clone, Copy, Default)]
struct EdgesOfPiece {
    /// Index of its first box, and of the first one after them.
    range: (u32, u32),
    /// Box around all of them.
    bounds: Aabb,
}

impl EdgePairs {
    /// Returns whether all normals are finite.
    #[cfg(feature = "serde")]
    pub(super) fn are_finite(&self) -> bool {
        let mut normals = self.found.iter().flat_map(|pair| &pair.normal);
        normals.all(|c| c.is_finite())
    }

    /// Begins a frame: the contacts of the last search become the previous ones.
    pub(super) fn begin_frame(&mut self) {
        std::mem::swap(&mut self.found, &mut self.previous);
        self.found.clear();
    }

    /// Finds the pairs of collected edges that overlap, by sweeps along the longest axis.
    fn find_near(&mut self, pieces: &Pieces, self_collision: bool) {
        let axis = longest_axis(&self.edges);
        self.boxes.clear();
        self.boxes
            .extend((0..).zip(&self.edges).map(|(i, edge)| EdgeBox {
                bounds: edge.bounds,
                piece: edge.piece,
                edge: i,
            }));
        self.boxes.sort_unstable_by(|a, b| {
            let by_place = a.bounds.min[axis].total_cmp(&b.bounds.min[axis]);
            a.piece.cmp(&b.piece).then(by_place)
        });
        self.of_pieces.clear();
        let none = EdgesOfPiece::default();
        self.of_pieces.resize(pieces.iter().len(), none);
        for (i, of_edge) in (0..).zip(&self.boxes) {
            let of_piece = &mut self.of_pieces[of_edge.piece as usize];
            if of_piece.range == none.range {
                of_piece.range.0 = i;
            }
            of_piece.range.1 = i + 1;
            of_piece.bounds = of_piece.bounds.union(of_edge.bounds);
        }
        self.near.clear();
        for piece in 0..index_u32(self.of_pieces.len()) {
            if self_collision {
                self.sweep([piece, piece], axis);
            }
            for other in pieces
                .neighbor_indices(piece)
                .filter(|&other| other > piece)
            {
                self.sweep([piece, other], axis);
            }
        }
    }

    /// Finds the previous contacts of the edges.
    fn find_known(&mut self) {
        let previous = &self.previous;
        let first = |edge: &MovingEdge| previous.partition_point(|pair| pair.key[0] < edge.key());
        self.known.clear();
        self.known
            .extend(self.edges.iter().map(|edge| index_u32(first(edge))));
    }

    /// Returns the normal of the previous contact of two edges, by index, if there was one.
    fn known_normal(&self, (a, b): (u32, u32)) -> Option<Vec3> {
        let [edge, other] = [a, b].map(|i| &self.edges[i as usize]);
        let previous = &self.previous[self.known[a as usize] as usize..];
        let of_edge = previous.iter().take_while(|pair| pair.key[0] == edge.key());
        let ends = [edge.edge.ends, other.edge.ends];
        let mut of_both = of_edge.filter(|pair| pair.key[1] == other.key() && pair.ends == ends);
        of_both.next().map(|pair| pair.normal)
    }

    /// Finds the overlapping pairs of edges of two pieces, or of one.
    fn sweep(&mut self, pieces: [u32; 2], axis: usize) {
        let Self {
            edges, boxes, near, ..
        } = self;
        let [a, b] = pieces.map(|piece| self.of_pieces[piece as usize]);
        if !a.bounds.overlaps(&b.bounds) {
            return;
        }
        let (mut i, mut j) = (a.range.0 as usize, b.range.0 as usize);
        let (end, other_end) = (a.range.1 as usize, b.range.1 as usize);
        let is_one = pieces[0] == pieces[1];
        while i < end && j < other_end {
            let [first, second] = [i, j].map(|i| boxes[i].bounds.min[axis]);
            // The edge that begins first, and the others from their first possible partner on.
            let (swept, others, far) = if is_one || first <= second {
                i += 1;
                j = if is_one { i } else { j };
                (boxes[i - 1], j..other_end, &b.bounds)
            } else {
                j += 1;
                (boxes[j - 1], i..end, &a.bounds)
            };
            if !swept.bounds.overlaps(far) {
                continue;
            }
            for partner in &boxes[others] {
                if partner.bounds.min[axis] > swept.bounds.max[axis] {
                    break;
                }
                if partner.bounds.overlaps(&swept.bounds) {
                    let [one, other] = [swept.edge, partner.edge];
                    let is_first = edges[one as usize].key() < edges[other as usize].key();
                    near.push(if is_first { (one, other) } else { (other, one) });
                }
            }
        }
    }
}

/// Returns the axis along which the first ends of edges vary most.
fn longest_axis(edges: &[MovingEdge]) -> usize {
    let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for edge in edges {
        for k in 0..3 {
            min[k] = min[k].min(edge.bounds.min[k]);
            max[k] = max[k].max(edge.bounds.min[k]);
        }
    }
    let extent = |k: usize| max[k] - min[k];
    let longer = |a: usize, b: usize| if extent(b) > extent(a) { b } else { a };
    longer(longer(0, 1), 2)
}

impl Search<'_> {
    /// Adds an edge to those of the row, if it is sharp and near other pieces.
    pub(super) fn collect_edge(&self, of: Searched<'_>, h: HalfEdge, piece: u32, row: &mut Row) {
        let (surface, motion) = (of.body.surface(), of.motion);
        let Some(edge) = SharpEdge::new(surface, h) else {
            return;
        };
        let displacement = edge.ends.map(|v| motion.max_displacement(v));
        let displacement = f64::max(displacement[0], displacement[1]);
        let thickness = motion.thickness(surface, h.triangle());
        let reach = thickness + self.frame.speed_gain * self.frame.dt + displacement;
        let tight = SharpEdge::bounds(surface, h);
        let is_near = |other: &Piece| {
            let mut bounds = tight;
            grow(&mut bounds, reach + other.max_displacement);
            other.bounds.overlaps(&bounds)
        };
        if self.frame.params.self_collision || self.pieces.neighbors(piece).any(is_near) {
            // Edges of very fast pieces would search whole bodies.
            let reach = reach.min(thickness + edge.length());
            let mut bounds = tight;
            grow(&mut bounds, reach);
            row.edges.push(MovingEdge {
                body: of.index,
                piece,
                edge,
                thickness,
                reach,
                bounds,
            });
        }
    }

    /// Finds the contacts of all collected edges.
    pub(super) fn find_edge_contacts(&self, all: &mut [BodyRows], pairs: &mut EdgePairs) {
        pairs.edges.clear();
        for of_body in &mut *all {
            of_body.edge_contacts.clear();
            for row in &mut of_body.rows {
                pairs.edges.append(&mut row.edges);
            }
        }
        pairs.find_near(self.pieces, self.frame.params.self_collision);
        pairs.find_known();
        let mut touches = std::mem::take(&mut pairs.touches);
        touches.clear();
        touches.resize(pairs.near.len(), None);
        let find = |(touch, &(i, j)): (&mut Option<_>, &(u32, u32))| {
            let [a, b] = [i, j].map(|i| &pairs.edges[i as usize]);
            *touch = self.touch(a, b, pairs.known_normal((i, j)));
        };
        if touches.len() < MIN_PARALLEL_PAIRS {
            touches.iter_mut().zip(&pairs.near).for_each(find);
        } else {
            let all = touches.par_iter_mut().zip(&pairs.near);
            all.with_min_len(MIN_PARALLEL_PAIRS / 2).for_each(find);
        }
        pairs.touching.clear();
        for (&(i, j), touch) in pairs.near.iter().zip(&touches) {
            if let Some((normal, gap)) = *touch {
                let [a, b] = [i, j].map(|i| &pairs.edges[i as usize]);
                let (key, ends) = ([a.key(), b.key()], [a.edge.ends, b.edge.ends]);
                let pair = EdgePair { key, ends, normal };
                pairs.touching.push((pair, gap));
            }
        }
        pairs.touches = touches;
        pairs.touching.sort_unstable_by_key(|(pair, _)| pair.key);
        pairs.found.clear();
        for &(pair, gap) in &pairs.touching {
            let [body, other] = pair.key.map(|(body, _)| body);
            let bodies = [body, other].map(|i| self.bodies[i as usize].as_ref());
            if let [Some(of_first), Some(of_second)] = bodies {
                pairs.found.push(pair);
                all[body as usize].edge_contacts.push(BodyContact {
                    other,
                    contact: edge_edge(pair.ends, pair.normal, gap, friction(of_first, of_second)),
                });
            }
        }
    }

    /// Returns the normal and the minimum distance \[m\] of two edges that may touch.
    ///
    /// A pair keeps the side of its previous normal. Edges of one body start on each other at a
    /// cut: a new pair of them touches once it has been apart.
    fn touch(&self, a: &MovingEdge, b: &MovingEdge, known: Option<Vec3>) -> Option<(Vec3, f64)> {
        // Edges that do not cross may slide over each other within the frame.
        let slide = (a.reach - a.thickness) + (b.reach - b.thickness);
        let found = a.edge.distance(&b.edge, known, slide)?;
        let gap = a.thickness.min(b.thickness);
        let is_within = found.distance <= a.reach + b.reach && found.distance >= -MAX_DEPTH * gap;
        let is_new = known.is_none() && a.body == b.body;
        let is_deep = found.distance < 0.0 && !found.is_crossing;
        if !is_within || is_deep || is_new && found.distance < gap {
            return None;
        }
        // Vertices alone keep a thin fold as it is.
        let is_fold = a.piece == b.piece;
        if is_fold && self.rest_distance(a, b, &found)? < 2.0 * gap {
            return None;
        }
        Some((found.normal, gap))
    }

    /// Returns the rest distance between the contact points of edges of one piece \[m\].
    ///
    /// `None` if they share an end.
    fn rest_distance(&self, a: &MovingEdge, b: &MovingEdge, at: &EdgeDistance) -> Option<f64> {
        if a.edge.ends.iter().any(|v| b.edge.ends.contains(v)) {
            return None;
        }
        let surface = self.bodies[a.body as usize].as_ref()?.surface();
        let [p, q] = [(a, at.fractions[0]), (b, at.fractions[1])]
            .map(|(edge, fraction)| rest_point(surface, &edge.edge, fraction));
        Some((p - q).norm())
    }
}

/// Returns the point at a fraction of an edge at rest.
fn rest_point(surface: &Surface, edge: &SharpEdge, fraction: f64) -> Vec3 {
    let [start, end] = edge.ends.map(|v| surface.rest_position(v));
    start + (end - start) * fraction
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
