//! Collapses a point of the walls onto a neighbor, on all walls that meet there.

use super::star::{Star, is_affine};
use super::{MAX_OFFSET, ROUNDING, Shape, Walls, smallest_sine};
use crate::exact::contract::swept_volume;
use crate::sizing;
use incise_mesh::geometry::area_vector;
use incise_mesh::{CornerValues, Edit, HalfEdge, Surface, Vec3, VertexId};
use smallvec::SmallVec;

/// Length below which an edge of a wall is collapsed, and length up to which edges may grow
/// [target lengths].
///
/// A collapse of two edges of equal length makes one of twice the length. Between both ends of a
/// range with the ratio 2, edges are as near to the target as they can be in the logarithm.
const LENGTHS: [f64; 2] = [std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::SQRT_2];

/// Maximum volume by which a collapse on the skin changes the body [cubes of the target length].
///
/// It is 0 but for rounding while the triangles around are flat, which those of a moving body are
/// not quite. Ten of them change a body of one cube by 1e-5, as a cut without snapping may.
const MAX_VOLUME: f64 = 1e-6;

impl Walls {
    /// Collapses a point onto the neighbor that leaves the largest smallest angle, if one is valid.
    pub(super) fn collapse(&mut self, edit: &mut Edit<'_>, shape: &Shape, point: u32) -> bool {
        let surface = edit.surface();
        let mut star = std::mem::take(&mut self.star);
        let found = star.find(surface, shape, self.points.starts(point));
        let bits = |h: HalfEdge| shape.rest.bits(surface, surface.topology().origin(h));
        let best = if found && star.copies.len() > 1 && star.find_skin(bits(star.spokes[0].h)) {
            best_target(surface, shape, &mut star)
        } else {
            None
        };
        if let Some(target) = &best {
            if star.has_skin {
                let moves = star.copies.iter().zip(target);
                let moves =
                    moves.map(|(own, &along)| star.rim_move(edit.surface(), shape, own, along));
                self.moved.extend(moves.flatten());
            }
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
    if star.has_skin && !sizing::is_made(surface, own) {
        return None;
    }
    let old = (0..star.spokes.len()).map(|i| sine(surface, shape, star.spokes[i].h, None));
    let old = old.fold(f64::INFINITY, f64::min);
    let mut best: Option<(f64, Vec<HalfEdge>)> = None;
    let by_end = std::mem::take(&mut star.by_end);
    let spokes = |i: &u32| star.spokes[*i as usize];
    for own in by_end.chunk_by(|a, b| spokes(a).to == spokes(b).to) {
        let is_one_each = own.len() == star.copies.len()
            && (0..).zip(own).all(|(copy, i)| spokes(i).copy == copy);
        // Other vertices of the point may be far from the cut, and other walls unpaired for that.
        let is_rim = |(own, &i): (_, &u32)| {
            let h = spokes(&i).h;
            let both = [h, surface.topology().twin(h)].map(|h| surface.material(h.triangle()));
            star.is_rim(own, i as usize) && both[0] != both[1]
        };
        if !is_one_each || (star.has_skin && !star.copies.iter().zip(own).all(is_rim)) {
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
    let mut volumes = [0.0; 2];
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
        if star.has_skin && !is_affine(surface, shape, star, own, along) {
            return None;
        }
        let charts = [along, back.next()].map(|h| chart(surface, h));
        let (mut old_area, mut new_area, mut slack) = (0.0, 0.0, 0.0);
        let mut has_flat = false;
        for i in own.clone() {
            let h = star.spokes[i].h;
            let t = h.triangle();
            let (material, values) = chart(surface, h);
            let is_own = |(own_material, own): &(u32, CornerValues)| {
                material == *own_material && values.is_like(own, MAX_OFFSET)
            };
            if !charts.iter().any(is_own) {
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
            let reach = (pb - p).norm() + (pc - p).norm();
            let edge = (pb - q).norm();
            if edge > (LENGTHS[1] * length).max((pb - p).norm()) {
                return None;
            }
            let new = area_vector([q, pb, pc]);
            new_area += new.norm();
            let height = old.dot(&(q - p)).abs();
            let offset = if star.is_skin[i] { 0.0 } else { offset };
            if height > offset * old.norm() + 4.0 * rounding * (old.norm() + way * reach) {
                return None;
            }
            if old.norm() <= 4.0 * rounding * reach {
                has_flat = true;
            } else if old.dot(&new) <= 0.0 {
                return None;
            }
            let all = [gone, b, c, kept];
            let places = [
                all.map(|v| surface.position(v)),
                all.map(|v| surface.rest_position(v)),
            ];
            for (sum, [from, b, c, to]) in volumes.iter_mut().zip(places) {
                *sum += swept_volume([from, b, c], to);
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
    let limit = MAX_VOLUME * length.powi(3);
    let is_kept = volumes.iter().all(|sum| sum.abs() <= limit);
    (is_kept || !star.has_skin).then_some(worst)
}

/// Returns the material of a corner's triangle and the corner's attributes.
fn chart(surface: &Surface, h: HalfEdge) -> (u32, CornerValues) {
    (surface.material(h.triangle()), surface.corner_values(h))
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
