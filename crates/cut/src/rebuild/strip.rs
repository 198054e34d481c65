//! Hit triangles in the order in which the sweep passes them: closed strips.

use super::crossing::{Hit, Signs};
use crate::error::CutError;
use incise_mesh::{Surface, TriangleId};

/// Hit triangles, each entered through the edge by which the one before was left; the last leads
/// to the first. The positive side is where the entry half-edges run to.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Strip {
    pub(crate) hits: Vec<Hit>,
}

/// All closed strips among `candidates`, in order of their first triangle.
///
/// # Errors
/// [`CutError::PartialCut`] where the sweep ends inside the body, [`CutError::OpenSurface`] at a
/// boundary, [`CutError::SideConflict`] and [`CutError::VertexNotFinite`] as they say.
pub(crate) fn trace(
    surface: &Surface,
    signs: &Signs,
    candidates: &mut Vec<TriangleId>,
) -> Result<Vec<Strip>, CutError> {
    candidates.sort_unstable();
    let mut hits: Vec<Hit> = Vec::new();
    for &t in &*candidates {
        hits.extend(signs.hit(surface, t)?);
    }
    let topology = surface.topology();
    let mut seen = vec![false; hits.len()];
    let mut strips = Vec::new();
    for start in 0..hits.len() {
        if seen[start] {
            continue;
        }
        let mut strip = Strip::default();
        let mut at = start;
        while !std::mem::replace(&mut seen[at], true) {
            let hit = hits[at];
            strip.hits.push(hit);
            let entry = topology.twin(hit.exit);
            if entry.is_null() {
                return Err(CutError::OpenSurface {
                    triangle: hit.triangle,
                });
            }
            // Both triangles of an edge test it alike, so the neighbor is hit and entered here.
            at = hits
                .binary_search_by_key(&entry.triangle(), |h| h.triangle)
                .map_err(|_| CutError::PartialCut {
                    triangle: entry.triangle(),
                })?;
        }
        strips.push(strip);
    }
    check_sides(surface, &hits)?;
    Ok(strips)
}

/// A vertex must be on one side of the whole sweep.
fn check_sides(surface: &Surface, hits: &[Hit]) -> Result<(), CutError> {
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
        Some(pair) => Err(CutError::SideConflict { vertex: pair[0].0 }),
        None => Ok(()),
    }
}
