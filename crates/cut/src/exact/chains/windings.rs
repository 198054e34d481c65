//! Winding numbers of sweep edges in a solid, and the ends of the chains that follow from them.

use super::Chains;
use super::piercings::Piercing;
use crate::intersection::facets::Facets;
use incise_mesh::index_u32;
use std::ops::Range;

/// An end of a chain: a node of a curve, or a corner of the sweep inside the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ChainEnd {
    Node(u32),
    /// The corner, and how many parts of the solid contain it up to this one.
    Corner {
        corner: u32,
        level: u32,
    },
}

/// The ends of a chain in the direction of its edge.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ends {
    pub(super) edge: u32,
    pub(super) ends: [ChainEnd; 2],
    pub(super) is_inverted: bool,
}

impl Chains {
    /// Returns the tip at an end of a sweep edge and whether the edge is inside the body there.
    fn tip_at(&self, facets: &Facets, edge: u32, end: usize, solid: u32) -> Option<(u32, bool)> {
        let corner = facets.edges()[edge as usize].ends[end];
        let from = self.tips.partition_point(|tip| tip.corner < corner);
        let own = self.tips[from..]
            .iter()
            .take_while(|tip| tip.corner == corner);
        let own = own.filter(|tip| tip.solid == solid);
        let own = own.map(|tip| (tip.node, tip.inside.contains(&edge)));
        // Of two parts of the tip that end at a corner, the edge is inside at one.
        own.max_by_key(|&(_, is_inside)| is_inside)
    }

    /// Counts how often each corner of the sweep that is on no tip is inside the solid.
    ///
    /// `starts_inside` returns whether the sweep's first corner is inside the body. It is called if
    /// the sweep's boundary is less inside elsewhere.
    pub(super) fn count_windings(
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
    pub(super) fn find_ends(&mut self, facets: &Facets, own: Range<usize>, solid: u32) {
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
}
