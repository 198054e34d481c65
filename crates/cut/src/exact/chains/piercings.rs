//! The points where curves meet sweep edges, sorted along the edges of each solid.

use super::{Chains, Opening};
use crate::error::CutError;
use crate::exact::open::Sides;
use crate::exact::rim::NO_NODE;
use crate::intersection::facets::Facets;
use crate::intersection::node::{Node, On};
use incise_mesh::{Edit, Surface, Vec3, index_u32};

/// A point where a curve meets a sweep edge.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piercing {
    pub(super) edge: u32,
    /// The solid: the piece, or the one around it if this is the wall of a cavity.
    pub(super) solid: u32,
    pub(super) node: u32,
    pub(super) corners: [Vec3; 3],
    /// Whether the edge enters the body here.
    pub(super) enters: bool,
}

/// A corner of the sweep on the tip that it continues.
#[derive(Debug, Clone)]
pub(super) struct TipCorner {
    pub(super) corner: u32,
    pub(super) node: u32,
    pub(super) solid: u32,
    /// The sweep's edges at the corner that are inside the body there.
    pub(super) inside: Vec<u32>,
}

impl Chains {
    /// Collects the piercings, sorted by edge and along the edge.
    pub(super) fn find_piercings(&mut self, edit: &Edit<'_>, at: &Opening<'_>, sides: &Sides) {
        self.piercings.clear();
        let surface = edit.surface();
        for curve in (0..at.rim.sizes.len()).filter(|&curve| at.curves[curve].is_capped) {
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
    }

    /// Assigns piercings and tips on cavities to the solids around these, and sorts piercings by
    /// solid.
    pub(super) fn find_solids(&mut self, surface: &Surface) {
        let tips = self.tips.iter().map(|tip| tip.solid);
        let mut solids = self.piercings.iter().map(|p| p.solid).chain(tips);
        let first = solids.next();
        let has_pieces = solids.any(|solid| Some(solid) != first);
        if has_pieces && self.has_cavities != Some(false) {
            let volumes = surface.piece_volumes();
            self.has_cavities = Some(volumes.iter().any(|&volume| volume < 0.0));
            self.assign_cavities(&volumes);
        }
        self.piercings.sort_by_key(|p| p.solid);
    }

    /// Assigns cavities to the solids in which they are, given the signed volume of each piece.
    ///
    /// A cavity is in the solid that an edge has entered last where it first meets the cavity.
    fn assign_cavities(&mut self, volumes: &[f64]) {
        let is_cavity = |piece: u32| volumes[piece as usize] < 0.0;
        let tips = self.tips.iter().map(|tip| tip.solid);
        let mut pieces = self.piercings.iter().map(|p| p.solid).chain(tips);
        let default = pieces.find(|&piece| !is_cavity(piece));
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
        let piercings = self.piercings.iter_mut().map(|p| &mut p.solid);
        let tips = self.tips.iter_mut().map(|tip| &mut tip.solid);
        for solid in piercings.chain(tips).filter(|solid| is_cavity(**solid)) {
            let known = around.iter().find(|&&(cavity, _)| cavity == *solid);
            *solid = known.map(|&(_, solid)| solid).or(default).unwrap_or(*solid);
        }
    }

    /// Collects the vertices of the tip that the sweep continues, sorted by corner.
    pub(super) fn find_tips(
        &mut self,
        edit: &Edit<'_>,
        at: &Opening<'_>,
        sides: &Sides,
    ) -> Result<(), CutError> {
        self.tips.clear();
        for part in &at.facets.tip().parts {
            for (k, (&corner, &vertex)) in part.corners.iter().zip(&part.vertices).enumerate() {
                let is_own = |node: &Node| node.on == On::Tip(vertex);
                let Some(node) = at.nodes.iter().position(is_own).map(index_u32) else {
                    continue;
                };
                if !at.curves[at.rim.curve_of[node as usize] as usize].is_capped {
                    continue;
                }
                let next = at.rim.next[node as usize];
                let prev = at.rim.prev[node as usize];
                let along = if prev == NO_NODE || next != NO_NODE {
                    node
                } else {
                    prev
                };
                let along = sides.rim[along as usize][0];
                if along.is_null() {
                    return Err(CutError::OpenSection);
                }
                let facet = |node: u32| at.nodes[node as usize].facet;
                let [before, after] = part.neighbors(k);
                let leaves = (next != NO_NODE).then(|| facet(node));
                let arrives = (prev != NO_NODE).then(|| facet(prev));
                self.tips.push(TipCorner {
                    corner,
                    node,
                    solid: edit.surface().piece(along.triangle()),
                    inside: inside(at.facets, corner, [before, after], [arrives, leaves]),
                });
            }
        }
        self.tips.sort_by_key(|tip| tip.corner);
        Ok(())
    }
}

/// Returns the sweep's edges at a corner of the tip that are inside the body there.
///
/// Counterclockwise, the inside begins behind the tip's edge to the corner after, and it ends at
/// that from the corner before. At an end of the tip, the facet decides in which the curve leaves
/// or arrives; a curve that ends there as well has none.
fn inside(
    facets: &Facets,
    corner: u32,
    [before, after]: [Option<u32>; 2],
    [arrives, leaves]: [Option<u32>; 2],
) -> Vec<u32> {
    let fan = facets.fan(corner);
    let of_facet = |facet: u32| fan.iter().position(|&(_, f)| f == facet);
    let of_edge = |to: u32| {
        let ends = |edge: u32| facets.edges()[edge as usize].ends;
        fan.iter().position(|&(edge, _)| ends(edge).contains(&to))
    };
    let behind = |place: Option<usize>| place.map(|i| i + 1);
    let start = match after {
        Some(after) => behind(of_edge(after)),
        None => leaves.and_then(|facet| behind(of_facet(facet))),
    };
    let end = match before {
        Some(before) => of_edge(before),
        None => arrives.and_then(|facet| behind(of_facet(facet))),
    };
    let own = fan.get(start.unwrap_or(0)..end.unwrap_or(fan.len()));
    own.unwrap_or_default()
        .iter()
        .map(|&(edge, _)| edge)
        .collect()
}
