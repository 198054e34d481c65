//! Small edits of a surface with their topology deltas: flip, split, and vertex replacement.

use incise_mesh::geometry::to_f32;
use incise_mesh::{
    AddedVertex, HalfEdge, Surface, TopologyDelta, TriangleId, Undo, VertexId, VertexOrigin,
};

/// Triangles and vertices that an edit adds.
///
/// Triangles refer to new vertices by their index in `vertices`, offset by [`NEW`].
#[derive(Debug, Default)]
pub struct Addition {
    /// Origins of the new vertices.
    pub vertices: Vec<VertexOrigin>,
    /// Corners of the new triangles.
    pub triangles: Vec<[VertexId; 3]>,
    /// Piece of the new triangles.
    pub piece: u32,
}

/// Triangles to remove, and their replacement.
pub type Replacement = (Vec<TriangleId>, Addition);

/// Index of the first new vertex in an [`Addition`].
pub const NEW: u32 = 1 << 30;

/// Replaces triangles and returns the topology delta.
///
/// # Panics
/// If the result is not a valid surface.
pub fn replace(surface: &mut Surface, remove: &[TriangleId], addition: &Addition) -> TopologyDelta {
    let triangles_removed = remove
        .iter()
        .map(|&t| (t, surface.topology().triangle(t)))
        .collect();
    let orphans = surface.remove_triangles(remove);
    let mut vertices_added: Vec<AddedVertex> = Vec::new();
    for &origin in &addition.vertices {
        let at = |v: VertexId| {
            let [x, y, z, _] = surface.positions()[v.index()];
            [x, y, z]
        };
        let position = to_f32(origin.interpolate(at).into());
        let rest = to_f32(
            origin
                .interpolate(|v| surface.rest_positions()[v.index()])
                .into(),
        );
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
            (surface.add_triangle(corners, addition.piece)).expect("corners are vertices")
        })
        .collect();
    let open: Vec<HalfEdge> = surface
        .topology()
        .triangles()
        .flat_map(TriangleId::half_edges)
        .filter(|&h| surface.topology().twin(h).is_null())
        .collect();
    surface.stitch(&open).expect("open edges pair up");
    let vertices_removed: Vec<VertexId> = orphans
        .into_iter()
        .filter(|&v| surface.topology().outgoing(v).is_null())
        .collect();
    surface.remove_vertices(&vertices_removed);
    surface.validate().expect("the edit leaves a valid surface");
    TopologyDelta {
        triangles_removed,
        triangles_added,
        vertices_removed,
        removed_positions: Vec::new(),
        vertices_added,
        pieces_added: Vec::new(),
        pieces_removed: Vec::new(),
    }
}

/// Replaces triangles in an edit that can be undone.
///
/// # Panics
/// If the result is not a valid surface.
pub fn replace_with_undo(
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
        let position = to_f32(
            origin
                .interpolate(|v| first_three(surface.positions()[v.index()]))
                .into(),
        );
        let rest = to_f32(
            origin
                .interpolate(|v| surface.rest_positions()[v.index()])
                .into(),
        );
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
    pairs.into_iter().for_each(|(g, h)| edit.set_twins(g, h));
    let done = edit.finish();
    surface
        .validate()
        .expect("the edit pairs the same edges as before");
    done
}

fn first_three([x, y, z, _]: [f32; 4]) -> [f32; 3] {
    [x, y, z]
}

/// Flips the edge of `h` if the result is a valid surface.
pub fn flip(surface: &mut Surface, h: HalfEdge) -> Option<TopologyDelta> {
    let (remove, addition) = flip_replacement(surface, h)?;
    Some(replace(surface, &remove, &addition))
}

/// Returns the replacement of [`flip`].
#[must_use]
pub fn flip_replacement(surface: &Surface, h: HalfEdge) -> Option<Replacement> {
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

/// Splits the edge of `h` at parameter `t`.
pub fn split(surface: &mut Surface, h: HalfEdge, t: f32) -> Option<TopologyDelta> {
    let (remove, addition) = split_replacement(surface, h, t)?;
    Some(replace(surface, &remove, &addition))
}

/// Returns the replacement of [`split`].
#[must_use]
pub fn split_replacement(surface: &Surface, h: HalfEdge, t: f32) -> Option<Replacement> {
    let topology = surface.topology();
    let twin = topology.twin(h);
    if twin.is_null() {
        return None;
    }
    let (a, b) = (topology.origin(h), topology.target(h));
    let (c, d) = (topology.origin(h.prev()), topology.origin(twin.prev()));
    let m = VertexId(NEW);
    let addition = Addition {
        vertices: vec![VertexOrigin::OnEdge { a, b, t }],
        triangles: vec![[a, m, c], [m, b, c], [b, m, d], [m, a, d]],
        piece: surface.piece(h.triangle()),
    };
    Some((vec![h.triangle(), twin.triangle()], addition))
}

/// Returns the origin of a section vertex at the mean of three vertices.
#[must_use]
pub fn on_cap(parents: [VertexId; 3]) -> VertexOrigin {
    VertexOrigin::OnCap {
        parents,
        weights: [1.0 / 3.0; 3],
    }
}

/// Removes `v` and its triangles and fills the hole with a fan around a new vertex.
pub fn replace_vertex(surface: &mut Surface, v: VertexId) -> Option<TopologyDelta> {
    let (remove, addition) = vertex_replacement(surface, v)?;
    Some(replace(surface, &remove, &addition))
}

/// Returns the replacement of [`replace_vertex`].
#[must_use]
pub fn vertex_replacement(surface: &Surface, v: VertexId) -> Option<Replacement> {
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

/// Removes `v` and fills the hole with a fan around a neighbor, if the result is a valid surface.
pub fn remove_vertex(surface: &mut Surface, v: VertexId) -> Option<TopologyDelta> {
    let (remove, addition) = removal_replacement(surface, v)?;
    Some(replace(surface, &remove, &addition))
}

/// Returns the replacement of [`remove_vertex`].
#[must_use]
pub fn removal_replacement(surface: &Surface, v: VertexId) -> Option<Replacement> {
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
