//! Inner vertices to better places.

use super::Filling;
use super::rim::unit;
use incise_mesh::Vec3;

/// Moves inner vertices to the mean of their neighbors, one after the other, each only if that makes the
/// worst triangle around it better, so that nothing folds. Rest positions move alike.
pub(super) fn smooth(filling: &mut Filling) {
    let around = Around::new(filling);
    for i in 0..filling.inner.len() {
        let v = filling.rim + i;
        let ring = around.sides(i);
        let side = unit(ring.iter().map(|&edge| area(filling, v, edge)).sum());
        let worst = |filling: &Filling| {
            let quality = ring.iter().map(|&edge| {
                let area = area(filling, v, edge).dot(&side);
                let [a, b] = edge.map(|w| filling.points[w as usize]);
                let p = filling.points[v];
                area / ((a - p).norm_squared() + (b - p).norm_squared() + (b - a).norm_squared())
            });
            quality.fold(f64::INFINITY, f64::min)
        };
        let before = (worst(filling), filling.points[v], filling.rest[v]);
        // Every neighbor is the start of one edge around.
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 edges")]
        let share = 1.0 / ring.len().max(1) as f64;
        for points in [&mut filling.points, &mut filling.rest] {
            points[v] = ring
                .iter()
                .map(|edge| points[edge[0] as usize])
                .sum::<Vec3>()
                * share;
        }
        let is_better = worst(filling) > before.0;
        if !is_better {
            (filling.points[v], filling.rest[v]) = (before.1, before.2);
        }
    }
}

fn area(filling: &Filling, v: usize, edge: [u32; 2]) -> Vec3 {
    let [a, b] = edge.map(|w| filling.points[w as usize] - filling.points[v]);
    a.cross(&b)
}

/// The edges across each inner vertex, in the direction of their triangles.
struct Around {
    starts: Vec<usize>,
    edges: Vec<[u32; 2]>,
}

impl Around {
    fn new(filling: &Filling) -> Self {
        let corners = || {
            let triangles = filling.triangles.iter();
            let corners = triangles.flat_map(|&[a, b, c]| [(a, [b, c]), (b, [c, a]), (c, [a, b])]);
            corners.filter_map(|(v, edge)| Some(((v as usize).checked_sub(filling.rim)?, edge)))
        };
        let mut starts = vec![0; filling.inner.len() + 1];
        corners().for_each(|(i, _)| starts[i + 1] += 1);
        for i in 0..filling.inner.len() {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut edges = vec![[0; 2]; starts[filling.inner.len()]];
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
