//! Which triangles may a sweep touch?

use super::{Bvh, MAX_HEIGHT, triangle_bounds};
use crate::sweep::Sweep;
use incise_mesh::geometry::{round, widen};
use incise_mesh::{Aabb, Surface, TriangleId, Vec3};

impl Bvh {
    /// Appends to `out` every triangle whose box may touch the sweep: all that do, and few that do
    /// not. In tree order. O(k + log n) for k found, when the sweep is small or flat.
    pub fn query(&self, surface: &Surface, sweep: &Sweep, out: &mut Vec<TriangleId>) {
        let slabs = sweep.triangles().map(Slab::new);
        let [first, second] = &slabs;
        match (first.exists(), second.exists()) {
            (true, true) => {
                let touches = |b: &Aabb| first.may_touch(b) || second.may_touch(b);
                self.collect(surface, touches, out);
            }
            (true, false) => self.collect(surface, |b| first.may_touch(b), out),
            (false, true) => self.collect(surface, |b| second.may_touch(b), out),
            (false, false) => {}
        }
    }

    /// Appends to `out` every triangle whose box `touches`.
    pub(super) fn collect(
        &self,
        surface: &Surface,
        touches: impl Fn(&Aabb) -> bool,
        out: &mut Vec<TriangleId>,
    ) {
        let mut at = 0;
        let mut rights = [0; MAX_HEIGHT];
        let mut depth = 0;
        while let Some(node) = self.nodes.get(at as usize) {
            if touches(&node.bounds) {
                if !node.is_leaf() {
                    rights[depth] = node.index + 1;
                    depth += 1;
                    at = node.index;
                    continue;
                }
                let block = &self.blocks[node.index as usize];
                for k in 0..node.count as usize {
                    if touches(&triangle_bounds(surface, block.corners[k])) {
                        out.push(block.triangles[k]);
                    }
                }
            }
            // The next node to visit is the right child of the nearest ancestor entered on the left.
            if depth == 0 {
                break;
            }
            depth -= 1;
            at = rights[depth];
        }
    }
}

/// A triangle of the sweep as what boxes are tested against: its own box and its plane.
struct Slab {
    bounds: Aabb,
    point: Vec3,
    normal: Vec3,
}

impl Slab {
    fn new(corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners;
        Self {
            bounds: Aabb::around(corners.map(round)),
            point: a,
            normal: (b - a).cross(&(c - a)),
        }
    }

    /// Whether the triangle has an area; without one nothing crosses it.
    fn exists(&self) -> bool {
        self.normal.norm() > 0.0
    }

    /// False only when the box is off the triangle for sure: the slack is far above f64 rounding.
    fn may_touch(&self, bounds: &Aabb) -> bool {
        if !self.bounds.overlaps(bounds) {
            return false;
        }
        let (min, max) = (widen(bounds.min), widen(bounds.max));
        let half = (max - min) / 2.0;
        let offset = (min + max) / 2.0 - self.point;
        let reach = self.normal.abs().dot(&half);
        let scale = self.normal.abs().dot(&offset.abs()) + reach;
        self.normal.dot(&offset).abs() <= reach + scale * 1e-12
    }
}
