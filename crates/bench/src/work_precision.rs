//! Rows of `accuracy` and their work-precision Pareto fronts: time of a frame against error.

use crate::chart::{Level, Series};
use serde::{Deserialize, Serialize};

/// Time of a frame \[ms\] and error.
pub(crate) type Point = [f64; 2];

/// Errors whose shortest times are listed.
#[cfg(feature = "reference")]
pub(crate) const TARGETS: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];
/// Times whose smallest errors are listed \[ms\].
pub(crate) const BUDGETS: [f64; 4] = [1.0, 4.0, 8.0, 16.0];

/// A run of a scene with one scheme, number of substeps and of iterations: a row of JSON and CSV.
///
/// `solver_*` are errors to the converged implicit step of the same size, `total_*` to the limit of
/// small steps. Positions are root mean squares over vertices and frames, over the mean rest
/// length.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Row {
    pub(crate) scene: String,
    pub(crate) backend: String,
    pub(crate) scheme: String,
    pub(crate) substeps: u32,
    pub(crate) iterations: u32,
    /// Median time of a frame until the backend is done.
    pub(crate) ms_per_frame: f64,
    /// Median time to encode a frame; none on the CPU.
    pub(crate) ms_encode: Option<f64>,
    /// Median GPU time by timestamps; none on the CPU and on devices without timestamps.
    pub(crate) ms_device: Option<f64>,
    pub(crate) projections_per_frame: u64,
    pub(crate) solver_position: Option<f64>,
    pub(crate) solver_farthest: Option<f64>,
    pub(crate) solver_force: Option<f64>,
    pub(crate) solver_strain: Option<f64>,
    pub(crate) solver_largest_strain: Option<f64>,
    pub(crate) solver_volume: Option<f64>,
    pub(crate) solver_energy: Option<f64>,
    pub(crate) solver_sag: Option<f64>,
    pub(crate) total_position: Option<f64>,
    pub(crate) total_farthest: Option<f64>,
    pub(crate) total_force: Option<f64>,
    pub(crate) total_strain: Option<f64>,
    pub(crate) total_largest_strain: Option<f64>,
    pub(crate) total_volume: Option<f64>,
    pub(crate) total_energy: Option<f64>,
    pub(crate) total_sag: Option<f64>,
    /// Estimated error of the limit; total errors below ten times of it are uncertain.
    pub(crate) uncertainty: Option<f64>,
    /// Position error to the limit of a converged second-order step of the same size: no solver of
    /// such steps can have a smaller one but by chance.
    pub(crate) floor_position: Option<f64>,
    /// The error of the run, if it failed.
    pub(crate) refusal: Option<String>,
    pub(crate) device: String,
    pub(crate) machine: String,
    pub(crate) commit: String,
    pub(crate) version: String,
}

impl Row {
    /// Returns whether the scheme is one of the solver's own, not the paper's or an alternative.
    pub(crate) fn is_ours(&self) -> bool {
        self.scheme != "pbd" && self.scheme != "patches"
    }

    /// Returns whether the row is the paper's Algorithm 1: one substep, any iterations.
    pub(crate) fn is_paper(&self) -> bool {
        self.scheme == "pbd" && self.substeps == 1
    }
}

/// Returns the points that no other is both faster and more accurate than, by time.
pub(crate) fn pareto_front(points: impl Iterator<Item = Point>) -> Vec<Point> {
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

/// Returns the Pareto front of time and total position error.
pub(crate) fn totals<'a>(rows: impl Iterator<Item = &'a Row>) -> Vec<Point> {
    pareto_front(rows.filter_map(|row| Some([row.ms_per_frame, row.total_position?])))
}

/// Returns the shortest time to an error \[ms\].
#[cfg(any(test, feature = "reference"))]
pub(crate) fn time_to(front: &[Point], error: f64) -> Option<f64> {
    front.iter().find(|p| p[1] <= error).map(|p| p[0])
}

/// Returns the smallest error within a time \[ms\].
pub(crate) fn error_at(front: &[Point], budget: f64) -> Option<f64> {
    front.iter().rev().find(|p| p[0] <= budget).map(|p| p[1])
}

/// Returns the smallest ratio of `theirs` to our error over [`BUDGETS`].
///
/// None where one front has no run within any of these times.
pub(crate) fn least_gain(ours: &[Point], theirs: &[Point]) -> Option<f64> {
    let gain = |ms: f64| Some(error_at(theirs, ms)? / error_at(ours, ms)?);
    BUDGETS.into_iter().filter_map(gain).reduce(f64::min)
}

/// A scheme as plots name it.
type Scheme = (&'static str, fn(&Row) -> bool);

const SCHEMES: [Scheme; 8] = [
    ("XPBD", |row| row.scheme == "xpbd"),
    ("the paper's (PBD, one substep)", Row::is_paper),
    ("PBD", |row| row.scheme == "pbd" && !row.is_paper()),
    ("XPBD, diagonal scale 0.5", |row| row.scheme == "xpbd-half"),
    ("the same, second order", |row| {
        row.scheme == "xpbd-half-bdf2"
    }),
    ("global step", |row| row.scheme == "global"),
    ("global step, second order", |row| {
        row.scheme == "global-bdf2"
    }),
    ("rigid patches", |row| row.scheme == "patches"),
];

/// Returns the points of every scheme, with its Pareto front as a line.
///
/// Points of fronts are labeled by substeps and iterations if `is_labeled`.
pub(crate) fn series<'a>(
    rows: impl Iterator<Item = &'a Row> + Clone,
    error: impl Fn(&Row) -> Option<f64>,
    is_labeled: bool,
) -> Vec<Series> {
    let point = |row: &Row| {
        let point = [row.ms_per_frame, error(row)?];
        let is_drawn = point.iter().all(|x| x.is_finite() && *x > 0.0);
        is_drawn.then_some(point)
    };
    let all = SCHEMES.into_iter().map(|(name, is)| {
        let rows = rows.clone().filter(move |row| is(row));
        let points: Vec<Point> = rows.clone().filter_map(point).collect();
        let line = pareto_front(points.iter().copied());
        let label = |&p: &Point| {
            let row = rows.clone().find(|row| point(row) == Some(p))?;
            Some((p, format!("{}x{}", row.substeps, row.iterations)))
        };
        let labels = line.iter().filter(|_| is_labeled).filter_map(label);
        Series {
            name: name.to_owned(),
            labels: labels.collect(),
            points,
            line,
        }
    });
    all.filter(|series| !series.points.is_empty()).collect()
}

/// Numbers of substeps whose floors are drawn.
pub(crate) const FLOOR_SUBSTEPS: [u32; 4] = [1, 2, 4, 8];

/// Returns the errors of converged second-order steps at every number of [`FLOOR_SUBSTEPS`].
pub(crate) fn floors<'a>(rows: impl Iterator<Item = &'a Row> + Clone) -> Vec<Level> {
    let floor = |substeps: u32| {
        let mut of_count = rows.clone().filter(|row| row.substeps == substeps);
        let label = match substeps {
            1 => "converged, 1 step".to_owned(),
            n => format!("converged, {n} steps"),
        };
        let y = of_count.find_map(|row| row.floor_position)?;
        Some(Level { y, label })
    };
    FLOOR_SUBSTEPS.into_iter().filter_map(floor).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_front_has_the_points_that_none_dominates() {
        let points = [
            [1.0, 0.5],
            [2.0, 0.6],
            [3.0, 0.1],
            [3.0, 0.05],
            [4.0, 0.05],
            [0.5, f64::NAN],
        ];
        let front = pareto_front(points.into_iter());
        assert_eq!(front, [[1.0, 0.5], [3.0, 0.05]]);
        assert_eq!(time_to(&front, 0.1), Some(3.0));
        assert_eq!(time_to(&front, 0.01), None);
        assert_eq!(error_at(&front, 2.9), Some(0.5));
        assert_eq!(error_at(&front, 0.9), None);
        let other = [[2.0, 1.0], [5.0, 0.2]];
        assert_eq!(least_gain(&front, &other), Some(4.0), "20, 4, 4 and 4");
        assert_eq!(least_gain(&front, &[[20.0, 0.1]]), None);
    }

    #[test]
    fn floors_are_those_of_their_substeps() {
        let row = |substeps, floor_position| Row {
            substeps,
            floor_position,
            ..Row::default()
        };
        let rows = [
            row(2, Some(0.5)),
            row(2, Some(0.5)),
            row(1, Some(0.7)),
            row(4, None),
            row(16, Some(0.1)),
        ];
        let found = floors(rows.iter()).into_iter();
        let found: Vec<(f64, String)> = found.map(|level| (level.y, level.label)).collect();
        let expected = [(0.7, "converged, 1 step"), (0.5, "converged, 2 steps")];
        assert_eq!(found, expected.map(|(y, label)| (y, label.to_owned())));
    }

    #[test]
    fn every_row_is_a_point_of_its_scheme() {
        let row = |scheme: &str, substeps, ms_per_frame, position| Row {
            scheme: scheme.to_owned(),
            substeps,
            iterations: 1,
            ms_per_frame,
            total_position: Some(position),
            ..Row::default()
        };
        let rows = [
            row("xpbd", 4, 1.0, 1e-2),
            row("xpbd", 2, 1.1, 2e-2),
            row("pbd", 1, 1.0, 1e-1),
            row("pbd", 1, 2.0, f64::NAN),
        ];
        let all = series(rows.iter(), |row| row.total_position, true);
        let [xpbd, paper] = &all[..] else {
            panic!("two schemes have points: {all:?}");
        };
        assert_eq!((xpbd.points.len(), xpbd.line.len()), (2, 1));
        assert_eq!(xpbd.labels, [([1.0, 1e-2], "4x1".to_owned())]);
        assert_eq!((paper.points.len(), paper.labels[0].1.as_str()), (1, "1x1"));
    }
}
