//! Collapses coincident wall vertices onto a neighbor, on all walls that meet there.

use super::quality::{are_linked, quality_onto, sine};
use super::star::{RingEdge, Star};
use super::{MAX_OFFSET, RimMove, Shape, Walls};
use crate::affine::AffineMap;
use crate::sizing;
use incise_mesh::geometry::to_f32;
use incise_mesh::{Edit, HalfEdge, Surface, Vec3, VertexId, VertexOrigin};
use smallvec::{SmallVec, smallvec};
use std::ops::Range;

/// A candidate collapse of a point onto a neighbor.
#[derive(Debug, Clone)]
pub(super) struct Collapse {
    /// A vertex of the neighbor.
    pub(super) to: VertexId,
    /// By vertex of the point, its half-edge to the neighbor.
    pub(super) along: SmallVec<[Option<HalfEdge>; 8]>,
    /// Whether vertices without one move there as well.
    pub(super) moves_all: bool,
}

impl Walls {
    /// Collapses a point onto the neighbor that leaves the largest smallest angle, if one is valid.
    pub(super) fn collapse(&mut self, edit: &mut Edit<'_>, shape: &Shape, point: u32) -> bool {
        let surface = edit.surface();
        let mut star = std::mem::take(&mut self.star);
        let found = star.find(surface, shape, self.points.starts(point));
        let best = if found {
            degenerate_collapse(surface, shape, &star)
                .or_else(|| best_collapse(surface, shape, &mut star))
        } else {
            None
        };
        if let Some(target) = &best {
            let along = star.copies.iter().zip(&target.along);
            let along = along.filter_map(|(own, along)| Some((own, (*along)?)));
            let moves = along.map(|(own, along)| match target.moves_all {
                true if star.has_skin => star.rim_move(surface, shape, own, along),
                true => None,
                false => Some(RimMove::onto_end(surface, along)),
            });
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
        let is_lone = |&copy: &usize| target.moves_all && target.along[copy].is_none();
        let lone = (0..star.copies.len()).filter(is_lone);
        let lone: Vec<_> = lone
            .map(|copy| {
                let places = target_places(surface, shape, star, target, copy);
                (star.copies[copy].clone(), places)
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
            let ring = &star.ring[own];
            let gone = edit.surface().topology().origin(ring[0].h);
            let [x, y, z] = to_f32(position);
            let w = edit.surface().positions()[gone.index()][3];
            let origin = VertexOrigin::OnCap {
                parents: [gone; 3],
                weights: [1.0, 0.0, 0.0],
            };
            let moved = edit.add_vertex([x, y, z, w], to_f32(rest), origin);
            for edge in ring {
                edit.set_corner(edge.h, moved);
                near.push(edit.surface().topology().target(edge.h));
            }
            self.points.set_start(gone, HalfEdge::NULL);
            if let Some(point) = point {
                self.points.insert(moved, ring[0].h, point);
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

/// Returns the position and the rest position that a vertex of a point gets by a collapse \[m\].
///
/// Vertices at one place in both shapes stay at one place, so that later cuts split all walls
/// alike.
pub(super) fn target_places(
    surface: &Surface,
    shape: &Shape,
    star: &Star,
    target: &Collapse,
    copy: usize,
) -> [Vec3; 2] {
    let topology = surface.topology();
    let vertex = |copy: usize| topology.origin(star.ring[star.copies[copy].start].h);
    let place = |copy: usize| shape.other(surface, vertex(copy));
    let own = place(copy);
    let same = (0..star.copies.len()).filter(|&other| place(other) == own);
    let along = same.clone().find_map(|other| target.along[other]);
    let along = target.along[copy].or(along);
    if let Some(kept) = along.map(|h| topology.target(h)) {
        return [surface.position(kept), surface.rest_position(kept)];
    }
    let first = same.min().unwrap_or(copy);
    moved_vertex(surface, shape, star, &star.copies[first], target.to)
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
    let ring = &star.ring[own.clone()];
    let gone = topology.origin(ring[0].h);
    let places = |v: VertexId| (shape.at(surface, v), shape.other(surface, v));
    let ends = ring.iter().map(|edge| topology.target(edge.h));
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

/// Returns a valid collapse that removes triangles without area, see [`Star::pocket`].
fn degenerate_collapse(surface: &Surface, shape: &Shape, star: &Star) -> Option<Collapse> {
    let own = surface.topology().origin(star.ring.first()?.h);
    let zeros = star.zero_length_collapses(surface, shape.rest.bits(surface, own));
    let mut all = star.pocket(surface).into_iter().chain(zeros);
    all.find(|target| are_linked(surface, star, target))
}

/// Returns the valid collapse that leaves the largest smallest angle.
fn best_collapse(surface: &Surface, shape: &Shape, star: &mut Star) -> Option<Collapse> {
    let own = surface.topology().origin(star.ring.first()?.h);
    if star.copies.len() < 2 || !star.find_skin(shape.rest.bits(surface, own)) {
        return None;
    }
    let length = shape.target(surface, own)?;
    if star.has_skin && !sizing::is_made(surface, own) {
        return None;
    }
    let old = (0..star.ring.len()).map(|i| sine(surface, shape, star.ring[i].h, None));
    let old = old.fold(f64::INFINITY, f64::min);
    let mut best: Option<(f64, Collapse)> = None;
    let by_end = std::mem::take(&mut star.by_end);
    let ring = |i: &u32| star.ring[*i as usize];
    let topology = surface.topology();
    for own in by_end.chunk_by(|a, b| ring(a).to == ring(b).to) {
        let ends = |h: HalfEdge| [topology.origin(h), topology.target(h)];
        let mut target = Collapse {
            to: ends(ring(&own[0]).h)[1],
            along: smallvec![None; star.copies.len()],
            moves_all: true,
        };
        let mut is_one_each = true;
        for i in own {
            let RingEdge { h, copy, .. } = ring(i);
            is_one_each &= target.along[copy as usize].replace(h).is_none();
        }
        let [p, q] = ends(ring(&own[0]).h).map(|v| shape.at(surface, v));
        let is_short = (q - p).norm() < MAX_OFFSET * length;
        let may_move = is_short && !star.has_skin;
        // Other vertices of the point may be far from the cut, and other walls unpaired for that.
        let is_rim = |(own, &i): (_, &u32)| {
            let h = ring(&i).h;
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
