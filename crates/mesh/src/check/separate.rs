//! Separation of the sheets that meet at edges of more than two triangles.
//!
//! Patches are triangles connected across edges of two triangles. A patch is loose if it cannot be
//! part of a closed surface: it has a boundary, or ends at patches that all face the same way.
//! Loose patches are detached from the others. What remains is paired around each edge so that the
//! pairs enclose material. Vertices are split accordingly.

mod patches;

use super::Defect;
use super::around::{IncidentTriangle, wedges};
use super::links::{Fans, Links};
use super::repair::{Repaired, rounding};
use super::tally::Tally;
use crate::ids::{EdgeKey, HalfEdge, VertexId};
use crate::io::{MeshData, Warning};
use patches::Patches;

/// Number of attempts to pair triangles such that no two edges have the same ends.
const ATTEMPTS: usize = 8;

/// An edge of more than two triangles.
pub(super) struct NonManifoldEdge {
    pub(super) key: EdgeKey,
    pub(super) spokes: Vec<IncidentTriangle>,
    /// Whether the triangles are in cyclic order; false if one has no area.
    pub(super) is_sorted: bool,
    /// Whether the pairs enclose void instead of material.
    is_inverted: bool,
    /// Numbers of triangles in attached patches: ends of material, starts of material.
    closed: [usize; 2],
}

/// The pairs of triangles at all edges of more than two.
#[derive(Default)]
struct Pairing {
    pairs: Vec<[HalfEdge; 2]>,
    /// Edges of closed surfaces without a unique pairing.
    ambiguous: Vec<EdgeKey>,
}

impl Repaired {
    /// Splits vertices so that no edge has more than two triangles. Patches must be oriented.
    ///
    /// Reports a defect, and splits nothing, if a closed surface can be separated in several ways.
    pub(super) fn separate_sheets(&mut self, data: &MeshData, links: &Links) {
        let mut patches = Patches::new(self, data, links);
        if patches.non_manifold_edges.is_empty() {
            return;
        }
        patches.detach_loose();
        patches.detach_inner_walls();
        let joined = self.triangles.clone();
        for _ in 0..ATTEMPTS {
            let pairing = pair_all(&patches);
            if !pairing.ambiguous.is_empty() {
                self.reject_edges(data, &pairing.ambiguous);
                return;
            }
            let crowded = patches.non_manifold_edges.iter().map(|c| c.key);
            let fans = fans_of_pairs(&joined, links, crowded, &pairing.pairs);
            let mut split = joined.clone();
            let copies = { fans }.split(&mut split, self.vertices.len());
            let bad = Links::new(&split);
            let bad: Vec<HalfEdge> = bad
                .edges()
                .filter(|edge| edge.len() > 2 || !Links::is_consistent(edge, &split))
                .flat_map(|edge| edge.iter().map(|&(_, h)| h))
                .collect();
            if bad.is_empty() {
                self.triangles = split;
                let originals = copies.iter().map(|&v| self.vertices[v as usize]);
                let originals: Vec<u32> = originals.collect();
                self.vertices.extend(originals);
                self.report_separation(&patches, &pairing);
                return;
            }
            // Two pairs have the same ends: joined across the void, they get different ones.
            let stuck = patches.invert(bad);
            if !stuck.is_empty() {
                self.reject_edges(data, &stuck);
                return;
            }
        }
        let all: Vec<EdgeKey> = patches.non_manifold_edges.iter().map(|c| c.key).collect();
        self.reject_edges(data, &all);
    }

    fn reject_edges(&mut self, data: &MeshData, edges: &[EdgeKey]) {
        if let Some(first) = edges.first() {
            let [a, b] = first.vertices().map(|v| self.vertices[v.index()]);
            self.defects.push(Defect::NonManifoldEdge {
                a: VertexId(a),
                b: VertexId(b),
                at: data.file_position(a),
                count: edges.len(),
                rounding: rounding(data),
            });
        }
    }

    fn report_separation(&mut self, patches: &Patches, pairing: &Pairing) {
        if let Some(first) = patches.non_manifold_edges.first() {
            let [a, b] = first.key.vertices().map(|v| self.vertices[v.index()]);
            self.warnings.push(Warning::EdgesSplit {
                a: VertexId(a),
                b: VertexId(b),
                count: patches.non_manifold_edges.len(),
            });
        }
        let mut is_paired = vec![false; 3 * self.triangles.len()];
        for h in pairing.pairs.iter().flatten() {
            is_paired[h.index()] = true;
        }
        let mut detached = vec![false; self.triangles.len()];
        for spoke in patches.non_manifold_edges.iter().flat_map(|c| &c.spokes) {
            detached[spoke.patch as usize] |= !is_paired[spoke.half_edge.index()];
        }
        let mut tally = Tally::default();
        for (&is_detached, &source) in detached.iter().zip(&self.sources) {
            tally.note(is_detached, source);
        }
        if let Some((triangle, count)) = tally.found() {
            self.warnings
                .push(Warning::SheetsDetached { triangle, count });
        }
    }
}

/// Returns the pairs at all edges.
fn pair_all(patches: &Patches) -> Pairing {
    let mut out = Pairing::default();
    for crowd in &patches.non_manifold_edges {
        let (loose, closed): (Vec<IncidentTriangle>, Vec<IncidentTriangle>) = crowd
            .spokes
            .iter()
            .partition(|s| patches.is_loose[s.patch as usize]);
        let (pairs, rest) = pair(crowd, &closed);
        out.pairs.extend(pairs);
        if rest > 0 {
            out.ambiguous.push(crowd.key);
        }
        out.pairs.extend(pair(crowd, &loose).0);
    }
    out
}

/// Pairs some of the triangles of an edge, and returns the number of those without a partner.
///
/// Two triangles are a pair, and so are neighbors that bound a wedge of material. Else the two
/// triangles of the same patch are a pair.
fn pair(crowd: &NonManifoldEdge, spokes: &[IncidentTriangle]) -> (Vec<[HalfEdge; 2]>, usize) {
    if let [p, q] = spokes
        && p.starts != q.starts
    {
        return (vec![[p.half_edge, q.half_edge]], 0);
    }
    if crowd.is_sorted
        && let Some(pairs) = wedges(spokes, crowd.is_inverted)
    {
        return (pairs, 0);
    }
    let mut by_patch = spokes.to_vec();
    by_patch.sort_unstable_by_key(|s| (s.patch, s.half_edge));
    let mut rest = 0;
    let mut pairs = Vec::new();
    for own in by_patch.chunk_by(|p, q| p.patch == q.patch) {
        match own {
            [p, q] if p.starts != q.starts => pairs.push([p.half_edge, q.half_edge]),
            _ => rest += own.len(),
        }
    }
    (pairs, rest)
}

/// Returns the fans of triangles that edges of two triangles and `pairs` connect.
///
/// Vertices without a crowded edge stay whole.
fn fans_of_pairs(
    triangles: &[[u32; 3]],
    links: &Links,
    crowded: impl Iterator<Item = EdgeKey>,
    pairs: &[[HalfEdge; 2]],
) -> Fans {
    let vertices = triangles.iter().flatten().max();
    let mut is_crowded = vec![false; vertices.map_or(0, |&v| v as usize + 1)];
    for key in crowded {
        for v in key.vertices() {
            is_crowded[v.index()] = true;
        }
    }
    let mut fans = Fans::single(3 * triangles.len());
    let mut first_corner = vec![HalfEdge::NULL; is_crowded.len()];
    for h in (0..3 * triangles.len()).map(HalfEdge::from_index) {
        let v = triangles[h.index() / 3][h.index() % 3] as usize;
        if is_crowded[v] {
            continue;
        }
        if first_corner[v].is_null() {
            first_corner[v] = h;
        }
        fans.join(first_corner[v], h);
    }
    for edge in links.edges() {
        if let [(_, h), (_, g)] = *edge {
            fans.join_across(triangles, h, g);
        }
    }
    for &[h, g] in pairs {
        fans.join_across(triangles, h, g);
    }
    fans
}

#[cfg(test)]
mod tests;
