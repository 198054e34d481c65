//! Divides vertices into compact parts by recursive bisection along the longest axis.

use incise_mesh::VertexId;

/// Divides vertices into parts of nearly equal size, at max `max` each, and passes them to `part`.
///
/// Ids within a part are ascending, and consecutive parts are adjacent. `position` returns the
/// position of a vertex; ids break ties.
pub(crate) fn divide(
    vertices: &mut [VertexId],
    max: usize,
    position: &impl Fn(VertexId) -> [f32; 3],
    part: &mut impl FnMut(&[VertexId]),
) {
    if vertices.len() <= max {
        vertices.sort_unstable();
        part(vertices);
        return;
    }
    let axis = longest_axis(vertices, position);
    let parts = vertices.len().div_ceil(max);
    let middle = vertices.len() * (parts / 2) / parts;
    vertices.select_nth_unstable_by(middle, |&v, &w| {
        position(v)[axis]
            .total_cmp(&position(w)[axis])
            .then(v.cmp(&w))
    });
    let (low, high) = vertices.split_at_mut(middle);
    divide(low, max, position, part);
    divide(high, max, position, part);
}

fn longest_axis(vertices: &[VertexId], position: &impl Fn(VertexId) -> [f32; 3]) -> usize {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for &v in vertices {
        for (k, c) in position(v).into_iter().enumerate() {
            low[k] = low[k].min(c);
            high[k] = high[k].max(c);
        }
    }
    let extent = |k: usize| high[k] - low[k];
    let longer = |a: usize, b: usize| if extent(b) > extent(a) { b } else { a };
    [1, 2].into_iter().fold(0, longer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise_mesh::VertexId;

    #[test]
    fn parts_of_a_grid_are_full_boxes() {
        // A grid of 40 x 20 points.
        let position = |v: VertexId| [(v.0 % 40) as f32, (v.0 / 40) as f32, 0.0];
        let mut vertices: Vec<VertexId> = (0..800).map(VertexId).collect();
        let mut parts = Vec::new();
        divide(&mut vertices, 100, &position, &mut |part| {
            parts.push(part.to_vec())
        });
        assert_eq!(parts.len(), 8);
        for part in &parts {
            let places: Vec<[f32; 3]> = part.iter().map(|&v| position(v)).collect();
            let side = |k: usize| {
                let along = || places.iter().map(|p| p[k]);
                along().fold(0.0, f32::max) - along().fold(f32::INFINITY, f32::min) + 1.0
            };
            assert_eq!((part.len(), side(0) * side(1)), (100, 100.0), "{part:?}");
        }
        let mut all = parts.concat();
        all.sort_unstable();
        assert!(
            all.into_iter().eq((0..800).map(VertexId)),
            "each vertex once"
        );
    }

    #[test]
    fn coincident_vertices_are_divided() {
        let mut vertices: Vec<VertexId> = (0..1000).rev().map(VertexId).collect();
        let mut sizes = Vec::new();
        divide(&mut vertices, 64, &|_| [1.0; 3], &mut |part| {
            sizes.push(part.len())
        });
        assert_eq!(sizes.iter().sum::<usize>(), 1000);
        assert_eq!(sizes.len(), 16);
        assert!(sizes.iter().all(|&size| size <= 64), "{sizes:?}");
    }
}
