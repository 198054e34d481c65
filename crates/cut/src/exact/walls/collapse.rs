//! Collapses a point of the walls onto a neighbor, on all walls that meet there.

use super::star::{RingEdge, Star, is_affine};
use super::{MAX_OFFSET, ROUNDING, Shape, Walls, smallest_sine};
use crate::affine::AffineMap;
use crate::exact::contract::swept_volume;
use crate::sizing;
use incise_mesh::geometry::{area_vector, to_f32};
use incise_mesh::{CornerValues, Edit, HalfEdge, Surface, Vec3, VertexId, VertexOrigin};
use smallvec::{SmallVec, smallvec};
use std::ops::Range;

/// Length below which an edge of a wall is collapsed, and length up to which edges may grow
/// [target lengths].
///
/// A collapse of two edges of equal length makes one of twice the length. Between both ends of a
/// range with the ratio 2, edges are as near to the target as they can be in the logarithm.
const LENGTHS: [f64; 2] = [std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::SQRT_2];

/// Maximum volume by which a collapse on the skin changes the body [cubes of the target length].
///
/// It is 0 up to rounding where the skin is flat, and the skin of a moving body is nearly flat. Ten
/// collapses change a body of one cube by 1e-5, as a cut without snapping may.
const MAX_VOLUME: f64 = 1e-6;

/// A candidate collapse of a point onto a neighbor.
#[derive(Debug, Clone)]
pub(super) struct Collapse {
    /// A vertex of the neighbor.
    pub(super) to: VertexId,
    /// By vertex of the point, its half-edge to the neighbor; none if it moves there without one.
    pub(super) along: SmallVec<[Option<HalfEdge>; 8]>,
}

impl Walls {
    /// Collapses a point onto the neighbor that leaves the largest smallest angle, if one is valid.
    pub(super) fn collapse(&mut self, edit: &mut Edit<'_>, shape: &Shape, point: u32) -> bool {
        let surface = edit.surface();
        let mut star = std::mem::take(&mut self.star);
        let found = star.find(surface, shape, self.points.starts(point));
        let best = if !found || star.copies.len() < 2 {
            None
        } else {
            let own = shape
                .rest
                .bits(surface, surface.topology().origin(star.spokes[0].h));
            if let Some(target) = star.zero_collapse(surface, own) {
                star.has_skin = false;
                Some(target).filter(|target| are_linked(surface, &star, target))
            } else if star.find_skin(own) {
                best_collapse(surface, shape, &mut star)
            } else {
                None
            }
        };
        if let Some(target) = best.as_ref().filter(|_| star.has_skin) {
            let moves = star.copies.iter().zip(target.along.iter().flatten());
            let moves = moves.map(|(own, &along)| star.rim_move(edit.surface(), shape, own, along));
            self.moved.extend(moves.flatten());
        }
        let is_done = best.is_some_and(|target| self.apply(edit, shape, &star, &target));
        self.star = star;
        is_done
    }

    /// Collapses the edges onto their ends, and moves the other vertices there.
    ///
    /// Returns whether anything has changed.
    fn apply(
        &mut self,
        edit: &mut Edit<'_>,
        shape: &Shape,
        star: &Star,
        target: &Collapse,
    ) -> bool {
        let surface = edit.surface();
        let own = surface.topology().origin(star.spokes[0].h);
        let is_moved = shape.rest.bits(surface, own) != shape.rest.bits(surface, target.to);
        let lone = star.copies.iter().zip(&target.along);
        let lone = lone.filter(|&(_, along)| is_moved && along.is_none());
        let lone: Vec<_> = lone
            .map(|(own, _)| {
                (
                    own.clone(),
                    moved_vertex(surface, shape, star, own, target.to),
                )
            })
            .collect();
        let mut near = Vec::new();
        for &h in target.along.iter().flatten() {
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
        let point = self.points.point_of(target.to);
        for (own, [position, rest]) in lone {
            let spokes = &star.spokes[own];
            let gone = edit.surface().topology().origin(spokes[0].h);
            let [x, y, z] = to_f32(position);
            let w = edit.surface().positions()[gone.index()][3];
            let origin = VertexOrigin::OnCap {
                parents: [gone; 3],
                weights: [1.0, 0.0, 0.0],
            };
            let moved = edit.add_vertex([x, y, z, w], to_f32(rest), origin);
            for spoke in spokes {
                edit.set_corner(spoke.h, moved);
                near.push(edit.surface().topology().target(spoke.h));
            }
            self.points.set_start(gone, HalfEdge::NULL);
            if let Some(point) = point {
                self.points.insert(moved, spokes[0].h, point);
            }
        }
        let has_changed = !near.is_empty();
        near.push(target.to);
        for v in near {
            if let Some(point) = self.points.point_of(v) {
                self.enqueue(point);
            }
        }
        has_changed
    }
}

/// Returns the position and the rest position of a vertex of a point that moves onto `to` \[m\].
///
/// In the shape that is not at rest it moves as the triangles around it map the way.
fn moved_vertex(
    surface: &Surface,
    shape: &Shape,
    star: &Star,
    own: &Range<usize>,
    to: VertexId,
) -> [Vec3; 2] {
    let topology = surface.topology();
    let spokes = &star.spokes[own.clone()];
    let gone = topology.origin(spokes[0].h);
    let places = |v: VertexId| (shape.at(surface, v), shape.other(surface, v));
    let ends = spokes.iter().map(|spoke| topology.target(spoke.h));
    let pairs: Vec<(Vec3, Vec3)> = ends.chain([gone]).map(places).collect();
    let map = AffineMap::fit(&pairs);
    let (from, present) = places(gone);
    let rest = shape.at(surface, to);
    let other = if pairs.iter().all(|(p, q)| p == q) {
        rest
    } else {
        present + map.at(rest) - map.at(from)
    };
    shape.in_order(rest, other)
}

/// Returns the way to the best neighbor.
fn best_collapse(surface: &Surface, shape: &Shape, star: &mut Star) -> Option<Collapse> {
    let own = surface.topology().origin(star.spokes[0].h);
    let length = shape.target(surface, own)?;
    if star.has_skin && !sizing::is_made(surface, own) {
        return None;
    }
    let old = (0..star.spokes.len()).map(|i| sine(surface, shape, star.spokes[i].h, None));
    let old = old.fold(f64::INFINITY, f64::min);
    let mut best: Option<(f64, Collapse)> = None;
    let by_end = std::mem::take(&mut star.by_end);
    let spokes = |i: &u32| star.spokes[*i as usize];
    let topology = surface.topology();
    for own in by_end.chunk_by(|a, b| spokes(a).to == spokes(b).to) {
        let ends = |h: HalfEdge| [topology.origin(h), topology.target(h)];
        let mut target = Collapse {
            to: ends(spokes(&own[0]).h)[1],
            along: smallvec![None; star.copies.len()],
        };
        let mut is_one_each = true;
        for i in own {
            let RingEdge { h, copy, .. } = spokes(i);
            is_one_each &= target.along[copy as usize].replace(h).is_none();
        }
        let [p, q] = ends(spokes(&own[0]).h).map(|v| shape.at(surface, v));
        let is_short = (q - p).norm() < MAX_OFFSET * length;
        let may_move = is_short && !star.has_skin;
        // Other vertices of the point may be far from the cut, and other walls unpaired for that.
        let is_rim = |(own, &i): (_, &u32)| {
            let h = spokes(&i).h;
            let both = [h, topology.twin(h)].map(|h| surface.material(h.triangle()));
            star.is_rim(own, i as usize) && both[0] != both[1]
        };
        if !is_one_each
            || !(may_move || own.len() == star.copies.len())
            || (star.has_skin && !star.copies.iter().zip(own).all(is_rim))
        {
            continue;
        }
        // Without short edges the other angles can become good.
        let least = if is_short {
            0.0
        } else {
            old.min(shape.good_sine)
        };
        let least = best.as_ref().map_or(least, |best| best.0);
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

/// Returns the sine of the smallest angle after a collapse onto `target`.
///
/// None if it is below `least`, if a wall would move too far or be inverted, or if an edge would
/// become too long.
fn quality_onto(
    surface: &Surface,
    shape: &Shape,
    star: &Star,
    target: &Collapse,
    length: f64,
    least: f64,
) -> Option<f64> {
    let topology = surface.topology();
    let mut worst = f64::INFINITY;
    let mut volumes = [0.0; 2];
    let is_pinned = |v: VertexId| surface.positions()[v.index()][3] == 0.0;
    let piece = |own: &Range<usize>| surface.piece(star.spokes[own.start].h.triangle());
    let is_one_piece = star
        .copies
        .iter()
        .all(|own| piece(own) == piece(&star.copies[0]));
    let offset = if is_one_piece {
        MAX_OFFSET * length
    } else {
        0.0
    };
    let own = topology.origin(star.spokes[0].h);
    let [p, q] = [own, target.to].map(|v| shape.at(surface, v));
    let way = (q - p).norm();
    if way >= LENGTHS[0] * length {
        return None;
    }
    let is_short = way < MAX_OFFSET * length;
    let rounding = ROUNDING * p.amax().max(q.amax());
    for (own, &along) in star.copies.iter().zip(&target.along) {
        let gone = topology.origin(star.spokes[own.start].h);
        let kept = along.map(|h| topology.target(h));
        if is_pinned(gone) && !kept.is_some_and(is_pinned) {
            return None;
        }
        let to = match kept {
            Some(kept) => [surface.position(kept), surface.rest_position(kept)],
            None => moved_vertex(surface, shape, star, own, target.to),
        };
        if let Some(along) = along
            && star.has_skin
            && !is_affine(surface, shape, star, own, along)
        {
            return None;
        }
        let charts = along.map(|h| [h, topology.twin(h).next()].map(|h| chart(surface, h)));
        let (mut old_area, mut new_area, mut slack) = (0.0, 0.0, 0.0);
        let mut has_flat = false;
        for i in own.clone() {
            let h = star.spokes[i].h;
            if let Some(charts) = &charts {
                let (material, values) = chart(surface, h);
                let is_own = |(own_material, own): &(u32, CornerValues)| {
                    material == *own_material && values.is_like(own, MAX_OFFSET)
                };
                if !charts.iter().any(is_own) {
                    return None;
                }
            }
            let [b, c] = [topology.target(h), topology.origin(h.prev())];
            let [pb, pc] = [b, c].map(|v| shape.at(surface, v));
            let old = area_vector([p, pb, pc]);
            old_area += old.norm();
            slack += rounding * ((pb - p).norm() + (pc - p).norm() + way);
            let is_at = |v: VertexId| Some(v) == kept;
            if is_at(b) || is_at(c) {
                continue;
            }
            let reach = (pb - p).norm() + (pc - p).norm();
            let edge = (pb - q).norm();
            if !is_short && edge > (LENGTHS[1] * length).max((pb - p).norm()) {
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
            worst = worst.min(smallest_sine([q, pb, pc]));
            if worst < least {
                return None;
            }
            let places = |v: VertexId| [surface.position(v), surface.rest_position(v)];
            let all = [places(gone), places(b), places(c), to];
            for (k, sum) in volumes.iter_mut().enumerate() {
                let [from, b, c, to] = all.map(|places| places[k]);
                *sum += swept_volume([from, b, c], to);
            }
            if !keeps_present(all) {
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

/// Returns whether a triangle keeps its orientation in both shapes if its first corner moves.
///
/// `all` has the places of its corners and that to which the first one moves, in both shapes.
fn keeps_present(all: [[Vec3; 2]; 4]) -> bool {
    if all.iter().all(|[place, rest]| place == rest) {
        return true;
    }
    (0..2).all(|k| {
        let [from, b, c, to] = all.map(|places| places[k]);
        let [old, new] = [from, to].map(|p| area_vector([p, b, c]));
        old.norm() == 0.0 || old.dot(&new) > 0.0
    })
}

/// Returns whether the link condition holds for all spokes of `target` together.
fn are_linked(surface: &Surface, star: &Star, target: &Collapse) -> bool {
    let topology = surface.topology();
    let ends = |copy: usize| {
        let own = star.spokes[star.copies[copy].clone()].iter();
        own.map(|spoke| topology.target(spoke.h))
    };
    let mut far: SmallVec<[VertexId; 16]> = SmallVec::new();
    let spokes = || {
        (0..)
            .zip(&target.along)
            .filter_map(|(copy, h)| Some((copy, (*h)?)))
    };
    for (copy, h) in spokes() {
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
        let mut before = spokes().take_while(|&(other, _)| other < copy);
        let repeats = before.any(|(other, h)| {
            topology.target(h) == kept && ends(other).any(|v| v != kept && near.contains(&v))
        });
        let is_folded = |h: HalfEdge| {
            let beyond = |side: HalfEdge| topology.origin(topology.twin(side).prev());
            near.len() <= 3 && beyond(h.next()) == beyond(h.prev())
        };
        if is_folded(h) || is_folded(back) || common != 2 || repeats {
            return false;
        }
    }
    true
}
