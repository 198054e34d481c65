//! Questions about the curves of a cut: sizes, ends, and which of them are capped.

use super::{Curve, Trace};
use crate::intersection::facets::{EdgeKind, Facets};
use crate::intersection::node::{Node, On};
use incise_mesh::{Surface, TriangleId};

/// Number of edges of a curve beside an end at which nothing is merged.
const NEAR_END: usize = 2;

/// The parts of a sweep's boundary that must be outside of the body.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Outside {
    /// The blade's previous edge.
    pub(crate) previous: bool,
    /// The first and the last rib.
    pub(crate) ribs: [bool; 2],
}

impl Outside {
    fn has(self, facets: &Facets, edge: u32) -> bool {
        let ribs = facets.corner_count() / 2;
        match facets.kind(edge) {
            EdgeKind::Previous => self.previous,
            EdgeKind::Rib => {
                let at = edge as usize;
                (at == 0 && self.ribs[0]) || (at + 1 == ribs && self.ribs[1])
            }
            EdgeKind::Diagonal | EdgeKind::Current => false,
        }
    }
}

impl Trace {
    /// Returns the number of mesh triangles that the curves cross.
    pub(crate) fn hits(&self) -> usize {
        let hits = self.chords.chunk_by(|a, b| a.triangle == b.triangle);
        hits.count()
    }

    /// Returns the mean edge length around the nodes \[m\].
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 nodes")]
    pub(crate) fn mean_local(&self) -> f64 {
        let sum: f64 = self.nodes.iter().map(|node| node.local).sum();
        sum / self.nodes.len() as f64
    }

    /// Returns the largest edge length around a node \[m\].
    pub(crate) fn max_local(&self) -> f64 {
        self.nodes.iter().fold(0.0, |m, node| node.local.max(m))
    }

    /// Returns whether a curve ends on the sweep's boundary.
    pub(crate) fn has_end(&self, curve: &Curve) -> bool {
        self.ends(curve).any(|end| end.is_end)
    }

    /// Iterates over the first and the last node of an open curve.
    fn ends(&self, curve: &Curve) -> impl Iterator<Item = &Node> {
        let ends = [curve.nodes.start, curve.nodes.end - 1].into_iter();
        let ends = ends.filter(|_| !curve.is_closed);
        ends.map(|end| &self.nodes[end as usize])
    }

    /// Returns the smallest barycentric weight of an end of a curve in its mesh triangle, or the
    /// shortest edge of a curve beside an end [local edge lengths] if that is less.
    ///
    /// Snapping merges points elsewhere, but not there.
    pub(crate) fn end_clearance(&self) -> f64 {
        let mut least = f64::INFINITY;
        for curve in self.curves.iter().filter(|curve| self.has_end(curve)) {
            let nodes = &self.nodes[curve.nodes.start as usize..curve.nodes.end as usize];
            for node in nodes.iter().filter(|node| node.is_end) {
                if let On::Face { weights, .. } = node.on {
                    least = weights.iter().fold(least, |m, &w| f64::from(w).min(m));
                }
            }
            let last = nodes.len() - 1;
            let beside = (0..last).filter(|&i| i < NEAR_END || i + NEAR_END >= last);
            for (a, b) in beside.map(|i| (&nodes[i], &nodes[i + 1])) {
                if !a.is_between_facets() && !b.is_between_facets() {
                    let length = (b.position - a.position).norm();
                    least = least.min(length / a.local.min(b.local));
                }
            }
        }
        least
    }

    /// Returns a mesh triangle that the sweep's boundary pierces, if a curve ends there.
    pub(crate) fn open_end(&self, surface: &Surface) -> Option<TriangleId> {
        let mut ends = (self.curves.iter()).flat_map(|curve| self.ends(curve));
        ends.find(|end| end.is_end).map(|end| end.triangle(surface))
    }

    /// Returns a mesh triangle in which a curve ends at a part of the sweep's boundary that must be
    /// outside of the body.
    pub(crate) fn end_outside(
        &self,
        surface: &Surface,
        facets: &Facets,
        outside: Outside,
    ) -> Option<TriangleId> {
        let mut ends = (self.curves.iter()).flat_map(|curve| self.ends(curve));
        let is_outside = |edge: u32| outside.has(facets, edge);
        let end = ends.find(|end| end.is_end && end.sweep_edge().is_some_and(is_outside))?;
        Some(end.triangle(surface))
    }

    /// Sets which curves bound sections with caps: those for whose piece and closedness
    /// `is_capped` holds.
    pub(crate) fn set_capped(&mut self, surface: &Surface, is_capped: impl Fn(u32, bool) -> bool) {
        for curve in &mut self.curves {
            let triangle = self.nodes[curve.nodes.start as usize].triangle(surface);
            curve.is_capped = is_capped(surface.piece(triangle), curve.is_closed);
        }
    }
}
