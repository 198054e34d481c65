//! Cotangent weights of the edges at the Steiner points of a section mesh.

use crate::section_mesh::SectionMesh;
use incise_mesh::geometry::round_to_f32;

/// Lower bound of weights, which are negative at edges that are not Delaunay.
const MIN_WEIGHT: f32 = 1e-6;

/// Upper bound of weights, which are unbounded in triangles without area.
const MAX_WEIGHT: f32 = 1e6;

/// The neighbors of each Steiner point and the weights of the edges to them.
#[derive(Debug, Clone, Default)]
pub(super) struct CotangentWeights {
    starts: Vec<u32>,
    ends: Vec<u32>,
    entries: Vec<(u32, f32)>,
}

impl CotangentWeights {
    /// Computes the weights of a mesh of a section with `n` points.
    ///
    /// A weight is the sum of the cotangents of the two angles opposite to the edge.
    pub(super) fn read(&mut self, mesh: &SectionMesh, n: usize, place: impl Fn(u32) -> [f64; 2]) {
        // A Steiner point has as many neighbors as triangles.
        self.ends.clear();
        self.ends.resize(mesh.steiner_points.len(), 0);
        for &v in mesh.triangles.iter().flatten() {
            if let Some(i) = (v as usize).checked_sub(n) {
                self.ends[i] += 1;
            }
        }
        self.starts.clear();
        let mut total = 0;
        for end in &mut self.ends {
            self.starts.push(total);
            total += std::mem::replace(end, total);
        }
        self.entries.clear();
        self.entries.resize(total as usize, (0, 0.0));
        for &[a, b, c] in &mesh.triangles {
            let [p, q, r] = [a, b, c].map(&place);
            let area = minus(q, p);
            let area = (area[0] * (r[1] - p[1]) - area[1] * (r[0] - p[0])).abs();
            let cotangent = |at: [f64; 2], from: [f64; 2], to: [f64; 2]| {
                let (u, v) = (minus(from, at), minus(to, at));
                // NaN where a triangle is a point; the bounds below replace it by the least weight.
                (u[0] * v[0] + u[1] * v[1]) / area
            };
            let [at_a, at_b, at_c] =
                [cotangent(p, q, r), cotangent(q, r, p), cotangent(r, p, q)].map(round_to_f32);
            for (v, [(next, weight), (before, other)]) in [
                (a, [(b, at_c), (c, at_b)]),
                (b, [(c, at_a), (a, at_c)]),
                (c, [(a, at_b), (b, at_a)]),
            ] {
                if let Some(i) = (v as usize).checked_sub(n) {
                    self.add(i, next, weight);
                    self.add(i, before, other);
                }
            }
        }
        for (_, weight) in &mut self.entries {
            let is_enough = *weight > MIN_WEIGHT;
            *weight = if is_enough {
                weight.min(MAX_WEIGHT)
            } else {
                MIN_WEIGHT
            };
        }
    }

    /// Adds a weight to the edge from Steiner point `i` to `v`.
    fn add(&mut self, i: usize, v: u32, weight: f32) {
        let (start, end) = (self.starts[i] as usize, self.ends[i] as usize);
        let known = self.entries[start..end].iter_mut().find(|e| e.0 == v);
        if let Some(entry) = known {
            entry.1 += weight;
        } else {
            self.entries[end] = (v, weight);
            self.ends[i] += 1;
        }
    }

    /// Returns the neighbors of a Steiner point and the weights of the edges to them.
    pub(super) fn of(&self, i: usize) -> &[(u32, f32)] {
        &self.entries[self.starts[i] as usize..self.ends[i] as usize]
    }
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}
