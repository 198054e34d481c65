//! Overlaps of triangles and edges with boxes.

use incise_mesh::Vec3;

/// Returns whether a triangle meets a box, given by its center and half of its edges.
///
/// By separating axes (Akenine-Möller, "Fast 3D Triangle-Box Overlap Testing", 2001).
pub(crate) fn triangle_meets_box(corners: &[Vec3; 3], center: Vec3, half: Vec3) -> bool {
    let [a, b, c] = corners.map(|p| p - center);
    let low = a.inf(&b).inf(&c);
    let high = a.sup(&b).sup(&c);
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

/// Returns the part of a triangle in a box, a convex polygon.
///
/// By clipping at one face after the other (Sutherland and Hodgman 1974).
pub(crate) fn clip(corners: &[Vec3; 3], low: Vec3, high: Vec3) -> Vec<Vec3> {
    let mut polygon = corners.to_vec();
    for k in 0..3 {
        for (sign, limit) in [(1.0, high[k]), (-1.0, -low[k])] {
            let excess = |p: &Vec3| sign * p[k] - limit;
            let mut kept = Vec::with_capacity(polygon.len() + 1);
            for (i, p) in polygon.iter().enumerate() {
                let q = &polygon[(i + 1) % polygon.len()];
                let (from, to) = (excess(p), excess(q));
                if from <= 0.0 {
                    kept.push(*p);
                }
                if (from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0) {
                    kept.push(p + (q - p) * (from / (from - to)));
                }
            }
            polygon = kept;
        }
    }
    polygon
}
