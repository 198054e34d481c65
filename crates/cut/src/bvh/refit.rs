//! New boxes for moved triangles in the old tree.

use super::Bvh;
use incise_mesh::{Aabb, Surface, TriangleId};

impl Bvh {
    /// Fits all boxes to where the vertices are now. O(n). The triangles must be those that the
    /// tree was built over.
    pub fn refit(&mut self, surface: &Surface) {
        // Children stand after their parents, so one pass from the end sees them first.
        for i in (0..self.nodes.len()).rev() {
            let node = self.nodes[i];
            self.nodes[i].bounds = if node.count > 0 {
                let first = node.index as usize;
                self.order[first..first + node.count as usize]
                    .iter()
                    .fold(Aabb::default(), |b, &t| {
                        b.union(triangle_bounds(surface, t))
                    })
            } else {
                self.nodes[i + 1]
                    .bounds
                    .union(self.nodes[node.index as usize].bounds)
            };
        }
    }

    /// The box around everything.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.nodes.first().map_or_else(Aabb::default, |n| n.bounds)
    }
}

/// The box around a triangle.
pub(super) fn triangle_bounds(surface: &Surface, t: TriangleId) -> Aabb {
    Aabb::around(surface.topology().triangle(t).map(|v| {
        let [x, y, z, _] = surface.positions[v.index()];
        [x, y, z]
    }))
}
