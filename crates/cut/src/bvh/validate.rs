//! The tree's invariants, checked in full.

use super::{Bvh, Node, triangle_bounds};
use incise_mesh::{Aabb, Surface};

/// A broken invariant of a [`Bvh`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{rule} does not hold at node {node}")]
pub struct InvalidBvh {
    /// The broken rule.
    pub rule: &'static str,
    /// Where.
    pub node: usize,
}

impl Bvh {
    /// Checks that every triangle of the surface is in one leaf and that every box is exactly the
    /// one around what it holds. O(n).
    ///
    /// # Errors
    /// The first broken rule and where.
    pub fn validate(&self, surface: &Surface) -> Result<(), InvalidBvh> {
        let broken = |rule, node| Err(InvalidBvh { rule, node });
        let mut covered = 0;
        for (i, node) in self.nodes.iter().enumerate() {
            let expected = match *node {
                Node {
                    count: 0, index, ..
                } => {
                    let right = index as usize;
                    if right <= i + 1 || right >= self.nodes.len() {
                        return broken("children stand after their parent", i);
                    }
                    self.nodes[i + 1].bounds.union(self.nodes[right].bounds)
                }
                Node { count, index, .. } => {
                    if index as usize != covered {
                        return broken("leaves follow each other in order", i);
                    }
                    covered += count as usize;
                    let Some(corners) = self.corners.get(index as usize..covered) else {
                        return broken("leaves lie within the order", i);
                    };
                    corners.iter().fold(Aabb::default(), |b, &c| {
                        b.union(triangle_bounds(surface, c))
                    })
                }
            };
            if node.bounds != expected {
                return broken("a box fits what it holds", i);
            }
        }
        let known = |(&t, &corners)| surface.topology().triangle(t) == corners;
        if self.corners.len() != self.order.len()
            || !self.order.iter().zip(&self.corners).all(known)
        {
            return broken("corners are those of the triangles in order", 0);
        }
        let mut order = self.order.clone();
        order.sort_unstable();
        if covered != order.len() || !order.into_iter().eq(surface.topology().triangles()) {
            return broken("every triangle is in one leaf", 0);
        }
        Ok(())
    }
}
