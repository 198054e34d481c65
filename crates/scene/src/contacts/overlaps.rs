//! [`Overlaps`]: pieces deep in each other, which are moved apart as rigid bodies.
//!
//! Contacts separate surfaces that are slightly behind each other. Bodies that start in each other
//! are deeper, and so are small ones that meet at high speed. Every frame tests a few points of
//! each piece. Two closed pieces, one of which has a point deep in the other one, are moved apart
//! before the next frames: from the deepest point to the nearest surface if nothing is deep there,
//! else along the [axis](super::axes) on which they overlap least. They lose the velocity with
//! which they approach each other in this direction.

use super::ContactFrame;
use super::axes::{Extents, along, separation, without_vertical_part};
use super::depth::{Point, sampled_points};
use super::free_way::free_way;
use super::narrow_phase::Search;
use crate::body::{piece_of, vertices_of};
use crate::scene::Bodies;
use incise_mesh::Vec3;
use rayon::prelude::*;

/// Number of points per piece that are tested in a frame.
const TESTED: usize = 8;

/// Minimum number of tested points for a thread.
const MIN_TESTS: usize = 64;

/// Number of frames between two measurements of an overlap.
const PERIOD: u32 = 8;

/// Maximum speed of the separation of a pair [diagonals of the smaller piece per second].
const SPEED: f64 = 1.0;

/// Maximum part of a displacement that an obstacle takes from it.
const MAX_BLOCKED: f64 = 1e-3;

/// Returns the longer one of two vectors.
fn longer(a: Vec3, b: Vec3) -> Vec3 {
    if b.norm_squared() > a.norm_squared() {
        b
    } else {
        a
    }
}

/// A piece of a body of the scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct PieceId {
    /// Index of the body in the scene.
    pub(crate) body: u32,
    pub(crate) number: u32,
}

/// Two pieces that are moved apart.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Overlap {
    pieces: [PieceId; 2],
    /// Fingerprints of their surfaces.
    versions: [u64; 2],
    /// Displacements per unit of separation.
    shifts: [[f64; 3]; 2],
    /// Initial centroid distance along the separation axis \[m\].
    start: f64,
    /// Separation per frame \[m\].
    step: f64,
    frames_left: u32,
}

impl Overlap {
    /// Returns the centroid distance along the separation axis \[m\].
    fn distance(&self, bodies: &Bodies) -> f64 {
        let [a, b] = self.shifts.map(Vec3::from);
        let [from, to] = self.pieces.map(|piece| middle(bodies, piece));
        (to - from).dot(&(b - a))
    }

    /// Returns the displacements of this frame \[m\].
    ///
    /// Other motion since the measurement counts toward the target: a piece that falls is lifted
    /// again, and one that something else carries is not.
    fn moves(&self, bodies: &Bodies, frame: &ContactFrame<'_>) -> [Vec3; 2] {
        let [a, b] = self.shifts.map(Vec3::from);
        let target = self.start + f64::from(PERIOD - self.frames_left) * self.step;
        let fall = frame.gravity.dot(&(b - a)).abs() * frame.dt.powi(2);
        let by = (target - self.distance(bodies)).clamp(0.0, self.step + fall);
        [a * by, b * by]
    }
}

/// Returns the mean position of a piece's vertices \[m\]; the origin without any.
fn middle(bodies: &Bodies, piece: PieceId) -> Vec3 {
    let Some(body) = bodies.get(piece.body as usize).and_then(Option::as_ref) else {
        return Vec3::zeros();
    };
    let (mut sum, mut count) = (Vec3::zeros(), 0.0);
    for v in vertices_of(body.surface(), piece.number) {
        sum += body.surface().position(v);
        count += 1.0;
    }
    sum / f64::max(count, 1.0)
}

/// The overlaps of a scene, in memory reused between frames.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Overlaps {
    list: Vec<Overlap>,
    /// Number of searches, from which the tested vertices follow.
    searches: u32,
    /// Scratch memory: the points that are tested.
    #[cfg_attr(feature = "serde", serde(skip))]
    tests: Vec<Test>,
    /// Scratch memory: the pieces that are moved and their displacements \[m\].
    #[cfg_attr(feature = "serde", serde(skip))]
    moves: Vec<(PieceId, Vec3)>,
}

impl Overlaps {
    /// Begins a frame: forgets overlaps of bodies that are gone or were cut.
    pub(super) fn begin_frame(&mut self, bodies: &Bodies) {
        self.list.retain_mut(|overlap| {
            overlap.frames_left = overlap.frames_left.saturating_sub(1);
            let mut versions = overlap.pieces.iter().zip(overlap.versions);
            versions.all(|(piece, version)| {
                let body = bodies.get(piece.body as usize).and_then(Option::as_ref);
                body.is_some_and(|body| body.surface().fingerprint() == version)
            })
        });
    }

    /// Returns whether all numbers are in the range of a search.
    #[cfg(feature = "serde")]
    pub(super) fn is_valid(&self) -> bool {
        let is_position = |x: &f64| x.abs() <= f64::from(f32::MAX);
        self.list.iter().all(|overlap| {
            let shifts = overlap.shifts.iter().flatten();
            let mut numbers = shifts.chain([&overlap.start, &overlap.step]);
            overlap.frames_left <= PERIOD && overlap.step >= 0.0 && numbers.all(is_position)
        })
    }

    /// Forgets the overlaps of a body, which is edited.
    pub(super) fn forget(&mut self, body: usize) {
        let is_of = |piece: &PieceId| piece.body as usize == body;
        self.list
            .retain(|overlap| !overlap.pieces.iter().any(is_of));
    }

    /// Returns the number of overlaps.
    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    /// Returns the pieces of an overlap and their displacements per unit of separation.
    pub(super) fn shifts(&self, n: usize) -> [(PieceId, Vec3); 2] {
        let Overlap { pieces, shifts, .. } = self.list[n];
        [0, 1].map(|i: usize| (pieces[i], Vec3::from(shifts[i])))
    }

    /// Adds up the displacements of every piece that is moved in this frame, and returns their
    /// number.
    ///
    /// Those of several pairs together are at most as long as the longest one, and no piece enters
    /// a collider.
    pub(super) fn find_moves(&mut self, bodies: &Bodies, frame: &ContactFrame<'_>) -> usize {
        let mut moves = std::mem::take(&mut self.moves);
        moves.clear();
        for overlap in &self.list {
            moves.extend(overlap.pieces.into_iter().zip(overlap.moves(bodies, frame)));
        }
        moves.retain(|(_, shift)| *shift != Vec3::zeros());
        moves.sort_by_key(|(piece, _)| (piece.body, piece.number));
        let mut longest = 0.0;
        moves.dedup_by(|(piece, shift), (kept, sum)| {
            if piece != kept {
                longest = 0.0;
                return false;
            }
            longest = f64::max(longest, sum.norm()).max(shift.norm());
            *sum = (*sum + *shift).cap_magnitude(longest);
            true
        });
        for (piece, shift) in &mut moves {
            let body = bodies.get(piece.body as usize).and_then(Option::as_ref);
            let surface = body.map(|body| body.surface());
            let points = surface.map(|surface| {
                let vertices = vertices_of(surface, piece.number);
                Extents::new(vertices.map(|v| surface.position(v)))
            });
            *shift = points.map_or(Vec3::zeros(), |extents| {
                free_way(extents.corners(), *shift, frame)
            });
        }
        self.moves = moves;
        self.moves.len()
    }

    /// Returns a piece that is moved in this frame and its displacement \[m\].
    pub(super) fn piece_move(&self, n: usize) -> (PieceId, Vec3) {
        self.moves[n]
    }

    /// Finds overlaps, and measures known ones again after their period.
    pub(super) fn find(&mut self, search: Search<'_>) {
        let start = self.searches as usize;
        self.searches = self.searches.wrapping_add(1);
        let due = self.list.par_iter_mut().filter(|o| o.frames_left == 0);
        due.for_each(|overlap| {
            let turn = start / PERIOD as usize;
            if let Some(measured) = search.measure(overlap.pieces, (turn, None)) {
                *overlap = measured;
            }
        });
        self.list.retain(|overlap| overlap.frames_left > 0);
        self.sample(search, start);
        let tests = self.tests.par_iter_mut().with_min_len(MIN_TESTS);
        tests.for_each(|test| test.way = search.way_out(test.pair, test.point, Vec3::zeros()));
        // The first point of a pair in the other piece counts.
        self.tests.retain(|test| test.way.is_some());
        (self.tests).sort_unstable_by_key(|test| (test.sorted_pair(), test.number));
        self.tests.dedup_by_key(|test| test.sorted_pair());
        let first = self.list.len();
        self.list.extend(self.tests.iter().map(|test| Overlap {
            pieces: test.pair,
            versions: [0; 2],
            shifts: [[0.0; 3]; 2],
            start: 0.0,
            step: 0.0,
            frames_left: 0,
        }));
        let new = self.list[first..].par_iter_mut().zip(&self.tests);
        new.for_each(|(overlap, test)| {
            let known = (self.searches as usize, test.way);
            if let Some(measured) = search.measure(test.pair, known) {
                *overlap = measured;
            }
        });
        self.list.retain(|overlap| overlap.frames_left > 0);
    }

    /// Collects the points that are tested in a search, in the boxes of other pieces.
    fn sample(&mut self, search: Search<'_>, start: usize) {
        self.tests.clear();
        for (index, piece) in (0..).zip(search.pieces.iter()) {
            let Some((body, _)) = search.body_of(piece.id()) else {
                continue;
            };
            let surface = body.surface();
            let vertices = search.pieces.vertices(index);
            for point in sampled_points(surface, vertices, (TESTED, start)) {
                let at = point.position(surface);
                let others = search.pieces.neighbors(index);
                let tests = others.filter(|other| other.contains(at, 0.0));
                let first = self.tests.len();
                self.tests
                    .extend((first..).zip(tests).map(|(number, other)| Test {
                        number,
                        pair: [piece.id(), other.id()],
                        point,
                        way: None,
                    }));
            }
        }
        let list = &self.list;
        self.tests.retain(|test| {
            let [a, b] = test.pair;
            !list
                .iter()
                .any(|o| o.pieces == [a, b] || o.pieces == [b, a])
        });
    }
}

/// A point of a piece that is tested against another piece.
#[derive(Debug, Clone, Copy)]
struct Test {
    /// Position in the order of pieces, vertices and other pieces.
    number: usize,
    /// The piece of the point, and the other one.
    pair: [PieceId; 2],
    point: Point,
    /// Way out of the other piece \[m\], if the point is deep.
    way: Option<Vec3>,
}

impl Test {
    /// Returns the pieces in ascending order.
    fn sorted_pair(&self) -> [PieceId; 2] {
        let [a, b] = self.pair;
        [a.min(b), a.max(b)]
    }
}

impl Search<'_> {
    /// Measures an overlap at the points of a search.
    ///
    /// A way of the first piece out of the second one may be known \[m\]. `None` if there is no
    /// overlap, or neither piece can be moved.
    fn measure(
        &self,
        pieces: [PieceId; 2],
        (search, known): (usize, Option<Vec3>),
    ) -> Option<Overlap> {
        let [a, b] = pieces;
        let mobilities = [self.mobility(a)?, self.mobility(b)?];
        if mobilities == [0.0; 2] {
            return None;
        }
        let ways = |shift: Vec3| {
            let first = self.ways_out([a, b], search, shift);
            let second = self.ways_out([b, a], search, -shift);
            let second = second.into_iter().flatten().map(|way| -way);
            first.into_iter().flatten().chain(second)
        };
        let way = ways(Vec3::zeros()).chain(known).reduce(longer)?;
        let way = without_vertical_part(way, self.frame.gravity);
        let (depth, direction) = (way.norm(), way.try_normalize(0.0)?);
        let extents = [self.extents(a)?, self.extents(b)?];
        let is_blocked = |piece: &Extents, by: Vec3| {
            let free = free_way(piece.corners(), by, self.frame);
            (free - by).norm() > MAX_BLOCKED * by.norm()
        };
        // To the nearest surface, if nothing is deep there; else along an axis.
        let shortest = along(-direction, mobilities, self.frame.gravity).filter(|shifts| {
            let mut moves = extents.iter().zip(shifts);
            !moves.any(|(piece, shift)| is_blocked(piece, shift * depth))
                && ways(way).next().is_none()
        });
        let separation = || separation(&extents, mobilities, self.frame.gravity, is_blocked);
        let shifts = shortest.or_else(separation)?;
        let smaller = f64::min(extents[0].diagonal(), extents[1].diagonal());
        let version = |piece| Some(self.body_of(piece)?.0.surface().fingerprint());
        let mut overlap = Overlap {
            pieces,
            versions: [version(a)?, version(b)?],
            shifts: shifts.map(Into::into),
            start: 0.0,
            step: f64::min(depth / f64::from(PERIOD), SPEED * smaller * self.frame.dt),
            frames_left: PERIOD,
        };
        overlap.start = overlap.distance(self.bodies);
        Some(overlap)
    }

    /// Returns the extents of a piece.
    fn extents(&self, piece: PieceId) -> Option<Extents> {
        let (body, _) = self.body_of(piece)?;
        let vertices = self.vertices(piece).iter();
        Some(Extents::new(vertices.map(|&v| body.surface().position(v))))
    }

    /// Returns the reciprocal mass of a piece [1/kg], 0 with a pin.
    fn mobility(&self, piece: PieceId) -> Option<f64> {
        let (body, _) = self.body_of(piece)?;
        let solver = body.solver();
        let is_own = |v| piece_of(body.surface(), v) == Some(piece.number);
        if solver.pins().iter().any(|pin| is_own(pin.vertex)) {
            return Some(0.0);
        }
        let vertices = self.vertices(piece).iter();
        let masses = vertices.map(|v| solver.masses()[v.index()]);
        let mass: f64 = masses.map(f64::from).sum();
        Some(if mass > 0.0 { mass.recip() } else { 0.0 })
    }
}

#[cfg(all(test, feature = "serde"))]
mod tests {
    use super::*;

    #[test]
    fn saved_numbers_out_of_range_are_refused() {
        let piece = PieceId { body: 0, number: 0 };
        let overlaps = |frames_left, shift| Overlaps {
            list: vec![Overlap {
                pieces: [piece; 2],
                versions: [0; 2],
                shifts: [[0.0, shift, 0.0], [0.0; 3]],
                start: 0.0,
                step: shift.abs(),
                frames_left,
            }],
            ..Overlaps::default()
        };
        assert!(overlaps(PERIOD, -0.1).is_valid());
        assert!(!overlaps(PERIOD + 1, 0.1).is_valid(), "a longer period");
        assert!(!overlaps(1, 1e39).is_valid(), "no position");
        assert!(!overlaps(1, f64::NAN).is_valid());
    }
}
