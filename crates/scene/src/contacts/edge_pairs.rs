//! Pairs of sharp edges in contact, and the sides on which they are.
//!
//! [`super::narrow_phase`] collects the edges of each row, then tests the pairs of near ones here.

use super::body_rows::{BodyContact, BodyRows, Row};
use super::broad_phase::Piece;
use super::edges::{EdgeDistance, MovingEdge, SharpEdge};
use super::narrow_phase::{MAX_DEPTH, Search, Searched, friction};
use super::near_bodies::grow;
use incise_mesh::{HalfEdge, Surface, Vec3, VertexId};
use incise_pbd_gpu::Contact;

/// The pairs of edges in contact, in memory reused between frames.
#[derive(Debug, Clone, Default)]
pub(super) struct EdgePairs {
    edges: Vec<MovingEdge>,
    /// Pairs of indices into `edges`.
    near: Vec<(u32, u32)>,
    /// The contacts of the last search, ascending.
    found: Vec<EdgePair>,
    /// The contacts of the previous frame, ascending.
    previous: Vec<EdgePair>,
}

/// A contact of two edges and its side.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgePair {
    /// Bodies and half-edges.
    pub(super) key: [(u32, HalfEdge); 2],
    pub(super) ends: [[VertexId; 2]; 2],
    /// Unit normal towards the first edge.
    pub(super) normal: Vec3,
}

impl EdgePairs {
    /// Returns the contacts of the last search.
    #[cfg(feature = "serde")]
    pub(super) fn found(&self) -> &[EdgePair] {
        &self.found
    }

    /// Sets the contacts of the last search.
    #[cfg(feature = "serde")]
    pub(super) fn set_found(&mut self, found: Vec<EdgePair>) {
        self.found = found;
    }

    /// Begins a frame: the contacts of the last search become the previous ones.
    pub(super) fn begin_frame(&mut self) {
        std::mem::swap(&mut self.found, &mut self.previous);
        self.found.clear();
    }

    /// Finds the pairs of collected edges that overlap, by a sweep along the longest axis.
    ///
    /// Sorts the edges. Pairs ascend by key, and so do the edges of each.
    fn find_near(&mut self, self_collision: bool) {
        let Self { edges, near, .. } = self;
        let axis = longest_axis(edges);
        let min = |edge: &MovingEdge| edge.bounds.min[axis];
        edges.sort_unstable_by(|a, b| min(a).total_cmp(&min(b)).then(a.key().cmp(&b.key())));
        near.clear();
        for (i, a) in (0..).zip(&*edges) {
            let later = (i + 1..).zip(&edges[i as usize + 1..]);
            for (j, b) in later.take_while(|(_, b)| min(b) <= a.bounds.max[axis]) {
                let may_touch = self_collision || a.piece != b.piece;
                if may_touch && a.bounds.overlaps(&b.bounds) {
                    near.push(if a.key() < b.key() { (i, j) } else { (j, i) });
                }
            }
        }
        let keys = |&(i, j): &(u32, u32)| (edges[i as usize].key(), edges[j as usize].key());
        near.sort_unstable_by_key(keys);
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
        if surface.topology().twin(h) < h {
            return;
        }
        let ends = [surface.topology().origin(h), surface.topology().target(h)];
        let displacement = ends.map(|v| motion.max_displacement(v));
        let displacement = f64::max(displacement[0], displacement[1]);
        let thickness = motion.thickness(surface, h.triangle());
        let reach = thickness + self.frame.speed_gain * self.frame.dt + displacement;
        let tight = SharpEdge::bounds(surface, h);
        let is_near = |other: &Piece| {
            let mut bounds = tight;
            grow(&mut bounds, reach + other.max_displacement());
            other.bounds.overlaps(&bounds)
        };
        if !self.frame.params.self_collision && !self.pieces.neighbors(piece).any(is_near) {
            return;
        }
        if let Some(edge) = SharpEdge::new(surface, h) {
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
        pairs.find_near(self.frame.params.self_collision);
        pairs.found.clear();
        let mut previous = pairs.previous.iter().peekable();
        for &(a, b) in &pairs.near {
            let [a, b] = [a, b].map(|i| &pairs.edges[i as usize]);
            let (key, ends) = ([a.key(), b.key()], [a.edge.ends, b.edge.ends]);
            while previous.next_if(|pair| pair.key < key).is_some() {}
            let known = previous.peek().filter(|p| p.key == key && p.ends == ends);
            let Some((normal, gap)) = self.touch(a, b, known.map(|pair| pair.normal)) else {
                continue;
            };
            let bodies = [a, b].map(|edge| self.bodies[edge.body as usize].as_ref());
            if let [Some(body), Some(other)] = bodies {
                pairs.found.push(EdgePair { key, ends, normal });
                all[a.body as usize].edge_contacts.push(BodyContact {
                    other: b.body,
                    contact: edge_edge(ends, normal, gap, friction(body, other)),
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
