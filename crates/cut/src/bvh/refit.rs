//! New boxes for moved triangles in the old tree.

use super::{Bvh, triangle_bounds};
use incise_mesh::{Aabb, Surface};

impl Bvh {
    /// Fits all boxes to where the vertices are now. O(n). The triangles must be those that the
    /// tree was built over.
    pub fn refit(&mut self, surface: &Surface) {
        // Children stand after their parents, so one pass from the end sees them first.
        for i in (0..self.nodes.len()).rev() {
            let node = self.nodes[i];
            self.nodes[i].bounds = if node.count > 0 {
                let first = node.index as usize;
                self.corners[first..first + node.count as usize]
                    .iter()
                    .fold(Aabb::default(), |b, &c| {
                        b.union(triangle_bounds(surface, c))
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
