//! What must hold after every cut, whatever was cut.

mod delta;
mod exact;
mod section;

pub use exact::assert_section_is_covered;

use delta::assert_delta_is_true;
use exact::assert_exact;
use incise_cut::{CutError, CutMethod, CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::{EdgeKey, Surface, TriangleId, VertexId};
use std::collections::{BTreeMap, BTreeSet};

/// Asserts that a surface is sound: valid arrays, closed, oriented, one fan around each vertex, every
/// pair of neighbors joined by one edge, every piece one connected component.
///
/// # Panics
/// When it is not.
pub fn assert_sound(surface: &Surface) {
    let topology = surface.topology();
    topology
        .validate()
        .expect("the corner table is as it should be");
    assert!(topology.is_closed(), "the surface is open");
    let mut valence = vec![0; topology.vertex_slots()];
    let mut directed = Vec::with_capacity(3 * topology.triangle_count());
    for t in topology.triangles() {
        for h in t.half_edges() {
            valence[topology.origin(h).index()] += 1;
            let edge = (topology.origin(h), topology.target(h));
            directed.push(edge);
        }
    }
    // Twins run against each other, so each direction once means each edge twice.
    directed.sort_unstable();
    let twice = directed.windows(2).find(|w| w[0] == w[1]);
    assert_eq!(twice, None, "two half-edges run along an edge");
    for v in topology.vertices() {
        let fan = topology.outgoing_fan(v).count();
        assert_eq!(fan, valence[v.index()], "{v} has more than one fan");
        assert!(fan >= 3, "only {fan} triangles around {v}");
    }
    let labels = topology.component_labels();
    let mut pairs: Vec<(u32, u32)> = (topology.triangles())
        .map(|t| (surface.piece(t), labels[t.index()]))
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    let pieces: BTreeSet<u32> = pairs.iter().map(|p| p.0).collect();
    let components: BTreeSet<u32> = pairs.iter().map(|p| p.1).collect();
    assert_eq!(
        (pieces.len(), components.len()),
        (pairs.len(), pairs.len()),
        "pieces and connected components differ: {pairs:?}"
    );
    assert_eq!(
        [surface.positions.len(), surface.rest.len()],
        [topology.vertex_slots(); 2],
        "vertex data does not fit the vertices"
    );
    for array in [surface.corners.uv.len(), surface.corners.normal.len()] {
        assert!(
            array == 0 || array == 3 * topology.triangle_slots(),
            "corner attributes do not fit the corners"
        );
    }
}

/// Asserts that two surfaces are the same bit for bit, free slots included.
///
/// # Panics
/// When they differ.
pub fn assert_same_bits(a: &Surface, b: &Surface) {
    assert_eq!(a.topology(), b.topology(), "the connectivity differs");
    assert!(bits(&a.positions) == bits(&b.positions), "positions differ");
    assert!(bits(&a.rest) == bits(&b.rest), "rest positions differ");
    let same_uv = bits(&a.corners.uv) == bits(&b.corners.uv);
    let same_normals = bits(&a.corners.normal) == bits(&b.corners.normal);
    assert!(same_uv && same_normals, "corner attributes differ");
    for t in a.topology().triangles() {
        assert_eq!(a.piece(t), b.piece(t), "the piece of {t}");
        assert_eq!(a.material(t), b.material(t), "the material of {t}");
    }
    assert_eq!(a.piece_bound(), b.piece_bound(), "the next piece differs");
}

fn bits<const N: usize>(values: &[[f32; N]]) -> Vec<[u32; N]> {
    values.iter().map(|v| v.map(f32::to_bits)).collect()
}

/// Vertices - edges + triangles of every piece.
#[must_use]
pub fn euler_characteristics(surface: &Surface) -> BTreeMap<u32, i64> {
    let topology = surface.topology();
    let mut sums = vec![None; surface.piece_bound() as usize];
    let mut add = |t: TriangleId, sign: i64| {
        *sums[surface.piece(t) as usize].get_or_insert(0) += sign;
    };
    topology.triangles().for_each(|t| add(t, 1));
    topology.edges().for_each(|h| add(h.triangle(), -1));
    let corner = |v: VertexId| topology.outgoing(v).triangle();
    topology.vertices().for_each(|v| add(corner(v), 1));
    let pieces = (0..).zip(sums);
    pieces
        .filter_map(|(piece, sum)| Some((piece, sum?)))
        .collect()
}

/// Vertices - edges + triangles of a part of a surface.
fn euler_characteristic_of(surface: &Surface, part: &[TriangleId]) -> i64 {
    let topology = surface.topology();
    let half_edges = || part.iter().flat_map(|t| t.half_edges());
    let edges: BTreeSet<EdgeKey> = half_edges()
        .map(|h| EdgeKey::new(topology.origin(h), topology.target(h)))
        .collect();
    let vertices: BTreeSet<VertexId> = half_edges().map(|h| topology.origin(h)).collect();
    let count = |n: usize| i64::try_from(n).expect("parts are small");
    count(vertices.len()) - count(edges.len()) + count(part.len())
}

/// Cuts, and asserts that
///
/// - a refused cut and one that missed leave the same bits;
/// - a cut surface is sound and its search tree fits;
/// - the delta tells all of the difference and nothing else;
/// - Euler's formula knows the cut: to open a surface along loops adds nothing, to close it adds what
///   the caps have, which is 1 for a disc;
/// - all that the exact method promises, see `laws/exact.rs`.
///
/// # Errors
/// [`CutError`] of a refused cut.
///
/// # Panics
/// When one does not hold.
pub fn cut_and_check(
    surface: &mut Surface,
    cutter: &mut Cutter,
    sweep: &Sweep,
    params: &CutParams,
) -> Result<CutOutcome, CutError> {
    let before = surface.clone();
    let result = cutter.cut(surface, sweep, params);
    cutter
        .bvh()
        .validate(surface)
        .expect("the search tree fits the surface");
    let outcome = match result {
        Ok(outcome) if !outcome.delta.is_empty() => outcome,
        other => {
            assert_same_bits(&before, surface);
            return other;
        }
    };
    assert_sound(surface);
    assert_delta_is_true(&before, surface, &outcome.delta);
    let added: BTreeSet<TriangleId> = outcome.delta.triangles_added.iter().copied().collect();
    assert!(
        outcome.cap.iter().all(|t| added.contains(t)),
        "caps are new triangles"
    );
    let sum = |s: &Surface| euler_characteristics(s).values().sum::<i64>();
    let added = match params.method {
        // Two discs a loop.
        CutMethod::Rebuild => 2 * i64::try_from(outcome.report.loops).expect("loops are few"),
        _ => euler_characteristic_of(surface, &outcome.cap),
    };
    assert_eq!(
        sum(surface),
        sum(&before) + added,
        "{} loops cut and closed",
        outcome.report.loops
    );
    if params.method == CutMethod::Exact {
        assert_exact(&before, surface, sweep, params, &outcome);
    }
    Ok(outcome)
}
