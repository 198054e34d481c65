//! Tips of cuts, lists of their vertices: what a step and other cuts change.

use super::TipPoint;
use super::columns::is_at_boundary;
use incise_mesh::{Surface, VertexId};

/// Removes the parts of a tip that other cuts have removed.
pub(super) fn remove_cut(tip: &mut Vec<TipPoint>, surface: &Surface) {
    let topology = surface.topology();
    tip.retain(|point| {
        point.vertex.index() < topology.vertex_slots()
            && !topology.outgoing(point.vertex).is_null()
            && surface.rest_position(point.vertex) == point.rest
    });
    for i in 0..tip.len() {
        let next = tip.get(i + 1).map(|next| next.vertex);
        let own = tip[i].vertex;
        tip[i].is_joined &= next.is_some_and(|next| topology.find_half_edge(own, next).is_some());
    }
    for i in 0..tip.len() {
        let next = tip.get(i + 1).map(|next| next.parameter);
        tip[i].meets_next &= next == Some(tip[i].parameter);
    }
    // A single vertex is the tip of a sheet.
    let joined: Vec<bool> = tip.iter().map(|point| point.is_joined).collect();
    let mut i = 0;
    tip.retain(|point| {
        i += 1;
        joined[i - 1] || (i > 1 && joined[i - 2]) || is_at_boundary(surface, point.vertex)
    });
}

/// Extends the vertices behind an end of the blade by those of a step, up to an end of the tip.
///
/// An end of the tip that stands still has none.
pub(super) fn extend_border(border: &mut Vec<VertexId>, own: &[VertexId], end: Option<&TipPoint>) {
    let end = end.filter(|end| end.is_inner).map(|end| end.vertex);
    if end.is_some() && own.last().copied() == end {
        if border.last() == own.first() {
            border.pop();
        } else {
            border.clear();
        }
        border.extend_from_slice(own);
    } else if border.last().copied() != end {
        border.clear();
    }
}

/// Returns a tip with the vertices of the last one that keep their places, in order.
///
/// A part that has moved begins and ends at such vertices, or where the last tip did.
pub(super) fn with_standing(
    moved: Vec<TipPoint>,
    last: &[TipPoint],
    stands: &[bool],
) -> Vec<TipPoint> {
    let mut tip = moved;
    for point in &mut tip {
        let known = last.iter().find(|known| known.vertex == point.vertex);
        point.is_inner |= known.is_some_and(|known| known.is_inner);
    }
    let is_kept = |i: usize| {
        let stays = |i: usize| stands.get(i) == Some(&true);
        stays(i) && last[i].is_joined && stays(i + 1)
    };
    for i in (0..last.len().saturating_sub(1)).filter(|&i| is_kept(i)) {
        let place = |tip: &[TipPoint], v: VertexId| tip.iter().position(|p| p.vertex == v);
        let [from, to] = [last[i], last[i + 1]];
        match (place(&tip, from.vertex), place(&tip, to.vertex)) {
            (Some(at), None) => {
                tip[at].is_joined = true;
                tip.insert(
                    at + 1,
                    TipPoint {
                        is_joined: false,
                        ..to
                    },
                );
            }
            (None, Some(at)) => tip.insert(at, from),
            (Some(at), Some(_)) => tip[at].is_joined = true,
            (None, None) => {
                let at = tip.partition_point(|p| p.parameter <= from.parameter);
                let end = TipPoint {
                    is_joined: false,
                    ..to
                };
                tip.splice(at..at, [from, end]);
            }
        }
    }
    tip
}
