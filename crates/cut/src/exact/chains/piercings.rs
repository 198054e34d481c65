//! The points where curves meet sweep edges, sorted along the edges of each solid.

use super::{Chains, Opening};
use crate::error::CutError;
use crate::exact::open::Sides;
use crate::exact::rim::NO_NODE;
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
#[derive(Debug, Clone, Copy)]
pub(super) struct TipCorner {
    pub(super) corner: u32,
    pub(super) node: u32,
    pub(super) solid: u32,
    /// Whether the edges that begin here are inside the body at first: the diagonal, the rib, and
    /// the previous edge beyond the end of the tip.
    pub(super) diagonal: bool,
    pub(super) rib: bool,
    pub(super) beyond: bool,
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

    /// Collects the vertices of the tip that the sweep continues.
    pub(super) fn find_tips(
        &mut self,
        edit: &Edit<'_>,
        at: &Opening<'_>,
        sides: &Sides,
    ) -> Result<(), CutError> {
        self.tips.clear();
        let tip = at.facets.tip();
        let ends = (0..).zip(&tip.vertices);
        let ends = ends.flat_map(|(corner, &[ends, begins])| {
            let begins = (begins != ends).then_some((corner, begins, [false, true]));
            let ends = (corner, ends, [true, begins.is_none()]);
            [Some(ends), begins].into_iter().flatten()
        });
        for (corner, vertex, [may_end, may_begin]) in ends {
            let is_own = |node: &Node| node.on == On::Tip(vertex);
            let Some(node) = at.nodes.iter().position(is_own).map(index_u32) else {
                continue;
            };
            if !at.curves[at.rim.curve_of[node as usize] as usize].is_capped {
                continue;
            }
            let is_joined = |i: Option<u32>| {
                let along = i.and_then(|i| tip.half_edges.get(i as usize));
                along.is_some_and(|h| !h.is_null())
            };
            let begins = may_begin && is_joined(Some(corner));
            let ends = may_end && is_joined(corner.checked_sub(1));
            let (prev, next) = (at.rim.prev[node as usize], at.rim.next[node as usize]);
            let facet = |node: u32| at.nodes[node as usize].facet;
            // The facets around the corner that are inside the body, from the tip on: all, unless
            // the curve leaves the tip there.
            let (quad, inside) = (2 * corner, u32::MAX);
            let [diagonal, rib, beyond] = if begins && ends {
                [true; 3]
            } else if begins {
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
            let along = sides.rim[along as usize][0];
            if along.is_null() {
                return Err(CutError::OpenSection);
            }
            self.tips.push(TipCorner {
                corner,
                node,
                solid: edit.surface().piece(along.triangle()),
                diagonal,
                rib,
                beyond,
            });
        }
        Ok(())
    }
}
