//! [`Search`]: the triangles near a blade, by a BVH or by scans of the surface.

use incise_mesh::geometry::to_f32;
use incise_mesh::{Aabb, BoxScan, Bvh, Surface, TriangleId, Vec3};

/// Finds triangles of a surface by its BVH, or by scans where no BVH fits. The same ones.
pub(crate) struct Search<'a> {
    bvh: Option<&'a Bvh>,
    scan: &'a mut BoxScan,
}

impl<'a> Search<'a> {
    /// Makes a search that uses a BVH if that fits the surface.
    pub(crate) fn new(bvh: &'a Bvh, scan: &'a mut BoxScan, is_fitted: bool) -> Self {
        Self {
            bvh: is_fitted.then_some(bvh),
            scan,
        }
    }

    /// Returns the triangles whose bounding boxes touch a box, ascending.
    pub(crate) fn in_box(&mut self, surface: &Surface, bounds: &Aabb) -> Vec<TriangleId> {
        let mut found = Vec::new();
        if let Some(bvh) = self.bvh {
            bvh.traverse(surface, |b| b.overlaps(bounds), &mut found);
            found.sort_unstable();
        } else {
            self.scan.query(surface, bounds, &mut found);
        }
        found
    }

    /// Returns the triangles whose bounding boxes a polyline may touch, ascending.
    pub(crate) fn along(&mut self, surface: &Surface, line: &[Vec3]) -> Vec<TriangleId> {
        let is_near =
            |bounds: &Aabb| (line.windows(2)).any(|ends| touches(bounds, ends[0], ends[1]));
        let mut found = Vec::new();
        if let Some(bvh) = self.bvh {
            bvh.traverse(surface, is_near, &mut found);
            found.sort_unstable();
        } else {
            self.scan.query_hull(surface, line, &mut found);
            let bounds = |t| Aabb::around(surface.triangle_positions(t).map(to_f32));
            found.retain(|&t| is_near(&bounds(t)));
        }
        found
    }
}

/// Returns whether the line from `p` to `q` may touch a box, up to rounding.
///
/// A box that contains another one is touched if that is, because rounding keeps the order.
pub(crate) fn touches(bounds: &Aabb, p: Vec3, q: Vec3) -> bool {
    let (mut first, mut last) = (0.0, 1.0);
    for k in 0..3 {
        let [low, high] = [bounds.min[k], bounds.max[k]].map(f64::from);
        let along = q[k] - p[k];
        if along == 0.0 {
            if p[k] < low || p[k] > high {
                return false;
            }
            continue;
        }
        let [s, t] = [low, high].map(|bound| (bound - p[k]) / along);
        first = s.min(t).max(first);
        last = s.max(t).min(last);
    }
    first <= last
}
