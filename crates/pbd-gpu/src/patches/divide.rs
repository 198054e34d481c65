//! Vertices divided by place: the longest side of their box is halved until the parts are small.

use incise_mesh::VertexId;

/// Divides vertices into parts of nearly equal size, at most `most` each, and hands every part over
/// with its ids ascending. Parts that come after one another lie next to one another. `at` is a
/// vertex's place; equal places are told apart by id.
pub(crate) fn divide(
    vertices: &mut [VertexId],
    most: usize,
    at: &impl Fn(VertexId) -> [f32; 3],
    part: &mut impl FnMut(&[VertexId]),
) {
    if vertices.len() <= most {
        vertices.sort_unstable();
        part(vertices);
        return;
    }
    let axis = longest_axis(vertices, at);
    let parts = vertices.len().div_ceil(most);
    let middle = vertices.len() * (parts / 2) / parts;
    vertices.select_nth_unstable_by(middle, |&v, &w| {
        at(v)[axis].total_cmp(&at(w)[axis]).then(v.cmp(&w))
    });
    let (low, high) = vertices.split_at_mut(middle);
    divide(low, most, at, part);
    divide(high, most, at, part);
}

fn longest_axis(vertices: &[VertexId], at: &impl Fn(VertexId) -> [f32; 3]) -> usize {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for &v in vertices {
        for (k, c) in at(v).into_iter().enumerate() {
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
    fn parts_are_full_and_boxes() {
        // A board of 40 x 20 places.
        let at = |v: VertexId| [(v.0 % 40) as f32, (v.0 / 40) as f32, 0.0];
        let mut vertices: Vec<VertexId> = (0..800).map(VertexId).collect();
        let mut parts = Vec::new();
        divide(&mut vertices, 100, &at, &mut |part| {
            parts.push(part.to_vec())
        });
        assert_eq!(parts.len(), 8);
        for part in &parts {
            let places: Vec<[f32; 3]> = part.iter().map(|&v| at(v)).collect();
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
    fn coincident_vertices_are_divided_all_the_same() {
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
