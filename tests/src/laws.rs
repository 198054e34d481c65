//! What must hold after every cut, whatever was cut.

use incise_cut::{CutError, CutMethod, CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::geometry::{round, widen};
use incise_mesh::{EdgeKey, HalfEdge, Origin, Surface, TopologyDelta, TriangleId, VertexId};
use std::collections::{BTreeMap, BTreeSet};

/// A coordinate that is computed from rounded parents instead of exact ones differs by their
/// rounding and its own: [units of the last place of the largest coordinate].
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

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
    let mut directed = BTreeSet::new();
    for t in topology.triangles() {
        for h in t.half_edges() {
            valence[topology.origin(h).index()] += 1;
            let edge = (topology.origin(h), topology.target(h));
            // Twins run against each other, so each direction once means each edge twice.
            assert!(directed.insert(edge), "two half-edges run from {edge:?}");
        }
    }
    for v in topology.vertices() {
        let fan = topology.outgoing_fan(v).count();
        assert_eq!(fan, valence[v.index()], "{v} has more than one fan");
        assert!(fan >= 3, "only {fan} triangles around {v}");
    }
    let labels = topology.component_labels();
    let mut pairs: BTreeSet<(u32, u32)> = BTreeSet::new();
    for t in topology.triangles() {
        pairs.insert((surface.piece(t), labels[t.index()]));
    }
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
    let mut out: BTreeMap<u32, i64> = BTreeMap::new();
    for t in topology.triangles() {
        *out.entry(surface.piece(t)).or_default() += 1;
    }
    for h in topology.edges() {
        *out.entry(surface.piece(h.triangle())).or_default() -= 1;
    }
    for v in topology.vertices() {
        let piece = surface.piece(topology.outgoing(v).triangle());
        *out.entry(piece).or_default() += 1;
    }
    out
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
///   the caps have, which is 1 for a disc.
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
    Ok(outcome)
}

/// Asserts that `delta` is the difference between two surfaces.
fn assert_delta_is_true(before: &Surface, after: &Surface, delta: &TopologyDelta) {
    assert_triangles_are_true(before, after, delta);
    assert_vertices_are_true(before, after, delta);
    assert_pieces_are_true(before, after, delta);
}

fn assert_triangles_are_true(before: &Surface, after: &Surface, delta: &TopologyDelta) {
    let mut expected: BTreeSet<TriangleId> = before.topology().triangles().collect();
    for &(t, corners) in &delta.triangles_removed {
        assert!(expected.remove(&t), "{t} was removed once and was there");
        assert_eq!(corners, before.topology().triangle(t), "corners of {t}");
    }
    for &t in &expected {
        assert_eq!(
            before.topology().triangle(t),
            after.topology().triangle(t),
            "{t} was kept"
        );
        for h in t.half_edges().map(HalfEdge::index) {
            let uv = |s: &Surface| s.corners.uv.get(h).map(|uv| uv.map(f32::to_bits));
            let normal = |s: &Surface| s.corners.normal.get(h).map(|n| n.map(f32::to_bits));
            assert_eq!(
                (uv(before), normal(before)),
                (uv(after), normal(after)),
                "{t} kept its attributes"
            );
        }
    }
    for &t in &delta.triangles_added {
        assert!(expected.insert(t), "{t} was added once into a free slot");
    }
    let found: BTreeSet<TriangleId> = after.topology().triangles().collect();
    assert_eq!(expected, found, "kept and added triangles");
}

fn assert_vertices_are_true(before: &Surface, after: &Surface, delta: &TopologyDelta) {
    let mut expected: BTreeSet<VertexId> = before.topology().vertices().collect();
    assert!(
        delta.vertices_removed.is_sorted(),
        "removed vertices ascend"
    );
    for v in &delta.vertices_removed {
        assert!(expected.remove(v), "{v} was removed once and was there");
    }
    for v in before.topology().vertices() {
        let same = before.positions[v.index()].map(f32::to_bits)
            == after.positions[v.index()].map(f32::to_bits)
            && before.rest[v.index()].map(f32::to_bits) == after.rest[v.index()].map(f32::to_bits);
        assert!(same, "the data of {v} was touched");
    }
    let bounds = before.bounds();
    let largest =
        (bounds.min.iter().chain(&bounds.max)).fold(0.0, |m, x| f64::from(x.abs()).max(m));
    for added in &delta.vertices_added {
        let v = added.vertex;
        assert!(
            !delta.vertices_removed.contains(&v),
            "{v} was removed and is used again"
        );
        let (parents, known): (&[VertexId], _) = match &added.origin {
            Origin::OnEdge { a, b, t } => {
                assert!((0.0..=1.0).contains(t), "{v} lies beyond its edge");
                (
                    &[*a, *b],
                    before.topology().find_half_edge(*a, *b).is_some(),
                )
            }
            Origin::InFace { corners, weights } => {
                assert_shares(weights, v);
                let [a, b, c] = *corners;
                let topology = before.topology();
                let third = |h: HalfEdge| topology.origin(h.prev());
                let face = topology.find_half_edge(a, b);
                (corners, face.is_some_and(|h| third(h) == c))
            }
            Origin::OnCap { parents, weights } => {
                assert_shares(weights, v);
                (parents, true)
            }
            _ => panic!("an origin that this test does not know"),
        };
        assert!(known, "the edge or triangle of {v} was none");
        for &p in parents {
            let was = p.index() < before.topology().vertex_slots()
                && !before.topology().outgoing(p).is_null();
            assert!(
                was || expected.contains(&p),
                "{p} comes after its child {v}"
            );
        }
        let at = |v: VertexId| {
            let [x, y, z, _] = after.positions[v.index()];
            [x, y, z]
        };
        let distance = widen(at(v)) - widen(round(added.origin.interpolate(at).into()));
        assert!(
            distance.amax() <= ROUNDING * largest,
            "{v} is {distance} from its origin"
        );
        let rest = round(added.origin.interpolate(|v| after.rest[v.index()]).into());
        assert_eq!(rest, after.rest[v.index()], "the rest position of {v}");
        assert!(expected.insert(v), "{v} was added once into a free slot");
        assert_eq!(
            added.piece,
            after.piece(after.topology().outgoing(v).triangle()),
            "the piece of {v}"
        );
    }
    let found: BTreeSet<VertexId> = after.topology().vertices().collect();
    assert_eq!(expected, found, "kept and added vertices");
}

/// Weights of parents: none negative, and together 1 but for rounding.
fn assert_shares(weights: &[f32; 3], v: VertexId) {
    assert!(
        weights.iter().all(|w| (0.0..=1.0).contains(w)),
        "{v} lies outside of its parents"
    );
    let sum: f64 = weights.iter().map(|&w| f64::from(w)).sum();
    assert!(
        (sum - 1.0).abs() <= ROUNDING,
        "the weights of {v} sum to {sum}"
    );
}

fn assert_pieces_are_true(before: &Surface, after: &Surface, delta: &TopologyDelta) {
    let pieces = |s: &Surface| -> BTreeSet<u32> {
        let triangles = s.topology().triangles();
        triangles.map(|t| s.piece(t)).collect()
    };
    let mut expected = pieces(before);
    let mut parent: BTreeMap<u32, u32> = expected.iter().map(|&p| (p, p)).collect();
    for &(new, old) in &delta.pieces_added {
        assert!(parent.insert(new, old).is_none(), "piece {new} is not new");
        assert!(expected.contains(&old), "piece {old} was not there");
    }
    expected.extend(delta.pieces_added.iter().map(|p| p.0));
    for p in &delta.pieces_removed {
        assert!(expected.remove(p), "piece {p} was removed once");
    }
    assert_eq!(expected, pieces(after), "pieces kept and added");
    let removed: BTreeSet<TriangleId> = delta.triangles_removed.iter().map(|r| r.0).collect();
    for t in before.topology().triangles() {
        if !removed.contains(&t) {
            assert_eq!(
                parent[&after.piece(t)],
                before.piece(t),
                "{t} came from another piece"
            );
        }
    }
}
