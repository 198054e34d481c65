//! Flips diagonals of walls, on both of two coincident walls.

use super::{MAX_OFFSET, ROUNDING, Shape, Walls, smallest_sine};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Edit, HalfEdge, Surface, VertexId};

/// Minimum ratio of the smallest sine after and before a flip.
///
/// Above 1, so that flips end: from an angle of the size of rounding, 1e-7, it takes at most 1,620
/// of them to a right angle.
const MIN_GAIN: f64 = 1.01;

impl Walls {
    /// Flips diagonals until none enlarges the smallest angle.
    pub(super) fn flip_all(&mut self, edit: &mut Edit<'_>, shape: &Shape) {
        let mut points: Vec<u32> = (0..self.points.len()).collect();
        while !points.is_empty() {
            let mut changed = Vec::new();
            for &point in &points {
                while self.flip_one(edit, shape, point, &mut changed) {}
            }
            changed.sort_unstable();
            changed.dedup();
            points = changed;
        }
    }

    /// Flips one diagonal at a point, if that is valid, and collects the points around.
    fn flip_one(
        &mut self,
        edit: &mut Edit<'_>,
        shape: &Shape,
        point: u32,
        changed: &mut Vec<u32>,
    ) -> bool {
        let surface = edit.surface();
        let (star, own_walls) = (&mut self.star, &self.own);
        if !star.find(surface, shape, self.points.starts(point)) {
            return false;
        }
        let edge = |i: u32| star.ring[i as usize];
        let mut groups = star.by_end.chunk_by(|&a, &b| edge(a).to == edge(b).to);
        let found = groups.find_map(|own| {
            let &[first, second] = own else { return None };
            let [first, second] = [first, second].map(edge);
            let is_pair = first.left == second.right && first.right == second.left;
            let is_fold = first.left == first.right;
            if !is_pair || is_fold {
                return None;
            }
            let pair = [first.h, second.h];
            let topology = surface.topology();
            let is_own = |h: HalfEdge| {
                let both = [h, topology.twin(h)];
                both.iter()
                    .any(|h| own_walls.find(h.triangle().0).is_some())
            };
            if pair.into_iter().any(is_own) {
                return None;
            }
            may_flip(surface, shape, pair).then_some(pair)
        });
        let Some(pair) = found else {
            return false;
        };
        let mut is_flipped = false;
        for h in pair {
            let twin = edit.surface().topology().twin(h);
            if edit.flip_edge(h).is_err() {
                continue;
            }
            is_flipped = true;
            let topology = edit.surface().topology();
            for h in [h, twin]
                .into_iter()
                .flat_map(|h| h.triangle().half_edges())
            {
                let v = topology.origin(h);
                self.points.set_start(v, h);
                changed.extend(self.points.point_of(v));
            }
        }
        is_flipped
    }
}

/// Returns whether flipping two coincident diagonals is valid and enlarges the smallest angle.
fn may_flip(surface: &Surface, shape: &Shape, pair: [HalfEdge; 2]) -> bool {
    let topology = surface.topology();
    let quad = |h: HalfEdge| {
        let twin = topology.twin(h);
        [h, twin.prev(), twin, h.prev()].map(|h| topology.origin(h))
    };
    let quads = pair.map(quad);
    // In the order a, d, b, c: the edge runs from a to b.
    let [a, d, b, c] = quads[0].map(|v| shape.at(surface, v));
    let old = [[a, b, c], [b, a, d]];
    let new = [[d, b, c], [c, a, d]];
    let worst = |triangles: [[_; 3]; 2]| {
        let [first, second] = triangles.map(smallest_sine);
        first.min(second)
    };
    if worst(new) <= MIN_GAIN * worst(old) {
        return false;
    }
    let Some(target) = shape.target(surface, quads[0][0]) else {
        return false;
    };
    let [first, second] = old.map(area_vector);
    let normal = first + second;
    let is_upright = new.into_iter().all(|t| area_vector(t).dot(&normal) > 0.0)
        && [first, second].into_iter().all(|n| n.dot(&normal) >= 0.0);
    let volume = (b - a).cross(&(c - a)).dot(&(d - a)).abs();
    let rounding = ROUNDING * [a, b, c, d].iter().fold(0.0, |m, p| p.amax().max(m));
    let is_one_piece = surface.piece(pair[0].triangle()) == surface.piece(pair[1].triangle());
    let offset = if is_one_piece {
        MAX_OFFSET * target
    } else {
        0.0
    };
    let reach = (b - a).norm() + (d - c).norm();
    let is_flat = volume <= offset * normal.norm() + 4.0 * rounding * reach * reach;
    let is_shared = quads[0][1] == quads[1][3] && quads[0][3] == quads[1][1];
    is_upright && is_flat && !is_shared && pair.into_iter().all(|h| is_free(surface, h))
}

/// Returns whether the triangles at an edge are alike and the other diagonal is no edge.
fn is_free(surface: &Surface, h: HalfEdge) -> bool {
    let topology = surface.topology();
    let twin = topology.twin(h);
    let [first, second] = [h.triangle(), twin.triangle()];
    let ends = [twin.prev(), h.prev()];
    let goal: VertexId = topology.origin(ends[1]);
    let mut at = ends[0];
    loop {
        if topology.target(at) == goal {
            return false;
        }
        at = topology.twin(at.prev());
        if at.is_null() {
            return false;
        }
        if at == ends[0] {
            break;
        }
    }
    surface.material(first) == surface.material(second)
        && surface.has_equal_corners(h, twin.next())
        && surface.has_equal_corners(h.next(), twin)
}
