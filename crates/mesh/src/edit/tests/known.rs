//! Edits with a known result.

use super::{assert_same_bytes, body, half_edges, patch};
use crate::delta::{TopologyDelta, VertexOrigin};
use crate::edit::{Undo, UndoError};
use crate::ids::{HalfEdge, TriangleId, VertexId};
use crate::shapes::icosphere;
use crate::surface::{Blend, Channel, Domain, Surface};

/// Returns a tetrahedron of four materials.
fn tetrahedron() -> Surface {
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let mut surface = Surface::from_triangles(&corners, &faces).unwrap();
    for i in 0..4 {
        surface.set_material(TriangleId(i), i);
    }
    surface
}

/// Inserts a vertex in triangle 2 of a tetrahedron.
fn divide(surface: &mut Surface) -> (TopologyDelta, Undo) {
    let mut edit = surface.edit();
    let corners = [1, 2, 3].map(VertexId);
    let third = 1.0 / 3.0_f32;
    let origin = VertexOrigin::InFace {
        corners,
        weights: [third; 3],
    };
    let m = edit.add_vertex([third, third, third, 1.0], [third; 3], origin);
    edit.remove_triangle(TriangleId(2));
    for i in 0..3 {
        patch(
            &mut edit,
            [corners[i], corners[(i + 1) % 3], m],
            TriangleId(0),
        );
    }
    edit.finish()
}

#[test]
fn a_vertex_in_a_face_is_in_the_delta() {
    let mut surface = tetrahedron();
    let (delta, undo) = divide(&mut surface);
    let corners = [1, 2, 3].map(VertexId);
    assert_eq!(delta.triangles_removed, [(TriangleId(2), corners)]);
    assert_eq!(delta.triangles_added, [2, 4, 5].map(TriangleId));
    let [added] = delta.vertices_added[..] else {
        panic!("one vertex came");
    };
    assert_eq!((added.vertex, added.piece), (VertexId(4), 0));
    assert!(delta.vertices_removed.is_empty() && delta.pieces_added.is_empty());
    surface.validate().unwrap();
    assert!(surface.topology().is_closed());
    assert_eq!(
        [0, 1, 2, 3, 4, 5].map(|i| surface.material(TriangleId(i))),
        [0, 1, 7, 3, 7, 7]
    );
    let back = undo.revert(&mut surface).unwrap();
    assert_eq!(back.triangles_added, [TriangleId(2)]);
    assert_eq!(back.vertices_removed, [VertexId(4)]);
    assert_eq!(surface.material(TriangleId(2)), 2);
}

#[test]
fn an_undo_applies_once_and_to_its_surface_only() {
    let mut surface = tetrahedron();
    let (_, undo) = divide(&mut surface);
    let mut other = body();
    let before = other.clone();
    assert_eq!(undo.clone().revert(&mut other), Err(UndoError::Stale));
    assert_same_bytes(&other, &before);

    let edits: [fn(&mut Surface); 8] = [
        |s| s.set_piece(TriangleId(1), 5),
        |s| s.set_material(TriangleId(1), 9),
        |s| {
            s.add_vertex([0.0; 4], [0.0; 3]);
        },
        |s| drop(s.remove_triangles(&[TriangleId(0)])),
        |s| {
            s.add_triangle([0, 1, 4].map(VertexId), 0).unwrap();
        },
        |s| s.stitch(&[HalfEdge(0), HalfEdge(3)]).unwrap(),
        |s| drop(s.compact()),
        |s| drop(divide(s)),
    ];
    for edit in edits {
        let mut edited = surface.clone();
        edit(&mut edited);
        let before = edited.clone();
        assert_eq!(undo.clone().revert(&mut edited), Err(UndoError::Stale));
        assert_same_bytes(&edited, &before);
    }

    undo.clone().revert(&mut surface).unwrap();
    assert_eq!(undo.clone().revert(&mut surface), Err(UndoError::Stale));
    // The repeated edit is the same, and the copy's undo matches.
    drop(divide(&mut surface));
    undo.revert(&mut surface).unwrap();
    assert_eq!(surface, tetrahedron());
}

#[test]
fn an_undo_after_motion_displaces_restored_vertices() {
    for named in [true, false] {
        let mut surface = tetrahedron();
        let gone = VertexId(3);
        let mut edit = surface.edit();
        // The new vertex is at the old one's position or does not depend on it.
        let a = if named { gone } else { VertexId(0) };
        let origin = VertexOrigin::OnEdge {
            a,
            b: VertexId(1),
            t: 0.25,
        };
        let new = edit.add_vertex([0.0, 0.5, 1.0, 2.0], [0.0, 0.5, 1.0], origin);
        for h in half_edges(&edit) {
            if edit.surface().topology().origin(h) == gone {
                edit.set_corner(h, new);
            }
        }
        let (delta, undo) = edit.finish();
        assert_eq!(delta.vertices_removed, [gone]);
        surface.validate().unwrap();
        let at = |x: f32| [x, -x, 0.5 * x];
        // Either the new vertex moves, or all old ones by their index.
        let by = |v: usize| match (named, v) {
            (true, 4) => at(1.0),
            (false, 0..3) => at(f32::from(u8::try_from(v).unwrap())),
            _ => [0.0; 3],
        };
        for (v, position) in surface.positions.iter_mut().enumerate() {
            for (coordinate, by) in position.iter_mut().zip(by(v)) {
                *coordinate += by;
            }
            position[3] = 0.5;
        }
        let moved = surface.clone();
        let back = undo.revert(&mut surface).unwrap();
        let [restored] = back.vertices_added[..] else {
            panic!("one vertex came back");
        };
        assert_eq!(restored.vertex, gone);
        let parents = if named { [4, 4, 4] } else { [0, 1, 2] };
        assert_eq!(
            restored.origin.weights().map(|w| w.0),
            parents.map(VertexId)
        );
        // It moves by 1 like the new vertex, or by the mean of 0, 1 and 2, with its old inverse
        // mass.
        assert_eq!(surface.positions[3], [1.0, -1.0, 1.5, 1.0]);
        assert_eq!(surface.positions[..3], moved.positions[..3]);
        assert_eq!(surface.topology(), tetrahedron().topology());
        assert_eq!(surface.rest, tetrahedron().rest);
    }
}

#[test]
fn a_removed_component_is_restored() {
    let mut surface = body();
    let before = surface.clone();
    let mut edit = surface.edit();
    for t in (0..80).map(TriangleId) {
        edit.remove_triangle(t);
    }
    let (delta, undo) = edit.finish();
    assert_eq!(delta.pieces_removed, [0]);
    assert_eq!(delta.vertices_removed.len(), 42);
    assert_eq!(
        surface.piece_bound(),
        before.piece_bound(),
        "numbers are not given twice"
    );
    let back = undo.revert(&mut surface).unwrap();
    assert_same_bytes(&surface, &before);
    assert_eq!(back.pieces_added, [(0, 0)]);
    let mut seen: Vec<VertexId> = Vec::new();
    for added in &back.vertices_added {
        // Without relatives, the first is its own parent; the others follow a restored one.
        let parents = added.origin.weights().map(|w| w.0);
        assert!(
            parents
                .iter()
                .all(|p| seen.contains(p) || *p == added.vertex)
        );
        seen.push(added.vertex);
    }
}

#[test]
fn a_vertex_that_was_unused_is_in_the_delta() {
    let mut surface = tetrahedron();
    let waiting = surface.add_vertex([0.5; 4], [0.5; 3]);
    let mut edit = surface.edit();
    edit.remove_triangle(TriangleId(2));
    for (a, b) in [(1, 2), (2, 3), (3, 1)] {
        patch(
            &mut edit,
            [VertexId(a), VertexId(b), waiting],
            TriangleId(0),
        );
    }
    let (delta, undo) = edit.finish();
    let [added] = delta.vertices_added[..] else {
        panic!("one vertex came");
    };
    assert_eq!(added.vertex, waiting);
    assert_eq!(
        added.origin.interpolate(|v| surface.rest[v.index()]),
        [0.5; 3]
    );
    undo.revert(&mut surface).unwrap();
    assert!(surface.topology().outgoing(waiting).is_null());
}

#[test]
fn attributes_that_came_after_the_edit_stay_in_step() {
    let mut surface = tetrahedron();
    let (_, undo) = divide(&mut surface);
    surface.corners.normal = vec![[0.0, 0.0, 1.0]; 18];
    undo.clone().revert(&mut surface).unwrap();
    assert_eq!(surface.corners.normal, [[0.0, 0.0, 1.0]; 12]);

    let (_, undo) = divide(&mut surface);
    assert_eq!(surface.corners.normal.len(), 18);
    surface.corners.normal.clear();
    surface.positions.pop();
    assert_eq!(
        undo.clone().revert(&mut surface),
        Err(UndoError::WrongLength {
            array: "positions",
            found: 4,
            expected: 5
        })
    );
    surface.positions.push([0.0; 4]);
    undo.revert(&mut surface).unwrap();
    assert!(surface.corners.normal.is_empty());
}

#[test]
fn channels_that_came_or_went_after_the_edit_stay_in_step() {
    let mut surface = tetrahedron();
    let channel =
        |domain, rows: usize| Channel::new("c", domain, Blend::Linear, 1, vec![1.0; rows]).unwrap();
    surface.set_channel(channel(Domain::Vertex, 4)).unwrap();
    let (_, undo) = divide(&mut surface);
    assert_eq!(surface.channels[0].values(), [1.0; 5]);
    surface.set_channel(channel(Domain::Corner, 18)).unwrap();
    undo.revert(&mut surface).unwrap();
    assert_eq!(surface.channels[0].values(), [1.0; 12]);
    surface.validate().unwrap();
    let (_, undo) = divide(&mut surface);
    surface.remove_channel("c");
    undo.revert(&mut surface).unwrap();
    assert!(surface.channels().is_empty());
}

#[test]
fn a_patch_inherits_the_corners_around_it() {
    let mut surface = icosphere(1, 1.0);
    let slots = 3 * surface.topology().triangle_slots();
    let values = (0..slots).map(|i| f32::from(u16::try_from(i).unwrap()));
    let channel = Channel::new("c", Domain::Corner, Blend::Linear, 1, values.collect());
    surface.set_channel(channel.unwrap()).unwrap();
    let before = surface.clone();
    let (t, corners) = (TriangleId(7), surface.topology().triangle(TriangleId(7)));
    let across = t.half_edges().map(|h| surface.topology().twin(h));
    let mut edit = surface.edit();
    edit.remove_triangle(t);
    let middle = edit.add_vertex(
        [0.0; 4],
        [0.0; 3],
        VertexOrigin::InFace {
            corners,
            weights: [0.25, 0.25, 0.5],
        },
    );
    let new: Vec<TriangleId> = (0..3)
        .map(|k| edit.add_triangle([corners[k], corners[(k + 1) % 3], middle], 0, 0))
        .collect();
    for k in 0..3 {
        let [side, ahead, _] = new[k].half_edges();
        let [_, _, behind] = new[(k + 1) % 3].half_edges();
        edit.set_twins(side, across[k]);
        edit.set_twins(ahead, behind);
    }
    edit.inherit_corner_channels(&new);
    let (_, undo) = edit.finish();
    let value = |h: HalfEdge| surface.channels[0].values()[h.index()];
    // Of the two corners across the border at a vertex, the smaller value.
    let rim = [0, 1, 2].map(|k| value(across[k].next()).min(value(across[(k + 2) % 3])));
    for k in 0..3 {
        let mean = 0.25 * rim[0] + 0.25 * rim[1] + 0.5 * rim[2];
        let expected = [rim[k], rim[(k + 1) % 3], mean];
        assert_eq!(new[k].half_edges().map(value), expected, "triangle {k}");
    }
    undo.revert(&mut surface).unwrap();
    assert_same_bytes(&surface, &before);
}

#[test]
fn an_undo_is_send_and_comparable() {
    fn needs<T: Send + Sync + Clone + PartialEq + std::fmt::Debug>(_: &T) {}
    let [x, y] = [(); 2].map(|()| divide(&mut tetrahedron()));
    needs(&x);
    assert_eq!(x, y);
}

#[test]
#[should_panic(expected = "t7 is no triangle")]
fn a_free_slot_cannot_be_removed() {
    tetrahedron().edit().remove_triangle(TriangleId(7));
}

#[test]
fn a_channel_of_an_edit_goes_with_its_undo() {
    let mut surface = tetrahedron();
    let before = surface.clone();
    let channel = Channel::new("made", Domain::Vertex, Blend::Linear, 2, Vec::new()).unwrap();
    let mut edit = surface.edit();
    edit.add_channel(&channel);
    edit.set_vertex_row(VertexId(1), "made", &[3.0]);
    let origin = VertexOrigin::OnEdge {
        a: VertexId(1),
        b: VertexId(2),
        t: 0.5,
    };
    let v = edit.add_vertex([0.5, 0.5, 0.0, 1.0], [0.5, 0.5, 0.0], origin);
    for h in TriangleId(2).half_edges() {
        if edit.surface().topology().origin(h) == VertexId(1) {
            edit.set_corner(h, v);
        }
    }
    let rows = edit.surface().channel("made").unwrap();
    assert_eq!(
        (rows.row(1), rows.row(v.index())),
        (&[3.0, 0.0][..], &[1.5, 0.0][..])
    );
    let (_, undo) = edit.finish();
    assert!(surface.channel("made").is_some());
    undo.revert(&mut surface).unwrap();
    assert_eq!(surface, before);
    let mut edit = surface.edit();
    edit.add_channel(&channel);
    drop(edit);
    assert_eq!(surface, before, "dropped");
}

#[test]
fn a_parent_that_no_triangle_uses_is_replaced_by_its_own() {
    let mut surface = tetrahedron();
    let mut edit = surface.edit();
    let between = |a, b, t| VertexOrigin::OnEdge { a, b, t };
    let at = [0.5, 0.5, 0.0];
    let position = [0.5, 0.5, 0.0, 1.0];
    let unused = edit.add_vertex(position, at, between(VertexId(1), VertexId(2), 0.75));
    let used = edit.add_vertex(position, at, between(unused, VertexId(3), 0.25));
    let h = TriangleId(2).half_edges()[0];
    edit.set_corner(h, used);
    let (delta, _) = edit.finish();
    let added = delta.vertices_added;
    assert_eq!(added.len(), 1);
    assert_eq!(added[0].origin, between(VertexId(2), VertexId(3), 0.25));
}
