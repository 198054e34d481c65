//! The segment in which a mesh triangle and a facet intersect.

use crate::error::CutError;
use crate::intersection::facets::{Facets, Shared};
use incise_mesh::{HalfEdge, Surface, TriangleId, Vec3, VertexId};

/// The place at which a segment of a curve enters or leaves a mesh triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    /// Across the edge of this half-edge of the mesh triangle.
    Mesh(HalfEdge),
    /// Across this edge of the facet: onto the next one, or nowhere at the sweep's boundary.
    Sweep(u32),
    /// At a vertex of the tip that the sweep continues.
    Tip(VertexId),
}

/// The segment of a curve in one mesh triangle and one facet.
///
/// The inside of the body is on its left, seen against the facet's normal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    pub(super) triangle: TriangleId,
    pub(super) facet: u32,
    pub(super) from: End,
    pub(super) to: End,
    /// Whether a curve has run along it.
    pub(super) is_seen: bool,
}

/// Appends the segments of curves in one mesh triangle.
pub(super) fn meet(
    surface: &Surface,
    facets: &Facets,
    triangle: TriangleId,
    segments: &mut Vec<Segment>,
) -> Result<(), CutError> {
    let vertices = surface.topology().triangle(triangle);
    let corners = vertices.map(|v| surface.position(v));
    for (v, p) in vertices.into_iter().zip(&corners) {
        if !p.iter().all(|x| x.is_finite()) {
            return Err(CutError::VertexNotFinite { vertex: v });
        }
    }
    let own = (0..facets.len()).filter(|&i| facets.exists(i) && facets.may_touch(i, &corners));
    segments.extend(own.filter_map(|i| match facets.shared(i, vertices) {
        Shared::No => meet_facet(facets, i, triangle, &corners),
        Shared::One {
            facet: k,
            triangle: j,
        } => meet_at_tip(facets, i, k, triangle, vertices[j], j, &corners),
        Shared::Edge => None,
    }));
    Ok(())
}

fn meet_facet(
    facets: &Facets,
    facet: u32,
    triangle: TriangleId,
    corners: &[Vec3; 3],
) -> Option<Segment> {
    let above = corners.map(|p| facets.is_above(facet, p));
    // Of the three edges one falls and one rises, unless all corners are on one side.
    let rises = (0..3).find(|&k| !above[k] && above[(k + 1) % 3])?;
    let falls = (0..3).find(|&k| above[k] && !above[(k + 1) % 3])?;
    let inside = |k: usize| {
        let (p, q) = (corners[k], corners[(k + 1) % 3]);
        facets.inside(facet, p, q, above[(k + 1) % 3])
    };
    let (entry, exit) = (inside(falls), inside(rises));
    let mut out = [(entry, falls), (exit, rises)].map(|(inside, k)| {
        let h = triangle.half_edges()[k];
        (inside == [true; 3]).then_some(End::Mesh(h))
    });
    if out.contains(&None) {
        // On the outer side of one sweep edge as a whole: the common case of a triangle beyond the
        // sweep.
        if (0..3).any(|side| !entry[side] && !exit[side]) {
            return None;
        }
        // Clipped by the sweep edges that it passes. Going in where the entry is beyond the edge.
        for (side, edge) in facets.edges_of(facet).into_iter().enumerate() {
            if entry[side] != exit[side] && facets.pierces(edge, *corners) {
                out[usize::from(entry[side])] = Some(End::Sweep(edge));
            }
        }
    }
    let [Some(from), Some(to)] = out else {
        return None;
    };
    Some(Segment {
        triangle,
        facet,
        from,
        to,
        is_seen: false,
    })
}

/// Returns the segment in a triangle and a facet that have `vertex`, their corners `j` and `k`, in
/// common.
///
/// It runs from there to the opposite side of one of them, if it is not a point.
fn meet_at_tip(
    facets: &Facets,
    facet: u32,
    k: usize,
    triangle: TriangleId,
    vertex: VertexId,
    j: usize,
    corners: &[Vec3; 3],
) -> Option<Segment> {
    let (p, q) = (corners[(j + 1) % 3], corners[(j + 2) % 3]);
    let [is_above, rises] = [p, q].map(|x| facets.is_above(facet, x));
    if is_above == rises {
        return None;
    }
    let inside = facets.inside(facet, p, q, rises);
    let opposite = (k + 1) % 3;
    let other = match inside {
        [true, true, true] => End::Mesh(triangle.half_edges()[(j + 1) % 3]),
        _ if (0..3).any(|side| side != opposite && !inside[side]) => return None,
        _ => End::Sweep(facets.edges_of(facet)[opposite]),
    };
    let tip = End::Tip(vertex);
    let (from, to) = if rises { (tip, other) } else { (other, tip) };
    Some(Segment {
        triangle,
        facet,
        from,
        to,
        is_seen: false,
    })
}
