//! Nearest points that a moving point may reach within a frame.
//!
//! Contact detection gives every vertex the box of its displacement. Nodes of the BVH have such a
//! box, too, so a search descends only where the relative motion may close the gap.

use super::nearest::Candidate;
use super::{Bvh, LEAF_SIZE, NONE, NearestPoint, least, most, triangle_bounds, union};
use crate::geometry::to_f32;
use crate::{Aabb, Surface, TriangleId, Vec3};

/// Boxes, displacements and pieces of the triangles below each node of a BVH.
#[derive(Debug, Clone, Default)]
pub struct MotionBounds {
    nodes: Vec<Motion>,
    /// By place in the leaves.
    triangles: Vec<Motion>,
}

/// The motion of triangles. Vectors have a fourth component of 0, so that each comparison is one
/// vector instruction.
#[derive(Debug, Clone, Copy)]
struct Motion {
    /// Corners of the bounding box \[m\].
    bounds: [[f32; 4]; 2],
    /// Corners of the box around the displacements of the vertices \[m\].
    displacement: [[f32; 4]; 2],
    /// Piece of all triangles; [`NONE`] for several pieces.
    piece: u32,
}

impl Motion {
    const NOTHING: Self = Self {
        bounds: [[0.0; 4]; 2],
        displacement: [[0.0; 4]; 2],
        piece: NONE,
    };

    fn of_triangle(surface: &Surface, t: TriangleId, displacements: &[Aabb]) -> Self {
        let corners = surface.topology().triangle(t);
        let [a, b, c] = corners.map(|v| &displacements[v.index()]);
        Self {
            bounds: padded_box(&triangle_bounds(surface, corners)),
            displacement: padded_box(&union(&union(a, b), c)),
            piece: surface.piece(t),
        }
    }

    fn union(&self, other: &Self) -> Self {
        let both = |a: &[[f32; 4]; 2], b: &[[f32; 4]; 2]| {
            [
                std::array::from_fn(|k| least(a[0][k], b[0][k])),
                std::array::from_fn(|k| most(a[1][k], b[1][k])),
            ]
        };
        Self {
            bounds: both(&self.bounds, &other.bounds),
            displacement: both(&self.displacement, &other.displacement),
            piece: if self.piece == other.piece {
                self.piece
            } else {
                NONE
            },
        }
    }
}

fn padded([x, y, z]: [f32; 3]) -> [f32; 4] {
    [x, y, z, 0.0]
}

fn padded_box(bounds: &Aabb) -> [[f32; 4]; 2] {
    [padded(bounds.min), padded(bounds.max)]
}

impl MotionBounds {
    /// Computes the bounds of a BVH's nodes from the displacements of vertex slots \[m\]. O(n).
    ///
    /// Valid until vertices move or the BVH is updated or rebuilt.
    pub fn find(&mut self, bvh: &Bvh, surface: &Surface, displacements: &[Aabb]) {
        self.nodes.resize(bvh.nodes.len(), Motion::NOTHING);
        let places = LEAF_SIZE * bvh.blocks.len();
        self.triangles.resize(places, Motion::NOTHING);
        if !bvh.nodes.is_empty() {
            self.find_below(bvh, surface, displacements, 0);
        }
    }

    /// Returns the capacity, in nodes and triangles.
    #[must_use]
    pub fn capacity(&self) -> usize {
        self.nodes.capacity() + self.triangles.capacity()
    }

    fn find_below(
        &mut self,
        bvh: &Bvh,
        surface: &Surface,
        displacements: &[Aabb],
        at: u32,
    ) -> Motion {
        let node = &bvh.nodes[at as usize];
        let found = if node.is_leaf() {
            let block = node.index as usize;
            let triangles = bvh.blocks[block].triangles[..node.count as usize].iter();
            let places = &mut self.triangles[LEAF_SIZE * block..];
            let each = triangles.zip(places).map(|(&t, place)| {
                *place = Motion::of_triangle(surface, t, displacements);
                *place
            });
            each.reduce(|a, b| a.union(&b)).unwrap_or(Motion::NOTHING)
        } else {
            let [left, right] = [node.index, node.index + 1]
                .map(|child| self.find_below(bvh, surface, displacements, child));
            left.union(&right)
        };
        self.nodes[at as usize] = found;
        found
    }
}

/// A point that moves, with the triangles that it may touch.
#[derive(Debug, Clone, Copy)]
pub struct MovingPoint {
    /// Position at the start \[m\].
    pub position: Vec3,
    /// Box around the possible displacements \[m\].
    pub displacement: Aabb,
    /// Distance that counts as reached \[m\].
    pub margin: f64,
    /// Piece whose triangles do not count.
    pub excluded_piece: Option<u32>,
}

impl MovingPoint {
    /// Returns whether something in a box, with a box of displacements, may be reached.
    #[must_use]
    pub fn reaches(&self, bounds: &Aabb, displacement: &Aabb) -> bool {
        Query::new(self).reaches(&padded_box(bounds), &padded_box(displacement))
    }
}

/// A [`MovingPoint`] in vectors of four components.
struct Query {
    position: [f32; 4],
    displacement: [[f32; 4]; 2],
    squared_margin: f32,
    /// Piece whose triangles do not count, or [`NONE`].
    excluded: u32,
}

impl Query {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "positions and displacements have 32 bits"
    )]
    fn new(point: &MovingPoint) -> Self {
        Self {
            position: padded(to_f32(point.position)),
            displacement: padded_box(&point.displacement),
            squared_margin: (point.margin * point.margin) as f32,
            excluded: point.excluded_piece.unwrap_or(NONE),
        }
    }

    /// Returns whether a box may be reached. True for any box in one that is reached.
    #[inline]
    fn reaches(&self, bounds: &[[f32; 4]; 2], displacement: &[[f32; 4]; 2]) -> bool {
        let [back, forth] = self.relative(displacement);
        let off: [f32; 4] = std::array::from_fn(|k| {
            let below = bounds[0][k] - (self.position[k] + forth[k]);
            let above = (self.position[k] + back[k]) - bounds[1][k];
            most(most(below, above), 0.0)
        });
        sum(off.map(|x| x * x)) <= self.squared_margin
    }

    /// Returns the ranges of displacements relative to others, with rest \[m\].
    #[inline]
    fn relative(&self, other: &[[f32; 4]; 2]) -> [[f32; 4]; 2] {
        let [min, max] = &self.displacement;
        [
            std::array::from_fn(|k| least(min[k] - other[1][k], 0.0)),
            std::array::from_fn(|k| most(max[k] - other[0][k], 0.0)),
        ]
    }

    /// Returns the maximum distance from a triangle that is reached \[m\].
    fn radius(&self, displacement: &[[f32; 4]; 2]) -> f64 {
        let [back, forth] = self.relative(displacement);
        let farthest: [f32; 4] = std::array::from_fn(|k| most(-back[k], forth[k]));
        f64::from(self.squared_margin).sqrt() + f64::from(sum(farthest.map(|x| x * x))).sqrt()
    }

    /// Returns whether triangles may count and be reached.
    #[inline]
    fn may_touch(&self, motion: &Motion) -> bool {
        (motion.piece != self.excluded || self.excluded == NONE)
            && self.reaches(&motion.bounds, &motion.displacement)
    }
}

#[inline]
fn sum([a, b, c, d]: [f32; 4]) -> f32 {
    (a + c) + (b + d)
}

impl Bvh {
    /// Returns the nearest point among the triangles that count and that a moving point may reach.
    ///
    /// `counts` decides which triangles count. A good first guess, such as the last nearest
    /// triangle, speeds the search up.
    #[must_use]
    pub fn nearest_in_reach(
        &self,
        surface: &Surface,
        point: &MovingPoint,
        bounds: &MotionBounds,
        first: Option<TriangleId>,
        counts: impl Fn(TriangleId) -> bool,
    ) -> Option<NearestPoint> {
        let query = Query::new(point);
        let reach = query.radius(&bounds.nodes.first()?.displacement);
        let is_near = |at: u32| query.may_touch(&bounds.nodes[at as usize]);
        let accepts = |t: TriangleId| {
            query.may_touch(&bounds.triangles[self.places[t.index()] as usize]) && counts(t)
        };
        let reaches = |found: &Candidate, t: TriangleId| {
            let motion = &bounds.triangles[self.places[t.index()] as usize];
            found.square <= query.radius(&motion.displacement).powi(2)
        };
        let first = first.filter(|&t| self.leaf_of(t).is_some() && accepts(t));
        let first = first.map(|t| {
            let found = Candidate::on(surface.triangle_positions(t), point.position);
            (found, t)
        });
        let first = first.filter(|(found, t)| reaches(found, *t));
        let to = (point.position, reach);
        self.nearest_below(surface, to, first, is_near, accepts, reaches)
    }
}
