//! Chains: the parts of sweep edges inside the body.
//!
//! Along a sweep edge the body is entered and left where curves meet the edge. Between, a chain of
//! nodes runs through the inside. On an edge between two facets it is a common side of their
//! sections. On the sweep's boundary it is the tip of an incision, at which both walls join.
//!
//! How often an edge is inside is counted for each solid, a piece with its cavities, so that
//! overlapping bodies have chains of their own. Where a body that intersects itself is inside out,
//! the count is negative and the chain is inverted.

use super::open::Sides;
use super::rest::RestMap;
use super::rim::{NO_NODE, Rim};
use crate::blade_position::blade_starts_inside;
use crate::interpolate::add_vertex;
use crate::intersection::facets::{EdgeKind, Facets};
use crate::intersection::node::{Node, On};
use crate::sweep::Sweep;
use incise_mesh::geometry::{round_to_f32, to_f32};
use incise_mesh::{Edit, Vec3, VertexId, VertexOrigin, index_u32};
use incise_refine::RefineParams;
use std::ops::Range;

/// The part of a sweep edge inside one solid.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    pub(super) edge: u32,
    /// Range of its nodes in [`Chains::nodes`], in the direction of the edge.
    pub(super) nodes: Range<usize>,
    /// Whether it is on the sweep's boundary.
    pub(super) is_tip: bool,
    /// Whether the body is inside out there.
    pub(super) is_inverted: bool,
}

/// A point where a curve meets a sweep edge.
#[derive(Debug, Clone, Copy)]
struct Piercing {
    edge: u32,
    /// The solid: the piece, or the one around it if this is the wall of a cavity.
    solid: u32,
    node: u32,
    corners: [Vec3; 3],
    /// Whether the edge enters the body here.
    enters: bool,
}

/// An end of a chain: a node of a curve, or a corner of the sweep inside the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ChainEnd {
    Node(u32),
    /// The corner, and how many parts of the solid contain it up to this one.
    Corner {
        corner: u32,
        level: u32,
    },
}

/// The ends of a chain in the direction of its edge.
#[derive(Debug, Clone, Copy)]
struct Ends {
    edge: u32,
    ends: [ChainEnd; 2],
    is_inverted: bool,
}

/// A corner of the sweep on the tip that it continues.
#[derive(Debug, Clone, Copy)]
struct TipCorner {
    corner: u32,
    node: u32,
    solid: u32,
    /// Whether the edges that begin here are inside the body at first: the diagonal, the rib, and
    /// the previous edge beyond the end of the tip.
    diagonal: bool,
    rib: bool,
    beyond: bool,
}

/// The chains of a cut, with scratch memory.
#[derive(Debug, Clone, Default)]
pub(crate) struct Chains {
    pub(super) chains: Vec<Chain>,
    /// The nodes of all chains. Numbers beyond the trace's nodes are nodes inside the body.
    pub(super) nodes: Vec<u32>,
    /// Each node with the edges of its chains, sorted.
    edges: Vec<(u32, u32)>,
    /// Positions \[m\] and target edge lengths \[m\] of the nodes inside the body.
    pub(super) positions: Vec<Vec3>,
    pub(super) lengths: Vec<f64>,
    piercings: Vec<Piercing>,
    tips: Vec<TipCorner>,
    windings: Vec<i32>,
    ends: Vec<Ends>,
    /// Nodes of corners inside the body, by corner and level.
    corners: Vec<(u32, u32, u32)>,
}

/// The input of [`Chains::find`].
pub(super) struct Opening<'a> {
    pub(super) sweep: &'a Sweep,
    pub(super) facets: &'a Facets,
    pub(super) nodes: &'a [Node],
    pub(super) rim: &'a Rim,
    pub(super) refine: &'a RefineParams,
    /// Target edge length at each node \[m\].
    pub(super) lengths: &'a [f64],
}

impl Chains {
    /// Finds the chains and adds their vertices: two for a node between facets, one at a tip.
    pub(super) fn find(&mut self, edit: &mut Edit<'_>, at: &Opening<'_>, sides: &mut Sides) {
        self.chains.clear();
        self.nodes.clear();
        self.positions.clear();
        self.lengths.clear();
        self.find_piercings(edit, at, sides);
        self.find_tips(edit, at, sides);
        let solids = self.piercings.iter().map(|p| p.solid);
        let mut solids: Vec<u32> = solids
            .chain(self.tips.iter().map(|tip| tip.solid))
            .collect();
        solids.sort_unstable();
        solids.dedup();
        for solid in solids {
            let from = self.piercings.partition_point(|p| p.solid < solid);
            let to = self.piercings.partition_point(|p| p.solid <= solid);
            let starts_inside = || blade_starts_inside(edit.surface(), at.sweep);
            self.count_windings(at.facets, from..to, solid, starts_inside);
            self.find_ends(at.facets, from..to, solid);
            self.add_chains(edit, at, sides, from..to, solid);
        }
        self.edges.clear();
        for chain in &self.chains {
            let own = self.nodes[chain.nodes.clone()].iter();
            self.edges.extend(own.map(|&node| (node, chain.edge)));
        }
        self.edges.sort_unstable();
    }

    /// Returns whether two nodes are on chains of one sweep edge.
    pub(super) fn are_on_one_edge(&self, a: u32, b: u32) -> bool {
        let edges = |node: u32| {
            let from = self.edges.partition_point(|&(n, _)| n < node);
            let own = self.edges[from..]
                .iter()
                .take_while(move |&&(n, _)| n == node);
            own.map(|&(_, edge)| edge)
        };
        edges(a).any(|edge| edges(b).any(|other| edge == other))
    }

    /// Collects the vertices of the tip that the sweep continues.
    fn find_tips(&mut self, edit: &Edit<'_>, at: &Opening<'_>, sides: &Sides) {
        self.tips.clear();
        let weld = at.facets.weld();
        for (corner, &vertex) in (0..).zip(&weld.vertices) {
            let is_own = |node: &Node| node.on == On::Tip(vertex);
            let Some(node) = at.nodes.iter().position(is_own).map(index_u32) else {
                continue;
            };
            let is_joined = |i: Option<u32>| {
                let along = i.and_then(|i| weld.half_edges.get(i as usize));
                along.is_some_and(|h| !h.is_null())
            };
            let (prev, next) = (at.rim.prev[node as usize], at.rim.next[node as usize]);
            let facet = |node: u32| at.nodes[node as usize].facet;
            // The facets around the corner that are inside the body, from the tip on: all, unless
            // the curve leaves the tip there.
            let (quad, inside) = (2 * corner, u32::MAX);
            let [diagonal, rib, beyond] =
                if is_joined(Some(corner)) && is_joined(corner.checked_sub(1)) {
                    [true; 3]
                } else if is_joined(Some(corner)) {
                    let from = if prev == NO_NODE { inside } else { facet(prev) };
                    [
                        from != quad,
                        from != quad && from != quad + 1,
                        from == inside,
                    ]
                } else {
                    let to = if next == NO_NODE { inside } else { facet(node) };
                    let is_before = quad.checked_sub(2) == Some(to);
                    [to == quad || to == inside, !is_before, to == inside]
                };
            let along = if prev == NO_NODE || at.rim.next[node as usize] != NO_NODE {
                node
            } else {
                prev
            };
            let triangle = sides.rim[along as usize][0].triangle();
            self.tips.push(TipCorner {
                corner,
                node,
                solid: edit.surface().piece(triangle),
                diagonal,
                rib,
                beyond,
            });
        }
    }

    /// Collects the piercings, sorted by solid, by edge and along the edge.
    fn find_piercings(&mut self, edit: &Edit<'_>, at: &Opening<'_>, sides: &Sides) {
        self.piercings.clear();
        let surface = edit.surface();
        for curve in 0..at.rim.sizes.len() {
            for node in at.rim.ring(curve) {
                let On::Face { edge, corners, .. } = at.nodes[node as usize].on else {
                    continue;
                };
                if at.nodes[node as usize].sweep_edge().is_none() {
                    continue;
                }
                let [left, right] = at.facets.edges()[edge as usize].facets;
                let before = at.rim.prev[node as usize];
                // The inside of the body is on the curve's left. So it lies ahead on the boundary
                // of a facet that the curve leaves, and behind on one that it enters.
                let (enters, along) = if before == NO_NODE {
                    (at.nodes[node as usize].facet == right, node)
                } else {
                    (at.nodes[before as usize].facet == left, before)
                };
                let triangle = sides.rim[along as usize][0].triangle();
                self.piercings.push(Piercing {
                    edge,
                    solid: surface.piece(triangle),
                    node,
                    corners: corners.map(|v| surface.position(v)),
                    enters,
                });
            }
        }
        let facets = at.facets;
        self.piercings.sort_by(|a, b| {
            (a.edge.cmp(&b.edge))
                .then_with(|| facets.compare_on_sweep_edge(a.edge, a.corners, b.corners))
                .then(a.enters.cmp(&b.enters))
        });
        let first = self.piercings.first().map(|p| p.solid);
        if self.piercings.iter().any(|p| Some(p.solid) != first) {
            self.assign_cavities(&surface.piece_volumes());
        }
        self.piercings.sort_by_key(|p| p.solid);
    }

    /// Assigns cavities to the solids in which they are, given the signed volume of each piece.
    ///
    /// A cavity is in the solid that an edge has entered last where it first meets the cavity.
    fn assign_cavities(&mut self, volumes: &[f64]) {
        let is_cavity = |piece: u32| volumes[piece as usize] < 0.0;
        let default = (self.piercings.iter())
            .map(|p| p.solid)
            .find(|&piece| !is_cavity(piece));
        let mut around: Vec<(u32, u32)> = Vec::new();
        for own in self.piercings.chunk_by(|a, b| a.edge == b.edge) {
            let mut entered = Vec::new();
            for p in own {
                if !is_cavity(p.solid) {
                    if p.enters {
                        entered.push(p.solid);
                    } else if let Some(i) = entered.iter().rposition(|&solid| solid == p.solid) {
                        entered.remove(i);
                    }
                } else if let Some(&solid) = entered.last()
                    && around.iter().all(|&(cavity, _)| cavity != p.solid)
                {
                    around.push((p.solid, solid));
                }
            }
        }
        for p in self.piercings.iter_mut().filter(|p| is_cavity(p.solid)) {
            let known = around.iter().find(|&&(cavity, _)| cavity == p.solid);
            p.solid = known
                .map(|&(_, solid)| solid)
                .or(default)
                .unwrap_or(p.solid);
        }
    }

    /// Returns the tip at an end of a sweep edge and whether the edge is inside the body there.
    fn tip_at(&self, facets: &Facets, edge: u32, end: usize, solid: u32) -> Option<(u32, bool)> {
        let corner = facets.edges()[edge as usize].ends[end];
        let is_own = |tip: &&TipCorner| tip.corner == corner && tip.solid == solid;
        let tip = self.tips.iter().find(is_own)?;
        let is_inside = match facets.kind(edge) {
            EdgeKind::Rib => tip.rib,
            EdgeKind::Diagonal => tip.diagonal,
            _ => tip.beyond,
        };
        Some((tip.node, is_inside))
    }

    /// Counts how often each corner of the sweep that is on no tip is inside the solid.
    ///
    /// `starts_inside` returns whether the sweep's first corner is inside the body. It is called if
    /// the sweep's boundary is less inside elsewhere.
    fn count_windings(
        &mut self,
        facets: &Facets,
        own: Range<usize>,
        solid: u32,
        starts_inside: impl FnOnce() -> bool,
    ) {
        const UNKNOWN: i32 = i32::MIN;
        let mut windings = std::mem::take(&mut self.windings);
        windings.clear();
        windings.resize(facets.corner_count(), UNKNOWN);
        let piercings = &self.piercings[own];
        let on_edge = |edge: u32| {
            let from = piercings.partition_point(|p| p.edge < edge);
            piercings[from..].iter().take_while(move |p| p.edge == edge)
        };
        let step = |p: &Piercing| if p.enters { 1 } else { -1 };
        let edges = || (0..index_u32(facets.edges().len())).filter(|&e| facets.may_have_chain(e));
        let ends = |edge: u32, windings: &[i32]| {
            [0, 1].map(|end| match self.tip_at(facets, edge, end, solid) {
                Some((_, is_inside)) => i32::from(is_inside),
                None => windings[facets.edges()[edge as usize].ends[end] as usize],
            })
        };
        let has_tip = self.tips.iter().any(|tip| tip.solid == solid);
        if !has_tip && let Some(first) = edges().next() {
            windings[facets.edges()[first as usize].ends[0] as usize] = 0;
        }
        let mut is_done = false;
        while !is_done {
            is_done = true;
            for edge in edges() {
                let [a, b] = facets.edges()[edge as usize].ends.map(|c| c as usize);
                let sum: i32 = on_edge(edge).map(step).sum();
                match ends(edge, &windings) {
                    [UNKNOWN, UNKNOWN] => {}
                    [known, UNKNOWN] => (windings[b], is_done) = (known + sum, false),
                    [UNKNOWN, known] => (windings[a], is_done) = (known - sum, false),
                    _ => {}
                }
            }
        }
        // Without a tip, all is relative to the first corner, which is mostly outside.
        let mut least = 0;
        let is_boundary = |edge: &u32| !facets.edges()[*edge as usize].is_crease();
        for edge in edges().filter(|edge| !has_tip && is_boundary(edge)) {
            let mut winding = ends(edge, &windings)[0];
            least = least.min(winding);
            for p in on_edge(edge) {
                winding += step(p);
                least = least.min(winding);
            }
        }
        let first = i32::from(least < 0 && starts_inside());
        for winding in &mut windings {
            *winding = (*winding).saturating_add(first).max(0);
        }
        self.windings = windings;
    }

    /// Finds the ends of the chains of one solid: where an edge enters and where it leaves again.
    fn find_ends(&mut self, facets: &Facets, own: Range<usize>, solid: u32) {
        let mut ends = std::mem::take(&mut self.ends);
        ends.clear();
        let mut open = Vec::new();
        for (edge, sweep_edge) in (0..).zip(facets.edges()) {
            if !facets.may_have_chain(edge) {
                continue;
            }
            let [start, end] = sweep_edge.ends;
            let corner = |corner, level| ChainEnd::Corner { corner, level };
            open.clear();
            match self.tip_at(facets, edge, 0, solid) {
                Some((node, true)) => open.push(ChainEnd::Node(node)),
                Some((_, false)) => {}
                None => {
                    let inside = u32::try_from(self.windings[start as usize]).unwrap_or_default();
                    open.extend((0..inside).map(|level| corner(start, level)));
                }
            }
            // All open ends have entered the body or, where it is inside out, left it.
            let mut is_inverted = false;
            for p in self.piercings[own.clone()]
                .iter()
                .filter(|p| p.edge == edge)
            {
                let to = ChainEnd::Node(p.node);
                if open.is_empty() || p.enters != is_inverted {
                    is_inverted = !p.enters;
                    open.push(to);
                } else if let Some(from) = open.pop() {
                    ends.push(Ends {
                        edge,
                        ends: [from, to],
                        is_inverted,
                    });
                }
            }
            let tip = self
                .tip_at(facets, edge, 1, solid)
                .map(|(node, _)| ChainEnd::Node(node));
            let rest = (0..).zip(open.drain(..));
            ends.extend(rest.map(|(level, from)| Ends {
                edge,
                ends: [from, tip.unwrap_or(corner(end, level))],
                is_inverted,
            }));
        }
        self.ends = ends;
    }

    /// Makes the nodes of the chains of one solid.
    fn add_chains(
        &mut self,
        edit: &mut Edit<'_>,
        at: &Opening<'_>,
        sides: &mut Sides,
        own: Range<usize>,
        solid: u32,
    ) {
        self.corners.clear();
        let pierced = self.piercings[own].iter().map(|p| p.node);
        let tips = self
            .tips
            .iter()
            .filter(|tip| tip.solid == solid)
            .map(|tip| tip.node);
        let known: Vec<u32> = pierced.chain(tips).collect();
        let anchors = [known[0], known[known.len() - 1]];
        let anchors = anchors.map(|node| sides.vertices[node as usize][0]);
        let has_corner = |own: &Ends| {
            own.ends
                .iter()
                .any(|end| matches!(end, ChainEnd::Corner { .. }))
        };
        let map = (self.ends.iter().any(has_corner)).then(|| {
            let curves = known.iter().map(|&node| at.rim.curve_of[node as usize]);
            RestMap::fit(edit.surface(), at.rim, sides, curves)
        });
        let lengths = known.iter().map(|&node| at.lengths[node as usize]);
        let coarsest = lengths.fold(0.0, f64::max);
        for i in 0..self.ends.len() {
            let Ends {
                edge,
                ends,
                is_inverted,
            } = self.ends[i];
            let ends = ends.map(|end| match (end, &map) {
                (ChainEnd::Corner { corner, level }, Some(map)) => {
                    let position = at.facets.corner(corner);
                    let known = self.corners.iter().find(|c| (c.0, c.1) == (corner, level));
                    known.map(|c| c.2).unwrap_or_else(|| {
                        let rest = map.at(position);
                        let vertex = add_corner(edit, position, rest, anchors);
                        let node = self.add_node(sides, position, coarsest, [vertex; 2]);
                        self.corners.push((corner, level, node));
                        node
                    })
                }
                (ChainEnd::Node(node), _) => node,
                (ChainEnd::Corner { .. }, None) => unreachable!("corners have a map"),
            });
            self.add_chain(edit, at, sides, (edge, is_inverted), ends);
        }
    }

    fn add_node(
        &mut self,
        sides: &mut Sides,
        position: Vec3,
        length: f64,
        vertices: [VertexId; 2],
    ) -> u32 {
        let node = index_u32(sides.vertices.len());
        sides.vertices.push(vertices);
        self.positions.push(position);
        self.lengths.push(length);
        node
    }

    /// Makes the nodes between the ends of a chain, spaced by the target lengths.
    fn add_chain(
        &mut self,
        edit: &mut Edit<'_>,
        at: &Opening<'_>,
        sides: &mut Sides,
        (edge, is_inverted): (u32, bool),
        ends: [u32; 2],
    ) {
        let is_tip = !at.facets.edges()[edge as usize].is_crease();
        let position = |chains: &Self, node: u32| match at.nodes.get(node as usize) {
            Some(node) => node.position,
            None => chains.positions[node as usize - at.nodes.len()],
        };
        // A sliver on the surface is no reason for many points in the inside.
        let least = MIN_LENGTH * mean(at.lengths);
        let length = |node: u32| match at.lengths.get(node as usize) {
            Some(&length) => length.max(least),
            None => self.lengths[node as usize - at.nodes.len()],
        };
        let [p, q] = ends.map(|node| position(self, node));
        let vertices = ends.map(|node| sides.vertices[node as usize]);
        // Between two corners, the chains of both sides would be the same edge; and the surface
        // may have an edge between the ends.
        let has_shared_ends = !is_tip && vertices.iter().all(|[below, above]| below == above);
        let is_on_rim = |node: u32| (node as usize) < at.nodes.len();
        let topology = edit.surface().topology();
        let is_edge = ends.into_iter().all(is_on_rim)
            && at.rim.is_beside(topology, sides, ends[0], vertices[1]);
        let min_count = 1 + u32::from(has_shared_ends || is_edge);
        let distance = (q - p).norm();
        let spacing = Spacing::new(ends.map(length), at.refine.grading, distance, min_count);
        let first = self.nodes.len();
        self.nodes.push(ends[0]);
        for k in 1..spacing.count {
            let part = round_to_f32(spacing.place(k));
            let weights = [1.0 - part, part, 0.0];
            let part = f64::from(part);
            let position = p + (q - p) * part;
            let mut add = |side: usize| {
                let [a, b] = vertices.map(|v| v[side]);
                let parents = [a, b, a];
                add_vertex(edit, position, VertexOrigin::OnCap { parents, weights })
            };
            let below = add(0);
            let above = if is_tip { below } else { add(1) };
            let node = self.add_node(sides, position, spacing.length(part), [below, above]);
            self.nodes.push(node);
        }
        self.nodes.push(ends[1]);
        self.chains.push(Chain {
            edge,
            nodes: first..self.nodes.len(),
            is_tip,
            is_inverted,
        });
    }
}

/// Adds the vertex of a corner inside the body, beside its parents.
fn add_corner(edit: &mut Edit<'_>, position: Vec3, rest: Vec3, [a, b]: [VertexId; 2]) -> VertexId {
    let origin = VertexOrigin::OnCap {
        parents: [a, b, a],
        weights: [0.5, 0.5, 0.0],
    };
    let positions = edit.surface().positions();
    let [w] = origin.interpolate(|v| [positions[v.index()][3]]);
    let [x, y, z] = to_f32(position);
    edit.add_vertex([x, y, z, round_to_f32(w)], to_f32(rest), origin)
}

/// Points along a segment at distances that grow from both ends.
#[derive(Debug, Clone, Copy)]
struct Spacing {
    /// Target lengths at the ends, relative to the segment.
    ends: [f64; 2],
    grading: f64,
    /// Length of the segment \[m\].
    distance: f64,
    /// Place at which the lengths from both ends are equal.
    middle: f64,
    /// Number of parts.
    count: u32,
}

/// Smallest target length along chains [of the mean along the rim].
const MIN_LENGTH: f64 = 0.5;

/// Maximum number of parts of a chain.
const MAX_PARTS: f64 = 65536.0;

#[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 nodes")]
fn mean(lengths: &[f64]) -> f64 {
    lengths.iter().sum::<f64>() / lengths.len() as f64
}

impl Spacing {
    fn new(lengths: [f64; 2], grading: f64, distance: f64, min_count: u32) -> Self {
        // The ends may have the same position.
        let distance = if distance > 0.0 { distance } else { lengths[0] };
        let ends = lengths.map(|l| (l / distance).max(1.0 / MAX_PARTS));
        let [a, b] = ends;
        // Without grading, lengths change linearly from end to end.
        let grading = grading.max((b - a).abs()).max(1e-6);
        let mut spacing = Self {
            ends,
            grading,
            distance,
            middle: ((b - a + grading) / (2.0 * grading)).clamp(0.0, 1.0),
            count: min_count,
        };
        let parts = spacing.parts_before(1.0).round();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at least 1 and at most MAX_PARTS"
        )]
        if parts > f64::from(min_count) {
            spacing.count = parts.min(MAX_PARTS) as u32;
        }
        spacing
    }

    /// Returns the target length at a place \[m\].
    fn length(&self, place: f64) -> f64 {
        let [a, b] = self.ends;
        let relative = (a + self.grading * place).min(b + self.grading * (1.0 - place));
        relative * self.distance
    }

    /// Returns the integral of 1 / length from the start to a place.
    fn parts_before(&self, place: f64) -> f64 {
        let [a, b] = self.ends;
        let g = self.grading;
        let rising = (1.0 + g * place.min(self.middle) / a).ln() / g;
        if place <= self.middle {
            return rising;
        }
        let high = b + g * (1.0 - self.middle);
        rising + (high / (b + g * (1.0 - place))).ln() / g
    }

    /// Returns the place of point `k`.
    fn place(&self, k: u32) -> f64 {
        let [a, b] = self.ends;
        let g = self.grading;
        let target = self.parts_before(1.0) * f64::from(k) / f64::from(self.count);
        let rising = self.parts_before(self.middle);
        if target <= rising {
            return a * (g * target).exp_m1() / g;
        }
        let high = b + g * (1.0 - self.middle);
        1.0 + b / g - high * (-g * (target - rising)).exp() / g
    }
}
