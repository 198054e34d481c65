//! The sections of the body in the planes of the facets, with target edge lengths.
//!
//! The boundary of a section consists of parts of curves, between the points where they meet the
//! facet's edges, and of chains along the edges.

use super::chains::Chains;
use super::frames::Frames;
use super::open::Sides;
use super::rim::{NO_NODE, Rim};
use crate::error::CutError;
use crate::intersection::facets::{Facets, NO_FACET};
use crate::intersection::node::Node;
use crate::intersection::trace::Curve;
use incise_mesh::{Topology, VertexId, index_u32};
use incise_refine::{
    RefineError, RefineParams, Section, SectionMesh, SectionMeshParams, SectionMeshScratch,
    SectionMeshSize, triangulate_section,
};

/// Number of neighbors to each side over which local edge lengths are averaged.
const SMOOTHING_NEIGHBORS: usize = 4;

/// An opened surface and its sections before they are meshed.
#[derive(Clone, Copy)]
pub(super) struct Rims<'a> {
    pub(super) nodes: &'a [Node],
    pub(super) curves: &'a [Curve],
    pub(super) sides: &'a Sides,
    pub(super) rim: &'a Rim,
    pub(super) facets: &'a Facets,
    pub(super) frames: &'a Frames,
    pub(super) chains: &'a Chains,
}

/// The element along an edge of a section's boundary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BoundaryEdge {
    /// The rim's edge that begins at this node.
    Rim(u32),
    /// The edge of a chain that begins at this place of [`Chains::nodes`].
    Chain { segment: usize, is_tip: bool },
}

/// The section of the body in the plane of one facet.
#[derive(Debug, Clone, Default)]
pub(super) struct FacetSection {
    pub(super) facet: u32,
    /// Node of each point.
    pub(super) nodes: Vec<u32>,
    /// The element of the boundary after each point.
    pub(super) boundary: Vec<BoundaryEdge>,
    /// Place in the facet's plane from which the points are counted \[m\].
    pub(super) center: [f64; 2],
    /// Positions in the plane \[m\].
    pub(super) points: Vec<[f64; 2]>,
    /// Points of each loop, counterclockwise around the section.
    pub(super) loops: Vec<Vec<u32>>,
    /// Target edge length at each point \[m\].
    pub(super) lengths: Vec<f64>,
}

/// A part of a section's boundary: of a curve, or a chain.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    facet: u32,
    /// First and last node.
    start: u32,
    end: u32,
    /// The number of the chain, and whether it is followed in the direction of its edge.
    chain: Option<(usize, bool)>,
    is_used: bool,
}

/// The sections of a cut.
#[derive(Debug, Clone, Default)]
pub(super) struct CrossSection {
    /// Sections by facet; those beyond the count keep their memory.
    sections: Vec<FacetSection>,
    count: usize,
    /// The nodes of the curves with two nodes, around parts of two triangles back to back.
    flat_curves: Vec<[u32; 2]>,
    stretches: Vec<Stretch>,
    /// Nodes and edges of the current loop.
    outline: Vec<(u32, BoundaryEdge)>,
    scratch: SectionMeshScratch,
}

/// Sets the target edge length at every node of the rim \[m\].
pub(super) fn target_lengths(nodes: &[Node], rim: &Rim, refine: &RefineParams, out: &mut Vec<f64>) {
    out.clear();
    out.resize(nodes.len(), 0.0);
    let z = refine.level.z();
    let mut own = Vec::new();
    for curve in 0..rim.sizes.len() {
        own.clear();
        own.extend(rim.ring(curve));
        let is_closed = rim.prev[own[0] as usize] != NO_NODE;
        let local = |i: usize| nodes[own[i] as usize].local;
        for (i, &node) in own.iter().enumerate() {
            let length = (refine.rim_length).unwrap_or_else(|| {
                if is_closed {
                    smooth(|i| local(i % own.len()), i, own.len())
                } else {
                    local(i)
                }
            });
            out[node as usize] = length * z;
        }
    }
}

impl CrossSection {
    /// Collects the loops of all sections.
    ///
    /// # Errors
    /// [`CutError::OpenSection`] if parts of boundaries do not close.
    pub(super) fn project(&mut self, rims: &Rims<'_>, lengths: &[f64]) -> Result<(), CutError> {
        self.count = 0;
        self.flat_curves.clear();
        self.stretches.clear();
        let capped = (0..rims.rim.sizes.len()).filter(|&curve| rims.curves[curve].is_capped);
        for curve in capped {
            self.add_curve(rims, lengths, curve);
        }
        for (i, chain) in rims.chains.chains.iter().enumerate() {
            let facets = rims.facets.edges()[chain.edge as usize].facets;
            let own = &rims.chains.nodes[chain.nodes.clone()];
            let (first, last) = (own[0], own[own.len() - 1]);
            for (facet, is_forward) in facets.into_iter().zip([true, false]) {
                let is_forward = is_forward != chain.is_inverted;
                if facet == NO_FACET {
                    continue;
                }
                let (start, end) = if is_forward {
                    (first, last)
                } else {
                    (last, first)
                };
                self.stretches.push(Stretch {
                    facet,
                    start,
                    end,
                    chain: Some((i, is_forward)),
                    is_used: false,
                });
            }
        }
        self.stretches.sort_by_key(|s| (s.facet, s.start));
        for first in 0..self.stretches.len() {
            if !self.stretches[first].is_used {
                self.close_loop(rims, lengths, first)?;
            }
        }
        Ok(())
    }

    /// Adds the parts of a curve between facets, or a loop if it stays in one.
    fn add_curve(&mut self, rims: &Rims<'_>, lengths: &[f64], curve: usize) {
        let is_break = |&node: &u32| rims.nodes[node as usize].is_between_facets();
        let Some(first) = rims.rim.ring(curve).find(is_break) else {
            self.outline.clear();
            let ring = rims.rim.ring(curve);
            self.outline
                .extend(ring.map(|node| (node, BoundaryEdge::Rim(node))));
            if let [(a, _), (b, _)] = self.outline[..] {
                self.flat_curves.push([a, b]);
                return;
            }
            let facet = rims.nodes[self.outline[0].0 as usize].facet;
            self.add_loop(rims, lengths, facet);
            return;
        };
        let mut start = first;
        loop {
            let mut end = rims.rim.next[start as usize];
            while end != NO_NODE && !is_break(&end) {
                end = rims.rim.next[end as usize];
            }
            if end == NO_NODE {
                return;
            }
            self.stretches.push(Stretch {
                facet: rims.nodes[start as usize].facet,
                start,
                end,
                chain: None,
                is_used: false,
            });
            start = end;
            if start == first {
                return;
            }
        }
    }

    /// Follows stretches of curves and chains around a loop.
    fn close_loop(
        &mut self,
        rims: &Rims<'_>,
        lengths: &[f64],
        first: usize,
    ) -> Result<(), CutError> {
        self.outline.clear();
        let facet = self.stretches[first].facet;
        let mut at = first;
        loop {
            let stretch = &mut self.stretches[at];
            stretch.is_used = true;
            let stretch = *stretch;
            if let Some((chain, is_forward)) = stretch.chain {
                let chain = &rims.chains.chains[chain];
                let is_tip = chain.is_tip;
                let (low, high) = (chain.nodes.start, chain.nodes.end - 1);
                let own = &rims.chains.nodes;
                let side = |segment| BoundaryEdge::Chain { segment, is_tip };
                if is_forward {
                    self.outline.extend((low..high).map(|k| (own[k], side(k))));
                } else {
                    let back = (low..high).rev();
                    self.outline.extend(back.map(|k| (own[k + 1], side(k))));
                }
            } else {
                let mut node = stretch.start;
                while node != stretch.end {
                    self.outline.push((node, BoundaryEdge::Rim(node)));
                    node = rims.rim.next[node as usize];
                }
            }
            let key = |s: &Stretch| (s.facet, s.start);
            at = (self
                .stretches
                .binary_search_by_key(&(facet, stretch.end), key))
            .map_err(|_| CutError::OpenSection)?;
            if at == first {
                break;
            }
            if self.stretches[at].is_used {
                return Err(CutError::OpenSection);
            }
        }
        self.add_loop(rims, lengths, facet);
        Ok(())
    }

    /// Adds the outline to the section of a facet.
    fn add_loop(&mut self, rims: &Rims<'_>, lengths: &[f64], facet: u32) {
        let known = self.sections[..self.count]
            .iter()
            .position(|s| s.facet == facet);
        let i = known.unwrap_or_else(|| {
            if self.count == self.sections.len() {
                self.sections.push(FacetSection::default());
            }
            self.count += 1;
            let position = rims.position(self.outline[0].0);
            self.sections[self.count - 1].begin(facet, rims.frames.local(facet, position));
            self.count - 1
        });
        let section = &mut self.sections[i];
        let mut points = Vec::with_capacity(self.outline.len());
        for &(node, side) in &self.outline {
            points.push(index_u32(section.nodes.len()));
            section.nodes.push(node);
            section.boundary.push(side);
            let [x, y] = rims.frames.local(facet, rims.position(node));
            section
                .points
                .push([x - section.center[0], y - section.center[1]]);
            section.lengths.push(match lengths.get(node as usize) {
                Some(&length) => length,
                None => rims.chains.lengths[node as usize - rims.nodes.len()],
            });
        }
        section.loops.push(points);
    }

    /// Returns the sections.
    pub(super) fn sections(&self) -> &[FacetSection] {
        &self.sections[..self.count]
    }

    /// Returns the nodes of each curve with two nodes. Its section is an edge, followed twice.
    pub(super) fn flat_curves(&self) -> &[[u32; 2]] {
        &self.flat_curves
    }

    /// Returns whether a loop is the boundary of a hole.
    pub(super) fn has_holes(&self) -> bool {
        let mut sections = self.sections().iter();
        sections.any(|section| section.loops.iter().any(|points| section.is_hole(points)))
    }

    /// Returns whether the sweep ends inside the body although no curve ends.
    ///
    /// `is_inside` returns whether the sweep's boundary is inside the body, and costs as much as
    /// `triangles` steps. It is called first if comparing all loops costs more.
    pub(super) fn ends_inside(&self, triangles: usize, is_inside: impl FnOnce() -> bool) -> bool {
        let is_suspect = |section: &FacetSection| {
            let holes = section
                .loops
                .iter()
                .filter(|points| section.is_hole(points))
                .count();
            let is_cheap = holes * section.points.len() <= triangles;
            holes > 0 && (!is_cheap || section.has_loose_hole())
        };
        self.sections().iter().any(is_suspect) && is_inside()
    }

    /// Triangulates section `i` to the target edge lengths or, unless `is_refined`, without new
    /// points.
    ///
    /// # Errors
    /// As [`triangulate_section`].
    pub(super) fn triangulate(
        &mut self,
        i: usize,
        rims: &Rims<'_>,
        topology: &Topology,
        refine: &RefineParams,
        is_refined: bool,
    ) -> Result<SectionMesh, RefineError> {
        let own = &self.sections[i];
        let params = SectionMeshParams {
            size: if is_refined {
                SectionMeshSize::Local(&own.lengths)
            } else {
                SectionMeshSize::Any
            },
            grading: refine.grading,
            max_triangles: refine.max_triangles,
            ..SectionMeshParams::default()
        };
        let has_edge = |a: u32, b: u32| rims.may_have_edge(topology, own, a, b);
        triangulate_section(&own.section(), &params, has_edge, &mut self.scratch)
    }
}

impl FacetSection {
    fn begin(&mut self, facet: u32, center: [f64; 2]) {
        self.facet = facet;
        self.center = center;
        self.nodes.clear();
        self.boundary.clear();
        self.points.clear();
        self.loops.clear();
        self.lengths.clear();
    }

    /// Returns the loops as the input of a triangulation.
    pub(super) fn section(&self) -> Section<'_> {
        Section {
            points: &self.points,
            loops: &self.loops,
        }
    }

    fn outline<'a>(&'a self, points: &'a [u32]) -> impl Iterator<Item = [f64; 2]> + Clone + 'a {
        points.iter().map(|&p| self.points[p as usize])
    }

    fn is_hole(&self, points: &[u32]) -> bool {
        doubled_area(self.outline(points)) < 0.0
    }

    /// Returns whether a hole lies in no outer loop. The rim of a cavity in which the sweep ends is
    /// such a hole.
    fn has_loose_hole(&self) -> bool {
        (0..self.loops.len()).any(|i| {
            if !self.is_hole(&self.loops[i]) {
                return false;
            }
            let inside = self.points[self.loops[i][0] as usize];
            let others = (0..self.loops.len()).filter(|&j| j != i);
            let winding = |j: usize| winding(self.outline(&self.loops[j]), inside);
            others.map(winding).sum::<i32>() <= 0
        })
    }
}

impl Rims<'_> {
    /// Returns the position of a node \[m\].
    pub(super) fn position(&self, node: u32) -> incise_mesh::Vec3 {
        match self.nodes.get(node as usize) {
            Some(node) => node.position,
            None => self.chains.positions[node as usize - self.nodes.len()],
        }
    }

    /// Returns whether an edge between two points of a section may exist elsewhere.
    ///
    /// On the surface, in the other wall if both sides share the two vertices, or in the section of
    /// the facet beyond a sweep edge on which both are.
    fn may_have_edge(&self, topology: &Topology, section: &FacetSection, a: u32, b: u32) -> bool {
        let [from, to] = [a, b].map(|p| section.nodes[p as usize]);
        let [own, other] = [from, to].map(|node| self.sides.vertices[node as usize]);
        let is_beside = |node: u32, others: [VertexId; 2]| {
            node < index_u32(self.nodes.len())
                && self.rim.is_beside(topology, self.sides, node, others)
        };
        if own[0] == own[1] && other[0] == other[1] {
            return true;
        }
        if self.chains.are_on_one_edge(from, to) {
            return true;
        }
        is_beside(from, other) || (!self.rim.pinches.is_empty() && is_beside(to, own))
    }
}

/// Returns the mean of `local` around place `i` of `n` on a loop.
///
/// So a single large triangle at the rim does not make the cap coarser.
#[expect(clippy::cast_precision_loss, reason = "few places")]
fn smooth(local: impl Fn(usize) -> f64, i: usize, n: usize) -> f64 {
    let reach = SMOOTHING_NEIGHBORS.min(n / 2);
    let places = i + n - reach..=i + n + reach;
    places.map(local).sum::<f64>() / (2 * reach + 1) as f64
}

/// Returns twice the signed area inside a closed outline.
fn doubled_area(outline: impl Iterator<Item = [f64; 2]> + Clone) -> f64 {
    let following = outline.clone().cycle().skip(1);
    (outline.zip(following))
        .map(|([ax, ay], [bx, by])| ax * by - ay * bx)
        .sum()
}

/// Returns the winding number of a closed outline around a point.
fn winding(outline: impl Iterator<Item = [f64; 2]> + Clone, [x, y]: [f64; 2]) -> i32 {
    let following = outline.clone().cycle().skip(1);
    (outline.zip(following))
        .map(|([ax, ay], [bx, by])| {
            let left = (bx - ax) * (y - ay) - (by - ay) * (x - ax);
            if ay <= y && by > y && left > 0.0 {
                1
            } else if ay > y && by <= y && left < 0.0 {
                -1
            } else {
                0
            }
        })
        .sum()
}
