//! The edit: hit triangles out, walls and caps in, everything checked before anything counts.

use super::points::PointSet;
use super::strip::Strip;
use super::{ClosedLip, Corner};
use crate::error::CutError;
use incise_mesh::geometry::round;
use incise_mesh::{
    AddedVertex, HalfEdge, Origin, Surface, TopologyDelta, TopologyError, TriangleId, VertexId,
};

/// An edited copy of a surface.
pub(super) struct Edit {
    pub(super) surface: Surface,
    pub(super) delta: TopologyDelta,
    pub(super) cap: Vec<TriangleId>,
    /// One triangle of every lip; none of a lip that needs none.
    lip_triangles: Vec<Option<TriangleId>>,
}

/// The most triangles that a flat component is looked for in: one of more is no tip or sliver.
const LARGEST_FLAT: usize = 256;

/// Why the result would not be a closed manifold, and which lips take part in it.
pub(super) struct Failure {
    pub(super) error: CutError,
    pub(super) lips: Vec<usize>,
}

/// Makes the edit on a copy of `before`.
///
/// # Errors
/// [`Failure`] when the result would not be a closed manifold.
pub(super) fn apply(
    before: &Surface,
    strips: &[Strip],
    lips: &[ClosedLip<'_>],
) -> Result<Edit, Failure> {
    let mut edit = Edit {
        surface: before.clone(),
        delta: TopologyDelta::default(),
        cap: Vec::new(),
        lip_triangles: Vec::with_capacity(lips.len()),
    };
    // How many vertices there were before each lip: a failure is traced back to its lips by them.
    let mut bounds = Vec::with_capacity(lips.len() + 1);
    match edit.make(before, strips, lips, &mut bounds) {
        Ok(()) => Ok(edit),
        Err(error) => {
            let vertices = edit.where_is(&error);
            let concerned = lips.iter().enumerate().filter(|&(i, lip)| {
                let first = bounds.get(i).copied().unwrap_or(usize::MAX);
                let last = bounds.get(i + 1).copied().unwrap_or(usize::MAX);
                let added = &edit.delta.vertices_added;
                let own = added.iter().take(last).skip(first);
                own.clone().any(|a| vertices.contains(&a.vertex))
                    || lip
                        .corners()
                        .any(|c| matches!(c, Corner::Old(v) if vertices.contains(&v)))
            });
            let lips = concerned.map(|(i, _)| i).collect();
            Err(Failure { error, lips })
        }
    }
}

impl ClosedLip<'_> {
    fn corners(&self) -> impl Iterator<Item = Corner> {
        self.walls.iter().flatten().chain(&self.rim).copied()
    }
}

impl Edit {
    fn make(
        &mut self,
        before: &Surface,
        strips: &[Strip],
        lips: &[ClosedLip<'_>],
        bounds: &mut Vec<usize>,
    ) -> Result<(), CutError> {
        let hits: Vec<TriangleId> = strips
            .iter()
            .flat_map(|s| s.hits.iter().map(|h| h.triangle))
            .collect();
        self.delta.triangles_removed = hits
            .iter()
            .map(|&t| (t, before.topology().triangle(t)))
            .collect();
        let mut open: Vec<HalfEdge> = hits
            .iter()
            .flat_map(|t| t.half_edges())
            .map(|h| before.topology().twin(h))
            .collect();
        let orphans = self.surface.remove_triangles(&hits);
        open.retain(|&h| self.surface.topology().is_triangle(h.triangle()));
        for lip in lips {
            bounds.push(self.delta.vertices_added.len());
            let first = self.delta.triangles_added.len();
            self.add_lip(before, lip)?;
            let own = self.delta.triangles_added.get(first).copied();
            self.lip_triangles.push(own);
        }
        bounds.push(self.delta.vertices_added.len());
        let added = &self.delta.triangles_added;
        open.extend(added.iter().flat_map(|t| t.half_edges()));
        self.surface.stitch(&open)?;
        check_closed(&self.surface, &open)?;
        check_fans(before, &hits, self)?;
        let unused: Vec<VertexId> = orphans
            .into_iter()
            .filter(|&v| self.surface.topology().outgoing(v).is_null())
            .collect();
        self.surface.remove_vertices(&unused);
        self.delta.vertices_removed = unused;
        Ok(())
    }

    /// The lips of components that enclose less than `smallest` \[m^3\] at rest: flat, or inside out.
    pub(super) fn flat_lips(&self, smallest: f64) -> Vec<usize> {
        let labels = self.surface.topology().component_labels();
        let mut sizes: Vec<usize> = Vec::new();
        for &label in labels.iter().filter(|&&label| label != u32::MAX) {
            let label = label as usize;
            sizes.resize(sizes.len().max(label + 1), 0);
            sizes[label] += 1;
        }
        let is_flat = |&t: &TriangleId| {
            let label = labels[t.index()];
            sizes[label as usize] <= LARGEST_FLAT && {
                let triangles = self.surface.topology().triangles();
                let own = triangles.filter(|t| labels[t.index()] == label);
                self.surface.rest_volume_of(own) < smallest
            }
        };
        let lips = self.lip_triangles.iter().enumerate();
        lips.filter(|(_, t)| t.as_ref().is_some_and(is_flat))
            .map(|(i, _)| i)
            .collect()
    }

    /// The vertices of the edited surface at which `error` was found.
    fn where_is(&self, error: &CutError) -> Vec<VertexId> {
        match *error {
            CutError::NotManifold { vertex }
            | CutError::Topology(TopologyError::RepeatedVertex { vertex, .. }) => vec![vertex],
            CutError::Topology(TopologyError::NonManifoldEdge { a, b }) => vec![a, b],
            CutError::Topology(TopologyError::InconsistentWinding { first, .. }) => {
                self.surface.topology().triangle(first).to_vec()
            }
            _ => Vec::new(),
        }
    }

    fn add_lip(&mut self, before: &Surface, lip: &ClosedLip<'_>) -> Result<(), CutError> {
        let points = lip.points;
        let mut ids: Vec<(Corner, VertexId)> = Vec::new();
        let is_point = |c: &Corner| matches!(c, Corner::Point(_));
        ids.extend(lip.corners().filter(is_point).map(|c| (c, VertexId::NULL)));
        ids.sort_unstable();
        ids.dedup_by_key(|entry| entry.0);
        for (corner, id) in &mut ids {
            if let Corner::Point(p) = *corner {
                let point = &points.points[p as usize];
                let [a, b] = point.ends;
                let origin = Origin::OnEdge { a, b, t: point.t };
                *id = self.add_vertex(round(point.position), origin, lip.piece);
            }
        }
        let vertex = |corner: Corner| match corner {
            Corner::Old(v) => v,
            Corner::Point(_) => {
                let at = ids
                    .binary_search_by_key(&corner, |entry| entry.0)
                    .expect("every point of the lip has a vertex");
                ids[at].1
            }
        };
        for wall in &lip.walls {
            let t = self.add_triangle(wall.map(vertex), lip.piece)?;
            interpolate_corners(before, points, wall, t, &mut self.surface);
        }
        let Some(cap) = &lip.cap else { return Ok(()) };
        let mut vertices: Vec<VertexId> = lip.rim.iter().map(|&c| vertex(c)).collect();
        for (parents, &position) in cap.inner.iter().zip(&cap.points[cap.rim..]) {
            let origin = Origin::OnCap {
                parents: parents.map(|i| vertices[i as usize]),
                weights: [1.0 / 3.0; 3],
            };
            vertices.push(self.add_vertex(round(position), origin, lip.piece));
        }
        for triangle in &cap.triangles {
            let t = self.add_triangle(triangle.map(|i| vertices[i as usize]), lip.piece)?;
            self.cap.push(t);
        }
        Ok(())
    }

    fn add_vertex(&mut self, [x, y, z]: [f32; 3], origin: Origin, piece: u32) -> VertexId {
        let surface = &self.surface;
        let rest = origin.interpolate(|v| surface.rest[v.index()]);
        let [w] = origin.interpolate(|v| [surface.positions[v.index()][3]]);
        let w = round([w, 0.0, 0.0].into())[0];
        let vertex = self.surface.add_vertex([x, y, z, w], round(rest.into()));
        self.delta.vertices_added.push(AddedVertex {
            vertex,
            origin,
            piece,
        });
        vertex
    }

    fn add_triangle(&mut self, corners: [VertexId; 3], piece: u32) -> Result<TriangleId, CutError> {
        let t = self.surface.add_triangle(corners, piece)?;
        self.delta.triangles_added.push(t);
        Ok(t)
    }
}

/// Gives the corners of a wall the attributes that the hit triangles had there. A vertex of the old
/// boundary takes those of the hit triangle through which a point of the same wall was found, if it
/// has the vertex, and else of any triangle around it.
fn interpolate_corners(
    before: &Surface,
    points: &PointSet,
    wall: &[Corner; 3],
    t: TriangleId,
    surface: &mut Surface,
) {
    let attributes = &before.corners;
    if attributes.uv.is_empty() && attributes.normal.is_empty() {
        return;
    }
    let entries = wall.iter().filter_map(|c| match c {
        Corner::Point(p) => Some(points.points[*p as usize].entry.triangle()),
        Corner::Old(_) => None,
    });
    let near: Vec<TriangleId> = entries.collect();
    for (h, &corner) in t.half_edges().into_iter().zip(wall) {
        let parents = match corner {
            Corner::Old(v) => {
                let own = near
                    .iter()
                    .flat_map(|t| t.half_edges())
                    .find(|&g| before.topology().origin(g) == v)
                    .unwrap_or_else(|| before.topology().outgoing(v));
                [(own, 1.0), (own, 0.0)]
            }
            Corner::Point(p) => {
                let point = &points.points[p as usize];
                let (low, high) = if before.topology().origin(point.entry) == point.ends[0] {
                    (point.entry, point.entry.next())
                } else {
                    (point.entry.next(), point.entry)
                };
                [(low, 1.0 - point.t), (high, point.t)]
            }
        };
        if let Some(uv) = surface.corners.uv.get_mut(h.index()) {
            *uv = blend(&attributes.uv, parents);
        }
        if let Some(normal) = surface.corners.normal.get_mut(h.index()) {
            *normal = blend(&attributes.normal, parents);
        }
    }
}

fn blend<const N: usize>(values: &[[f32; N]], parents: [(HalfEdge, f32); 2]) -> [f32; N] {
    let [(a, s), (b, t)] = parents;
    std::array::from_fn(|k| s * values[a.index()][k] + t * values[b.index()][k])
}

fn check_closed(surface: &Surface, half_edges: &[HalfEdge]) -> Result<(), CutError> {
    let topology = surface.topology();
    match half_edges.iter().find(|&&h| topology.twin(h).is_null()) {
        Some(&h) => Err(CutError::NotManifold {
            vertex: topology.origin(h),
        }),
        None => Ok(()),
    }
}

/// Around every vertex of the new triangles: all its triangles in one fan, at least three, and no
/// neighbor twice.
fn check_fans(before: &Surface, hits: &[TriangleId], edit: &Edit) -> Result<(), CutError> {
    let topology = edit.surface.topology();
    let mut corners: Vec<VertexId> = edit
        .delta
        .triangles_added
        .iter()
        .flat_map(|&t| topology.triangle(t))
        .collect();
    corners.sort_unstable();
    let mut lost: Vec<VertexId> = hits
        .iter()
        .flat_map(|&t| before.topology().triangle(t))
        .collect();
    lost.sort_unstable();
    let mut neighbors: Vec<VertexId> = Vec::new();
    for run in corners.chunk_by(|a, b| a == b) {
        let vertex = run[0];
        let old = if vertex.index() < before.topology().vertex_slots()
            && !before.topology().outgoing(vertex).is_null()
        {
            let gone =
                lost.partition_point(|&v| v <= vertex) - lost.partition_point(|&v| v < vertex);
            before.topology().outgoing_fan(vertex).count() - gone
        } else {
            0
        };
        neighbors.clear();
        neighbors.extend(topology.outgoing_fan(vertex).map(|h| topology.target(h)));
        let fan = neighbors.len();
        neighbors.sort_unstable();
        neighbors.dedup();
        if fan != old + run.len() || neighbors.len() != fan || fan < 3 {
            return Err(CutError::NotManifold { vertex });
        }
    }
    Ok(())
}
