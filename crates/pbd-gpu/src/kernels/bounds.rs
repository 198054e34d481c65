//! Bounding box of a body, as the GPU computes it.

/// Returns the minimum and maximum corner of the vertices in use \[m\].
///
/// Without vertices it returns infinity and negative infinity. NaN coordinates are ignored. GPU
/// vertex slots without triangles have a negative inverse mass.
pub(crate) fn bounds(x: &[[f32; 4]]) -> [[f32; 3]; 2] {
    let mut min = [f32::INFINITY; 3];
    let mut max = [f32::NEG_INFINITY; 3];
    for x in x.iter().filter(|x| x[3] >= 0.0) {
        for k in 0..3 {
            min[k] = if x[k] < min[k] { x[k] } else { min[k] };
            max[k] = if x[k] > max[k] { x[k] } else { max[k] };
        }
    }
    [min, max]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_without_a_vertex_do_not_count() {
        let pinned = [1.0, -2.0, 3.0, 0.0];
        let free = [-1.0, 5.0, f32::NAN, 2.0];
        let unused = [9.0, -9.0, 9.0, -1.0];
        let found = bounds(&[pinned, free, unused]);
        assert_eq!(found, [[-1.0, -2.0, 3.0], [1.0, 5.0, 3.0]]);
        let none = bounds(&[unused]);
        assert_eq!(none, [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]]);
    }
}
