//! What the runs that no other run beats say.

use super::row::Row;
use crate::front::{Point, front};

/// Errors that tables say the time to.
pub(super) const TARGETS: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];
/// Times that tables say the error at \[ms\].
pub(super) const BUDGETS: [f64; 4] = [1.0, 4.0, 8.0, 16.0];

/// The least time to an error \[ms\].
pub(super) fn time_to(front: &[Point], error: f64) -> Option<f64> {
    front.iter().find(|p| p[1] <= error).map(|p| p[0])
}

/// The least error in a time \[ms\].
pub(super) fn error_at(front: &[Point], budget: f64) -> Option<f64> {
    front.iter().rev().find(|p| p[0] <= budget).map(|p| p[1])
}

/// Time and total error of rows.
pub(super) fn totals<'a>(rows: impl Iterator<Item = &'a Row>) -> Vec<Point> {
    front(rows.filter_map(|row| Some([row.ms_per_frame, row.total()?])))
}

/// How many times nearer `ours` is than `theirs` in the same time, at the least of [`BUDGETS`]. None where one has no run
/// that is so fast.
pub(super) fn least_gain(ours: &[Point], theirs: &[Point]) -> Option<f64> {
    let gain = |ms: f64| Some(error_at(theirs, ms)? / error_at(ours, ms)?);
    BUDGETS.into_iter().filter_map(gain).reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_front_is_what_nothing_beats() {
        let points = [
            [1.0, 0.5],
            [2.0, 0.6],
            [3.0, 0.1],
            [3.0, 0.05],
            [4.0, 0.05],
            [0.5, f64::NAN],
        ];
        let front = front(points.into_iter());
        assert_eq!(front, [[1.0, 0.5], [3.0, 0.05]]);
        assert_eq!(time_to(&front, 0.1), Some(3.0));
        assert_eq!(time_to(&front, 0.01), None);
        assert_eq!(error_at(&front, 2.9), Some(0.5));
        assert_eq!(error_at(&front, 0.9), None);
        let other = [[2.0, 1.0], [5.0, 0.2]];
        assert_eq!(least_gain(&front, &other), Some(4.0), "20, 4, 4 and 4");
        assert_eq!(least_gain(&front, &[[20.0, 0.1]]), None);
    }
}
