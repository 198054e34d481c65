//! Random edits: a drop or undo leaves no trace, and the delta equals the difference.

mod edges;
mod known;

use super::{Edit, Undo, UndoError};
use crate::delta::{TopologyDelta, VertexOrigin};
use crate::ids::{HalfEdge, TriangleId, VertexId};
use crate::shapes::icosphere;
use crate::surface::{Blend, Channel, Domain, Surface};
use proptest::prelude::*;
use std::collections::BTreeSet;

/// One step of a random edit: operation and operands.
type Step = (u8, u16, u16);

/// Operations below this keep a closed surface closed.
const CLOSED: u8 = 6;
const ALL: u8 = 9;

fn steps(kinds: u8) -> impl Strategy<Value = Vec<Step>> {
    prop::collection::vec((0..kinds, any::<u16>(), any::<u16>()), 0..40)
}

/// Returns a surface of two pieces with free slots and all attributes.
fn body() -> Surface {
    let ball = icosphere(1, 1.0);
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for i in 0..3_u8 {
        let offset = u32::try_from(positions.len()).unwrap();
        positions.extend(
            ball.rest
                .iter()
                .map(|&[x, y, z]| [x + 3.0 * f32::from(i), y, z]),
        );
        faces.extend((ball.topology().triangles()).map(|t| {
            let corners = ball.topology().triangle(t);
            corners.map(|v| v.0 + offset)
        }));
    }
    let mut surface = Surface::from_triangles(&positions, &faces).unwrap();
    // Removes the second of three from both ends, so that the free lists are unordered.
    let middle: Vec<TriangleId> = (80..160)
        .rev()
        .step_by(2)
        .chain((80..160).step_by(2))
        .map(TriangleId)
        .collect();
    let unused = surface.remove_triangles(&middle);
    surface.remove_vertices(&unused);
    let corners = 3 * surface.topology().triangle_slots();
    let number = |i: usize| f32::from(u16::try_from(i).unwrap());
    surface.corners.uv = (0..corners).map(|i| [number(i), -number(i)]).collect();
    surface.corners.normal = (0..corners).map(|i| [0.0, number(i), -0.0]).collect();
    let vertices = surface.topology().vertex_slots();
    for (name, domain, blend, width, slots) in [
        ("color", Domain::Vertex, Blend::Linear, 3, vertices),
        ("skin", Domain::Vertex, Blend::Skin, 4, vertices),
        ("uv1", Domain::Corner, Blend::Linear, 2, corners),
    ] {
        let values = (0..slots * width).map(number).collect();
        let channel = Channel::new(name, domain, blend, width, values).unwrap();
        surface.set_channel(channel).unwrap();
    }
    surface
}

fn bits<const N: usize>(values: &[[f32; N]]) -> Vec<[u32; N]> {
    values.iter().map(|v| v.map(f32::to_bits)).collect()
}

fn assert_same_bytes(a: &Surface, b: &Surface) {
    assert_eq!(a, b);
    assert_eq!(bits(&a.positions), bits(&b.positions));
    assert_eq!(bits(&a.rest), bits(&b.rest));
    assert_eq!(bits(&a.corners.uv), bits(&b.corners.uv));
    assert_eq!(bits(&a.corners.normal), bits(&b.corners.normal));
    for (a, b) in a.channels.iter().zip(&b.channels) {
        let bits = |values: &[f32]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(a.values()), bits(b.values()), "{}", a.name());
    }
    assert_eq!(a.history, b.history);
}

fn pick<T>(items: impl IntoIterator<Item = T>, at: u16) -> Option<T> {
    let mut items: Vec<T> = items.into_iter().collect();
    (!items.is_empty()).then(|| items.swap_remove(usize::from(at) % items.len()))
}

fn triangles(edit: &Edit<'_>) -> Vec<TriangleId> {
    edit.surface().topology().triangles().collect()
}

fn half_edges(edit: &Edit<'_>) -> Vec<HalfEdge> {
    (triangles(edit).iter().flat_map(|t| t.half_edges())).collect()
}

/// Adds a triangle and pairs it with every matching boundary edge.
fn patch(edit: &mut Edit<'_>, corners: [VertexId; 3], like: TriangleId) -> TriangleId {
    let piece = edit.surface().piece(like);
    let t = edit.add_triangle(corners, piece, 7);
    for h in t.half_edges() {
        let topology = edit.surface().topology();
        let ends = (topology.target(h), topology.origin(h));
        let open = half_edges(edit).into_iter().find(|&g| {
            let topology = edit.surface().topology();
            (topology.origin(g), topology.target(g)) == ends && topology.twin(g).is_null()
        });
        if let Some(g) = open {
            edit.set_twins(h, g);
        }
    }
    t
}

/// Makes one step at the triangle that `at` picks; `other` is its second operand.
fn step(
    edit: &mut Edit<'_>,
    gone: &mut Vec<(TriangleId, [VertexId; 3])>,
    kind: u8,
    at: u16,
    other: u16,
) {
    let Some(t) = pick(triangles(edit), at) else {
        return;
    };
    let corners = edit.surface().topology().triangle(t);
    let value = f32::from(other);
    match kind {
        // Insert a vertex in a triangle.
        0 => {
            let weights = [0.5, 0.25, 0.25];
            let m = edit.add_vertex(
                [value; 4],
                [-value; 3],
                VertexOrigin::InFace { corners, weights },
            );
            edit.remove_triangle(t);
            for i in 0..3 {
                patch(edit, [corners[i], corners[(i + 1) % 3], m], t);
            }
        }
        // Move all corners of a vertex to a new one.
        1 => {
            let (a, b) = (corners[0], corners[1]);
            let new = edit.add_vertex(
                [value; 4],
                [value; 3],
                VertexOrigin::OnEdge { a, b, t: 0.25 },
            );
            for h in half_edges(edit) {
                if edit.surface().topology().origin(h) == a {
                    edit.set_corner(h, new);
                }
            }
        }
        // Replace a triangle by its rotation.
        2 => {
            edit.remove_triangle(t);
            let [a, b, c] = corners;
            patch(
                edit,
                if other.is_multiple_of(2) {
                    [b, c, a]
                } else {
                    corners
                },
                t,
            );
        }
        // Flip an edge.
        3 => {
            let h = t.half_edges()[usize::from(other % 3)];
            let twin = edit.surface().topology().twin(h);
            if twin.is_null() {
                return;
            }
            let topology = edit.surface().topology();
            let (a, b) = (topology.origin(h), topology.target(h));
            let (c, d) = (topology.origin(h.prev()), topology.origin(twin.prev()));
            let joined = half_edges(edit).into_iter().any(|g| {
                let topology = edit.surface().topology();
                [topology.origin(g), topology.target(g)] == [c, d]
                    || [topology.origin(g), topology.target(g)] == [d, c]
            });
            if c != d && !joined {
                edit.remove_triangle(t);
                edit.remove_triangle(twin.triangle());
                patch(edit, [c, d, b], t);
                patch(edit, [d, c, a], t);
            }
        }
        4 => {
            let surface = edit.surface();
            let piece = match other % 3 {
                0 => edit.new_piece(surface.piece(t)),
                1 => surface.piece(t),
                _ => pick(triangles(edit), other).map_or(0, |t| surface.piece(t)),
            };
            edit.set_piece(t, piece);
        }
        5 => {
            let h = t.half_edges()[usize::from(other % 3)];
            edit.set_uv(h, [value, 0.5]);
            edit.set_normal(h, [value; 3]);
            let values = edit.surface().corner_values(h.next());
            edit.set_corner_values(h.prev(), &values);
            let [a, b, _] = corners;
            edit.add_vertex(
                [value; 4],
                [value; 3],
                VertexOrigin::OnEdge { a, b, t: 0.5 },
            );
        }
        6 => {
            edit.remove_triangle(t);
            gone.push((t, corners));
        }
        7 => {
            if let Some((t, corners)) = gone.pop() {
                let topology = edit.surface().topology();
                let runs = |a: VertexId, b: VertexId| {
                    let mut all = topology.triangles().flat_map(TriangleId::half_edges);
                    all.any(|h| (topology.origin(h), topology.target(h)) == (a, b))
                };
                let [a, b, c] = corners;
                if !runs(a, b) && !runs(b, c) && !runs(c, a) {
                    patch(edit, corners, t);
                }
            }
        }
        // Pair with another half-edge and back.
        _ => {
            let h = t.half_edges()[usize::from(other % 3)];
            let twin = edit.surface().topology().twin(h);
            let elsewhere = pick(half_edges(edit), other).unwrap();
            if !twin.is_null() && elsewhere.triangle() != t {
                let third = edit.surface().topology().twin(elsewhere);
                edit.set_twins(h, elsewhere);
                if third.is_null() {
                    edit.set_twins(h, twin);
                } else if elsewhere != twin {
                    edit.set_twins(elsewhere, third);
                    edit.set_twins(h, twin);
                }
            }
        }
    }
}

fn run(edit: &mut Edit<'_>, steps: &[Step]) {
    let mut gone = Vec::new();
    for &(kind, at, other) in steps {
        step(edit, &mut gone, kind, at, other);
    }
}

/// Compares a delta with the difference of two surfaces, found by brute force.
fn assert_difference(before: &Surface, after: &Surface, delta: &TopologyDelta) {
    let corners = |s: &Surface, i: u32| {
        let t = TriangleId(i);
        s.topology()
            .is_triangle(t)
            .then(|| s.topology().triangle(t))
    };
    let slots = before
        .topology()
        .triangle_slots()
        .max(after.topology().triangle_slots());
    let (mut removed, mut added) = (Vec::new(), Vec::new());
    for i in 0..u32::try_from(slots).unwrap() {
        let (old, new) = (corners(before, i), corners(after, i));
        if old != new {
            removed.extend(old.map(|corners| (TriangleId(i), corners)));
            added.extend(new.map(|_| TriangleId(i)));
        }
    }
    assert_eq!(delta.triangles_removed, removed);
    assert_eq!(delta.triangles_added, added);
    let used = |s: &Surface| -> BTreeSet<VertexId> {
        let triangles = s.topology().triangles();
        triangles.flat_map(|t| s.topology().triangle(t)).collect()
    };
    let (old, new) = (used(before), used(after));
    let removed: Vec<VertexId> = old.difference(&new).copied().collect();
    let added: Vec<VertexId> = new.difference(&old).copied().collect();
    assert_eq!(delta.vertices_removed, removed);
    let mut found: Vec<VertexId> = delta.vertices_added.iter().map(|a| a.vertex).collect();
    found.sort_unstable();
    assert_eq!(found, added);
    for a in &delta.vertices_added {
        let mut around = after.topology().triangles().filter(|&t| {
            let corners = after.topology().triangle(t);
            corners.contains(&a.vertex)
        });
        assert!(
            around.any(|t| after.piece(t) == a.piece),
            "{} is not of piece {}",
            a.vertex,
            a.piece
        );
    }
    let pieces = |s: &Surface| -> BTreeSet<u32> {
        let triangles = s.topology().triangles();
        triangles.map(|t| s.piece(t)).collect()
    };
    let (old, new) = (pieces(before), pieces(after));
    let mut named: Vec<u32> = delta.pieces_added.iter().map(|p| p.0).collect();
    named.sort_unstable();
    assert!(new.difference(&old).eq(&named), "pieces added: {named:?}");
    let mut named = delta.pieces_removed.clone();
    named.sort_unstable();
    assert!(old.difference(&new).eq(&named), "pieces removed: {named:?}");
}

/// Compares stored piece counts and the next number with recounted ones.
fn assert_counted(surface: &Surface) {
    let mut all: Vec<u32> = surface
        .topology()
        .triangles()
        .map(|t| surface.piece(t))
        .collect();
    all.sort_unstable();
    for piece in 0..surface.piece_bound() {
        let count = all.iter().filter(|&&p| p == piece).count();
        assert_eq!(
            surface.piece_triangles(piece),
            count,
            "triangles of piece {piece}"
        );
    }
    assert!(all.last().is_none_or(|&p| p < surface.piece_bound()));
    let slots = surface.topology().triangle_slots();
    assert_eq!([surface.piece.len(), surface.material.len()], [slots; 2]);
    assert_eq!(
        [surface.corners.uv.len(), surface.corners.normal.len()],
        [3 * slots; 2]
    );
    let vertices = surface.topology().vertex_slots();
    assert_eq!([surface.positions.len(), surface.rest.len()], [vertices; 2]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn a_dropped_edit_leaves_no_trace(steps in steps(ALL)) {
        let before = body();
        let mut surface = before.clone();
        let mut edit = surface.edit();
        run(&mut edit, &steps);
        drop(edit);
        assert_same_bytes(&surface, &before);
    }

    #[test]
    fn a_finished_edit_tells_all_and_can_be_undone(steps in steps(ALL)) {
        let before = body();
        let mut surface = before.clone();
        let mut edit = surface.edit();
        run(&mut edit, &steps);
        let (delta, undo) = edit.finish();
        surface.validate().unwrap();
        assert_counted(&surface);
        assert_difference(&before, &surface, &delta);
        let after = surface.clone();
        let back = undo.revert(&mut surface).unwrap();
        assert_same_bytes(&surface, &before);
        assert_difference(&after, &surface, &back);
    }

    #[test]
    fn edits_are_undone_last_first(edits in prop::collection::vec(steps(CLOSED), 1..5)) {
        let mut surface = body();
        let mut done: Vec<(Surface, Undo)> = Vec::new();
        for steps in &edits {
            let before = surface.clone();
            let mut edit = surface.edit();
            run(&mut edit, steps);
            let (delta, undo) = edit.finish();
            surface.validate().unwrap();
            assert_difference(&before, &surface, &delta);
            done.push((before, undo));
        }
        let last = surface.clone();
        for (_, undo) in done.iter().rev().skip(1) {
            prop_assert_eq!(undo.clone().revert(&mut surface), Err(UndoError::Stale));
            assert_same_bytes(&surface, &last);
        }
        for (before, undo) in done.into_iter().rev() {
            undo.revert(&mut surface).unwrap();
            assert_same_bytes(&surface, &before);
            assert_counted(&surface);
        }
    }

    #[test]
    fn the_same_edit_gives_the_same_bytes(steps in steps(ALL)) {
        let [(a, x), (b, y)] = [(); 2].map(|()| {
            let mut surface = body();
            let mut edit = surface.edit();
            run(&mut edit, &steps);
            let done = edit.finish();
            (surface, done)
        });
        assert_same_bytes(&a, &b);
        prop_assert_eq!(x, y);
    }
}
