//! Overlaps of triangles and edges with boxes.

use incise_mesh::Vec3;

/// Returns whether a triangle meets a box, given by its center and half of its edges.
///
/// By separating axes (Akenine-Möller, "Fast 3D Triangle-Box Overlap Testing", 2001).
pub(crate) fn triangle_meets_box(corners: &[Vec3; 3], center: Vec3, half: Vec3) -> bool {
    let [a, b, c] = corners.map(|p| p - center);
    let [low, high] = bounds(&[a, b, c]);
    if (0..3).any(|k| low[k] > half[k] || high[k] < -half[k]) {
        return false;
    }
    let edges = [b - a, c - b, a - c];
    let normal = edges[0].cross(&edges[1]);
    let reach = half.dot(&normal.abs());
    // The plane has one distance from the center; three cover the rounding errors.
    let at = [normal.dot(&a), normal.dot(&b), normal.dot(&c)];
    if is_beyond(at, reach) {
        return false;
    }
    // Cross products of an edge with an axis of the box: components along the other two.
    edges.iter().all(|e| {
        (0..3).all(|k| {
            let [u, v] = [(k + 1) % 3, (k + 2) % 3];
            let along = |p: &Vec3| e[u] * p[v] - e[v] * p[u];
            let reach = half[u] * e[v].abs() + half[v] * e[u].abs();
            !is_beyond([along(&a), along(&b), along(&c)], reach)
        })
    })
}

/// Returns whether three coordinates along an axis are all beyond one end of a box.
fn is_beyond(at: [f64; 3], reach: f64) -> bool {
    let least = at[0].min(at[1]).min(at[2]);
    let most = at[0].max(at[1]).max(at[2]);
    least > reach || most < -reach
}

/// Returns the lowest and the highest coordinates of a triangle's corners.
pub(crate) fn bounds([a, b, c]: &[Vec3; 3]) -> [Vec3; 2] {
    // Plain comparisons: `f64::min` costs more, for NaN.
    let least = |x: f64, y: f64| if x < y { x } else { y };
    let most = |x: f64, y: f64| if x > y { x } else { y };
    [
        Vec3::from_fn(|k, _| least(least(a[k], b[k]), c[k])),
        Vec3::from_fn(|k, _| most(most(a[k], b[k]), c[k])),
    ]
}

/// Returns whether a point is in a box, given by two corners.
pub(crate) fn is_in_box(p: &Vec3, [low, high]: &[Vec3; 2]) -> bool {
    (0..3).all(|k| low[k] <= p[k] && p[k] <= high[k])
}

/// Returns whether an edge meets a box, given by two corners.
pub(crate) fn edge_meets_box([a, b]: [Vec3; 2], low: Vec3, high: Vec3) -> bool {
    let (mut first, mut last) = (0.0f64, 1.0f64);
    for k in 0..3 {
        let along = b[k] - a[k];
        if along == 0.0 {
            if a[k] < low[k] || a[k] > high[k] {
                return false;
            }
            continue;
        }
        let [u, v] = [low, high].map(|p| (p[k] - a[k]) / along);
        first = first.max(u.min(v));
        last = last.min(u.max(v));
    }
    first <= last
}

/// A convex polygon: a triangle, clipped at the six faces of a box.
#[derive(Debug)]
struct Polygon {
    corners: [Vec3; Self::MAX],
    len: usize,
}

impl Polygon {
    /// Maximum number of corners: each face cuts off at most one and adds two. Rounding may add
    /// some.
    const MAX: usize = 16;

    fn new(triangle: &[Vec3; 3]) -> Self {
        let mut polygon = Self::empty();
        for p in triangle {
            polygon.push(*p);
        }
        polygon
    }

    fn corners(&self) -> &[Vec3] {
        &self.corners[..self.len]
    }

    fn empty() -> Self {
        Self {
            corners: [Vec3::zeros(); Self::MAX],
            len: 0,
        }
    }

    fn push(&mut self, p: Vec3) {
        if let Some(corner) = self.corners.get_mut(self.len) {
            *corner = p;
            self.len += 1;
        }
    }
}

/// Calls `found` with the corners of the part of a triangle in a box.
pub(crate) fn clip_triangle(
    triangle: &[Vec3; 3],
    low: Vec3,
    high: Vec3,
    mut found: impl FnMut(&Vec3),
) {
    if triangle.iter().all(|p| is_in_box(p, &[low, high])) {
        triangle.iter().for_each(found);
        return;
    }
    let mut polygon = Polygon::new(triangle);
    clip(&mut polygon, low, high);
    polygon.corners().iter().for_each(&mut found);
}

/// Clips a polygon at the faces of a box (Sutherland and Hodgman 1974).
fn clip(polygon: &mut Polygon, low: Vec3, high: Vec3) {
    for k in 0..3 {
        for (sign, limit) in [(1.0, high[k]), (-1.0, -low[k])] {
            let excess = |p: &Vec3| sign * p[k] - limit;
            let corners = polygon.corners();
            if corners.iter().all(|p| excess(p) <= 0.0) {
                continue;
            }
            let mut kept = Polygon::empty();
            for (i, p) in corners.iter().enumerate() {
                let q = &corners[(i + 1) % corners.len()];
                let (from, to) = (excess(p), excess(q));
                if from <= 0.0 {
                    kept.push(*p);
                }
                if (from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0) {
                    kept.push(p + (q - p) * (from / (from - to)));
                }
            }
            *polygon = kept;
        }
    }
}
