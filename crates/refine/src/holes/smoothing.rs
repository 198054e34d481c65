//! Smart Laplacian smoothing of a patch's new vertices.

use super::HolePatch;
use super::rim::unit;
use incise_mesh::Vec3;

/// Moves each new vertex to the mean of its neighbors if that improves its worst triangle.
///
/// The condition prevents fold-overs. Rest positions move in the same way.
pub(super) fn smooth(patch: &mut HolePatch) {
    let around = Around::new(patch);
    for i in 0..patch.inner.len() {
        let v = patch.rim + i;
        let ring = around.sides(i);
        let side = unit(ring.iter().map(|&edge| area(patch, v, edge)).sum());
        let worst = |patch: &HolePatch| {
            let quality = ring.iter().map(|&edge| {
                let area = area(patch, v, edge).dot(&side);
                let [a, b] = edge.map(|w| patch.points[w as usize]);
                let p = patch.points[v];
                area / ((a - p).norm_squared() + (b - p).norm_squared() + (b - a).norm_squared())
            });
            quality.fold(f64::INFINITY, f64::min)
        };
        let before = (worst(patch), patch.points[v], patch.rest[v]);
        // Every neighbor is the start of one opposite edge.
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 edges")]
        let share = 1.0 / ring.len().max(1) as f64;
        for points in [&mut patch.points, &mut patch.rest] {
            points[v] = ring
                .iter()
                .map(|edge| points[edge[0] as usize])
                .sum::<Vec3>()
                * share;
        }
        let is_better = worst(patch) > before.0;
        if !is_better {
            (patch.points[v], patch.rest[v]) = (before.1, before.2);
        }
    }
}

fn area(patch: &HolePatch, v: usize, edge: [u32; 2]) -> Vec3 {
    let [a, b] = edge.map(|w| patch.points[w as usize] - patch.points[v]);
    a.cross(&b)
}

/// The edges opposite to each new vertex, in the direction of their triangles.
struct Around {
    starts: Vec<usize>,
    edges: Vec<[u32; 2]>,
}

impl Around {
    fn new(patch: &HolePatch) -> Self {
        let corners = || {
            let triangles = patch.triangles.iter();
            let corners = triangles.flat_map(|&[a, b, c]| [(a, [b, c]), (b, [c, a]), (c, [a, b])]);
            corners.filter_map(|(v, edge)| Some(((v as usize).checked_sub(patch.rim)?, edge)))
        };
        let mut starts = vec![0; patch.inner.len() + 1];
        corners().for_each(|(i, _)| starts[i + 1] += 1);
        for i in 0..patch.inner.len() {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut edges = vec![[0; 2]; starts[patch.inner.len()]];
        for (i, edge) in corners() {
            edges[next[i]] = edge;
            next[i] += 1;
        }
        Self { starts, edges }
    }

    fn sides(&self, i: usize) -> &[[u32; 2]] {
        &self.edges[self.starts[i]..self.starts[i + 1]]
    }
}
