//! The runs that no other run beats.

/// A point of a plane of time \[ms\] and error.
pub(crate) type Point = [f64; 2];

/// The points that no other one is both faster and nearer than, from fast to slow.
pub(crate) fn front(points: impl Iterator<Item = Point>) -> Vec<Point> {
    let mut points: Vec<Point> = points.filter(|p| p.iter().all(|x| x.is_finite())).collect();
    points.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut best = f64::INFINITY;
    points.retain(|p| {
        let is_better = p[1] < best;
        best = best.min(p[1]);
        is_better
    });
    points
}
