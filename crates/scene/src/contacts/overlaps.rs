//! [`Overlaps`]: pieces deep in each other, which are moved apart as rigid bodies.
//!
//! Contacts separate surfaces that are at most two thicknesses behind each other. Bodies that start
//! in each other are deeper, and so are small ones that meet at high speed. Every frame tests a few
//! points inside of each piece. Two pieces that contain such a point are moved apart before the
//! next frames. They move along the [axis](super::axes) on which they overlap least, without a
//! change of velocity.

use super::axes::{Extents, separation};
use super::broad_phase::piece_of;
use super::motion::Motion;
use super::narrow_phase::Search;
use super::outside::outward_normal;
use crate::body::Body;
use crate::scene::Bodies;
use incise_mesh::geometry::{to_f32, to_f64};
use incise_mesh::{Aabb, Vec3, VertexId};
use incise_pbd_gpu::Collider;

/// Number of vertices per piece that are tested in a frame.
const TESTED: usize = 4;

/// Number of vertices per piece at which the depth of an overlap is measured.
const MEASURED: usize = 256;

/// Minimum distance of a common point from both surfaces [thicknesses].
///
/// Both surfaces are twice as far behind each other, deeper than any contact.
const CLEARANCE: f64 = 1.25;

/// Number of frames between two measurements of an overlap.
const PERIOD: u32 = 8;

/// Maximum speed of the separation of a pair [diagonals of the smaller piece per second].
const SPEED: f64 = 1.0;

/// A piece of a body of the scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
    /// Displacements per frame \[m\].
    shifts: [[f64; 3]; 2],
    frames_left: u32,
}

/// The overlaps of a scene, in memory reused between frames.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Overlaps {
    list: Vec<Overlap>,
    /// Number of searches, from which the tested vertices follow.
    searches: u32,
    /// Scratch memory, by index of a piece in the broad phase: number of its vertices so far.
    #[cfg_attr(feature = "serde", serde(skip))]
    seen: Vec<usize>,
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
        let is_position = |shift: f64| shift.abs() <= f64::from(f32::MAX);
        self.list.iter().all(|overlap| {
            overlap.frames_left <= PERIOD
                && overlap.shifts.iter().flatten().all(|c| is_position(*c))
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

    /// Returns the pieces of an overlap and their displacements in this frame \[m\].
    pub(super) fn shifts(&self, n: usize) -> [(PieceId, Vec3); 2] {
        let Overlap { pieces, shifts, .. } = self.list[n];
        [0, 1].map(|i: usize| (pieces[i], Vec3::from(shifts[i])))
    }

    /// Finds overlaps, and measures known ones again after their period.
    pub(super) fn find(&mut self, search: Search<'_>) {
        let start = self.searches as usize;
        self.searches = self.searches.wrapping_add(1);
        self.list.retain_mut(|overlap| {
            if overlap.frames_left > 0 {
                return true;
            }
            let measured = search.measure(overlap.pieces, (start, 0.0));
            measured.is_some_and(|measured| {
                *overlap = measured;
                true
            })
        });
        self.seen.clear();
        self.seen.resize(search.pieces.iter().len(), 0);
        for (i, body) in (0..).zip(search.bodies) {
            let Some(body) = body.as_ref().filter(|_| search.is_active(i)) else {
                continue;
            };
            let surface = body.surface();
            for v in surface.topology().vertices() {
                let Some(number) = piece_of(surface, v) else {
                    continue;
                };
                let index = search.motions[i as usize].pieces[number as usize];
                let seen = &mut self.seen[index as usize];
                *seen += 1;
                if is_sampled(*seen, search.pieces.vertex_count(index), (TESTED, start)) {
                    let own = PieceId { body: i, number };
                    self.test(search, own, (v, surface.position(v)));
                }
            }
        }
    }

    /// Finds the overlaps of a piece at one of its vertices.
    fn test(&mut self, search: Search<'_>, own: PieceId, (v, at): (VertexId, Vec3)) {
        let motion = &search.motions[own.body as usize];
        let reach = 2.0 * CLEARANCE * motion.piece_thickness(own.number);
        let index = motion.pieces[own.number as usize];
        for other in search.pieces.neighbors(index) {
            if !other.contains(at, reach) {
                continue;
            }
            let pair = [own, other.id()];
            let is_known = |o: &Overlap| o.pieces == pair || o.pieces == [pair[1], pair[0]];
            if self.list.iter().any(is_known) {
                continue;
            }
            if let Some(depth) = search.common_point(pair, v) {
                let start = self.searches as usize;
                self.list.extend(search.measure(pair, (start, depth)));
            }
        }
    }
}

/// Returns whether the vertex of a `number` in its piece is one of about `count` of `all`.
///
/// They are at equal distances, and others in the next searches.
fn is_sampled(number: usize, all: usize, (count, search): (usize, usize)) -> bool {
    let stride = (all / count).max(1);
    (number + search).is_multiple_of(stride)
}

impl Search<'_> {
    /// Returns whether a body is searched in this frame.
    fn is_active(&self, body: u32) -> bool {
        self.motions[body as usize].is_active
    }

    /// Returns the body of a piece and its motion.
    fn body_of(&self, piece: PieceId) -> Option<(&Body, &Motion)> {
        let body = self.bodies.get(piece.body as usize)?.as_ref()?;
        let is_known = piece.number < body.surface().piece_bound();
        let motion = &self.motions[piece.body as usize];
        (is_known && motion.is_active).then_some((body, motion))
    }

    /// Returns the vertices of a piece.
    fn vertices_of(&self, piece: PieceId) -> impl Iterator<Item = VertexId> {
        let surface = self.body_of(piece).map(|(body, _)| body.surface());
        surface.into_iter().flat_map(move |surface| {
            let vertices = surface.topology().vertices();
            vertices.filter(move |&v| piece_of(surface, v) == Some(piece.number))
        })
    }

    /// Returns the minimum distance of two closed pieces \[m\]; `None` for sheets.
    fn thickness_of(&self, pieces: [PieceId; 2]) -> Option<f64> {
        let mut least = f64::INFINITY;
        for piece in pieces {
            let (body, motion) = self.body_of(piece)?;
            if body.piece_shapes().get(piece.number).is_sheet {
                return None;
            }
            least = least.min(motion.piece_thickness(piece.number));
        }
        Some(least)
    }

    /// Returns the distance of a point inside a piece from its surface \[m\], if it is at least
    /// `clearance`.
    fn depth_in(&self, piece: PieceId, at: Vec3, clearance: f64) -> Option<f64> {
        let (body, _) = self.body_of(piece)?;
        let (surface, bvh) = (body.surface(), body.bvh());
        let is_own = |t| surface.piece(t) == piece.number;
        if bvh.nearest(surface, at, clearance, is_own).is_some() {
            return None;
        }
        let hit = bvh.cast(surface, at, Vec3::x(), is_own)?;
        let nearest = || bvh.nearest(surface, at, hit.distance, is_own);
        hit.from_inside
            .then(|| nearest().map_or(hit.distance, |found| found.distance.abs()))
    }

    /// Returns the depth of the common point of two pieces below a vertex of the first one \[m\].
    fn common_point(&self, [own, other]: [PieceId; 2], v: VertexId) -> Option<f64> {
        let clearance = CLEARANCE * self.thickness_of([own, other])?;
        let (body, _) = self.body_of(own)?;
        let surface = body.surface();
        let inward = -outward_normal(surface, v).try_normalize(0.0)?;
        let point = surface.position(v) + inward * (2.0 * clearance);
        let depth = self.depth_in(other, point, clearance)?;
        self.depth_in(own, point, clearance)?;
        Some(depth + clearance)
    }

    /// Returns the maximum depth of the first piece in the second one \[m\], 0 without an overlap.
    fn depth(&self, pieces: [PieceId; 2], start: usize) -> f64 {
        let all = self.vertices_of(pieces[0]).count();
        let sampled = (0..).zip(self.vertices_of(pieces[0]));
        sampled
            .filter(|(number, _)| is_sampled(*number, all, (MEASURED, start)))
            .filter_map(|(_, v)| self.common_point(pieces, v))
            .fold(0.0, f64::max)
    }

    /// Measures an overlap of a known depth or 0 \[m\] in a search.
    ///
    /// `None` if there is none, or neither piece can be moved.
    fn measure(&self, pieces: [PieceId; 2], (search, known): (usize, f64)) -> Option<Overlap> {
        let [a, b] = pieces;
        let mobilities = [self.mobility(a)?, self.mobility(b)?];
        if mobilities == [0.0; 2] {
            return None;
        }
        let depth = f64::max(self.depth([a, b], search), self.depth([b, a], search));
        let depth = depth.max(known);
        if depth == 0.0 {
            return None;
        }
        let extents = [self.extents(a)?, self.extents(b)?];
        let enters = |piece: &Extents, by| self.enters_collider(piece, by);
        let shifts = separation(&extents, mobilities, self.frame.gravity, enters)?;
        let smaller = f64::min(extents[0].diagonal(), extents[1].diagonal());
        let step = f64::min(depth / f64::from(PERIOD), SPEED * smaller * self.frame.dt);
        let version = |piece| Some(self.body_of(piece)?.0.surface().fingerprint());
        Some(Overlap {
            pieces,
            versions: [version(a)?, version(b)?],
            shifts: shifts.map(|shift| (shift * step).into()),
            frames_left: PERIOD,
        })
    }

    /// Returns whether the box of a piece enters a collider, or goes deeper into the ground or a
    /// plane.
    fn enters_collider(&self, piece: &Extents, by: Vec3) -> bool {
        let [min, max] = piece.corners();
        let ground = self.frame.ground.map_or(f64::NEG_INFINITY, f64::from);
        if by.y < 0.0 && min.y + by.y < ground {
            return true;
        }
        let boxed = |by: Vec3| Aabb::around([to_f32(min + by), to_f32(max + by)]);
        self.frame.colliders.iter().any(|collider| {
            if let Collider::Plane { point, normal } = collider.start {
                let (point, normal) = (to_f64(point), to_f64(normal));
                let corner = min.zip_zip_map(&max, &normal, |a, b, n| if n > 0.0 { a } else { b });
                normal.dot(&by) < 0.0 && normal.dot(&(corner + by - point)) < 0.0
            } else {
                let bounds = collider.start.bounds();
                boxed(by).overlaps(&bounds) && !boxed(Vec3::zeros()).overlaps(&bounds)
            }
        })
    }

    /// Returns the extents of a piece.
    fn extents(&self, piece: PieceId) -> Option<Extents> {
        let (body, _) = self.body_of(piece)?;
        let vertices = self.vertices_of(piece);
        Some(Extents::new(vertices.map(|v| body.surface().position(v))))
    }

    /// Returns the reciprocal mass of a piece [1/kg], 0 with a pin.
    fn mobility(&self, piece: PieceId) -> Option<f64> {
        let (body, _) = self.body_of(piece)?;
        let solver = body.solver();
        let is_own = |v| piece_of(body.surface(), v) == Some(piece.number);
        if solver.pins().iter().any(|pin| is_own(pin.vertex)) {
            return Some(0.0);
        }
        let masses = self.vertices_of(piece).map(|v| solver.masses()[v.index()]);
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
