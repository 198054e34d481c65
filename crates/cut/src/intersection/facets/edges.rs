//! Edges of the sweep: between two facets, or on its boundary.

use super::{Facets, NO_FACET};
use incise_mesh::{Vec3, index_u32};

/// An edge of the sweep's facets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SweepEdge {
    pub(crate) ends: [u32; 2],
    /// The facet on its left and the one on its right, [`NO_FACET`] at the sweep's boundary.
    pub(crate) facets: [u32; 2],
    /// Whether the surface is opened along it by identity.
    pub(crate) is_tip: bool,
}

impl SweepEdge {
    /// Returns whether the edge is between two facets; else it is part of the sweep's boundary.
    pub(crate) fn is_crease(&self) -> bool {
        !self.facets.contains(&NO_FACET)
    }
}

/// The kinds of edges of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum EdgeKind {
    /// From a previous point to the same point now.
    Rib,
    /// Across two neighbors.
    Diagonal,
    /// Between two neighbors in the previous frame.
    Previous,
    /// Between two neighbors in the current frame.
    Current,
}

impl Facets {
    /// Returns the largest coordinate of the ends of diagonals \[m\].
    pub(crate) fn largest_diagonal(&self) -> f64 {
        let edges =
            (0..index_u32(self.edges.len())).filter(|&e| self.kind(e) == EdgeKind::Diagonal);
        let ends = edges.flat_map(|edge| self.ends(edge));
        ends.fold(0.0, |largest, p| p.amax().max(largest))
    }

    /// Returns the length of the shorter rib beside a facet \[m\], or of the only one.
    pub(crate) fn motion(&self, facet: u32) -> f64 {
        let lengths = [facet / 2, facet / 2 + 1].map(|rib| {
            let [from, to] = self.ends(rib);
            (to - from).norm()
        });
        let moved = lengths.into_iter().filter(|&length| length > 0.0);
        moved.min_by(f64::total_cmp).unwrap_or_default()
    }

    /// Returns the facet nearest to a point and the crease of that facet nearest to it.
    ///
    /// No crease for a facet that has none. Sweeps without area have no facet.
    pub(crate) fn nearest(&self, p: Vec3) -> Option<(u32, Option<u32>)> {
        let existing = (0..self.len()).filter(|&i| self.exists(i));
        let distances = existing.map(|i| (i, self.miss(i, p)));
        let (facet, _) = distances.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let sides = (0..3).map(|k| (self.edges_of(facet)[k], self.outside(facet, k, p)));
        let creases = sides.filter(|&(edge, _)| self.edges[edge as usize].is_crease());
        let crease = creases.max_by(|a, b| a.1.total_cmp(&b.1));
        Some((facet, crease.map(|(edge, _)| edge)))
    }

    /// Returns the kind of an edge.
    pub(crate) fn kind(&self, edge: u32) -> EdgeKind {
        let ribs = index_u32(self.corners.len() / 2);
        match edge.checked_sub(ribs).map(|i| i % 3) {
            None => EdgeKind::Rib,
            Some(0) => EdgeKind::Diagonal,
            Some(1) => EdgeKind::Previous,
            Some(_) => EdgeKind::Current,
        }
    }

    /// Returns the pair of neighbors on the polyline at which a diagonal, previous or current edge
    /// lies; for others none.
    pub(crate) fn pair_of(&self, edge: u32) -> Option<u32> {
        let ribs = index_u32(self.corners.len() / 2);
        edge.checked_sub(ribs).map(|i| i / 3)
    }

    /// Returns whether parts of an edge inside the body become chains.
    ///
    /// Not where the sweep continues a tip, nor on edges of triangles without area alone.
    pub(crate) fn may_have_chain(&self, edge: u32) -> bool {
        let SweepEdge { facets, is_tip, .. } = self.edges[edge as usize];
        facets != [NO_FACET; 2] && !is_tip
    }

    /// Returns the facet on the left of the edge from one corner to another, if there is one.
    pub(crate) fn left_of(&self, [from, to]: [u32; 2]) -> Option<u32> {
        self.edges.iter().find_map(|edge| {
            let is_own = |ends: [u32; 2]| edge.ends == ends;
            let facet = match (is_own([from, to]), is_own([to, from])) {
                (true, _) => edge.facets[0],
                (_, true) => edge.facets[1],
                _ => NO_FACET,
            };
            (facet != NO_FACET).then_some(facet)
        })
    }

    /// Returns the facet at the previous edge before a corner, or the first one.
    pub(crate) fn before(&self, corner: u32) -> u32 {
        let points = index_u32(self.corner_count() / 2);
        2 * (corner % points).saturating_sub(1)
    }

    /// Returns the edges around a corner on the sweep's boundary, counterclockwise, each with the
    /// facet that follows.
    pub(crate) fn fan(&self, corner: u32) -> Vec<(u32, u32)> {
        // The facets on the left and on the right, seen from the corner.
        let beside = |edge: &SweepEdge| {
            let [left, right] = edge.facets;
            if edge.ends[0] == corner {
                [left, right]
            } else {
                [right, left]
            }
        };
        let own = (0..).zip(&self.edges);
        let own = own.filter(|(_, e)| e.ends.contains(&corner) && e.facets != [NO_FACET; 2]);
        let own: Vec<(u32, [u32; 2])> = own.map(|(i, e)| (i, beside(e))).collect();
        let mut fan = Vec::with_capacity(own.len());
        let mut behind = NO_FACET;
        while let Some(&(edge, [ahead, _])) = own.iter().find(|(_, facets)| facets[1] == behind) {
            fan.push((edge, ahead));
            behind = ahead;
            if ahead == NO_FACET {
                break;
            }
        }
        fan
    }

    /// Returns the facet beyond an edge of facet `i`, [`NO_FACET`] at the sweep's boundary.
    pub(crate) fn beyond_edge(&self, i: u32, edge: u32) -> u32 {
        let [left, right] = self.edges[edge as usize].facets;
        if left == i { right } else { left }
    }

    /// Returns the distance of `p` from the line of a sweep edge \[m\].
    pub(crate) fn off_edge(&self, edge: u32, p: Vec3) -> f64 {
        let [start, end] = self.ends(edge);
        let along = end - start;
        along.cross(&(p - start)).norm() / along.norm()
    }
}
