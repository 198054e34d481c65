//! Whether a collapse is valid, and the smallest angle that it leaves.

use super::collapse::{Collapse, target_places};
use super::star::{Star, is_affine};
use super::{MAX_OFFSET, ROUNDING, Shape, smallest_sine};
use crate::exact::contract::swept_volume;
use incise_mesh::geometry::area_vector;
use incise_mesh::{CornerValues, HalfEdge, Surface, Vec3, VertexId};
use smallvec::SmallVec;
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

/// Returns the sine of the smallest angle of the triangle left of an edge, with another origin.
pub(super) fn sine(surface: &Surface, shape: &Shape, h: HalfEdge, origin: Option<Vec3>) -> f64 {
    let topology = surface.topology();
    let [p, b, c] = [h, h.next(), h.prev()].map(|h| shape.at(surface, topology.origin(h)));
    smallest_sine([origin.unwrap_or(p), b, c])
}

/// Returns the sine of the smallest angle after a collapse onto `target`.
///
/// None if it is below `least`, if a wall would move too far or be inverted, or if an edge would
/// become too long.
pub(super) fn quality_onto(
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
    let piece = |own: &Range<usize>| surface.piece(star.ring[own.start].h.triangle());
    let is_one_piece = star
        .copies
        .iter()
        .all(|own| piece(own) == piece(&star.copies[0]));
    let offset = if is_one_piece {
        MAX_OFFSET * length
    } else {
        0.0
    };
    let own = topology.origin(star.ring[0].h);
    let [p, q] = [own, target.to].map(|v| shape.at(surface, v));
    let way = (q - p).norm();
    if way >= LENGTHS[0] * length {
        return None;
    }
    let is_short = way < MAX_OFFSET * length;
    let rounding = ROUNDING * p.amax().max(q.amax());
    for (copy, (own, &along)) in star.copies.iter().zip(&target.along).enumerate() {
        let gone = topology.origin(star.ring[own.start].h);
        let kept = along.map(|h| topology.target(h));
        if is_pinned(gone) && !kept.is_some_and(is_pinned) {
            return None;
        }
        let to = target_places(surface, shape, star, target, copy);
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
            let h = star.ring[i].h;
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

/// Returns whether the link condition holds for all edges of `target` together.
pub(super) fn are_linked(surface: &Surface, star: &Star, target: &Collapse) -> bool {
    let topology = surface.topology();
    let ends = |copy: usize| {
        let own = star.ring[star.copies[copy].clone()].iter();
        own.map(|edge| topology.target(edge.h))
    };
    let mut far: SmallVec<[VertexId; 16]> = SmallVec::new();
    let ring = || {
        (0..)
            .zip(&target.along)
            .filter_map(|(copy, h)| Some((copy, (*h)?)))
    };
    for (copy, h) in ring() {
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
        let mut before = ring().take_while(|&(other, _)| other < copy);
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
