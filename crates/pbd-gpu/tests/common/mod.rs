//! Small bodies and edits for the tests.
#![allow(dead_code, reason = "every test file uses a part of it")]

use incise_mesh::geometry::round;
use incise_mesh::{
    AddedVertex, EdgeKey, HalfEdge, Origin, Surface, TopologyDelta, TriangleId, Undo, VertexId,
};
use std::collections::HashMap;

/// A sphere of radius 1 around `center`: an octahedron, divided `levels` times.
pub(crate) fn sphere(levels: u32, center: [f32; 3]) -> Surface {
    let (positions, faces) = sphere_parts(levels, center);
    Surface::from_triangles(&positions, &faces).unwrap()
}

/// Two spheres apart in one surface.
pub(crate) fn two_spheres(levels: u32) -> Surface {
    let (mut positions, mut faces) = sphere_parts(levels, [0.0, 2.0, 0.0]);
    let (more, other) = sphere_parts(levels, [3.0, 2.0, 0.0]);
    let offset = u32::try_from(positions.len()).unwrap();
    positions.extend(more);
    faces.extend(other.iter().map(|t| t.map(|v| v + offset)));
    Surface::from_triangles(&positions, &faces).unwrap()
}

fn sphere_parts(levels: u32, center: [f32; 3]) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let mut positions = vec![
        [1.0_f32, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [-1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, -1.0],
    ];
    let mut faces: Vec<[u32; 3]> = vec![
        [0, 1, 2],
        [1, 3, 2],
        [3, 4, 2],
        [4, 0, 2],
        [1, 0, 5],
        [3, 1, 5],
        [4, 3, 5],
        [0, 4, 5],
    ];
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in faces {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| {
                *middles.entry((p.min(q), p.max(q))).or_insert_with(|| {
                    let (x, y) = (positions[p as usize], positions[q as usize]);
                    let sum = [0, 1, 2].map(|k: usize| x[k] + y[k]);
                    let norm = sum.iter().map(|c| c * c).sum::<f32>().sqrt();
                    positions.push(sum.map(|c| c / norm));
                    u32::try_from(positions.len() - 1).unwrap()
                })
            });
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        faces = finer;
    }
    for p in &mut positions {
        *p = [p[0] + center[0], p[1] + center[1], p[2] + center[2]];
    }
    (positions, faces)
}

/// A closed double cone: `n` vertices around a ring, one above, one below, both of valence `n`.
pub(crate) fn double_cone(n: u32) -> Surface {
    let mut positions = vec![[0.0, 1.5, 0.0], [0.0, 0.5, 0.0]];
    for i in 0..n {
        let angle = std::f32::consts::TAU * i as f32 / n as f32;
        positions.push([angle.cos(), 1.0, angle.sin()]);
    }
    let faces: Vec<[u32; 3]> = (0..n)
        .flat_map(|i| {
            let (a, b) = (2 + i, 2 + (i + 1) % n);
            [[0, b, a], [1, a, b]]
        })
        .collect();
    Surface::from_triangles(&positions, &faces).unwrap()
}

/// What an edit adds: triangles over old vertices and new ones. A new vertex is named by its place among
/// `vertices`, counted from [`NEW`].
#[derive(Debug, Default)]
pub(crate) struct Addition {
    pub(crate) vertices: Vec<Origin>,
    pub(crate) triangles: Vec<[VertexId; 3]>,
    pub(crate) piece: u32,
}

/// Triangles to take away and what to add instead.
pub(crate) type Replacement = (Vec<TriangleId>, Addition);

/// The first number of a new vertex in an [`Addition`].
pub(crate) const NEW: u32 = 1 << 30;

/// Replaces triangles by others and says what changed.
pub(crate) fn replace(
    surface: &mut Surface,
    remove: &[TriangleId],
    addition: &Addition,
) -> TopologyDelta {
    let triangles_removed = remove
        .iter()
        .map(|&t| (t, surface.topology().triangle(t)))
        .collect();
    let orphans = surface.remove_triangles(remove);
    let mut vertices_added: Vec<AddedVertex> = Vec::new();
    for &origin in &addition.vertices {
        let at = |v: VertexId| {
            let [x, y, z, _] = surface.positions[v.index()];
            [x, y, z]
        };
        let position = round(origin.interpolate(at).into());
        let rest = round(origin.interpolate(|v| surface.rest[v.index()]).into());
        let [x, y, z] = position;
        let vertex = surface.add_vertex([x, y, z, 0.0], rest);
        vertices_added.push(AddedVertex {
            vertex,
            origin,
            piece: addition.piece,
        });
    }
    let triangles_added: Vec<TriangleId> = addition
        .triangles
        .iter()
        .map(|corners| {
            let corners = corners.map(|v| match v.0.checked_sub(NEW) {
                Some(i) => vertices_added[i as usize].vertex,
                None => v,
            });
            surface.add_triangle(corners, addition.piece).unwrap()
        })
        .collect();
    let open: Vec<HalfEdge> = surface
        .topology()
        .triangles()
        .flat_map(TriangleId::half_edges)
        .filter(|&h| surface.topology().twin(h).is_null())
        .collect();
    surface.stitch(&open).unwrap();
    let vertices_removed: Vec<VertexId> = orphans
        .into_iter()
        .filter(|&v| surface.topology().outgoing(v).is_null())
        .collect();
    surface.remove_vertices(&vertices_removed);
    surface.topology().validate().unwrap();
    TopologyDelta {
        triangles_removed,
        triangles_added,
        vertices_removed,
        removed_from: Vec::new(),
        vertices_added,
        pieces_added: Vec::new(),
        pieces_removed: Vec::new(),
    }
}

/// Replaces triangles by others in an edit that can be undone.
pub(crate) fn replace_for_now(
    surface: &mut Surface,
    remove: &[TriangleId],
    addition: &Addition,
) -> (TopologyDelta, Undo) {
    let mut edit = surface.edit();
    let mut open: Vec<HalfEdge> = Vec::new();
    for &t in remove {
        open.extend(t.half_edges().map(|h| edit.surface().topology().twin(h)));
    }
    remove.iter().for_each(|&t| edit.remove_triangle(t));
    let mut vertices = Vec::new();
    for &origin in &addition.vertices {
        let surface = edit.surface();
        let position = round(
            origin
                .interpolate(|v| first_three(surface.positions[v.index()]))
                .into(),
        );
        let rest = round(origin.interpolate(|v| surface.rest[v.index()]).into());
        let [x, y, z] = position;
        vertices.push(edit.add_vertex([x, y, z, 0.0], rest, origin));
    }
    for corners in &addition.triangles {
        let corners = corners.map(|v| match v.0.checked_sub(NEW) {
            Some(i) => vertices[i as usize],
            None => v,
        });
        let t = edit.add_triangle(corners, addition.piece, 0);
        open.extend(t.half_edges());
    }
    let topology = edit.surface().topology();
    open.retain(|h| !h.is_null() && topology.is_triangle(h.triangle()));
    let mut pairs = Vec::new();
    for (i, &h) in open.iter().enumerate() {
        let ends = (topology.target(h), topology.origin(h));
        let mut before = open[..i].iter();
        pairs.extend(
            before
                .find(|&&g| (topology.origin(g), topology.target(g)) == ends)
                .map(|&g| (g, h)),
        );
    }
    pairs.into_iter().for_each(|(g, h)| edit.join(g, h));
    let done = edit.finish();
    surface.topology().validate().unwrap();
    done
}

fn first_three([x, y, z, _]: [f32; 4]) -> [f32; 3] {
    [x, y, z]
}

/// Flips the edge of `h` if that leaves a surface.
pub(crate) fn flip(surface: &mut Surface, h: HalfEdge) -> Option<TopologyDelta> {
    let (remove, addition) = flipped(surface, h)?;
    Some(replace(surface, &remove, &addition))
}

/// What [`flip`] does.
pub(crate) fn flipped(surface: &Surface, h: HalfEdge) -> Option<Replacement> {
    let topology = surface.topology();
    let twin = topology.twin(h);
    if twin.is_null() {
        return None;
    }
    let (a, b) = (topology.origin(h), topology.target(h));
    let (c, d) = (topology.origin(h.prev()), topology.origin(twin.prev()));
    if c == d || topology.are_adjacent(c, d) {
        return None;
    }
    let addition = Addition {
        triangles: vec![[c, d, b], [d, c, a]],
        piece: surface.piece(h.triangle()),
        ..Addition::default()
    };
    Some((vec![h.triangle(), twin.triangle()], addition))
}

/// Splits the edge of `h` at `t`.
pub(crate) fn split(surface: &mut Surface, h: HalfEdge, t: f32) -> Option<TopologyDelta> {
    let (remove, addition) = divided(surface, h, t)?;
    Some(replace(surface, &remove, &addition))
}

/// What [`split`] does.
pub(crate) fn divided(surface: &Surface, h: HalfEdge, t: f32) -> Option<Replacement> {
    let topology = surface.topology();
    let twin = topology.twin(h);
    if twin.is_null() {
        return None;
    }
    let (a, b) = (topology.origin(h), topology.target(h));
    let (c, d) = (topology.origin(h.prev()), topology.origin(twin.prev()));
    let m = VertexId(NEW);
    let addition = Addition {
        vertices: vec![Origin::OnEdge { a, b, t }],
        triangles: vec![[a, m, c], [m, b, c], [b, m, d], [m, a, d]],
        piece: surface.piece(h.triangle()),
    };
    Some((vec![h.triangle(), twin.triangle()], addition))
}

/// The mean of three vertices.
pub(crate) fn on_cap(parents: [VertexId; 3]) -> Origin {
    Origin::OnCap {
        parents,
        weights: [1.0 / 3.0; 3],
    }
}

/// Takes `v` and its triangles away and closes the hole with a new vertex between its neighbors.
pub(crate) fn renew(surface: &mut Surface, v: VertexId) -> Option<TopologyDelta> {
    let (remove, addition) = renewed(surface, v)?;
    Some(replace(surface, &remove, &addition))
}

/// What [`renew`] does.
pub(crate) fn renewed(surface: &Surface, v: VertexId) -> Option<Replacement> {
    let topology = surface.topology();
    let fan: Vec<HalfEdge> = topology.outgoing_fan(v).collect();
    if fan.iter().any(|&h| topology.twin(h).is_null()) {
        return None;
    }
    let rim: Vec<[VertexId; 2]> = fan
        .iter()
        .map(|&h| [topology.target(h), topology.origin(h.prev())])
        .collect();
    let parents = [rim[0][0], rim[1][0], rim[2][0]];
    let addition = Addition {
        vertices: vec![on_cap(parents)],
        triangles: rim.iter().map(|&[a, b]| [VertexId(NEW), a, b]).collect(),
        piece: surface.piece(fan[0].triangle()),
    };
    let remove: Vec<TriangleId> = fan.iter().map(|h| h.triangle()).collect();
    Some((remove, addition))
}

/// The edges of a surface as keys.
pub(crate) fn edge_keys(surface: &Surface) -> Vec<EdgeKey> {
    let topology = surface.topology();
    topology
        .edges()
        .map(|h| EdgeKey::new(topology.origin(h), topology.target(h)))
        .collect()
}

/// Takes `v` and its triangles away and closes the hole with triangles around one of its neighbors, if
/// that leaves a surface.
pub(crate) fn close(surface: &mut Surface, v: VertexId) -> Option<TopologyDelta> {
    let (remove, addition) = closed(surface, v)?;
    Some(replace(surface, &remove, &addition))
}

/// What [`close`] does.
pub(crate) fn closed(surface: &Surface, v: VertexId) -> Option<Replacement> {
    let topology = surface.topology();
    let fan: Vec<HalfEdge> = topology.outgoing_fan(v).collect();
    if fan.iter().any(|&h| topology.twin(h).is_null()) {
        return None;
    }
    let next = |at: VertexId| {
        let h = fan.iter().find(|&&h| topology.target(h) == at)?;
        Some(topology.origin(h.prev()))
    };
    let hub = topology.target(fan[0]);
    let (mut a, mut triangles) = (next(hub)?, Vec::new());
    while let Some(b) = next(a).filter(|&b| b != hub) {
        if triangles.len() + 3 < fan.len() && topology.are_adjacent(hub, b) {
            return None;
        }
        triangles.push([hub, a, b]);
        a = b;
    }
    if fan.len() == 3 && surface.topology().triangles().count() < 6 {
        return None;
    }
    let addition = Addition {
        triangles,
        piece: surface.piece(fan[0].triangle()),
        ..Addition::default()
    };
    let remove: Vec<TriangleId> = fan.iter().map(|h| h.triangle()).collect();
    Some((remove, addition))
}
