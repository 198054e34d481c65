//! Whether a cover is one: what every cover must fulfill, whatever the section.

use super::{Cover, Section};

/// What is wrong with a cover.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CoverFault {
    /// A triangle has a corner that does not exist, or one twice.
    #[error("triangle {triangle} has the corners {corners:?}")]
    Triangle {
        /// Its index.
        triangle: usize,
        /// Its corners.
        corners: [u32; 3],
    },
    /// Two triangles run along an edge in the same direction.
    #[error("the edge {0} -> {1} is the side of two triangles", edge[0], edge[1])]
    EdgeTwice {
        /// Its ends.
        edge: [u32; 2],
    },
    /// An edge of a loop has no triangle on its left, or one on its right.
    #[error("the loop's edge {0} -> {1} is not on the boundary", edge[0], edge[1])]
    Boundary {
        /// Its ends.
        edge: [u32; 2],
    },
    /// An edge with one triangle that is on no loop.
    #[error("the edge {0} -> {1} has one triangle and is on no loop", edge[0], edge[1])]
    Open {
        /// Its ends.
        edge: [u32; 2],
    },
    /// The triangles around a vertex form more than one fan, or none.
    #[error("the triangles around vertex {vertex} form {fans} fans")]
    Fans {
        /// The vertex.
        vertex: u32,
        /// How many fans.
        fans: usize,
    },
    /// An inner point that is not the mean it says it is.
    #[error("inner point {index} is off its parents' mean by {error}, or a weight is wrong")]
    Mean {
        /// Its index.
        index: usize,
        /// How far \[m\].
        error: f64,
    },
}

impl Cover {
    /// Checks that the triangles form a manifold whose boundary is exactly the section's loops,
    /// with one fan around every vertex, and that every inner point is its parents' weighted mean
    /// within `tolerance` \[m\].
    ///
    /// # Errors
    /// The first [`CoverFault`] found.
    pub fn validate(&self, section: &Section<'_>, tolerance: f64) -> Result<(), CoverFault> {
        let count = section.points.len() + self.inner.len();
        let mut sides: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * self.triangles.len());
        for (triangle, &corners) in self.triangles.iter().enumerate() {
            let [a, b, c] = corners;
            if a == b || b == c || c == a || corners.iter().any(|&v| v as usize >= count) {
                return Err(CoverFault::Triangle { triangle, corners });
            }
            sides.extend([([a, b], c), ([b, c], a), ([c, a], b)]);
        }
        sides.sort_unstable();
        if let Some(pair) = sides.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return Err(CoverFault::EdgeTwice { edge: pair[0].0 });
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
                    return Err(CoverFault::Boundary { edge: [a, b] });
                }
            }
        }
        for &([a, b], _) in &sides {
            if after[a as usize] != b && find([b, a]).is_none() {
                return Err(CoverFault::Open { edge: [a, b] });
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
    ) -> Result<(), CoverFault> {
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
            // From the loop's edge, or any, around to the left; one turn must see every side.
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
                return Err(CoverFault::Fans {
                    vertex,
                    fans: if n == 0 { 0 } else { 2 },
                });
            }
        }
        Ok(())
    }

    fn check_means(&self, section: &Section<'_>, tolerance: f64) -> Result<(), CoverFault> {
        for (index, inner) in self.inner.iter().enumerate() {
            let mut error: f64 = 0.0;
            for k in 0..2 {
                let mean: f64 = (0..3)
                    .map(|i| inner.weights[i] * section.points[inner.parents[i] as usize][k])
                    .sum();
                error = error.max((mean - inner.at[k]).abs());
            }
            let sum: f64 = inner.weights.iter().sum();
            let weighed = (sum - 1.0).abs() < 1e-12 && inner.weights.iter().all(|&w| w >= 0.0);
            if !weighed || !error.is_finite() || error > tolerance {
                return Err(CoverFault::Mean { index, error });
            }
        }
        Ok(())
    }
}
