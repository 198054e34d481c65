//! Overlap queries: triangles that a sweep may touch.

use super::{Bvh, MAX_HEIGHT, triangle_bounds};
use crate::geometry::{area_vector, to_f32, to_f64};
use crate::ids::index_u32;
use crate::{Aabb, Surface, TriangleId, Vec3};
use robust::{Coord, orient2d};
use smallvec::SmallVec;

/// Maximum number of query triangles that are all tested at every node.
const MAX_TESTED_SLABS: usize = 4;

impl Bvh {
    /// Appends every triangle whose bounding box may touch one of `triangles` to `out`.
    ///
    /// The result is conservative and in the order of the tree. A query triangle without area
    /// touches nothing. O(k + log n) for k results, if `triangles` are small or coplanar.
    pub fn query(
        &self,
        surface: &Surface,
        triangles: impl IntoIterator<Item = [Vec3; 3]>,
        out: &mut Vec<TriangleId>,
    ) {
        let slabs: SmallVec<[Slab; 2]> = triangles.into_iter().map(Slab::new).collect();
        if slabs.len() > MAX_TESTED_SLABS {
            self.query_many(surface, &slabs, out);
        } else {
            self.traverse(surface, |b| slabs.iter().any(|slab| slab.may_touch(b)), out);
        }
    }

    /// Runs a query of many triangles.
    ///
    /// Tests a node only against the triangles that may touch its parent.
    fn query_many(&self, surface: &Surface, slabs: &[Slab], out: &mut Vec<TriangleId>) {
        if self.nodes.is_empty() {
            return;
        }
        // The slabs at each node on the way to the current one, node after node.
        let mut active: Vec<u32> = (0..index_u32(slabs.len())).collect();
        let touches = |slab: u32, bounds: &Aabb| slabs[slab as usize].may_touch(bounds);
        // Nodes to visit, with the range of their parent's slabs.
        let mut stack = vec![(0, 0..active.len())];
        while let Some((at, parent)) = stack.pop() {
            let node = &self.nodes[at as usize];
            active.truncate(parent.end);
            for i in parent.clone() {
                let slab = active[i];
                if touches(slab, &node.bounds) {
                    active.push(slab);
                }
            }
            let own = parent.end..active.len();
            if own.is_empty() {
                continue;
            }
            if !node.is_leaf() {
                stack.push((node.index + 1, own.clone()));
                stack.push((node.index, own));
                continue;
            }
            let block = &self.blocks[node.index as usize];
            for k in 0..node.count as usize {
                let bounds = triangle_bounds(surface, block.corners[k]);
                if active[own.clone()]
                    .iter()
                    .any(|&slab| touches(slab, &bounds))
                {
                    out.push(block.triangles[k]);
                }
            }
        }
    }

    /// Appends every triangle whose box `touches` to `out`.
    ///
    /// Boxes of whole subtrees are tested first: `touches` must accept every box that contains an
    /// accepted one.
    pub fn traverse(
        &self,
        surface: &Surface,
        touches: impl Fn(&Aabb) -> bool,
        out: &mut Vec<TriangleId>,
    ) {
        self.visit(surface, touches, |t| out.push(t));
    }

    /// Calls `each` with every triangle whose box `touches`, as in [`Bvh::traverse`].
    pub(super) fn visit(
        &self,
        surface: &Surface,
        touches: impl Fn(&Aabb) -> bool,
        mut each: impl FnMut(TriangleId),
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
                        each(block.triangles[k]);
                    }
                }
            }
            // The next node to visit is the right child of the nearest ancestor entered on the
            // left.
            if depth == 0 {
                break;
            }
            depth -= 1;
            at = rights[depth];
        }
    }
}

/// A query triangle as a bounding box and a plane.
pub(crate) struct Slab {
    /// Empty if the triangle has no area.
    bounds: Aabb,
    point: Vec3,
    normal: Vec3,
    /// By component, the sum of the unsigned products of which the normal is the difference.
    products: Vec3,
}

impl Slab {
    pub(crate) fn new(corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners;
        let bounds = if has_area(corners) {
            Aabb::around(corners.map(to_f32))
        } else {
            Aabb::default()
        };
        let (u, v) = ((b - a).abs(), (c - a).abs());
        Self {
            bounds,
            point: a,
            normal: area_vector(corners),
            products: Vec3::new(
                u.y * v.z + u.z * v.y,
                u.z * v.x + u.x * v.z,
                u.x * v.y + u.y * v.x,
            ),
        }
    }

    /// Returns false only if the box is certainly off the triangle; the slack exceeds f64 rounding.
    pub(crate) fn may_touch(&self, bounds: &Aabb) -> bool {
        if !self.bounds.overlaps(bounds) {
            return false;
        }
        let (min, max) = (to_f64(bounds.min), to_f64(bounds.max));
        let half = (max - min) / 2.0;
        let offset = (min + max) / 2.0 - self.point;
        let reach = self.normal.abs().dot(&half);
        let scale = self.normal.abs().dot(&offset.abs()) + reach;
        // The normal of a nearly collinear triangle is mostly rounding of its products.
        let rounding = self.products.dot(&(offset.abs() + half));
        self.normal.dot(&offset).abs() <= reach + scale * 1e-12 + rounding * 1e-15
    }
}

/// Returns whether a triangle has an area, decided exactly: that in one of three projections.
fn has_area([a, b, c]: [Vec3; 3]) -> bool {
    [(0, 1), (1, 2), (2, 0)].into_iter().any(|(i, j)| {
        let [a, b, c] = [a, b, c].map(|p| Coord { x: p[i], y: p[j] });
        orient2d(a, b, c) != 0.0
    })
}
