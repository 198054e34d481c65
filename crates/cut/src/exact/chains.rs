//! Chains: the parts of sweep edges inside the body.
//!
//! Along a sweep edge the body is entered and left where curves meet the edge. Between, a chain of
//! nodes runs through the inside. On an edge between two facets it is a common side of their
//! sections. On the sweep's boundary it is the tip of an incision, at which both walls join.
//!
//! How often an edge is inside is counted for each solid, a piece with its cavities, so that
//! overlapping bodies have chains of their own. Where a body that intersects itself is inside out,
//! the count is negative and the chain is inverted.

mod piercings;
mod spacing;
mod windings;

use super::open::Sides;
use super::rest::{add_vertex_between, fit_rest};
use super::rim::Rim;
use crate::blade_position::is_in_body;
use crate::error::CutError;
use crate::intersection::facets::{EdgeKind, Facets};
use crate::intersection::node::Node;
use crate::intersection::trace::Curve;
use crate::sweep::Sweep;
use incise_mesh::geometry::{round_to_f32, to_f32};
use incise_mesh::{Edit, Vec3, VertexId, VertexOrigin, index_u32};
use incise_refine::RefineParams;
use piercings::{Piercing, TipCorner};
use spacing::Spacing;
use std::ops::Range;
use windings::{ChainEnd, Ends};

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
    /// Whether the surface has cavities, once known: cuts of bodies without any make none.
    pub(super) has_cavities: Option<bool>,
    /// Nodes of corners inside the body, by corner and level.
    corners: Vec<(u32, u32, u32)>,
}

/// The input of [`Chains::find`].
pub(super) struct Opening<'a> {
    pub(super) sweep: &'a Sweep,
    pub(super) is_sheet: &'a [bool],
    pub(super) facets: &'a Facets,
    pub(super) nodes: &'a [Node],
    pub(super) curves: &'a [Curve],
    pub(super) rim: &'a Rim,
    pub(super) refine: &'a RefineParams,
    /// Target edge length at each node \[m\].
    pub(super) lengths: &'a [f64],
}

impl Chains {
    /// Finds the chains and adds their vertices: two for a node between facets, one at a tip.
    ///
    /// # Errors
    /// [`CutError::OpenSection`] if a curve at a tip has no edge.
    pub(super) fn find(
        &mut self,
        edit: &mut Edit<'_>,
        at: &Opening<'_>,
        sides: &mut Sides,
    ) -> Result<(), CutError> {
        self.chains.clear();
        self.nodes.clear();
        self.positions.clear();
        self.lengths.clear();
        self.find_piercings(edit, at, sides);
        self.find_tips(edit, at, sides)?;
        self.find_solids(edit.surface());
        let solids = self.piercings.iter().map(|p| p.solid);
        let mut solids: Vec<u32> = solids
            .chain(self.tips.iter().map(|tip| tip.solid))
            .collect();
        solids.sort_unstable();
        solids.dedup();
        for solid in solids {
            let from = self.piercings.partition_point(|p| p.solid < solid);
            let to = self.piercings.partition_point(|p| p.solid <= solid);
            let starts_inside = || is_in_body(edit.surface(), at.is_sheet, at.sweep.points()[0]);
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
        Ok(())
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
            fit_rest(edit.surface(), at.rim, sides, curves)
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
                        let rest = at
                            .facets
                            .present(corner)
                            .unwrap_or_else(|| map.at(position));
                        let vertex = add_corner(edit, position, rest, anchors);
                        let node = self.add_node(sides, position, coarsest, [vertex; 2]);
                        self.corners.push((corner, level, node));
                        node
                    })
                }
                (ChainEnd::Node(node), _) => node,
                (ChainEnd::Corner { .. }, None) => unreachable!("corners have a map"),
            });
            self.add_chain(edit, at, sides, edge, is_inverted, ends);
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

    /// Returns whether a chain along the blade's present edge is a tip by itself.
    ///
    /// A tip of one edge could not be opened by the next step, which shares both of its vertices.
    fn is_whole_tip(&self, facets: &Facets, edge: u32, ends: [u32; 2]) -> bool {
        let count = index_u32(facets.corner_count());
        let is_inner = |corner: u32| corner != count / 2 && corner != count - 1;
        let corners = facets.edges()[edge as usize].ends;
        let goes_on = |(corner, node): (u32, u32)| {
            is_inner(corner) && self.corners.iter().any(|c| (c.0, c.2) == (corner, node))
        };
        facets.kind(edge) == EdgeKind::Current && !corners.into_iter().zip(ends).any(goes_on)
    }

    /// Makes the nodes between the ends of a chain, spaced by the target lengths.
    fn add_chain(
        &mut self,
        edit: &mut Edit<'_>,
        at: &Opening<'_>,
        sides: &mut Sides,
        edge: u32,
        is_inverted: bool,
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
        let is_alone = self.is_whole_tip(at.facets, edge, ends);
        let min_count = 1 + u32::from(has_shared_ends || is_edge || is_alone);
        let distance = (q - p).norm();
        let spacing = Spacing::new(ends.map(length), at.refine.grading, distance, min_count);
        let first = self.nodes.len();
        self.nodes.push(ends[0]);
        for k in 1..spacing.count {
            let part = round_to_f32(spacing.parameter(k));
            let weights = [1.0 - part, part, 0.0];
            let part = f64::from(part);
            let position = p + (q - p) * part;
            let mut add = |side: usize| {
                let [a, b] = vertices.map(|v| v[side]);
                let parents = [a, b, a];
                let origin = VertexOrigin::OnCap { parents, weights };
                add_vertex_between(edit, position, origin, |mean| mean)
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

/// Smallest target length along chains [of the mean along the rim].
const MIN_LENGTH: f64 = 0.5;

#[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 nodes")]
fn mean(lengths: &[f64]) -> f64 {
    lengths.iter().sum::<f64>() / lengths.len() as f64
}
