//! Validation of a section mesh against the invariants that hold for every section.

use super::{Section, SectionMesh};

/// A violated invariant of a section mesh.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidSectionMesh {
    /// A triangle repeats a corner or has one that does not exist.
    #[error("triangle {triangle} has the corners {corners:?}: one is repeated or does not exist")]
    Triangle {
        /// Index of the triangle.
        triangle: usize,
        /// Corners of the triangle.
        corners: [u32; 3],
    },
    /// Two triangles have the same directed edge.
    #[error("the edge {0} -> {1} is the side of two triangles", edge[0], edge[1])]
    EdgeTwice {
        /// Ends of the edge.
        edge: [u32; 2],
    },
    /// An edge of a loop has no triangle on its left, or one on its right.
    #[error("the loop's edge {0} -> {1} is not on the boundary", edge[0], edge[1])]
    Boundary {
        /// Ends of the edge.
        edge: [u32; 2],
    },
    /// An edge on no loop has only one triangle.
    #[error("the edge {0} -> {1} has one triangle and is on no loop", edge[0], edge[1])]
    Open {
        /// Ends of the edge.
        edge: [u32; 2],
    },
    /// The triangles around a vertex do not form a single fan.
    #[error("the triangles around vertex {vertex} form {fans} fans")]
    Fans {
        /// The vertex.
        vertex: u32,
        /// Number of fans: 0, or 2 for more than one.
        fans: usize,
    },
    /// A Steiner point is not the weighted mean of its parents.
    #[error("Steiner point {index} is off its parents' mean by {error} m, or a weight is wrong")]
    Mean {
        /// Index of the Steiner point.
        index: usize,
        /// Largest difference of a coordinate \[m\].
        error: f64,
    },
}

impl SectionMesh {
    /// Checks that the mesh is a manifold whose boundary is exactly the section's loops.
    ///
    /// Every vertex must have one fan of triangles. Every Steiner point must be its parents'
    /// weighted mean within `tolerance` \[m\].
    ///
    /// # Errors
    /// The first [`InvalidSectionMesh`] found.
    pub fn validate(
        &self,
        section: &Section<'_>,
        tolerance: f64,
    ) -> Result<(), InvalidSectionMesh> {
        let count = section.points.len() + self.steiner_points.len();
        let mut sides: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * self.triangles.len());
        for (triangle, &corners) in self.triangles.iter().enumerate() {
            let [a, b, c] = corners;
            if a == b || b == c || c == a || corners.iter().any(|&v| v as usize >= count) {
                return Err(InvalidSectionMesh::Triangle { triangle, corners });
            }
            sides.extend([([a, b], c), ([b, c], a), ([c, a], b)]);
        }
        sides.sort_unstable();
        if let Some(pair) = sides.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return Err(InvalidSectionMesh::EdgeTwice { edge: pair[0].0 });
        }
        let find = |edge: [u32; 2]| {
            let at = sides.binary_search_by_key(&edge, |side| side.0).ok()?;
            Some(sides[at].1)
        };
        // Vertex after each vertex on its loop.
        let mut after = vec![u32::MAX; count];
        for corners in section.loops {
            for (i, &a) in corners.iter().enumerate() {
                let b = corners[(i + 1) % corners.len()];
                after[a as usize] = b;
                if find([a, b]).is_none() || find([b, a]).is_some() {
                    return Err(InvalidSectionMesh::Boundary { edge: [a, b] });
                }
            }
        }
        for &([a, b], _) in &sides {
            if after[a as usize] != b && find([b, a]).is_none() {
                return Err(InvalidSectionMesh::Open { edge: [a, b] });
            }
        }
        self.check_fans(section, &sides, &after, find)?;
        self.check_means(section, tolerance)
    }

    fn check_fans(
        &self,
        section: &Section<'_>,
        sides: &[([u32; 2], u32)],
        after: &[u32],
        find: impl Fn([u32; 2]) -> Option<u32>,
    ) -> Result<(), InvalidSectionMesh> {
        let mut degree = vec![0usize; after.len()];
        let mut some = vec![u32::MAX; after.len()];
        for &([a, b], _) in sides {
            degree[a as usize] += 1;
            some[a as usize] = b;
        }
        for (vertex, &n) in (0u32..).zip(&degree) {
            let on_loop = after[vertex as usize] != u32::MAX;
            let inner = vertex as usize >= section.points.len();
            if n == 0 && !on_loop && !inner {
                continue;
            }
            // One turn around the vertex, from a boundary edge if there is one, must visit all
            // of its edges.
            let first = if on_loop {
                after[vertex as usize]
            } else {
                some[vertex as usize]
            };
            let (mut at, mut seen) = (first, 0);
            while let Some(left) = find([vertex, at]) {
                seen += 1;
                at = left;
                if at == first || seen > n {
                    break;
                }
            }
            if seen != n || n == 0 {
                return Err(InvalidSectionMesh::Fans {
                    vertex,
                    fans: if n == 0 { 0 } else { 2 },
                });
            }
        }
        Ok(())
    }

    fn check_means(&self, section: &Section<'_>, tolerance: f64) -> Result<(), InvalidSectionMesh> {
        for (index, inner) in self.steiner_points.iter().enumerate() {
            let mut error: f64 = 0.0;
            for k in 0..2 {
                let mean: f64 = (0..3)
                    .map(|i| inner.weights[i] * section.points[inner.parents[i] as usize][k])
                    .sum();
                error = error.max((mean - inner.position[k]).abs());
            }
            let sum: f64 = inner.weights.iter().sum();
            let weighed = (sum - 1.0).abs() < 1e-12 && inner.weights.iter().all(|&w| w >= 0.0);
            if !weighed || !error.is_finite() || error > tolerance {
                return Err(InvalidSectionMesh::Mean { index, error });
            }
        }
        Ok(())
    }
}
