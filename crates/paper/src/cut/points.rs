//! Intersection points of the sweep with edges, and the merge of close ones (Algorithm 2, lines 9
//! and 20 to 25).
//!
//! The listing compares all points with all, which also merges points of different loops, or of
//! opposite sides of a thin limb. Points merge only along their own loop here, each run into its
//! first point, and a loop keeps at least three: the order along the loop survives.

use super::strip::{Hit, Strip};
use super::{Corner, newell};
use crate::error::PaperError;
use incise_cut::{EdgeCrossing, Sweep};
use incise_mesh::{HalfEdge, Surface, TriangleId, Vec3, VertexId, index_u32};
use std::ops::Range;

/// Minimum distance of a point from the ends of its edge \[edge lengths\].
///
/// Keeps vertices apart when the sweep passes through a vertex.
const MARGIN: f32 = 0.02;

/// A point where an edge crosses the sweep.
#[derive(Debug, Clone, Copy)]
pub(super) struct IntersectionPoint {
    /// The edge's ends, the smaller id first.
    pub(super) ends: [VertexId; 2],
    /// Position along the edge, 0 to 1.
    pub(super) t: f32,
    /// Position \[m\].
    pub(super) position: Vec3,
    /// The half-edge through which its strip is entered: corner attributes come from its triangle.
    pub(super) entry: HalfEdge,
}

/// The points of one strip.
#[derive(Debug, Clone)]
pub(super) struct Loop {
    /// The representatives, by their number in [`PointSet::points`].
    pub(super) representatives: Range<u32>,
    /// The representative into which the entry point of each hit of the strip merged.
    ///
    /// Counted from the first, never decreasing; the number of representatives is the first again.
    pub(super) rank: Vec<u32>,
    /// A triangle of the strip, to name it in an error.
    triangle: TriangleId,
    /// The shortest and the longest edge of the strip's triangles \[m\].
    shortest: f64,
    longest: f64,
}

/// The points of a cut after merging.
#[derive(Debug, Clone, Default)]
pub(super) struct PointSet {
    pub(super) points: Vec<IntersectionPoint>,
    pub(super) loops: Vec<Loop>,
}

/// Returns the points of every strip, merged where closer than `min_distance` \[m\]; 0 keeps all.
pub(super) fn intersection_points(
    surface: &Surface,
    strips: &[Strip],
    min_distance: f64,
) -> PointSet {
    let mut set = PointSet::default();
    for strip in strips {
        let all: Vec<IntersectionPoint> = strip
            .hits
            .iter()
            .map(|hit| IntersectionPoint::new(surface, hit))
            .collect();
        let (kept, rank) = merge(&all, min_distance);
        let first = index_u32(set.points.len());
        let (shortest, longest) = edge_range(surface, strip);
        set.points.extend(kept.iter().map(|&j| all[j]));
        set.loops.push(Loop {
            representatives: first..index_u32(set.points.len()),
            rank,
            triangle: strip.hits[0].triangle,
            shortest,
            longest,
        });
    }
    set
}

fn edge_range(surface: &Surface, strip: &Strip) -> (f64, f64) {
    let corners = strip
        .hits
        .iter()
        .map(|hit| surface.triangle_positions(hit.triangle));
    let edges = corners.flat_map(|[a, b, c]| [b - a, c - b, a - c]);
    edges.map(|edge| edge.norm()).fold(
        (f64::INFINITY, 0.0),
        |(shortest, longest): (f64, f64), length| (shortest.min(length), longest.max(length)),
    )
}

impl IntersectionPoint {
    /// The point on the entry edge of a hit triangle.
    fn new(surface: &Surface, hit: &Hit) -> Self {
        let EdgeCrossing { ends, t, .. } = hit.crossing;
        let t = t.clamp(MARGIN, 1.0 - MARGIN);
        let [p, q] = ends.map(|v| surface.position(v));
        Self {
            ends,
            t,
            position: p + (q - p) * f64::from(t),
            entry: hit.entry,
        }
    }

    /// Returns the weights of the corners of a triangle at the edge.
    pub(super) fn weights_in(&self, corners: [VertexId; 3]) -> [f32; 3] {
        corners.map(|v| match v {
            v if v == self.ends[0] => 1.0 - self.t,
            v if v == self.ends[1] => self.t,
            _ => 0.0,
        })
    }
}

/// Returns the points that stay, and the rank of each.
fn merge(points: &[IntersectionPoint], min_distance: f64) -> (Vec<usize>, Vec<u32>) {
    let mut distance = min_distance;
    loop {
        let close = |i: usize, j: usize| {
            distance > 0.0 && (points[i].position - points[j].position).norm() < distance
        };
        let mut kept: Vec<usize> = Vec::new();
        let mut rank = Vec::with_capacity(points.len());
        for j in 0..points.len() {
            if kept.last().is_none_or(|&last| !close(j, last)) {
                kept.push(j);
            }
            rank.push(index_u32(kept.len() - 1));
        }
        // The last run may lie at the loop's beginning: its points then stand for the first again.
        if kept.len() > 3 && close(kept[kept.len() - 1], 0) {
            kept.pop();
        }
        if kept.len() >= 3 || distance == 0.0 {
            return (kept, rank);
        }
        distance = if distance < min_distance / 16.0 {
            0.0
        } else {
            distance / 2.0
        };
    }
}

impl PointSet {
    /// Returns the position of a corner \[m\].
    pub(super) fn position(&self, surface: &Surface, corner: Corner) -> Vec3 {
        match corner {
            Corner::Old(v) => surface.position(v),
            Corner::Point(p) => self.points[p as usize].position,
        }
    }

    /// Checks that no loop lies inside another and runs against it.
    ///
    /// The cap would have a hole, and capping both loops would cover the hole twice. The two loops
    /// belong to one piece, or the inner one to a cavity. A loop that encloses less than the square
    /// of half its shortest edge is a fold of the surface, no tunnel, and is ignored.
    pub(super) fn refuse_nested_loops(
        &self,
        surface: &Surface,
        sweep: &Sweep,
    ) -> Result<(), PaperError> {
        let (_, normal) = sweep.plane();
        let side = Vec3::ith(normal.iamin(), 1.0);
        let u = normal.cross(&side).normalize();
        let v = normal.cross(&u);
        let outlines: Vec<Vec<Vec3>> = self
            .loops
            .iter()
            .map(|l| self.points_of(l).map(|p| p.position).collect())
            .collect();
        // Entered from below to above, the strip of an outer loop runs clockwise about the normal.
        let areas: Vec<f64> = outlines
            .iter()
            .map(|o| newell(o).dot(&normal) / 2.0)
            .collect();
        let piece = |l: usize| surface.piece(self.loops[l].triangle);
        for inner in (0..areas.len()).filter(|&l| areas[l] > 0.0) {
            let own = &self.loops[inner];
            let cavity = is_cavity(surface, piece(inner), own.longest);
            if !cavity && areas[inner] < own.shortest.powi(2) / 4.0 {
                continue;
            }
            let p = outlines[inner][0];
            let inside = |other: &Vec<Vec3>| {
                let crossings = (0..other.len()).filter(|&i| {
                    let [a, b] = [other[i], other[(i + 1) % other.len()]].map(|x| x - p);
                    let ((ax, ay), (bx, by)) = ((a.dot(&u), a.dot(&v)), (b.dot(&u), b.dot(&v)));
                    (ay > 0.0) != (by > 0.0) && ax - ay * (bx - ax) / (by - ay) > 0.0
                });
                crossings.count() % 2 == 1
            };
            let encloses = |&o: &usize| {
                areas[o] <= 0.0 && (cavity || piece(o) == piece(inner)) && inside(&outlines[o])
            };
            if (0..areas.len()).any(|o| encloses(&o)) {
                return Err(PaperError::NestedSection {
                    triangle: own.triangle,
                });
            }
        }
        Ok(())
    }

    /// Returns the positions of points \[m\].
    pub(super) fn outline(&self, numbers: &[u32]) -> Vec<Vec3> {
        let position = |&p: &u32| self.points[p as usize].position;
        numbers.iter().map(position).collect()
    }

    fn points_of(&self, l: &Loop) -> impl Iterator<Item = &IntersectionPoint> {
        self.points[l.representatives.start as usize..l.representatives.end as usize].iter()
    }
}

/// Returns whether a piece is the wall of a cavity.
///
/// It is inside out at rest, by more volume than slivers with edges of `length` \[m\] have.
fn is_cavity(surface: &Surface, piece: u32, length: f64) -> bool {
    let triangles = surface.topology().triangles();
    let own = triangles.filter(|&t| surface.piece(t) == piece);
    surface.rest_volume_of(own) < -length.powi(3) / 12.0
}
