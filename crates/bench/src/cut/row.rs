//! What is known of a model's cuts.

use super::times::Times;
use crate::statistics::slope;
use serde::Serialize;

/// An object of the JSON.
#[derive(Debug, Clone, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(super) enum Record {
    Cut(Box<Row>),
    Slope(Slope),
    Latency(Box<Latency>),
}

/// What was measured with and on.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Stamp {
    pub(super) method: &'static str,
    pub(super) level: f64,
    pub(super) grading: f64,
    pub(super) seed: u64,
    pub(super) machine: String,
    pub(super) commit: String,
    pub(super) version: &'static str,
}

/// Cuts of one model along one plane or many.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Row {
    pub(super) model: String,
    pub(super) family: Option<&'static str>,
    pub(super) source: String,
    /// `middle`: one plane through the middle, again and again; `seeded`: planes at random.
    pub(super) planes: &'static str,
    /// n.
    pub(super) triangles: usize,
    /// k, the median.
    pub(super) hits: f64,
    /// Of both sides, the median.
    pub(super) cap_triangles: f64,
    pub(super) cuts: usize,
    /// Planes that hit nothing.
    pub(super) missed: usize,
    /// Why cuts could not be done, with their planes.
    pub(super) failures: Vec<String>,
    pub(super) ms_median: Times,
    pub(super) ms_p99: Times,
    #[serde(flatten)]
    pub(super) stamp: Stamp,
}

/// How the time of detection and split grows with the number of triangles: as its power `slope`, at
/// the plane through the middle.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Slope {
    pub(super) family: &'static str,
    pub(super) sizes: usize,
    pub(super) triangles_from: usize,
    pub(super) triangles_to: usize,
    pub(super) slope: f64,
    #[serde(flatten)]
    pub(super) stamp: Stamp,
}

/// Cuts that hit about as many triangles, of a body that has been cut so often before.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Latency {
    pub(super) model: String,
    pub(super) cuts_before: u32,
    pub(super) triangles: usize,
    pub(super) pieces: u32,
    pub(super) probes: usize,
    pub(super) hits: f64,
    pub(super) hits_from: f64,
    pub(super) hits_to: f64,
    pub(super) failures: Vec<String>,
    pub(super) ms_median: Times,
    pub(super) ms_p99: Times,
    /// The 99th percentile of the total by that of the first row.
    pub(super) p99_ratio: f64,
    #[serde(flatten)]
    pub(super) stamp: Stamp,
}

impl Slope {
    /// One for each family that was measured at three sizes or more.
    pub(super) fn of_families(records: &[Record], stamp: &Stamp) -> Vec<Self> {
        let rows: Vec<&Row> = (records.iter())
            .filter_map(|record| match record {
                Record::Cut(row) if row.planes == "middle" && row.cuts > 0 => Some(row.as_ref()),
                _ => None,
            })
            .collect();
        let mut families: Vec<&'static str> = rows.iter().filter_map(|row| row.family).collect();
        families.dedup();
        let slopes = families.into_iter().filter_map(|family| {
            let of: Vec<&&Row> = (rows.iter())
                .filter(|row| row.family == Some(family))
                .collect();
            let points: Vec<[f64; 2]> = (of.iter())
                .map(|row| {
                    let ms = row.ms_median.detect + row.ms_median.split;
                    [(row.triangles as f64).ln(), ms.ln()]
                })
                .collect();
            let sizes = of.iter().map(|row| row.triangles);
            (points.len() >= 3).then(|| Self {
                family,
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
pub(super) mod tests {
    use super::*;

    pub(crate) fn stamp() -> Stamp {
        Stamp {
            method: "exact",
            level: 1.0,
            grading: 0.0,
            seed: 1,
            machine: "m".to_owned(),
            commit: "c".to_owned(),
            version: "0",
        }
    }

    pub(crate) fn row(triangles: usize, ms: f64) -> Row {
        let times = Times {
            detect: ms / 4.0,
            split: 3.0 * ms / 4.0,
            total: ms,
            ..Times::default()
        };
        Row {
            model: "Sphere".to_owned(),
            family: Some("Sphere"),
            source: "built-in".to_owned(),
            planes: "middle",
            triangles,
            hits: 10.0,
            cap_triangles: 20.0,
            cuts: 15,
            missed: 0,
            failures: Vec::new(),
            ms_median: times,
            ms_p99: times,
            stamp: stamp(),
        }
    }

    #[test]
    fn a_time_as_the_root_of_the_size_has_slope_one_half() {
        let of = |sizes: &[usize]| -> Vec<Slope> {
            let rows = sizes.iter().map(|&n| row(n, 0.01 * (n as f64).sqrt()));
            let records: Vec<Record> = rows.map(|row| Record::Cut(Box::new(row))).collect();
            Slope::of_families(&records, &stamp())
        };
        let slopes = of(&[100, 1000, 5000, 100_000]);
        assert_eq!(slopes.len(), 1);
        assert!((slopes[0].slope - 0.5).abs() < 1e-12);
        assert_eq!(
            (slopes[0].triangles_from, slopes[0].triangles_to),
            (100, 100_000)
        );
        assert!(of(&[100, 1000]).is_empty(), "two sizes tell little");
    }

    #[test]
    fn an_object_says_what_it_is() {
        let json = serde_json::to_value(Record::Cut(Box::new(row(20, 1.0)))).unwrap();
        assert_eq!(json["kind"], "cut");
        assert_eq!(json["machine"], "m");
        assert_eq!(json["ms_median"]["total"], 1.0);
    }
}
