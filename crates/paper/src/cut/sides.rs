//! The two sides of a strip, in one representation (Algorithm 2, lines 17 to 19 and 31).
//!
//! A side lists the remainder of each hit triangle, an edge or a single vertex, in the direction of
//! the triangles that fill the hole.

use super::points::PointSet;
use super::strip::Strip;
use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, TriangleId, Vec3, VertexId, index_u32};

/// The remainder of one hit triangle on one side.
#[derive(Debug, Clone, Copy)]
pub(super) struct SideStep {
    /// Rank of the intersection point before (as in [`super::points::Loop::rank`], but counted
    /// along the side) and after.
    pub(super) from: u32,
    pub(super) to: u32,
    /// The vertex on this side; the first one if there are two.
    pub(super) start: VertexId,
    /// The second one: then start to end is an edge of the old boundary.
    pub(super) end: Option<VertexId>,
    /// Whether the triangle behind that edge is hit too, so that no triangle of the edge is left.
    pub(super) is_loose: bool,
    /// Normal of the hit triangle, as long as twice its area \[m^2\].
    pub(super) normal: Vec3,
}

/// One side of one strip.
#[derive(Debug, Clone)]
pub(super) struct Side {
    pub(super) steps: Vec<SideStep>,
    /// The strip's representatives in the order of the side.
    pub(super) points: Vec<u32>,
    /// Old vertices that the boundaries of this side pass more than once, ascending.
    pub(super) pinched: Vec<VertexId>,
    /// Whether this is the side to which the sweep's normal points.
    pub(super) positive: bool,
    pub(super) piece: u32,
}

impl Side {
    pub(super) fn is_pinched(&self, v: VertexId) -> bool {
        self.pinched.binary_search(&v).is_ok()
    }

    pub(super) fn is_single_vertex(&self) -> bool {
        self.steps.iter().all(|s| s.end.is_none())
    }
}

/// Returns both sides of every strip.
pub(super) fn sides(surface: &Surface, strips: &[Strip], points: &PointSet) -> Vec<Side> {
    let mut sides: Vec<Side> = Vec::with_capacity(2 * strips.len());
    let mut hit_triangles: Vec<TriangleId> = strips
        .iter()
        .flat_map(|s| s.hits.iter().map(|h| h.triangle))
        .collect();
    hit_triangles.sort_unstable();
    for positive in [true, false] {
        let first = sides.len();
        for (strip, l) in strips.iter().zip(&points.loops) {
            let n = l.representatives.len();
            let count = index_u32(n);
            let mut steps = steps(surface, strip, &l.rank, count, positive, &hit_triangles);
            let mut order: Vec<u32> = l.representatives.clone().collect();
            if !positive {
                // Against the strip, ranks count down: count them up from the last.
                steps.reverse();
                order.reverse();
                order.rotate_right(1);
                for step in &mut steps {
                    (step.from, step.to) = (count - step.to, count - step.from);
                }
            }
            sides.push(Side {
                steps,
                points: order,
                pinched: Vec::new(),
                positive,
                piece: surface.piece(strip.hits[0].triangle),
            });
        }
        let mut visits: Vec<VertexId> = sides[first..].iter().flat_map(visits).collect();
        visits.sort_unstable();
        let pinched: Vec<VertexId> = visits
            .chunk_by(|a, b| a == b)
            .filter(|run| run.len() > 1)
            .map(|run| run[0])
            .collect();
        for side in &mut sides[first..] {
            side.pinched.clone_from(&pinched);
        }
    }
    sides
}

fn steps(
    surface: &Surface,
    strip: &Strip,
    rank: &[u32],
    count: u32,
    positive: bool,
    hit_triangles: &[TriangleId],
) -> Vec<SideStep> {
    let topology = surface.topology();
    let mut steps = Vec::with_capacity(strip.hits.len());
    for (j, hit) in strip.hits.iter().enumerate() {
        // The triangle is (a, b, c) with a below and b above; c is where the exit tells.
        let [a, b] = [hit.entry, hit.entry.next()].map(|h| topology.origin(h));
        let c = topology.origin(hit.entry.prev());
        let c_above = hit.exit == hit.entry.prev();
        let (start, edge) = match (positive, c_above) {
            (true, true) => (b, Some(hit.entry.next())),
            (true, false) => (b, None),
            (false, true) => (a, None),
            (false, false) => (c, Some(hit.entry.prev())),
        };
        let is_loose = edge.is_some_and(|h| {
            hit_triangles
                .binary_search(&topology.twin(h).triangle())
                .is_ok()
        });
        steps.push(SideStep {
            from: rank[j],
            to: rank.get(j + 1).copied().unwrap_or(count),
            start,
            end: edge.map(|h| topology.target(h)),
            is_loose,
            normal: area_vector(surface.triangle_positions(hit.triangle)),
        });
    }
    steps
}

/// Returns the old vertices that a side passes, one entry per passage.
fn visits(side: &Side) -> Vec<VertexId> {
    if side.is_single_vertex() {
        return vec![side.steps[0].start];
    }
    side.steps
        .iter()
        .filter(|s| s.end.is_some())
        .map(|s| s.start)
        .collect()
}
