//! Collapses a point of the walls onto a neighbor, on all walls that meet there.

use super::{MAX_OFFSET, ROUNDING, Shape, Walls, smallest_sine};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Edit, HalfEdge, Surface, Vec3, VertexId, index_u32};
use smallvec::SmallVec;
use std::ops::Range;

/// Length below which an edge of a wall is collapsed, and length up to which edges may grow
/// [target lengths].
///
/// A collapse of two edges of equal length makes one of twice the length. Between both ends of a
/// range with the ratio 2, edges are as near to the target as they can be in the logarithm.
const LENGTHS: [f64; 2] = [std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::SQRT_2];

/// A half-edge that leaves a vertex of a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spoke {
    pub(super) h: HalfEdge,
    /// The number of the vertex within the point.
    pub(super) copy: u32,
    /// Rest positions at its end and across its left and its right triangle, as bits.
    pub(super) to: [u32; 3],
    pub(super) left: [u32; 3],
    pub(super) right: [u32; 3],
}

/// The triangles around all vertices of a point.
#[derive(Debug, Clone, Default)]
pub(super) struct Star {
    /// By vertex, counterclockwise.
    pub(super) spokes: Vec<Spoke>,
    pub(super) copies: Vec<Range<usize>>,
    /// Numbers of the spokes by their ends.
    pub(super) by_end: Vec<u32>,
    keys: Vec<([u32; 3], [u32; 3], bool)>,
}

impl Star {
    /// Collects the spokes of a point. Returns false at a boundary.
    pub(super) fn find(
        &mut self,
        surface: &Surface,
        shape: &Shape,
        starts: impl Iterator<Item = HalfEdge>,
    ) -> bool {
        let topology = surface.topology();
        self.spokes.clear();
        self.copies.clear();
        let bits = |v: VertexId| shape.rest.bits(surface, v);
        for (copy, first) in (0..).zip(starts) {
            let from = self.spokes.len();
            let mut at = first;
            loop {
                let twin = topology.twin(at);
                if twin.is_null() {
                    return false;
                }
                self.spokes.push(Spoke {
                    h: at,
                    copy,
                    to: bits(topology.target(at)),
                    left: bits(topology.origin(at.prev())),
                    right: bits(topology.origin(twin.prev())),
                });
                at = topology.twin(at.prev());
                if at.is_null() {
                    return false;
                }
                if at == first {
                    break;
                }
            }
            self.copies.push(from..self.spokes.len());
        }
        self.by_end.clear();
        self.by_end.extend(0..index_u32(self.spokes.len()));
        let spokes = &self.spokes;
        (self.by_end).sort_unstable_by_key(|&i| (spokes[i as usize].to, i));
        true
    }

    /// Returns whether all triangles around the point `own` have their partners there, and no spoke
    /// is on a tip or has no length.
    fn is_closed(&mut self, own: [u32; 3]) -> bool {
        let is_excluded = |spoke: &Spoke| spoke.left == spoke.right || spoke.to == own;
        if self.spokes.iter().any(is_excluded) {
            return false;
        }
        self.keys.clear();
        let keys = self.spokes.iter().map(|spoke| {
            let (a, b) = (spoke.to, spoke.left);
            (a.min(b), a.max(b), a < b)
        });
        self.keys.extend(keys);
        self.keys.sort_unstable();
        let mut pairs = self.keys.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1));
        pairs.all(|own| own.iter().filter(|key| key.2).count() * 2 == own.len())
    }
}

impl Walls {
    /// Collapses a point onto the neighbor that leaves the largest smallest angle, if one is valid.
    pub(super) fn collapse(&mut self, edit: &mut Edit<'_>, shape: &Shape, point: u32) -> bool {
        let surface = edit.surface();
        let mut star = std::mem::take(&mut self.star);
        let found = star.find(surface, shape, self.points.starts(point));
        let bits = |h: HalfEdge| shape.rest.bits(surface, surface.topology().origin(h));
        let best = if found && star.copies.len() > 1 && star.is_closed(bits(star.spokes[0].h)) {
            best_target(surface, shape, &mut star)
        } else {
            None
        };
        if let Some(target) = &best {
            self.apply(edit, target);
        }
        self.star = star;
        best.is_some()
    }

    /// Collapses the edge of each spoke onto its end.
    fn apply(&mut self, edit: &mut Edit<'_>, target: &[HalfEdge]) {
        let mut near = Vec::new();
        for &h in target {
            let topology = edit.surface().topology();
            let back = topology.twin(h);
            let gone = topology.origin(h);
            let kept = topology.origin(back);
            let sides = [h.prev(), back.prev()].map(|side| topology.origin(side));
            // After the collapse the edges to both sides have one half-edge from each end.
            let to_side = [h.prev(), back.next()].map(|side| topology.twin(side));
            let from_side = [h.next(), back.prev()].map(|side| topology.twin(side));
            if edit.collapse_edge(back).is_err() {
                continue;
            }
            self.points.set_start(gone, HalfEdge::NULL);
            let topology = edit.surface().topology();
            for h in to_side.into_iter().chain(from_side) {
                self.points.set_start(topology.origin(h), h);
            }
            near.extend([kept, sides[0], sides[1]]);
            let mut at = to_side[0];
            loop {
                near.push(topology.target(at));
                at = topology.twin(at.prev());
                if at.is_null() || at == to_side[0] {
                    break;
                }
            }
        }
        for v in near {
            if let Some(point) = self.points.point_of(v) {
                self.enqueue(point);
            }
        }
    }
}

/// Returns the spokes to the best neighbor, one of each vertex.
fn best_target(surface: &Surface, shape: &Shape, star: &mut Star) -> Option<Vec<HalfEdge>> {
    let own = surface.topology().origin(star.spokes[0].h);
    let length = shape.target(surface, own)?;
    let old = (0..star.spokes.len()).map(|i| sine(surface, shape, star.spokes[i].h, None));
    let old = old.fold(f64::INFINITY, f64::min);
    let mut best: Option<(f64, Vec<HalfEdge>)> = None;
    let by_end = std::mem::take(&mut star.by_end);
    let spokes = |i: &u32| star.spokes[*i as usize];
    for own in by_end.chunk_by(|a, b| spokes(a).to == spokes(b).to) {
        let is_one_each = own.len() == star.copies.len()
            && (0..).zip(own).all(|(copy, i)| spokes(i).copy == copy);
        if !is_one_each {
            continue;
        }
        let target: Vec<HalfEdge> = own.iter().map(|i| spokes(i).h).collect();
        let least = best
            .as_ref()
            .map_or(old.min(shape.good_sine), |best| best.0);
        let new = quality_onto(surface, shape, star, &target, length, least);
        if let Some(new) = new.filter(|_| are_linked(surface, star, &target)) {
            best = Some((new, target));
        }
    }
    star.by_end = by_end;
    best.map(|best| best.1)
}

/// Returns the sine of the smallest angle of the triangle left of a spoke, with another origin.
fn sine(surface: &Surface, shape: &Shape, h: HalfEdge, origin: Option<Vec3>) -> f64 {
    let topology = surface.topology();
    let [p, b, c] = [h, h.next(), h.prev()].map(|h| shape.at(surface, topology.origin(h)));
    smallest_sine([origin.unwrap_or(p), b, c])
}

/// Returns the sine of the smallest angle after a collapse along the spokes `target`.
///
/// None if it is below `least`, if a wall would move too far or be inverted, or if an edge would
/// become too long.
fn quality_onto(
    surface: &Surface,
    shape: &Shape,
    star: &Star,
    target: &[HalfEdge],
    length: f64,
    least: f64,
) -> Option<f64> {
    let topology = surface.topology();
    let mut worst = f64::INFINITY;
    let is_pinned = |v: VertexId| surface.positions()[v.index()][3] == 0.0;
    let pieces = target.iter().map(|h| surface.piece(h.triangle()));
    let first = surface.piece(target[0].triangle());
    let is_one_piece = pieces.into_iter().all(|piece| piece == first);
    let offset = if is_one_piece {
        MAX_OFFSET * length
    } else {
        0.0
    };
    for (own, &along) in star.copies.iter().zip(target) {
        let back = topology.twin(along);
        let [gone, kept] = [topology.origin(along), topology.target(along)];
        if is_pinned(gone) && !is_pinned(kept) {
            return None;
        }
        let [p, q] = [gone, kept].map(|v| shape.at(surface, v));
        let way = (q - p).norm();
        if way >= LENGTHS[0] * length {
            return None;
        }
        let rounding = ROUNDING * p.amax().max(q.amax());
        let material = surface.material(along.triangle());
        let charts = [along, back.next()].map(|h| surface.corner_values(h));
        let (mut old_area, mut new_area, mut slack) = (0.0, 0.0, 0.0);
        let mut has_flat = false;
        for spoke in &star.spokes[own.clone()] {
            let h = spoke.h;
            let t = h.triangle();
            if surface.material(t) != material {
                return None;
            }
            let [b, c] = [topology.target(h), topology.origin(h.prev())];
            let [pb, pc] = [b, c].map(|v| shape.at(surface, v));
            let old = area_vector([p, pb, pc]);
            old_area += old.norm();
            slack += rounding * ((pb - p).norm() + (pc - p).norm() + way);
            if t == along.triangle() || t == back.triangle() {
                continue;
            }
            let values = surface.corner_values(h);
            if !charts.contains(&values) {
                return None;
            }
            let reach = (pb - p).norm() + (pc - p).norm();
            let edge = (pb - q).norm();
            if edge > (LENGTHS[1] * length).max((pb - p).norm()) {
                return None;
            }
            let new = area_vector([q, pb, pc]);
            new_area += new.norm();
            let height = old.dot(&(q - p)).abs();
            if height > offset * old.norm() + 4.0 * rounding * (old.norm() + way * reach) {
                return None;
            }
            if old.norm() <= 4.0 * rounding * reach {
                has_flat = true;
            } else if old.dot(&new) <= 0.0 {
                return None;
            }
            worst = worst.min(smallest_sine([q, pb, pc]));
            if worst < least {
                return None;
            }
            if !keeps_present(surface, [gone, kept, b, c]) {
                return None;
            }
        }
        if has_flat && new_area > old_area + 4.0 * slack {
            return None;
        }
    }
    Some(worst)
}

/// Returns whether a triangle `from`, `b`, `c` keeps its orientation in both shapes if its first
/// corner moves to `to`.
fn keeps_present(surface: &Surface, [from, to, b, c]: [VertexId; 4]) -> bool {
    let all = [from, to, b, c];
    let is_at_rest = |v: &VertexId| {
        let [x, y, z, _] = surface.positions()[v.index()];
        surface.rest_positions()[v.index()] == [x, y, z]
    };
    if all.iter().all(is_at_rest) {
        return true;
    }
    let places = [
        all.map(|v| surface.position(v)),
        all.map(|v| surface.rest_position(v)),
    ];
    places.into_iter().all(|[from, to, b, c]| {
        let [old, new] = [from, to].map(|p| area_vector([p, b, c]));
        old.norm() == 0.0 || old.dot(&new) > 0.0
    })
}

/// Returns whether the link condition holds for all spokes of `target` together.
fn are_linked(surface: &Surface, star: &Star, target: &[HalfEdge]) -> bool {
    let topology = surface.topology();
    let ends = |copy: usize| {
        let own = star.spokes[star.copies[copy].clone()].iter();
        own.map(|spoke| topology.target(spoke.h))
    };
    let mut far: SmallVec<[VertexId; 16]> = SmallVec::new();
    for (copy, &h) in target.iter().enumerate() {
        let near: SmallVec<[VertexId; 16]> = ends(copy).collect();
        let back = topology.twin(h);
        far.clear();
        let mut at = back;
        loop {
            far.push(topology.target(at));
            at = topology.twin(at.prev());
            if at.is_null() {
                return false;
            }
            if at == back {
                break;
            }
        }
        let common = near.iter().filter(|v| far.contains(v)).count();
        // Two vertices that end at one must not bring it the same neighbor twice.
        let kept = topology.target(h);
        let mut before = target[..copy].iter().enumerate();
        let repeats = before.any(|(other, &h)| {
            topology.target(h) == kept && ends(other).any(|v| v != kept && near.contains(&v))
        });
        if near.len() < 4 || common != 2 || repeats {
            return false;
        }
    }
    true
}
