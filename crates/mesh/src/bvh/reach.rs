//! Nearest points that a moving point may reach within a frame.
//!
//! Contact detection gives every vertex its displacement in the frame. [`MotionBounds`] have the
//! maximum displacements, so a search descends only where both motions may close the gap.

use super::motion_bounds::{LANES, Lanes, MotionBounds, Target};
use super::nearest::{Candidate, Nearest, TraversalStack};
use super::{Bvh, LEAF_SIZE, MAX_HEIGHT, NONE, NearestPoint, most};
use crate::geometry::to_f32;
use crate::{Aabb, Surface, TriangleId, Vec3};
use std::array::from_fn;

/// A point that moves, with the triangles that it may touch.
#[derive(Debug, Clone, Copy)]
pub struct MovingPoint {
    /// Position at the start \[m\]. Searches round it to 32 bits where they compare boxes.
    pub position: Vec3,
    /// Displacement in the frame at its present velocity \[m\].
    pub displacement: [f32; 3],
    /// Distance that counts as reached \[m\].
    pub margin: f64,
    /// Piece whose triangles do not count.
    pub excluded_piece: Option<u32>,
}

impl MovingPoint {
    /// Factor by which a velocity may grow or be reversed within the frame: an impact bends a body.
    pub const SPEED_MARGIN: f32 = 2.0;

    /// Returns whether something in a box may be reached.
    ///
    /// `max_displacement` is its maximum displacement along each axis, in either direction \[m\].
    #[must_use]
    pub fn reaches(&self, bounds: &Aabb, max_displacement: [f32; 3]) -> bool {
        let corners = [bounds.min, bounds.max].map(|corner| corner.map(|c| [c]));
        let query = Query::new(self);
        let [square] = query.squares(&corners, &max_displacement.map(|c| [c]), &[NONE]);
        square < f32::INFINITY
    }
}

/// A piece number that no triangle or node has.
const NO_PIECE: u32 = NONE - 1;

/// A [`MovingPoint`] in single precision.
struct Query {
    position: [f32; 3],
    displacement: [f32; 3],
    squared_margin: f32,
    /// Piece whose triangles do not count, or [`NO_PIECE`].
    excluded: u32,
}

impl Query {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "positions and displacements have 32 bits"
    )]
    fn new(point: &MovingPoint) -> Self {
        Self {
            position: to_f32(point.position),
            displacement: point.displacement,
            squared_margin: (point.margin * point.margin) as f32,
            excluded: point.excluded_piece.unwrap_or(NO_PIECE),
        }
    }

    /// Returns the squared distance to each box \[m^2\].
    ///
    /// It is infinite for a box that does not count, and for one that cannot be reached. If a box
    /// is reached, so is every box around it. Components are by corner, axis and box; each
    /// operation is one on all boxes, so that it compiles to one instruction.
    #[inline]
    fn squares<const N: usize>(
        &self,
        [min, max]: &[[[f32; N]; 3]; 2],
        displacement: &[[f32; N]; 3],
        pieces: &[u32; N],
    ) -> [f32; N] {
        let (mut at_rest, mut moving) = ([0.0; N], [0.0; N]);
        for k in 0..3 {
            let at = self.position[k];
            let own = self.displacement[k];
            let outside: [f32; N] = from_fn(|i| most(min[k][i] - at, at - max[k][i]));
            let approach: [f32; N] = from_fn(|i| max_approach(own, displacement[k][i]));
            let nearer: [f32; N] = from_fn(|i| most(outside[i] - approach[i], 0.0));
            let off: [f32; N] = from_fn(|i| most(outside[i], 0.0));
            at_rest = from_fn(|i| at_rest[i] + off[i] * off[i]);
            moving = from_fn(|i| moving[i] + nearer[i] * nearer[i]);
        }
        let is_excluded: [bool; N] = from_fn(|i| pieces[i] == self.excluded);
        from_fn(|i| {
            if (moving[i] <= self.squared_margin) & !is_excluded[i] {
                at_rest[i]
            } else {
                f32::INFINITY
            }
        })
    }

    /// Returns the squared distances from four boxes, as [`Query::squares`] does.
    #[inline]
    fn squares_to(&self, lanes: &Lanes) -> [f32; LANES] {
        self.squares(&lanes.bounds, &lanes.displacement, &lanes.pieces)
    }

    /// Returns the maximum distance from a triangle that is reached \[m\].
    fn radius(&self, displacement: [f32; 3]) -> f64 {
        let farthest = |k: usize| max_approach(self.displacement[k], displacement[k]);
        let [x, y, z] = [0, 1, 2].map(farthest).map(|x| x * x);
        f64::from(self.squared_margin).sqrt() + f64::from(x + y + z).sqrt()
    }
}

/// Returns the maximum approach along an axis of a point and of others.
///
/// Both velocities may grow or be reversed, also where the point and the others move together: an
/// impact or a pull changes them within the frame.
#[inline]
fn max_approach(own: f32, max_of_others: f32) -> f32 {
    MovingPoint::SPEED_MARGIN * (own.abs() + max_of_others)
}

/// Returns a finite upper bound of squared distances that are rounded to 32 bits.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    reason = "the slack exceeds the rounding"
)]
fn rounded_up(square: f64) -> f32 {
    let bound = square as f32 * (1.0 + 8.0 * f32::EPSILON) + f32::MIN_POSITIVE;
    bound.min(f32::MAX)
}

/// Maximum length of the traversal stack: three nodes at each quad on the way, and one.
const MAX_STACK: usize = 3 * (MAX_HEIGHT / 2 + 1) + 1;

impl Bvh {
    /// Returns the nearest point among the triangles that count and that a moving point may reach.
    ///
    /// `counts` decides which triangles count. A good first guess, such as the last nearest
    /// triangle, speeds the search up. Ties are decided as in [`Bvh::nearest`].
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
        let mut best = Nearest::within(query.radius(bounds.all.displacement));
        let mut limit = rounded_up(best.limit());
        let test =
            |best: &mut Nearest, limit: &mut f32, t: TriangleId, lanes: &Lanes, lane: usize| {
                if counts(t) {
                    let found = Candidate::on(surface.triangle_positions(t), point.position);
                    let radius = query.radius(lanes.displacement(lane));
                    if found.square <= radius * radius {
                        best.offer(found, t);
                        *limit = rounded_up(best.limit());
                    }
                }
            };
        if let Some(t) = first.filter(|&t| self.leaf_of(t).is_some()) {
            let place = self.places[t.index()] as usize;
            let (lanes, lane) = (&bounds.leaves[place / LEAF_SIZE], place % LEAF_SIZE);
            if query.squares_to(lanes)[lane] <= limit {
                test(&mut best, &mut limit, t, lanes, lane);
            }
        }
        let mut stack = TraversalStack::<_, _, MAX_STACK>::default();
        let mut next = bounds.root;
        while let Some(at) = next {
            match at.target() {
                Target::Quad(index) => {
                    let quad = &bounds.quads[index];
                    stack.push(quad.children, query.squares_to(&quad.lanes), limit);
                }
                Target::Leaf(block) => {
                    let lanes = &bounds.leaves[block];
                    let squares = query.squares_to(lanes);
                    for (lane, &t) in self.blocks[block].triangles.iter().enumerate() {
                        if squares[lane] <= limit {
                            test(&mut best, &mut limit, t, lanes, lane);
                        }
                    }
                }
            }
            next = stack.pop(limit);
        }
        best.into_point()
    }
}
