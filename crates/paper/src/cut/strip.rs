//! Hit triangles in the order in which the sweep passes them: closed strips (Algorithm 2, lines 4
//! to 12).
//!
//! The edges that the sweep crosses are those of the exact intersection curves. A bent sweep may
//! cross an edge twice; its ends are then on the same side, and the edge counts as not crossed.

use crate::error::PaperError;
use incise_cut::EdgeCrossing;
use incise_mesh::{EdgeKey, HalfEdge, Surface, TriangleId};

/// A triangle that the sweep crosses: in through one edge, out through another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hit {
    pub(super) triangle: TriangleId,
    /// Half-edge of the triangle that runs from the negative to the positive side.
    pub(super) entry: HalfEdge,
    /// Half-edge of the triangle that runs from the positive to the negative side.
    pub(super) exit: HalfEdge,
    /// The crossing of the edge of `entry`.
    pub(super) crossing: EdgeCrossing,
}

/// A closed strip of hit triangles.
///
/// Each is entered through the edge by which the one before was left; the last leads to the first.
/// The positive side is the one to which entry half-edges run.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Strip {
    pub(super) hits: Vec<Hit>,
}

/// Returns the closed strips of the crossings of closed curves, in order of their first triangle.
///
/// # Errors
/// [`PaperError::SideConflict`] where the sweep passes a vertex on both sides.
pub(super) fn strips(
    surface: &Surface,
    crossings: &[EdgeCrossing],
) -> Result<Vec<Strip>, PaperError> {
    let topology = surface.topology();
    let hits = hits(surface, crossings)?;
    let mut seen = vec![false; hits.len()];
    let mut strips = Vec::new();
    for start in 0..hits.len() {
        if seen[start] {
            continue;
        }
        let mut strip = Strip::default();
        let mut at = start;
        while !std::mem::replace(&mut seen[at], true) {
            strip.hits.push(hits[at]);
            let next = topology.twin(hits[at].exit).triangle();
            at = hits
                .binary_search_by_key(&next, |hit| hit.triangle)
                .expect("both triangles of a crossed edge are hit");
        }
        strips.push(strip);
    }
    check_sides(surface, &hits)?;
    Ok(strips)
}

/// Returns the hit triangles, ascending.
fn hits(surface: &Surface, crossings: &[EdgeCrossing]) -> Result<Vec<Hit>, PaperError> {
    let topology = surface.topology();
    let key = |crossing: &EdgeCrossing| EdgeKey::new(crossing.ends[0], crossing.ends[1]);
    let mut crossed: Vec<(EdgeKey, HalfEdge, usize)> = (crossings.iter().enumerate())
        .map(|(number, crossing)| (key(crossing), crossing.half_edge, number))
        .collect();
    crossed.sort_unstable();
    // Every crossed edge is the entry of one of its triangles and the exit of the other.
    let mut sides: Vec<(TriangleId, HalfEdge, Option<usize>)> = Vec::new();
    for group in crossed.chunk_by(|a, b| a.0 == b.0) {
        let (_, rising, number) = group[0];
        if group.len() % 2 == 1 {
            let falling = topology.twin(rising);
            sides.push((rising.triangle(), rising, Some(number)));
            sides.push((falling.triangle(), falling, None));
        }
    }
    sides.sort_unstable();
    let hit = |group: &[(TriangleId, HalfEdge, Option<usize>)]| match *group {
        [(triangle, entry, Some(number)), (_, exit, None)]
        | [(triangle, exit, None), (_, entry, Some(number))] => Ok(Hit {
            triangle,
            entry,
            exit,
            crossing: crossings[number],
        }),
        _ => Err(PaperError::SideConflict {
            vertex: topology.origin(group[0].1),
        }),
    };
    sides.chunk_by(|a, b| a.0 == b.0).map(hit).collect()
}

/// Checks that every vertex is on one side of the whole sweep.
fn check_sides(surface: &Surface, hits: &[Hit]) -> Result<(), PaperError> {
    let topology = surface.topology();
    let mut sides: Vec<_> = hits
        .iter()
        .flat_map(|hit| {
            [hit.entry, hit.exit].into_iter().flat_map(|h| {
                let rises = h == hit.entry;
                [(topology.origin(h), !rises), (topology.target(h), rises)]
            })
        })
        .collect();
    sides.sort_unstable();
    sides.dedup();
    match sides.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some(pair) => Err(PaperError::SideConflict { vertex: pair[0].0 }),
        None => Ok(()),
    }
}
