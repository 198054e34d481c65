//! The edit of a cut: replaces hit triangles by walls and caps, and checks for a closed manifold.

use super::points::PointSet;
use super::strip::Strip;
use super::{ClosedSide, Corner};
use crate::error::PaperError;
use incise_mesh::{
    EdgeKey, Edit, HalfEdge, Surface, TriangleCorners, TriangleId, VertexId, VertexOrigin,
};

/// The new triangles of a cut.
#[derive(Debug, Default)]
pub(super) struct Rebuilt {
    pub(super) cap: Vec<TriangleId>,
    /// A triangle of each side; none of a side without triangles.
    pub(super) seeds: Vec<Option<TriangleId>>,
}

/// Maximum number of triangles of a component whose volume is checked: tips and slivers are small.
const MAX_FLAT_TRIANGLES: usize = 256;

/// Sides for which the result would not be a closed manifold.
pub(super) struct Failure {
    pub(super) error: PaperError,
    pub(super) sides: Vec<usize>,
}

/// Replaces the hit triangles by the walls and caps of all sides.
///
/// # Errors
/// [`Failure`] when the result would not be a closed manifold; the edit is then to be dropped.
pub(super) fn apply(
    edit: &mut Edit<'_>,
    strips: &[Strip],
    sides: &[ClosedSide<'_>],
    cap_material: u32,
) -> Result<Rebuilt, Failure> {
    let mut replacement = Replacement {
        hits: hits(edit.surface(), strips),
        fans: Vec::new(),
        cap_material,
        new_vertices: Vec::with_capacity(sides.len()),
        new_triangles: Vec::new(),
        rebuilt: Rebuilt::default(),
    };
    match replacement.make(edit, strips, sides) {
        Ok(()) => Ok(replacement.rebuilt),
        Err(vertices) => {
            let is_failed = |v: &VertexId| vertices.contains(v);
            let has_failed = |&i: &usize| {
                let new = replacement.new_vertices.get(i);
                new.is_some_and(|new| new.iter().any(is_failed))
                    || sides[i]
                        .corners()
                        .any(|c| matches!(c, Corner::Old(v) if is_failed(&v)))
            };
            let [vertex, ..] = vertices[..] else {
                unreachable!("a failure names a vertex");
            };
            Err(Failure {
                error: PaperError::NotManifold { vertex },
                sides: (0..sides.len()).filter(has_failed).collect(),
            })
        }
    }
}

/// Returns the hit triangles before the edit, ascending.
fn hits(surface: &Surface, strips: &[Strip]) -> Vec<TriangleCorners> {
    let hits = strips.iter().flat_map(|s| &s.hits);
    let mut hits: Vec<_> = hits
        .map(|h| TriangleCorners::new(surface, h.triangle))
        .collect();
    hits.sort_unstable_by_key(|hit| hit.triangle);
    hits
}

/// A failure of the manifold conditions, as the vertices at which they fail.
type NotManifold = Vec<VertexId>;

/// A replacement of hit triangles in progress.
struct Replacement {
    hits: Vec<TriangleCorners>,
    /// Corners of the hit triangles, ascending.
    fans: Vec<Fan>,
    cap_material: u32,
    /// By side.
    new_vertices: Vec<Vec<VertexId>>,
    new_triangles: Vec<TriangleId>,
    rebuilt: Rebuilt,
}

/// The triangles around a vertex of the old boundary.
struct Fan {
    vertex: VertexId,
    /// A hit triangle and which of its corners the vertex is.
    hit: (usize, usize),
    /// Number of triangles that are not hit.
    surviving_count: usize,
}

impl Replacement {
    fn make(
        &mut self,
        edit: &mut Edit<'_>,
        strips: &[Strip],
        sides: &[ClosedSide<'_>],
    ) -> Result<(), NotManifold> {
        self.find_fans(edit.surface());
        let removed = || {
            strips
                .iter()
                .flat_map(|s| s.hits.iter().map(|h| h.triangle))
        };
        let topology = edit.surface().topology();
        let mut open: Vec<HalfEdge> = removed()
            .flat_map(TriangleId::half_edges)
            .map(|h| topology.twin(h))
            .collect();
        // Against their order, so that new triangles take the slots in order.
        let removed: Vec<TriangleId> = removed().collect();
        for &t in removed.iter().rev() {
            edit.remove_triangle(t);
        }
        open.retain(|h| edit.surface().topology().is_triangle(h.triangle()));
        for side in sides {
            let first = self.new_triangles.len();
            self.add_side(edit, side)?;
            let seed = self.new_triangles.get(first).copied();
            self.rebuilt.seeds.push(seed);
        }
        open.extend(self.new_triangles.iter().flat_map(|t| t.half_edges()));
        stitch(edit, &open)?;
        edit.inherit_corner_channels(&self.rebuilt.cap);
        self.check_fans(edit.surface())
    }

    fn find_fans(&mut self, surface: &Surface) {
        let mut corners: Vec<(VertexId, usize, usize)> = Vec::with_capacity(3 * self.hits.len());
        for (i, hit) in self.hits.iter().enumerate() {
            corners.extend((0..3).map(|k| (hit.vertices[k], i, k)));
        }
        corners.sort_unstable();
        let fan = |run: &[(VertexId, usize, usize)]| Fan {
            vertex: run[0].0,
            hit: (run[0].1, run[0].2),
            surviving_count: surface.topology().outgoing_fan(run[0].0).count() - run.len(),
        };
        self.fans = corners.chunk_by(|a, b| a.0 == b.0).map(fan).collect();
    }

    fn fan(&self, v: VertexId) -> Option<&Fan> {
        let at = self.fans.binary_search_by_key(&v, |fan| fan.vertex);
        at.ok().map(|at| &self.fans[at])
    }

    fn add_side(&mut self, edit: &mut Edit<'_>, side: &ClosedSide<'_>) -> Result<(), NotManifold> {
        let points = side.points;
        let mut ids: Vec<(Corner, VertexId)> = Vec::new();
        let is_point = |c: &Corner| matches!(c, Corner::Point(_));
        ids.extend(side.corners().filter(is_point).map(|c| (c, VertexId::NULL)));
        ids.sort_unstable();
        ids.dedup_by_key(|entry| entry.0);
        for (corner, id) in &mut ids {
            if let Corner::Point(p) = *corner {
                let point = &points.points[p as usize];
                let [a, b] = point.ends;
                let origin = VertexOrigin::OnEdge { a, b, t: point.t };
                *id = edit.add_interpolated_vertex(point.position, origin);
            }
        }
        self.new_vertices
            .push(ids.iter().map(|entry| entry.1).collect());
        let vertex = |corner: Corner| match corner {
            Corner::Old(v) => v,
            Corner::Point(_) => {
                let at = ids
                    .binary_search_by_key(&corner, |entry| entry.0)
                    .expect("every point of the side has a vertex");
                ids[at].1
            }
        };
        for wall in &side.walls {
            let t = self.add_triangle(edit, wall.map(vertex), side.piece, 0)?;
            self.interpolate_corners(edit, points, wall, t);
        }
        let Some(cap) = &side.cap else { return Ok(()) };
        let mut vertices: Vec<VertexId> = side.rim.iter().map(|&c| vertex(c)).collect();
        for (parents, &position) in cap.parents.iter().zip(&cap.points[cap.rim_len..]) {
            let origin = VertexOrigin::OnCap {
                parents: parents.map(|i| vertices[i as usize]),
                weights: [1.0 / 3.0; 3],
            };
            vertices.push(edit.add_interpolated_vertex(position, origin));
        }
        let steiner_vertices = &vertices[cap.rim_len..];
        (self.new_vertices.last_mut().into_iter()).for_each(|own| own.extend(steiner_vertices));
        for triangle in &cap.triangles {
            let corners = triangle.map(|i| vertices[i as usize]);
            let t = self.add_triangle(edit, corners, side.piece, self.cap_material)?;
            self.rebuilt.cap.push(t);
        }
        Ok(())
    }

    fn add_triangle(
        &mut self,
        edit: &mut Edit<'_>,
        [a, b, c]: [VertexId; 3],
        piece: u32,
        material: u32,
    ) -> Result<TriangleId, NotManifold> {
        if a == b || b == c || c == a {
            return Err(vec![if b == c { b } else { a }]);
        }
        let t = edit.add_triangle([a, b, c], piece, material);
        self.new_triangles.push(t);
        Ok(t)
    }

    /// Gives the corners of a wall the attributes of the hit triangles. A vertex of the old
    /// boundary takes those of the hit triangle through which a point of the same wall was found,
    /// if that has the vertex, and else of any hit triangle around it.
    fn interpolate_corners(
        &self,
        edit: &mut Edit<'_>,
        points: &PointSet,
        wall: &[Corner; 3],
        t: TriangleId,
    ) {
        if self.hits.first().is_none_or(TriangleCorners::is_plain) {
            return;
        }
        let hit = |t: TriangleId| {
            let at = self.hits.binary_search_by_key(&t, |hit| hit.triangle);
            &self.hits[at.expect("a point is found through a hit triangle")]
        };
        let entries = wall.iter().filter_map(|c| match c {
            Corner::Point(p) => Some(points.points[*p as usize].entry.triangle()),
            Corner::Old(_) => None,
        });
        let near: Vec<&TriangleCorners> = entries.map(hit).collect();
        for (h, &corner) in t.half_edges().into_iter().zip(wall) {
            let (source, weights) = match corner {
                Corner::Old(v) => {
                    let own = |hit: &TriangleCorners| hit.vertices.iter().position(|&c| c == v);
                    let near = near.iter().find_map(|&hit| Some((hit, own(hit)?)));
                    let fan = self.fan(v).map(|fan| (&self.hits[fan.hit.0], fan.hit.1));
                    let (hit, k) = near
                        .or(fan)
                        .expect("an old corner belongs to a hit triangle");
                    (hit, [0, 1, 2].map(|i| if i == k { 1.0 } else { 0.0 }))
                }
                Corner::Point(p) => {
                    let point = &points.points[p as usize];
                    let hit = hit(point.entry.triangle());
                    (hit, point.weights_in(hit.vertices))
                }
            };
            source.interpolate(edit, h, weights);
        }
    }

    /// Checks the fan of every vertex of the new triangles: it has all triangles of the vertex, at
    /// least three, and no neighbor twice.
    fn check_fans(&self, surface: &Surface) -> Result<(), NotManifold> {
        let topology = surface.topology();
        let new = self.new_triangles.iter().flat_map(|t| t.half_edges());
        let mut corners: Vec<(VertexId, HalfEdge)> = new.map(|h| (topology.origin(h), h)).collect();
        corners.sort_unstable();
        let mut neighbors: Vec<VertexId> = Vec::new();
        for run in corners.chunk_by(|a, b| a.0 == b.0) {
            let (vertex, first) = run[0];
            let surviving_count = self.fan(vertex).map_or(0, |fan| fan.surviving_count);
            // Not by `outgoing_fan`, which is valid only after the edit.
            neighbors.clear();
            let mut h = first;
            loop {
                neighbors.push(topology.target(h));
                h = topology.twin(h.prev());
                if h == first {
                    break;
                }
            }
            let fan = neighbors.len();
            neighbors.sort_unstable();
            neighbors.dedup();
            if fan != surviving_count + run.len() || neighbors.len() != fan || fan < 3 {
                return Err(vec![vertex]);
            }
        }
        Ok(())
    }
}

/// Joins boundary half-edges, all of which must find a partner.
fn stitch(edit: &mut Edit<'_>, half_edges: &[HalfEdge]) -> Result<(), NotManifold> {
    let topology = edit.surface().topology();
    let key = |h: HalfEdge| EdgeKey::new(topology.origin(h), topology.target(h));
    let mut keyed: Vec<(EdgeKey, HalfEdge)> = half_edges.iter().map(|&h| (key(h), h)).collect();
    keyed.sort_unstable();
    for group in keyed.chunk_by(|a, b| a.0 == b.0) {
        match *group {
            [_] => {}
            [(_, h), (_, g)] if topology.origin(h) == topology.origin(g) => {
                return Err(topology.triangle(h.triangle()).to_vec());
            }
            [_, _] => {}
            _ => return Err(group[0].0.vertices().to_vec()),
        }
    }
    for group in keyed.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, h), (_, g)] = *group {
            edit.set_twins(h, g);
        }
    }
    let topology = edit.surface().topology();
    match half_edges.iter().find(|&&h| topology.twin(h).is_null()) {
        Some(&h) => Err(vec![topology.origin(h)]),
        None => Ok(()),
    }
}

/// Returns the sides of components that enclose less than `min_volume` \[m^3\] at rest: flat, or
/// inside out.
pub(super) fn flat_sides(surface: &Surface, rebuilt: &Rebuilt, min_volume: f64) -> Vec<usize> {
    let mut seen = vec![false; surface.topology().triangle_slots()];
    let mut component = Vec::new();
    let mut is_flat = |seed: TriangleId| {
        component
            .iter()
            .for_each(|t: &TriangleId| seen[t.index()] = false);
        component.clear();
        component.push(seed);
        seen[seed.index()] = true;
        let mut at = 0;
        while let Some(&t) = component.get(at) {
            at += 1;
            for twin in t.half_edges().map(|h| surface.topology().twin(h)) {
                let neighbor = twin.triangle();
                if !std::mem::replace(&mut seen[neighbor.index()], true) {
                    component.push(neighbor);
                }
            }
            if component.len() > MAX_FLAT_TRIANGLES {
                return false;
            }
        }
        component.sort_unstable();
        surface.rest_volume_of(component.iter().copied()) < min_volume
    };
    let sides = rebuilt.seeds.iter().enumerate();
    sides
        .filter_map(|(i, seed)| seed.is_some_and(&mut is_flat).then_some(i))
        .collect()
}
