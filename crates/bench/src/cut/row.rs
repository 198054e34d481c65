//! Records of `cut`: rows of models, slopes of families, latencies, and progressive cuts.

use super::progressive::row::Row as ProgressiveRow;
use super::times::Times;
use crate::numbers::fixed;
use crate::statistics::slope;
use crate::text_table::Column;
use serde::{Deserialize, Serialize};

/// Explains the columns.
pub(crate) const LEGEND: &str = "\
n: triangles; k: hit triangles; caps: triangles of both caps; medians. Times of stages in ms, \
medians; p99: of the sum. detect: search and intersection; split: mesh edit along the sweep; \
separate: pieces, unless beside the cap; commit: delta and undo; bvh: update of the BVH, unless \
beside the solver; solver: update of constraints and masses. middle: the plane through the middle, \
15 times; seeded: seeded planes. Every cut is undone before the next.";

/// An object of the JSON file.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(crate) enum Record {
    Cut(Box<Row>),
    Slope(Slope),
    Latency(Box<Latency>),
    Progressive(Box<ProgressiveRow>),
}

/// Options and origin of a record.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Stamp {
    pub(crate) method: String,
    pub(crate) level: f64,
    pub(crate) grading: f64,
    pub(crate) seed: u64,
    pub(crate) machine: String,
    pub(crate) commit: String,
    pub(crate) version: String,
}

/// Cuts of one model along one plane or many.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Row {
    pub(crate) model: String,
    pub(crate) family: Option<String>,
    pub(crate) source: String,
    /// `middle`: the plane through the middle, repeated; `seeded`: seeded planes.
    pub(crate) planes: String,
    pub(crate) triangles: usize,
    /// Hit triangles, median.
    pub(crate) hits: f64,
    /// Triangles of both caps, median.
    pub(crate) cap_triangles: f64,
    pub(crate) cuts: usize,
    /// Number of planes without a hit.
    pub(crate) missed: usize,
    /// Errors of cuts, with their planes.
    pub(crate) failures: Vec<String>,
    pub(crate) ms_median: Times,
    pub(crate) ms_p99: Times,
    #[serde(flatten)]
    pub(crate) stamp: Stamp,
}

/// Growth of detection and split with the number of triangles, as a power of it.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Slope {
    pub(crate) family: String,
    pub(crate) sizes: usize,
    pub(crate) triangles_from: usize,
    pub(crate) triangles_to: usize,
    pub(crate) slope: f64,
    #[serde(flatten)]
    pub(crate) stamp: Stamp,
}

/// Time of cuts with about equal hits, of a body with many earlier cuts.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Latency {
    pub(crate) model: String,
    pub(crate) cuts_before: u32,
    pub(crate) triangles: usize,
    pub(crate) pieces: u32,
    pub(crate) probes: usize,
    pub(crate) hits: f64,
    pub(crate) hits_from: f64,
    pub(crate) hits_to: f64,
    pub(crate) failures: Vec<String>,
    pub(crate) ms_median: Times,
    pub(crate) ms_p99: Times,
    /// 99th percentile of the total, relative to the first stage.
    pub(crate) p99_ratio: f64,
    #[serde(flatten)]
    pub(crate) stamp: Stamp,
}

/// Columns of the printed table and of the report.
pub(crate) const COLUMNS: &[Column<Row>] = &[
    ("model", |row| row.model.clone()),
    ("planes", |row| row.planes.clone()),
    ("n", |row| row.triangles.to_string()),
    ("k", |row| fixed(row.hits, 0)),
    ("caps", |row| fixed(row.cap_triangles, 0)),
    ("cuts", |row| row.cuts.to_string()),
    ("failed", |row| row.failures.len().to_string()),
    ("detect", |row| fixed(row.ms_median.detect, 3)),
    ("split", |row| fixed(row.ms_median.split, 3)),
    ("cap", |row| fixed(row.ms_median.cap, 3)),
    ("refine", |row| fixed(row.ms_median.refine, 3)),
    ("separate", |row| fixed(row.ms_median.separate, 3)),
    ("commit", |row| fixed(row.ms_median.commit, 3)),
    ("bvh", |row| fixed(row.ms_median.bvh_update, 3)),
    ("solver", |row| fixed(row.ms_median.constraints, 3)),
    ("sum", |row| fixed(row.ms_median.total, 3)),
    ("p99", |row| fixed(row.ms_p99.total, 3)),
    ("source", |row| row.source.clone()),
];

impl Record {
    /// Returns the row of a model.
    pub(crate) fn row(&self) -> Option<&Row> {
        match self {
            Self::Cut(row) => Some(row),
            _ => None,
        }
    }

    /// Returns the row of a body that was cut step by step.
    pub(crate) fn progressive(&self) -> Option<&ProgressiveRow> {
        match self {
            Self::Progressive(row) => Some(row),
            _ => None,
        }
    }

    /// Returns a slope or a latency as a sentence; none for a row of a table.
    pub(crate) fn sentence(&self) -> Option<String> {
        match self {
            Self::Cut(_) | Self::Progressive(_) => None,
            Self::Slope(slope) => Some(format!(
                "{}: detect and split grow as n to the power of {:.2} ({} sizes from {} to {}).",
                slope.family, slope.slope, slope.sizes, slope.triangles_from, slope.triangles_to
            )),
            Self::Latency(row) => Some(format!(
                "After {} cuts of {} ({} triangles, {} pieces): {} cuts that hit {} to {} \
                 triangles, median {} ms, p99 {} ms, {} times that of the first.",
                row.cuts_before,
                row.model,
                row.triangles,
                row.pieces,
                row.probes,
                fixed(row.hits_from, 0),
                fixed(row.hits_to, 0),
                fixed(row.ms_median.total, 3),
                fixed(row.ms_p99.total, 3),
                fixed(row.p99_ratio, 2),
            )),
        }
    }

    /// Returns the model, the number of successful cuts and the errors of the others.
    pub(super) fn failures(&self) -> (&str, usize, &[String]) {
        match self {
            Self::Cut(row) => (&row.model, row.cuts, &row.failures),
            Self::Latency(row) => (&row.model, row.probes, &row.failures),
            Self::Slope(slope) => (&slope.family, 0, &[]),
            // Its failures are counted by kind.
            Self::Progressive(row) => (&row.model, row.steps, &[]),
        }
    }
}

impl Slope {
    /// Returns the slopes of families with at least three sizes.
    pub(crate) fn of_families(records: &[Record], stamp: &Stamp) -> Vec<Self> {
        let mut rows: Vec<&Row> = records.iter().filter_map(Record::row).collect();
        rows.retain(|row| row.planes == "middle" && row.cuts > 0);
        let mut families: Vec<&str> = rows
            .iter()
            .filter_map(|row| row.family.as_deref())
            .collect();
        families.dedup();
        let slopes = families.into_iter().filter_map(|family| {
            let of: Vec<&&Row> = (rows.iter())
                .filter(|row| row.family.as_deref() == Some(family))
                .collect();
            let points: Vec<[f64; 2]> = (of.iter())
                .map(|row| {
                    let ms = row.ms_median.detect + row.ms_median.split;
                    [(row.triangles as f64).ln(), ms.ln()]
                })
                .collect();
            let sizes = of.iter().map(|row| row.triangles);
            (points.len() >= 3).then(|| Self {
                family: family.to_owned(),
                sizes: points.len(),
                triangles_from: sizes.clone().min().unwrap_or(0),
                triangles_to: sizes.max().unwrap_or(0),
                slope: slope(&points),
                stamp: stamp.clone(),
            })
        });
        slopes.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(triangles: usize, ms: f64) -> Row {
        let times = Times {
            detect: ms / 4.0,
            split: 3.0 * ms / 4.0,
            total: ms,
            ..Times::default()
        };
        Row {
            model: "Sphere".to_owned(),
            family: Some("Sphere".to_owned()),
            planes: "middle".to_owned(),
            triangles,
            cuts: 15,
            ms_median: times,
            ms_p99: times,
            ..Row::default()
        }
    }

    #[test]
    fn a_time_as_the_root_of_the_size_has_slope_one_half() {
        let of = |sizes: &[usize]| -> Vec<Slope> {
            let rows = sizes.iter().map(|&n| row(n, 0.01 * (n as f64).sqrt()));
            let records: Vec<Record> = rows.map(|row| Record::Cut(Box::new(row))).collect();
            Slope::of_families(&records, &Stamp::default())
        };
        let slopes = of(&[100, 1000, 5000, 100_000]);
        assert_eq!(slopes.len(), 1);
        assert!((slopes[0].slope - 0.5).abs() < 1e-12);
        let ends = (slopes[0].triangles_from, slopes[0].triangles_to);
        assert_eq!(ends, (100, 100_000));
        assert!(of(&[100, 1000]).is_empty(), "two sizes tell little");
    }

    #[test]
    fn an_object_has_its_kind() {
        let json = serde_json::to_value(Record::Cut(Box::new(row(20, 1.0)))).unwrap();
        assert_eq!(json["kind"], "cut");
        assert_eq!(json["ms_median"]["total"], 1.0);
    }
}
