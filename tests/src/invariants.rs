//! Invariants of every cut, as assertions.

mod delta;
mod exact;
mod folds;
mod section;

pub use exact::assert_caps_cover_section;
pub use folds::assert_no_fold_added;

use delta::assert_delta_matches;
use exact::assert_exact;
use incise_cut::{CutError, CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::{EdgeKey, Surface, TriangleId, VertexId};
use incise_paper::{PaperError, PaperParams};
use std::collections::{BTreeMap, BTreeSet};

/// Asserts that a surface is a closed manifold of whole pieces.
///
/// # Panics
/// If [`Surface::validate_closed`] fails.
pub fn assert_closed_manifold(surface: &Surface) {
    if let Err(error) = surface.validate_closed() {
        panic!("the surface is not a closed manifold: {error}");
    }
}

/// Asserts that two surfaces are equal bit for bit, including free slots.
///
/// # Panics
/// If they differ.
pub fn assert_same_bits(a: &Surface, b: &Surface) {
    assert_eq!(a.topology(), b.topology(), "the connectivity differs");
    assert!(
        bits(a.positions()) == bits(b.positions()),
        "positions differ"
    );
    assert!(
        bits(a.rest_positions()) == bits(b.rest_positions()),
        "rest positions differ"
    );
    let same_uv = bits(a.corner_uvs()) == bits(b.corner_uvs());
    let same_normals = bits(a.corner_normals()) == bits(b.corner_normals());
    assert!(same_uv && same_normals, "corner attributes differ");
    for (a, b) in a.channels().iter().zip(b.channels()) {
        let bits = |values: &[f32]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert!(
            bits(a.values()) == bits(b.values()),
            "channel {} differs",
            a.name()
        );
    }
    for t in a.topology().triangles() {
        assert_eq!(a.piece(t), b.piece(t), "the piece of {t}");
        assert_eq!(a.material(t), b.material(t), "the material of {t}");
    }
    assert_eq!(a.piece_bound(), b.piece_bound(), "the next piece differs");
}

fn bits<const N: usize>(values: &[[f32; N]]) -> Vec<[u32; N]> {
    values.iter().map(|v| v.map(f32::to_bits)).collect()
}

/// Returns vertices - edges + triangles of every piece.
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

/// Returns vertices - edges of the boundary of a part: 0 for loops, less where they share vertices.
fn boundary_characteristic_of(surface: &Surface, part: &[TriangleId]) -> i64 {
    let topology = surface.topology();
    let own: BTreeSet<TriangleId> = part.iter().copied().collect();
    let half_edges = part.iter().flat_map(|t| t.half_edges());
    let rim: Vec<_> = half_edges
        .filter(|&h| !own.contains(&topology.twin(h).triangle()))
        .collect();
    let vertices: BTreeSet<VertexId> = rim.iter().map(|&h| topology.origin(h)).collect();
    let count = |n: usize| i64::try_from(n).expect("parts are small");
    count(vertices.len()) - count(rim.len())
}

/// Returns vertices - edges + triangles of a part of a surface.
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

/// Cuts, and asserts the invariants of the result:
///
/// - a failed cut and a miss leave every bit of the surface;
/// - the result is a closed manifold and the BVH matches it;
/// - the delta lists the whole difference and nothing else;
/// - the Euler characteristic grows by that of the caps, which is 1 for a disk, less that of their
///   boundary, which is 0 for loops;
/// - it folds the skin nowhere, see [`assert_no_fold_added`];
/// - those of `invariants/exact.rs`.
///
/// # Errors
/// [`CutError`] of a failed cut.
///
/// # Panics
/// If an invariant does not hold.
pub fn cut_and_check(
    surface: &mut Surface,
    cutter: &mut Cutter,
    sweep: &Sweep,
    params: &CutParams,
) -> Result<CutOutcome, CutError> {
    let before = surface.clone();
    let result = cutter.cut(surface, sweep, params);
    let outcome = assert_changed(&before, surface, cutter, result)?;
    if !outcome.is_miss() {
        let added = euler_characteristic_of(surface, &outcome.cap)
            - boundary_characteristic_of(surface, &outcome.cap);
        assert_euler_characteristic(&before, surface, &outcome, added);
        assert_no_fold_added(&before, surface, params, &outcome);
        assert_exact(&before, surface, sweep, params, &outcome);
    }
    Ok(outcome)
}

/// Cuts by the paper's method, and asserts the invariants of [`cut_and_check`] except for the last
/// two.
///
/// # Errors
/// [`PaperError`] of a failed cut.
///
/// # Panics
/// If an invariant does not hold.
pub fn paper_cut_and_check(
    surface: &mut Surface,
    cutter: &mut Cutter,
    sweep: &Sweep,
    params: &PaperParams,
) -> Result<CutOutcome, PaperError> {
    let before = surface.clone();
    let result = incise_paper::cut(cutter, surface, sweep, params).map(|outcome| outcome.cut);
    let outcome = assert_changed(&before, surface, cutter, result)?;
    if !outcome.is_miss() {
        // Two disks per loop.
        let added = 2 * i64::try_from(outcome.report.loops).expect("loops are few");
        assert_euler_characteristic(&before, surface, &outcome, added);
    }
    Ok(outcome)
}

/// Asserts that a failed cut and a miss change nothing, and others what their delta lists.
fn assert_changed<E>(
    before: &Surface,
    surface: &Surface,
    cutter: &Cutter,
    result: Result<CutOutcome, E>,
) -> Result<CutOutcome, E> {
    cutter
        .bvh()
        .validate(surface)
        .expect("the BVH matches the surface");
    let outcome = match result {
        Ok(outcome) if !outcome.is_miss() => outcome,
        other => {
            assert_same_bits(before, surface);
            return other;
        }
    };
    assert_closed_manifold(surface);
    assert_delta_matches(before, surface, &outcome.delta);
    let added: BTreeSet<TriangleId> = outcome.delta.triangles_added.iter().copied().collect();
    assert!(
        outcome.cap.iter().all(|t| added.contains(t)),
        "caps are new triangles"
    );
    Ok(outcome)
}

fn assert_euler_characteristic(
    before: &Surface,
    surface: &Surface,
    outcome: &CutOutcome,
    added: i64,
) {
    let sum = |s: &Surface| euler_characteristics(s).values().sum::<i64>();
    assert_eq!(
        sum(surface),
        sum(before) + added,
        "{} loops cut and closed",
        outcome.report.loops
    );
}
