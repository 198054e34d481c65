//! Invariants of a delta: it lists the whole difference of an edit and nothing else.

use incise_mesh::geometry::{to_f32, to_f64};
use incise_mesh::{
    Blend, Channel, Domain, HalfEdge, Surface, TopologyDelta, TriangleId, VertexId, VertexOrigin,
};
use std::collections::{BTreeMap, BTreeSet};

/// Rounding of a coordinate that is interpolated from rounded parents, relative to the largest one.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// Asserts that `delta` is the difference between two surfaces.
pub(super) fn assert_delta_matches(before: &Surface, after: &Surface, delta: &TopologyDelta) {
    assert_triangles_match(before, after, delta);
    assert_vertices_match(before, after, delta);
    assert_pieces_match(before, after, delta);
    assert_channels_follow(before, after, delta);
}

fn assert_triangles_match(before: &Surface, after: &Surface, delta: &TopologyDelta) {
    let slots = before.topology().triangle_slots();
    let mut expected = vec![false; slots.max(after.topology().triangle_slots())];
    for t in before.topology().triangles() {
        expected[t.index()] = true;
    }
    for &(t, corners) in &delta.triangles_removed {
        let was = std::mem::replace(&mut expected[t.index()], false);
        assert!(was, "{t} was removed once and was there");
        assert_eq!(corners, before.topology().triangle(t), "corners of {t}");
    }
    for t in (before.topology().triangles()).filter(|t| expected[t.index()]) {
        assert_eq!(
            before.topology().triangle(t),
            after.topology().triangle(t),
            "{t} was kept"
        );
        for h in t.half_edges().map(HalfEdge::index) {
            let uv = |s: &Surface| s.corner_uvs().get(h).map(|uv| uv.map(f32::to_bits));
            let normal = |s: &Surface| s.corner_normals().get(h).map(|n| n.map(f32::to_bits));
            assert_eq!(
                (uv(before), normal(before)),
                (uv(after), normal(after)),
                "{t} kept its attributes"
            );
        }
    }
    for &t in &delta.triangles_added {
        let was = std::mem::replace(&mut expected[t.index()], true);
        assert!(!was, "{t} was added once into a free slot");
    }
    for (t, expected) in (0..).map(TriangleId).zip(expected) {
        let is = t.index() < after.topology().triangle_slots() && after.topology().is_triangle(t);
        assert_eq!(is, expected, "{t} was kept or added");
    }
}

fn assert_vertices_match(before: &Surface, after: &Surface, delta: &TopologyDelta) {
    let slots = before.topology().vertex_slots();
    let mut expected = vec![false; slots.max(after.topology().vertex_slots())];
    for v in before.topology().vertices() {
        expected[v.index()] = true;
    }
    assert!(
        delta.vertices_removed.is_sorted(),
        "removed vertices ascend"
    );
    for v in &delta.vertices_removed {
        let was = std::mem::replace(&mut expected[v.index()], false);
        assert!(was, "{v} was removed once and was there");
    }
    for v in before.topology().vertices() {
        let same = before.positions()[v.index()].map(f32::to_bits)
            == after.positions()[v.index()].map(f32::to_bits)
            && before.rest_positions()[v.index()].map(f32::to_bits)
                == after.rest_positions()[v.index()].map(f32::to_bits);
        assert!(same, "the data of {v} was touched");
    }
    let bounds = before.bounds();
    let largest =
        (bounds.min.iter().chain(&bounds.max)).fold(0.0, |m, x| f64::from(x.abs()).max(m));
    let ranges = displacement_ranges(after, delta);
    for added in &delta.vertices_added {
        let v = added.vertex;
        assert!(
            delta.vertices_removed.binary_search(&v).is_err(),
            "{v} was removed and is used again"
        );
        let (parents, known): (&[VertexId], _) = match &added.origin {
            VertexOrigin::OnEdge { a, b, t } => {
                assert!((0.0..=1.0).contains(t), "{v} lies beyond its edge");
                (
                    &[*a, *b],
                    before.topology().find_half_edge(*a, *b).is_some(),
                )
            }
            VertexOrigin::InFace { corners, weights } => {
                assert_weights(weights, v);
                let [a, b, c] = *corners;
                let topology = before.topology();
                // In either order: corners are sorted, so that coincident walls round alike.
                let third = |h: HalfEdge| topology.origin(h.prev());
                let mut faces = [(a, b), (b, a)].into_iter();
                let is_face = |(a, b)| topology.find_half_edge(a, b).is_some_and(|h| third(h) == c);
                (corners, faces.any(is_face))
            }
            VertexOrigin::OnCap { parents, weights } => {
                assert_weights(weights, v);
                (parents, true)
            }
            _ => panic!("unknown kind of origin"),
        };
        assert!(known, "the edge or triangle of {v} was none");
        for &p in parents {
            let was = p.index() < before.topology().vertex_slots()
                && !before.topology().outgoing(p).is_null();
            assert!(was || expected[p.index()], "{p} comes after its child {v}");
        }
        let at = |v: VertexId| {
            let [x, y, z, _] = after.positions()[v.index()];
            [x, y, z]
        };
        let distance = to_f64(at(v)) - to_f64(to_f32(added.origin.interpolate(at).into()));
        assert!(
            distance.amax() <= ROUNDING * largest,
            "{v} is {distance} from its origin"
        );
        let rest = to_f32(
            added
                .origin
                .interpolate(|v| after.rest_positions()[v.index()])
                .into(),
        );
        let is_on_cap = matches!(added.origin, VertexOrigin::OnCap { .. });
        let is_at_rest = |v: VertexId| at(v) == after.rest_positions()[v.index()];
        // A vertex between parents at rest may be at rest, where the mean is rounded another way.
        let is_between = is_at_rest(v) && parents.iter().all(|&p| is_at_rest(p));
        for k in (0..3).filter(|_| !is_between) {
            // Within caps rest positions are harmonic instead of interpolated. Both are affine at
            // the rim, so they differ by at most the range of displacements along the rim.
            let off = (f64::from(rest[k]) - f64::from(after.rest_positions()[v.index()][k])).abs();
            let range = if is_on_cap { ranges[k] } else { 0.0 };
            let bound = if range > 0.0 {
                range + ROUNDING * largest
            } else {
                0.0
            };
            assert!(off <= bound, "the rest position of {v} is {off} off");
        }
        let was = std::mem::replace(&mut expected[v.index()], true);
        assert!(!was, "{v} was added once into a free slot");
        assert_eq!(
            added.piece,
            after.piece(after.topology().outgoing(v).triangle()),
            "the piece of {v}"
        );
    }
    for (v, expected) in (0..).map(VertexId).zip(expected) {
        let is =
            v.index() < after.topology().vertex_slots() && !after.topology().outgoing(v).is_null();
        assert_eq!(is, expected, "{v} was kept or added");
    }
}

/// Returns the range of displacements from rest over the parents of cap vertices, by coordinate
/// \[m\].
fn displacement_ranges(after: &Surface, delta: &TopologyDelta) -> [f64; 3] {
    let caps = delta.vertices_added.iter().filter_map(|a| match a.origin {
        VertexOrigin::OnCap { parents, .. } => Some(parents),
        _ => None,
    });
    let others = delta.vertices_added.iter().filter_map(|a| match a.origin {
        VertexOrigin::OnCap { .. } => None,
        _ => Some(a.vertex),
    });
    let (mut least, mut most) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for v in caps.flatten().chain(others) {
        let displacement = after.position(v) - after.rest_position(v);
        for k in 0..3 {
            least[k] = least[k].min(displacement[k]);
            most[k] = most[k].max(displacement[k]);
        }
    }
    [0, 1, 2].map(|k| (most[k] - least[k]).max(0.0))
}

/// Asserts that weights are not negative and sum to 1 up to rounding.
fn assert_weights(weights: &[f32; 3], v: VertexId) {
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

fn assert_pieces_match(before: &Surface, after: &Surface, delta: &TopologyDelta) {
    let pieces = |s: &Surface| -> BTreeSet<u32> {
        let numbers = 0..s.piece_bound();
        numbers.filter(|&p| s.piece_triangles(p) > 0).collect()
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
    let kept = before.topology().triangles();
    let mut pairs: Vec<(u32, u32)> = (kept.filter(|t| !removed.contains(t)))
        .map(|t| (after.piece(t), before.piece(t)))
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    let mut sources: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
    for (piece, source) in pairs {
        sources.entry(piece).or_default().insert(source);
    }
    for added in &delta.vertices_added {
        if let VertexOrigin::OnEdge { a, b, .. } = added.origin
            && let Some(h) = before.topology().find_half_edge(a, b)
        {
            let source = sources.entry(added.piece).or_default();
            source.insert(before.piece(h.triangle()));
        }
    }
    // A cap may join pieces, such as the shells of a hollow body; one of them is the parent.
    for (piece, sources) in sources {
        let parent = parent[&piece];
        assert!(
            sources.contains(&parent),
            "piece {piece} was made of {parent}, its triangles come from {sources:?}"
        );
    }
}

/// Asserts that kept rows are untouched and that new ones lie between those of their parents.
fn assert_channels_follow(before: &Surface, after: &Surface, delta: &TopologyDelta) {
    for (old, new) in before.channels().iter().zip(after.channels()) {
        let name = new.name();
        match new.domain() {
            Domain::Vertex => {
                for v in before.topology().vertices().map(VertexId::index) {
                    assert_eq!(old.row(v), new.row(v), "{name} of v{v} was touched");
                }
                for added in &delta.vertices_added {
                    let (v, row) = (added.vertex, new.row(added.vertex.index()));
                    let weights = added.origin.weights();
                    let parents = weights.iter().filter(|(_, weight)| *weight > 0.0);
                    let parents: Vec<&[f32]> = parents.map(|(p, _)| new.row(p.index())).collect();
                    assert_row_between(new, row, &parents, &format!("{name} of {v}"));
                }
            }
            Domain::Corner => {
                let removed: BTreeSet<TriangleId> = delta
                    .triangles_removed
                    .iter()
                    .map(|entry| entry.0)
                    .collect();
                let kept = before
                    .topology()
                    .triangles()
                    .filter(|t| !removed.contains(t));
                for h in kept.flat_map(|t| t.half_edges()).map(HalfEdge::index) {
                    assert_eq!(old.row(h), new.row(h), "{name} of h{h} was touched");
                }
                let all = before.topology().triangles().flat_map(|t| t.half_edges());
                let all: Vec<&[f32]> = all.map(|h| old.row(h.index())).collect();
                let bounds = [f32::min, f32::max].map(|pick| {
                    let pick = |k: usize| all.iter().map(|row| row[k]).reduce(pick);
                    (0..new.width()).filter_map(pick).collect::<Vec<f32>>()
                });
                let bounds = bounds.each_ref().map(Vec::as_slice);
                for &t in &delta.triangles_added {
                    for h in t.half_edges() {
                        let at = format!("{name} of {h}");
                        assert_row_between(new, new.row(h.index()), &bounds, &at);
                    }
                }
            }
        }
    }
}

/// Asserts that a row lies between others; skin weights sum to 1 and have joints of the others.
fn assert_row_between(channel: &Channel, row: &[f32], others: &[&[f32]], at: &str) {
    match channel.blend() {
        Blend::Skin => {
            let (joints, weights) = row.split_at(channel.width() / 2);
            let sum: f64 = weights.iter().map(|&w| f64::from(w)).sum();
            assert!((sum - 1.0).abs() < 1e-6, "{at}: weights {weights:?}");
            for (joint, _) in joints
                .iter()
                .zip(weights)
                .filter(|(_, weight)| **weight > 0.0)
            {
                let has = |row: &&[f32]| row[..joints.len()].contains(joint);
                assert!(others.iter().any(has), "{at}: joint {joint}");
            }
        }
        _ => {
            for (k, x) in row.iter().enumerate() {
                let (below, above) = (
                    others.iter().any(|o| o[k] <= *x),
                    others.iter().any(|o| o[k] >= *x),
                );
                assert!(below && above, "{at}: {row:?} between {others:?}");
            }
        }
    }
}
