//! Cotangent weights of the edges at every inner point of a cover.

use crate::cover::Cover;

/// Weights below this count as this: where triangles are not Delaunay they may be negative, and every
/// point must have a say.
const LEAST: f32 = 1e-6;

/// And none counts for more: a triangle without area gives weights without bound.
const MOST: f32 = 1e6;

/// By inner point, its neighbors and the weights of the edges to them.
#[derive(Debug, Clone, Default)]
pub(super) struct Rows {
    starts: Vec<u32>,
    ends: Vec<u32>,
    entries: Vec<(u32, f32)>,
}

impl Rows {
    /// Reads the triangles of a cover of `n` points. A weight is the sum of the cotangents of the two angles
    /// across the edge.
    pub(super) fn read(&mut self, cover: &Cover, n: usize, place: impl Fn(u32) -> [f64; 2]) {
        // An inner point has as many neighbors as triangles.
        self.ends.clear();
        self.ends.resize(cover.inner.len(), 0);
        for &v in cover.triangles.iter().flatten() {
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
        for &[a, b, c] in &cover.triangles {
            let [p, q, r] = [a, b, c].map(&place);
            let area = minus(q, p);
            let area = (area[0] * (r[1] - p[1]) - area[1] * (r[0] - p[0])).abs();
            let cotangent = |at: [f64; 2], from: [f64; 2], to: [f64; 2]| {
                let (u, v) = (minus(from, at), minus(to, at));
                // No number where a triangle is a point: that counts for least.
                (u[0] * v[0] + u[1] * v[1]) / area
            };
            let [at_a, at_b, at_c] =
                [cotangent(p, q, r), cotangent(q, r, p), cotangent(r, p, q)].map(store);
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
            let is_enough = *weight > LEAST;
            *weight = if is_enough { weight.min(MOST) } else { LEAST };
        }
    }

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

    /// The neighbors of an inner point, and their weights.
    pub(super) fn of(&self, i: usize) -> &[(u32, f32)] {
        &self.entries[self.starts[i] as usize..self.ends[i] as usize]
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "this is the one rounding of a weight; one that is too large for it is cut off"
)]
fn store(weight: f64) -> f32 {
    weight as f32
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}
