//! The triangles that fill one hole, before they are stitched into the surface.

use super::rim::Rim;
use incise_mesh::{Surface, Vec3, index_u32};

/// The patch of a hole. Vertices `0..rim` are the rim's, in its order; the rest are new.
#[derive(Debug, Clone, Default)]
pub(super) struct HolePatch {
    /// Number of rim vertices.
    pub(super) rim: usize,
    /// Positions \[m\].
    pub(super) points: Vec<Vec3>,
    /// Rest positions \[m\].
    pub(super) rest: Vec<Vec3>,
    /// Parents and weights of the new vertices.
    pub(super) inner: Vec<NewVertex>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// A new vertex: the weighted mean of three vertices with smaller indices.
#[derive(Debug, Clone, Copy)]
pub(super) struct NewVertex {
    pub(super) parents: [u32; 3],
    pub(super) weights: [f64; 3],
}

impl HolePatch {
    /// Returns a patch with the vertices of a rim and no triangles.
    pub(super) fn new(surface: &Surface, rim: &Rim) -> Self {
        let vertices = rim.vertices.iter();
        Self {
            rim: rim.len(),
            points: vertices.clone().map(|&v| surface.position(v)).collect(),
            rest: vertices.map(|&v| surface.rest_position(v)).collect(),
            ..Self::default()
        }
    }

    /// Appends a vertex at the mean of its parents.
    pub(super) fn push(&mut self, inner: NewVertex) {
        for points in [&mut self.points, &mut self.rest] {
            let terms = inner.parents.iter().zip(inner.weights);
            let mean = terms.map(|(&p, weight)| points[p as usize] * weight).sum();
            points.push(mean);
        }
        self.inner.push(inner);
    }

    /// Fills a rim without a free diagonal by a fan around a new vertex.
    pub(super) fn fan(&mut self, rim: &[u32]) {
        let n = rim.len();
        let parents = [rim[0], rim[n / 3], rim[2 * n / 3]];
        let center = index_u32(self.points.len());
        self.push(NewVertex {
            parents,
            weights: [1.0 / 3.0; 3],
        });
        let fan = (0..n).map(|i| [rim[i], rim[(i + 1) % n], center]);
        self.triangles.extend(fan);
    }
}
