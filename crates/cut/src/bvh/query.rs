//! Which triangles may a sweep touch?

use super::{Bvh, triangle_bounds};
use crate::sweep::Sweep;
use incise_mesh::geometry::widen;
use incise_mesh::{Aabb, Surface, TriangleId, Vec3};

/// Median splits halve the triangles at every level, and ids have 32 bits.
const MAX_DEPTH: usize = 32;

impl Bvh {
    /// Appends to `out` every triangle whose box may touch the sweep: all that do, and few that do
    /// not. In tree order. O(k + log n) for k found, when the sweep is small or flat.
    pub fn query(&self, surface: &Surface, sweep: &Sweep, out: &mut Vec<TriangleId>) {
        let slabs = sweep.triangles().map(Slab::new);
        let mut at = 0;
        let mut rights = [0; MAX_DEPTH];
        let mut depth = 0;
        while at < self.nodes.len() {
            let node = &self.nodes[at];
            let hit = slabs.iter().any(|s| s.may_touch(&node.bounds));
            if hit && node.count > 0 {
                for i in node.index as usize..node.index as usize + node.count as usize {
                    let bounds = triangle_bounds(surface, self.corners[i]);
                    if slabs.iter().any(|s| s.may_touch(&bounds)) {
                        out.push(self.order[i]);
                    }
                }
            }
            if hit && node.count == 0 {
                rights[depth] = node.index;
                depth += 1;
                at += 1;
                continue;
            }
            // The next node to visit is the right child of the nearest ancestor entered on the left.
            if depth == 0 {
                break;
            }
            depth -= 1;
            at = rights[depth] as usize;
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
            bounds: Aabb::around(corners.map(incise_mesh::geometry::round)),
            point: a,
            normal: (b - a).cross(&(c - a)),
        }
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
