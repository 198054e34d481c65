//! [`BoxScan`]: the triangles near a box or a few points, without a BVH.

use crate::bvh::{Slab, triangle_bounds};
use crate::geometry::to_f32;
use crate::{Aabb, Surface, TriangleId, Vec3, VertexId};
use smallvec::SmallVec;

/// Rounding error of a coordinate along a unit vector [sum of the unsigned coordinates].
///
/// Products and sums round by at most three halves of [`f32::EPSILON`] together. The other half
/// is for the rounding of this bound and of the sums with it.
const ROUNDING: f32 = 2.0 * f32::EPSILON;

/// Finds the triangles near something by one pass over all vertices.
///
/// For a few queries of a surface that has moved, it costs less than
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
        self.scan(surface, outcode, out);
    }

    /// Appends the triangles that may touch the convex hull of some points, ascending. O(n).
    ///
    /// Conservative: no triangle that touches the hull is missing. A coordinate that is NaN counts
    /// as inside.
    pub fn query_hull(&mut self, surface: &Surface, points: &[Vec3], out: &mut Vec<TriangleId>) {
        let Some(hull) = OrientedBox::around(points) else {
            return;
        };
        self.scan(surface, |p| hull.outcode(p), out);
    }

    /// Removes the triangles that [`Self::query_hull`] does not find.
    pub fn retain_hull(surface: &Surface, points: &[Vec3], triangles: &mut Vec<TriangleId>) {
        let Some(hull) = OrientedBox::around(points) else {
            triangles.clear();
            return;
        };
        let outcode = |v: VertexId| hull.outcode(&surface.positions()[v.index()]);
        triangles.retain(|&t| {
            let [a, b, c] = surface.topology().triangle(t).map(outcode);
            a & b & c == 0
        });
    }

    /// Appends the triangles that both [`Bvh::query`](crate::Bvh::query) and [`Self::query_hull`]
    /// of all corners find, ascending. O(n).
    pub fn query_triangles(
        &mut self,
        surface: &Surface,
        triangles: impl IntoIterator<Item = [Vec3; 3]>,
        out: &mut Vec<TriangleId>,
    ) {
        let triangles: SmallVec<[[Vec3; 3]; 2]> = triangles.into_iter().collect();
        let first = out.len();
        self.query_hull(surface, triangles.as_flattened(), out);
        let slabs: SmallVec<[Slab; 2]> = triangles.into_iter().map(Slab::new).collect();
        let mut kept = first;
        for i in first..out.len() {
            let bounds = triangle_bounds(surface, surface.topology().triangle(out[i]));
            if slabs.iter().any(|slab| slab.may_touch(&bounds)) {
                out[kept] = out[i];
                kept += 1;
            }
        }
        out.truncate(kept);
    }

    /// Appends the triangles whose vertices have no bit in common.
    fn scan(
        &mut self,
        surface: &Surface,
        outcode: impl Fn(&[f32; 4]) -> u8,
        out: &mut Vec<TriangleId>,
    ) {
        self.outcodes.clear();
        self.outcodes
            .extend(surface.positions().iter().map(outcode));
        for (i, corners) in surface.topology().all_corners().iter().enumerate() {
            let [a, b, c] = corners;
            // A free slot has no vertices.
            if let Some(a) = self.outcodes.get(a.index())
                && let Some(b) = self.outcodes.get(b.index())
                && let Some(c) = self.outcodes.get(c.index())
                && a & b & c == 0
            {
                out.push(TriangleId::from_index(i));
            }
        }
    }
}

/// A box along three directions, which need not be orthogonal.
///
/// In 32 bits, because rounding makes it larger by far less than a triangle.
#[derive(Debug, Clone, Copy)]
struct OrientedBox {
    axes: [[f32; 3]; 3],
    /// Extent along each axis, extended by the rounding error.
    min: [f32; 3],
    max: [f32; 3],
}

impl OrientedBox {
    /// Returns the box of some points, along their largest extents; none without points.
    fn around(points: &[Vec3]) -> Option<Self> {
        let &first = points.first()?;
        let farthest = |of: &dyn Fn(Vec3) -> Vec3| {
            let offsets = points.iter().map(|&p| of(p - first));
            let longest = offsets.max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
            longest.and_then(|offset| offset.try_normalize(0.0))
        };
        let along = farthest(&|offset| offset).unwrap_or(Vec3::x());
        let across = farthest(&|offset| offset - along * along.dot(&offset));
        // Without a second extent any direction off the first one will do.
        let across = across.unwrap_or_else(|| {
            let least = along.iamin();
            let axis = Vec3::from_fn(|k, _| f64::from(u8::from(k == least)));
            along.cross(&axis)
        });
        let mut all = Self {
            axes: [along, across, along.cross(&across)].map(to_f32),
            min: [f32::INFINITY; 3],
            max: [f32::NEG_INFINITY; 3],
        };
        for &p in points {
            let p = to_f32(p);
            // Its own rounding to 32 bits counts, too.
            let slack = 2.0 * rounding(p);
            for (k, place) in all.place(p).into_iter().enumerate() {
                all.min[k] = all.min[k].min(place - slack);
                all.max[k] = all.max[k].max(place + slack);
            }
        }
        Some(all)
    }

    /// Returns the coordinates of a point along the axes.
    #[inline]
    fn place(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        self.axes.map(|[a, b, c]| a * x + b * y + c * z)
    }

    /// Returns a bit for each plane beyond which a vertex certainly lies.
    #[inline]
    fn outcode(&self, &[x, y, z, _]: &[f32; 4]) -> u8 {
        let place = self.place([x, y, z]);
        let slack = rounding([x, y, z]);
        (0..3).fold(0, |code, k| {
            code | u8::from(place[k] + slack < self.min[k]) << k
                | u8::from(place[k] - slack > self.max[k]) << (k + 3)
        })
    }
}

/// Returns the rounding error of a point's coordinate along a unit vector \[m\].
#[inline]
fn rounding([x, y, z]: [f32; 3]) -> f32 {
    ROUNDING * (x.abs() + y.abs() + z.abs())
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

    /// Also without an extent: a segment and a point, in a plane of symmetry of the sphere.
    #[test]
    fn a_scan_finds_the_triangles_of_a_query_of_the_tree() {
        let surface = cube_sphere(8, 1.0);
        let bvh = Bvh::build(&surface);
        let mut scan = BoxScan::default();
        let corners = |of: fn(f64, f64) -> [f64; 3]| {
            let [a, b, c, d] = [[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]]
                .map(|[u, v]| Vec3::from(of(u, v)));
            [[a, b, c], [a, c, d]]
        };
        let queries = [
            corners(|u, v| [u, v, 0.0]),
            corners(|u, v| [u, 0.3 * u + 0.2 * v, v]),
            corners(|u, v| [0.1 * u + 0.6, 0.1 * u - 0.1 * v, 0.1 * v]),
            corners(|u, v| [1e7 * u, 1e7 * v, 0.1]),
            corners(|u, _| [u, u, u]),
            corners(|_, _| [0.0, 0.0, 1.0]),
        ];
        for query in queries {
            let (mut found, mut expected) = (Vec::new(), Vec::new());
            scan.query_triangles(&surface, query, &mut found);
            bvh.query(&surface, query, &mut expected);
            BoxScan::retain_hull(&surface, query.as_flattened(), &mut expected);
            expected.sort_unstable();
            assert_eq!(found, expected, "{query:?}");
            // Each vertex of the hull is a triangle's vertex or off the surface.
            for v in surface.topology().vertices() {
                let points = [surface.position(v), query[0][0]];
                let mut near = Vec::new();
                scan.query_hull(&surface, &points, &mut near);
                let mut around = surface.topology().outgoing_fan(v);
                assert!(
                    around.all(|h| near.binary_search(&h.triangle()).is_ok()),
                    "{v}"
                );
            }
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
