//! Coarsens walls near a cut in pairs, so that cuts across walls do not refine them without end.
//!
//! Walls of incisions coincide at rest. Vertices of equal rest positions are one [`Points`] entry:
//! two inside a wall, four where two walls cross, eight where three do. An operation is applied to
//! all of them or to none, so partners stay partners, and as the changes of two coincident walls
//! cancel, volumes stay.
//!
//! - [`collapse`]: all vertices of a point are contracted onto those of one neighbor. A point may
//!   go only if the triangles around it have all their partners there too. So points along tips and
//!   where three walls meet stay, and points of a crease move along it. A point of a cut on the
//!   skin moves along the rim where the skin is flat.
//! - [`flip`]: the diagonal of two triangles and that of their partners are flipped, but not those
//!   of the cut's own walls, whose triangles are mirror images corner by corner.
//!
//! Each operation moves a wall by at most [`MAX_OFFSET`] target lengths. A pass over k triangles
//! near the cut is O(k log k).

mod collapse;
mod flip;
mod points;
mod quality;
mod star;

use super::open::Sides;
use super::rim::Rim;
use super::sparse_set::SparseSet;
use crate::sizing::{self, RestShape};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Edit, HalfEdge, Surface, TriangleId, Vec3, VertexId};
use incise_refine::RefineParams;
use points::Points;
use star::Star;

/// Maximum displacement of a wall by an operation [target lengths].
///
/// An edge of one target length is as far off an arc whose radius is six of them.
pub(crate) const MAX_OFFSET: f64 = 0.02;

/// Sine of the smallest angle above which a collapse may make angles smaller: 20 degrees, as of
/// remeshing, and 10 degrees if the cut crosses walls.
///
/// Cells between crossing walls have smaller corners, and points to enlarge these would be many.
const GOOD_SINES: [f64; 2] = [0.342_020_143_325_668_7, 0.173_648_177_666_930_3];

/// Rounding error of the difference of two stored coordinates [of the largest coordinate].
const ROUNDING: f64 = f32::EPSILON as f64;

/// The walls near a cut, with scratch memory.
#[derive(Debug, Clone, Default)]
pub(crate) struct Walls {
    points: Points,
    /// The triangles of the cut's own walls.
    own: SparseSet,
    queue: Vec<u32>,
    is_queued: Vec<bool>,
    star: Star,
    /// Moves of vertices along the rim, in their order.
    moved: Vec<RimMove>,
}

/// A vertex of a rim that a collapse has moved onto the next one along it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RimMove {
    pub(crate) gone: VertexId,
    pub(crate) kept: VertexId,
    /// The vertex on its other side along the rim.
    pub(crate) other: VertexId,
    /// Its place before, as a part of the way from `kept` to `other`.
    pub(crate) part: f32,
}

impl RimMove {
    /// Returns the move of a vertex along an edge onto its end, whose places are the same.
    fn onto_end(surface: &Surface, along: HalfEdge) -> Self {
        let topology = surface.topology();
        let kept = topology.target(along);
        Self {
            gone: topology.origin(along),
            kept,
            other: kept,
            part: 0.0,
        }
    }
}

/// The place of a cut: its rim and its own walls.
#[derive(Debug, Clone, Copy)]
pub(super) struct Around<'a> {
    pub(super) rim: &'a Rim,
    pub(super) sides: &'a Sides,
    pub(super) caps: &'a [Vec<TriangleId>; 2],
    /// Whether it crosses walls of other incisions.
    pub(super) crosses_walls: bool,
}

/// The shape of a surface at rest, and the targets of its edges.
#[derive(Debug, Clone, Copy)]
struct Shape {
    rest: RestShape,
    /// Fixed edge length of the surface \[m\].
    length: Option<f64>,
    z: f64,
    /// Sine of the smallest angle above which a collapse may make angles smaller.
    good_sine: f64,
}

impl Shape {
    fn at(&self, surface: &Surface, v: VertexId) -> Vec3 {
        self.rest.position(surface, v)
    }

    /// Returns the place of a vertex in the shape that is not at rest \[m\].
    fn other(&self, surface: &Surface, v: VertexId) -> Vec3 {
        match self.rest {
            RestShape::Rest => surface.position(v),
            RestShape::Present => surface.rest_position(v),
        }
    }

    /// Returns the position and the rest position of a vertex with these places \[m\].
    fn in_order(&self, rest: Vec3, other: Vec3) -> [Vec3; 2] {
        match self.rest {
            RestShape::Rest => [other, rest],
            RestShape::Present => [rest, other],
        }
    }

    /// Returns the target edge length at a vertex at rest \[m\]; none where none is stored.
    fn target(&self, surface: &Surface, v: VertexId) -> Option<f64> {
        let stored = sizing::stored(surface, v)?;
        Some(self.length.unwrap_or(stored) * self.z)
    }
}

impl Walls {
    /// Coarsens the walls around a cut and its own.
    ///
    /// Nothing changes on surfaces without stored targets.
    pub(super) fn coarsen(
        &mut self,
        edit: &mut Edit<'_>,
        rest: RestShape,
        around: Around<'_>,
        refine: &RefineParams,
    ) {
        self.moved.clear();
        if edit.surface().channel(sizing::CHANNEL).is_none() {
            return;
        }
        let shape = Shape {
            rest,
            length: refine.rim_length,
            z: refine.level.z(),
            good_sine: GOOD_SINES[usize::from(around.crosses_walls)],
        };
        let Around {
            rim, sides, caps, ..
        } = around;
        let rings = (0..rim.sizes.len()).flat_map(|i| rim.ring(i));
        let along = rings.flat_map(|node| sides.rim[node as usize]);
        let along = along.filter(|h| !h.is_null()).flat_map(|h| [h, h.next()]);
        let inside = caps.iter().flatten().flat_map(|t| t.half_edges());
        let starts: Vec<HalfEdge> = along.chain(inside).collect();
        self.points.find(edit.surface(), rest, &starts);
        self.own.clear(edit.surface().topology().triangle_slots());
        for t in caps.iter().flatten() {
            self.own.insert(t.0);
        }
        loop {
            self.queue.clear();
            self.queue.extend(0..self.points.len());
            self.is_queued.clear();
            self.is_queued.resize(self.queue.len(), true);
            self.flip_all(edit, &shape);
            if self.collapse_all(edit, &shape) == 0 {
                return;
            }
        }
    }

    /// Returns the moves of vertices along the rim by the last cut, in their order.
    pub(super) fn moved(&self) -> &[RimMove] {
        &self.moved
    }

    /// Collapses points until none can go. Returns the number of collapses.
    fn collapse_all(&mut self, edit: &mut Edit<'_>, shape: &Shape) -> usize {
        let mut done = 0;
        let mut at = 0;
        while let Some(&point) = self.queue.get(at) {
            at += 1;
            self.is_queued[point as usize] = false;
            if self.collapse(edit, shape, point) {
                done += 1;
            }
        }
        done
    }

    fn enqueue(&mut self, point: u32) {
        if !std::mem::replace(&mut self.is_queued[point as usize], true) {
            self.queue.push(point);
        }
    }
}

/// Returns the sine of the smallest angle of a triangle.
fn smallest_sine([a, b, c]: [Vec3; 3]) -> f64 {
    let mut edges = [(b - a).norm(), (c - b).norm(), (a - c).norm()];
    edges.sort_by(f64::total_cmp);
    let area = area_vector([a, b, c]).norm();
    if area > 0.0 {
        area / (edges[1] * edges[2])
    } else {
        0.0
    }
}
