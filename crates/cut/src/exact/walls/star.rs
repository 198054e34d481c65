//! The triangles around a point: all wall vertices with one rest position.

use super::collapse::Collapse;
use super::{MAX_OFFSET, RimMove, Shape};
use incise_mesh::{HalfEdge, Surface, VertexId, index_u32};
use smallvec::smallvec;
use std::ops::Range;

/// A half-edge that leaves a vertex of a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct RingEdge {
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
    pub(super) ring: Vec<RingEdge>,
    pub(super) copies: Vec<Range<usize>>,
    /// Numbers of the edges in the order of their ends.
    pub(super) by_end: Vec<u32>,
    /// By edge, whether its left triangle has no partner.
    pub(super) is_skin: Vec<bool>,
    pub(super) has_skin: bool,
    keys: Vec<([u32; 3], [u32; 3], bool, usize)>,
}

impl Star {
    /// Collects the ring of a point. Returns false at a boundary.
    pub(super) fn find(
        &mut self,
        surface: &Surface,
        shape: &Shape,
        starts: impl Iterator<Item = HalfEdge>,
    ) -> bool {
        let topology = surface.topology();
        self.ring.clear();
        self.copies.clear();
        let bits = |v: VertexId| shape.rest.bits(surface, v);
        for (copy, first) in (0..).zip(starts) {
            let from = self.ring.len();
            let mut at = first;
            loop {
                let twin = topology.twin(at);
                if twin.is_null() {
                    return false;
                }
                self.ring.push(RingEdge {
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
            self.copies.push(from..self.ring.len());
        }
        self.by_end.clear();
        self.by_end.extend(0..index_u32(self.ring.len()));
        let ring = &self.ring;
        (self.by_end).sort_unstable_by_key(|&i| (ring[i as usize].to, i));
        true
    }

    /// Marks the edges whose left triangle has no partner around the point `own`.
    ///
    /// Returns whether the point may go. No edge may run along a tip or have no length. Around
    /// each vertex, the triangles without a partner must form one run, or none has any.
    pub(super) fn find_skin(&mut self, own: [u32; 3]) -> bool {
        let is_excluded = |edge: &RingEdge| edge.left == edge.right || edge.to == own;
        if self.ring.iter().any(is_excluded) {
            return false;
        }
        self.keys.clear();
        let keys = (0..).zip(&self.ring).map(|(i, edge)| {
            let (a, b) = (edge.to, edge.left);
            (a.min(b), a.max(b), a < b, i)
        });
        self.keys.extend(keys);
        self.keys.sort_unstable();
        self.is_skin.clear();
        self.is_skin.resize(self.ring.len(), false);
        for own in self.keys.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let is_paired = own.iter().filter(|key| key.2).count() * 2 == own.len();
            for key in own {
                self.is_skin[key.3] = !is_paired;
            }
        }
        self.has_skin = self.is_skin.contains(&true);
        self.copies.iter().all(|own| {
            let is_skin = &self.is_skin[own.clone()];
            let changes = (0..is_skin.len()).filter(|&i| self.is_rim(own, own.start + i));
            changes.count() == if self.has_skin { 2 } else { 0 }
        })
    }

    /// Iterates over collapses of the zero-length edges at the point `own`.
    ///
    /// First of all edges together, then of each alone. They connect vertices that rounding has
    /// given one position.
    pub(super) fn zero_length_collapses<'a>(
        &'a self,
        surface: &'a Surface,
        own: [u32; 3],
    ) -> impl Iterator<Item = Collapse> + 'a {
        let topology = surface.topology();
        let is_zero = |edge: &&RingEdge| edge.to == own && edge.h < topology.twin(edge.h);
        let zeros: Vec<RingEdge> = self.ring.iter().filter(is_zero).copied().collect();
        let all = self.joined(surface, &zeros);
        let each = zeros.into_iter();
        (all.into_iter()).chain(each.filter_map(move |edge| self.joined(surface, &[edge])))
    }

    /// Returns the collapse of zero-length edges, if each takes another vertex onto one that stays.
    fn joined(&self, surface: &Surface, edges: &[RingEdge]) -> Option<Collapse> {
        let topology = surface.topology();
        let is_tip = |copy: u32| {
            let own = &self.ring[self.copies[copy as usize].clone()];
            own.iter().any(|edge| edge.left == edge.right)
        };
        let copy_of = |v: VertexId| {
            let mut copies = (0..).zip(&self.copies);
            copies.find_map(|(copy, own)| {
                (topology.origin(self.ring[own.start].h) == v).then_some(copy)
            })
        };
        // The end of more edges is kept.
        let ends = |edge: &RingEdge| [topology.origin(edge.h), topology.target(edge.h)];
        let degree = |v: VertexId| edges.iter().filter(|s| ends(s).contains(&v)).count();
        let mut target = Collapse {
            to: ends(edges.first()?)[0],
            along: smallvec![None; self.copies.len()],
            moves_all: false,
        };
        let mut kept = Vec::new();
        for edge in edges {
            let [from, to] = ends(edge);
            let other = copy_of(to)?;
            let tips = [is_tip(edge.copy), is_tip(other)];
            if tips == [true, true] {
                return None;
            }
            let is_forward = !tips[0] && (tips[1] || degree(from) <= degree(to));
            let (copy, h, end) = if is_forward {
                (edge.copy, edge.h, other)
            } else {
                (other, topology.twin(edge.h), edge.copy)
            };
            if target.along[copy as usize].replace(h).is_some() {
                return None;
            }
            kept.push(end);
        }
        let stays = |&copy: &u32| target.along[copy as usize].is_none();
        kept.iter().all(stays).then_some(target)
    }

    /// Returns the collapse of a vertex with three neighbors, two of which have one position.
    ///
    /// Two of its triangles coincide, and the third has no area. Other vertices of the point stay.
    pub(super) fn pocket(&self, surface: &Surface) -> Option<Collapse> {
        let topology = surface.topology();
        let material = |edge: &RingEdge| surface.material(edge.h.triangle());
        let edge = self.copies.iter().find_map(|own| {
            let ring: &[RingEdge; 3] = self.ring[own.clone()].try_into().ok()?;
            let is_alike = ring.iter().all(|edge| material(edge) == material(&ring[0]));
            let is_double = |edge: &&RingEdge| edge.to == edge.left;
            ring.iter().find(is_double).filter(|_| is_alike)
        })?;
        let mut along = smallvec![None; self.copies.len()];
        along[edge.copy as usize] = Some(edge.h);
        Some(Collapse {
            to: topology.target(edge.h),
            along,
            moves_all: false,
        })
    }

    /// Returns the rim's other edge at the vertex `own`, and the part of the way from the end of
    /// `along` to its end at which the vertex lies.
    pub(super) fn other_rim(
        &self,
        surface: &Surface,
        shape: &Shape,
        own: &Range<usize>,
        along: HalfEdge,
    ) -> Option<(usize, f32)> {
        let is_other = |&i: &usize| self.is_rim(own, i) && self.ring[i].h != along;
        let other = own.clone().find(is_other)?;
        let topology = surface.topology();
        let center = shape.at(surface, topology.origin(along));
        let both = [along, self.ring[other].h];
        let [near, far] = both.map(|h| (shape.at(surface, topology.target(h)) - center).norm());
        #[expect(
            clippy::cast_possible_truncation,
            reason = "weights have storage precision"
        )]
        let part = (near / (near + far)) as f32;
        Some((other, part))
    }

    /// Returns the move of the vertex `own` along the rim to the end of `along`.
    pub(super) fn rim_move(
        &self,
        surface: &Surface,
        shape: &Shape,
        own: &Range<usize>,
        along: HalfEdge,
    ) -> Option<RimMove> {
        let (other, part) = self.other_rim(surface, shape, own, along)?;
        let topology = surface.topology();
        Some(RimMove {
            gone: topology.origin(along),
            kept: topology.target(along),
            other: topology.target(self.ring[other].h),
            part,
        })
    }

    /// Returns whether an edge of the vertex `own` is between the skin and a wall.
    pub(super) fn is_rim(&self, own: &Range<usize>, edge: usize) -> bool {
        // The triangle right of an edge is left of the one before.
        let before = if edge == own.start { own.end } else { edge } - 1;
        self.is_skin[edge] != self.is_skin[before]
    }
}

/// Returns whether the texture and the normals of the skin at a point are the means of those at its
/// neighbors along the rim.
///
/// Then those of the skin change by at most [`MAX_OFFSET`] of their difference along the rim.
pub(super) fn is_affine(
    surface: &Surface,
    shape: &Shape,
    star: &Star,
    own: &Range<usize>,
    along: HalfEdge,
) -> bool {
    let topology = surface.topology();
    let Some((other, part)) = star.other_rim(surface, shape, own, along) else {
        return false;
    };
    let both = [along, star.ring[other].h];
    // The corners on the skin, at the end of an edge and at the point.
    let corners = |h: HalfEdge| {
        let twin = topology.twin(h);
        let is_left = own.clone().any(|i| star.ring[i].h == h && star.is_skin[i]);
        let ends = if is_left {
            [h.next(), h]
        } else {
            [twin, twin.next()]
        };
        ends.map(|h| surface.corner_values(h))
    };
    let [to, from] = both.map(corners);
    to[1] == from[1] && to[1].is_mean([&to[0], &from[0]], part, MAX_OFFSET)
}
