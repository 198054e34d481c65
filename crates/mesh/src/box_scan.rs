//! [`BoxScan`]: the triangles near a box, without a BVH.

use crate::{Aabb, Surface, TriangleId};

/// Finds the triangles near a box by one pass over all vertices.
///
/// For one query of a surface that has moved, it costs less than
/// [`Bvh::refit`](crate::Bvh::refit). Kept between queries for its memory.
#[derive(Debug, Clone, Default)]
pub struct BoxScan {
    /// By vertex slot, a bit for each plane of the box beyond which the vertex lies.
    outcodes: Vec<u8>,
}

impl BoxScan {
    /// Appends the triangles whose bounding boxes touch a box, ascending. O(n).
    ///
    /// They are not beyond one plane of the box as a whole (Cohen and Sutherland's outcodes). A
    /// coordinate that is NaN counts as inside.
    pub fn query(&mut self, surface: &Surface, bounds: &Aabb, out: &mut Vec<TriangleId>) {
        let Aabb { min, max } = *bounds;
        let outcode = |p: &[f32; 4]| {
            (0..3).fold(0, |code, k| {
                code | u8::from(p[k] < min[k]) << k | u8::from(p[k] > max[k]) << (k + 3)
            })
        };
        self.outcodes.clear();
        self.outcodes
            .extend(surface.positions().iter().map(outcode));
        let topology = surface.topology();
        out.extend(topology.triangles().filter(|&t| {
            let [a, b, c] = topology.triangle(t).map(|v| self.outcodes[v.index()]);
            a & b & c == 0
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bvh, cube_sphere};

    #[test]
    fn a_scan_finds_all_triangles_whose_boxes_touch() {
        let surface = cube_sphere(8, 1.0);
        let bvh = Bvh::build(&surface);
        let mut scan = BoxScan::default();
        for (min, max) in [
            ([0.1; 3], [0.9; 3]),
            ([-2.0; 3], [2.0; 3]),
            ([0.0, -2.0, -2.0], [0.01, 2.0, 2.0]),
            ([5.0; 3], [6.0; 3]),
        ] {
            let bounds = Aabb { min, max };
            let (mut found, mut touching) = (Vec::new(), Vec::new());
            scan.query(&surface, &bounds, &mut found);
            bvh.traverse(&surface, |b| b.overlaps(&bounds), &mut touching);
            touching.sort_unstable();
            // A triangle is found if and only if its own box touches.
            assert_eq!(found, touching, "{bounds:?}");
        }
    }

    #[test]
    fn a_vertex_that_is_not_finite_is_found() {
        let mut surface = cube_sphere(2, 1.0);
        surface.positions_mut()[0][1] = f32::NAN;
        let mut found = Vec::new();
        let bounds = Aabb {
            min: [-9.0; 3],
            max: [9.0; 3],
        };
        BoxScan::default().query(&surface, &bounds, &mut found);
        assert_eq!(found.len(), surface.topology().triangle_count());
    }
}
