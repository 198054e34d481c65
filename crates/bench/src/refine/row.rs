//! The row of `refine`: section meshes of one model at one level.

use crate::json::nan_if_null;
use crate::numbers::fixed;
use crate::text_table::Column;
use serde::{Deserialize, Serialize};

/// Explains the columns.
pub(crate) const LEGEND: &str = "\
rim: boundary points; tris: triangles of one mesh; medians. ms tri, ms ref: triangulation and \
refinement, medians of the fastest of five. Angles: the smallest of every triangle \
[degrees] over all meshes: minimum; minimum of sections without a corner below 40 \
degrees; 5th percentile; that of the worst mesh; median. edge, longest: inner edges over their \
targets, mean and maximum; long: number above 1.8.";

/// Options and origin of a row.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Stamp {
    pub(crate) grading: f64,
    pub(crate) snap: f64,
    pub(crate) seed: u64,
    pub(crate) machine: String,
    pub(crate) commit: String,
    pub(crate) version: String,
}

/// Section meshes of one model at one level.
///
/// `covers`, `rim_points` and `rim_angle` are the names in result files.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Row {
    pub(crate) model: String,
    pub(crate) source: String,
    /// `middle`: the plane through the middle; `seeded`: seeded planes.
    pub(crate) planes: String,
    /// Refinement level z.
    pub(crate) level: f64,
    pub(crate) covers: usize,
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) rim_points: f64,
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) triangles: f64,
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) triangulation_ms: f64,
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) refinement_ms: f64,
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) million_triangles_a_second: f64,
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) smallest_angle: f64,
    /// Of sections without a corner below 40 degrees.
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) smallest_angle_free: f64,
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) rim_angle: f64,
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) angle_5: f64,
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) angle_5_worst: f64,
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) angle_median: f64,
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) edge_mean: f64,
    #[serde(deserialize_with = "nan_if_null")]
    pub(crate) edge_longest: f64,
    pub(crate) long_edges: usize,
    /// Errors of sections that could not be cut or triangulated.
    pub(crate) failures: Vec<String>,
    #[serde(flatten)]
    pub(crate) stamp: Stamp,
}

/// Columns of the printed table and of the report.
pub(crate) const COLUMNS: &[Column<Row>] = &[
    ("model", |row| row.model.clone()),
    ("planes", |row| row.planes.clone()),
    ("z", |row| fixed(row.level, 2)),
    ("meshes", |row| row.covers.to_string()),
    ("rim", |row| fixed(row.rim_points, 0)),
    ("tris", |row| fixed(row.triangles, 0)),
    ("ms tri", |row| fixed(row.triangulation_ms, 3)),
    ("ms ref", |row| fixed(row.refinement_ms, 3)),
    ("Mtri/s", |row| fixed(row.million_triangles_a_second, 2)),
    ("min", |row| fixed(row.smallest_angle, 1)),
    ("min free", |row| fixed(row.smallest_angle_free, 1)),
    ("5%", |row| fixed(row.angle_5, 1)),
    ("5% worst", |row| fixed(row.angle_5_worst, 1)),
    ("median", |row| fixed(row.angle_median, 1)),
    ("edge", |row| fixed(row.edge_mean, 3)),
    ("longest", |row| fixed(row.edge_longest, 2)),
    ("long", |row| row.long_edges.to_string()),
    ("source", |row| row.source.clone()),
];
