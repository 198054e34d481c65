//! Nearest points that a moving point may reach within a frame.
//!
//! Contact detection gives every vertex its displacement in the frame. [`MotionBounds`] have boxes
//! of displacements, so a search descends only where both motions may close the gap.

use super::motion_bounds::{LANES, Lanes, MotionBounds, Target};
use super::nearest::{Candidate, Nearest, TraversalStack};
use super::{Bvh, LEAF_SIZE, MAX_HEIGHT, NONE, NearestPoint, most};
use crate::geometry::to_f32;
use crate::{Aabb, Surface, TriangleId, Vec3};

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

    /// Returns whether something in a box, with a box of displacements, may be reached.
    #[must_use]
    pub fn reaches(&self, bounds: &Aabb, displacement: &Aabb) -> bool {
        let corners = |bounds: &Aabb| [bounds.min, bounds.max].map(|c| c.map(|x| [x]));
        let query = Query::new(self);
        let [square] = query.squares(&corners(bounds), &corners(displacement), [NONE]);
        square < f32::INFINITY
    }
}

/// A [`MovingPoint`] in single precision.
struct Query {
    position: [f32; 3],
    displacement: [f32; 3],
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
            position: to_f32(point.position),
            displacement: point.displacement,
            squared_margin: (point.margin * point.margin) as f32,
            excluded: point.excluded_piece.unwrap_or(NONE),
        }
    }

    /// Returns the squared distance to each box \[m^2\].
    ///
    /// It is infinite for a box that does not count, and for one that cannot be reached. If a box
    /// is reached, so is every box around it. Components are by corner, axis and box.
    #[inline]
    fn squares<const N: usize>(
        &self,
        bounds: &[[[f32; N]; 3]; 2],
        displacement: &[[[f32; N]; 3]; 2],
        pieces: [u32; N],
    ) -> [f32; N] {
        let (mut at_rest, mut moving) = ([0.0; N], [0.0; N]);
        for k in 0..3 {
            let at = self.position[k];
            let own = self.displacement[k];
            for i in 0..N {
                let below = bounds[0][k][i] - at;
                let above = at - bounds[1][k][i];
                let off = most(most(below, above), 0.0);
                at_rest[i] += off * off;
                let approach = max_approach(own, [displacement[0][k][i], displacement[1][k][i]]);
                let off = most(most(below, above) - approach, 0.0);
                moving[i] += off * off;
            }
        }
        std::array::from_fn(|i| {
            let counts = pieces[i] != self.excluded || self.excluded == NONE;
            if counts && moving[i] <= self.squared_margin {
                at_rest[i]
            } else {
                f32::INFINITY
            }
        })
    }

    /// Returns the squared distances from four boxes, as [`Query::squares`] does.
    #[inline]
    fn squares_to(&self, lanes: &Lanes) -> [f32; LANES] {
        self.squares(&lanes.bounds, &lanes.displacement, lanes.pieces)
    }

    /// Returns the maximum distance from a triangle that is reached \[m\].
    fn radius(&self, displacement: &Aabb) -> f64 {
        let farthest = |k: usize| {
            let others = [displacement.min[k], displacement.max[k]];
            max_approach(self.displacement[k], others)
        };
        let [x, y, z] = [0, 1, 2].map(farthest).map(|x| x * x);
        f64::from(self.squared_margin).sqrt() + f64::from(x + y + z).sqrt()
    }
}

/// Returns the maximum approach along an axis of a point and others with a range of displacements.
///
/// Both velocities may grow or be reversed, also where the point and the others move together: an
/// impact or a pull changes them within the frame.
#[inline]
fn max_approach(own: f32, [min, max]: [f32; 2]) -> f32 {
    MovingPoint::SPEED_MARGIN * (own.abs() + most(max, -min))
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
        let mut best = Nearest::within(query.radius(&bounds.all.displacement));
        let test = |best: &mut Nearest, t: TriangleId, lanes: &Lanes, lane: usize| {
            if counts(t) {
                let found = Candidate::on(surface.triangle_positions(t), point.position);
                let radius = query.radius(&lanes.displacement(lane));
                if found.square <= radius * radius {
                    best.offer(found, t);
                }
            }
        };
        if let Some(t) = first.filter(|&t| self.leaf_of(t).is_some()) {
            let place = self.places[t.index()] as usize;
            let (lanes, lane) = (&bounds.leaves[place / LEAF_SIZE], place % LEAF_SIZE);
            if query.squares_to(lanes)[lane] <= rounded_up(best.limit()) {
                test(&mut best, t, lanes, lane);
            }
        }
        let mut stack = TraversalStack::<_, _, MAX_STACK>::default();
        let mut next = bounds.root;
        while let Some(at) = next {
            match at.target() {
                Target::Quad(index) => {
                    let quad = &bounds.quads[index];
                    let squares = query.squares_to(&quad.lanes);
                    stack.push(quad.children, squares, rounded_up(best.limit()));
                }
                Target::Leaf(block) => {
                    let lanes = &bounds.leaves[block];
                    let squares = query.squares_to(lanes);
                    for (lane, &t) in self.blocks[block].triangles.iter().enumerate() {
                        if squares[lane] <= rounded_up(best.limit()) {
                            test(&mut best, t, lanes, lane);
                        }
                    }
                }
            }
            next = stack.pop(rounded_up(best.limit()));
        }
        best.into_point()
    }
}
