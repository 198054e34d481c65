//! Rows that earlier runs wrote, as far as the page shows them. Fields that older files have not are optional.

use super::error::PageError;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::path::Path;

/// The benches that the page shows, in its order.
pub(super) const NAMES: [&str; 7] = [
    "table",
    "cut",
    "refine",
    "step",
    "accuracy",
    "stability",
    "skip",
];

/// Rows of one bench.
#[derive(Debug)]
pub(super) enum Rows {
    Table(Vec<TableRow>),
    Cut(Vec<CutRow>),
    Refine(Vec<RefineRow>),
    Step(Vec<StepRow>),
    Accuracy(Vec<AccuracyRow>),
    Stability(Vec<StabilityRow>),
    Skip(Vec<SkipRow>),
}

impl Rows {
    /// The bench's name.
    pub(super) fn name(&self) -> &'static str {
        let i = match self {
            Self::Table(_) => 0,
            Self::Cut(_) => 1,
            Self::Refine(_) => 2,
            Self::Step(_) => 3,
            Self::Accuracy(_) => 4,
            Self::Stability(_) => 5,
            Self::Skip(_) => 6,
        };
        NAMES[i]
    }

    fn len(&self) -> usize {
        match self {
            Self::Table(rows) => rows.len(),
            Self::Cut(rows) => rows.len(),
            Self::Refine(rows) => rows.len(),
            Self::Step(rows) => rows.len(),
            Self::Accuracy(rows) => rows.len(),
            Self::Stability(rows) => rows.len(),
            Self::Skip(rows) => rows.len(),
        }
    }
}

/// A file of results.
#[derive(Debug)]
pub(super) struct Source {
    /// Its name, without the folder.
    pub(super) file: String,
    pub(super) rows: Rows,
    pub(super) count: usize,
    /// What was measured on, and the commit, as far as the rows say: each that there is once.
    pub(super) machines: Vec<String>,
    pub(super) commits: Vec<String>,
}

/// A row of the paper's table.
#[derive(Debug, Deserialize)]
pub(super) struct TableRow {
    pub(super) model: String,
    pub(super) source: String,
    pub(super) vertices: u64,
    pub(super) triangles: u64,
    pub(super) triangles_after: u64,
    pub(super) backend: String,
    pub(super) pbd_fps: f64,
    pub(super) pbd_cs_fps: f64,
    #[serde(default)]
    pub(super) pbd_fps_by_second: Vec<Option<f64>>,
    #[serde(default)]
    pub(super) pbd_cs_fps_by_second: Vec<Option<f64>>,
    pub(super) fps_difference_percent: f64,
    pub(super) cut_ms_mean: Option<f64>,
    pub(super) cut_ms_p99: Option<f64>,
    pub(super) cuts: u64,
    #[serde(default)]
    pub(super) cuts_refused: Vec<String>,
    pub(super) stretch_error_percent: Option<f64>,
    pub(super) volume_error_percent: Option<f64>,
    pub(super) cap_min_angle_deg: Option<f64>,
    /// Not in files from before there were two methods.
    pub(super) method: Option<String>,
    pub(super) seconds: f64,
    pub(super) iterations: u64,
    /// Whether pieces keep their volumes, have struts, touch each other: not in files from before they could.
    #[serde(default)]
    pub(super) volume: bool,
    #[serde(default)]
    pub(super) struts: bool,
    #[serde(default)]
    pub(super) contacts: bool,
}

/// A row of `cut`: a model, or what is told of several.
#[derive(Debug, Deserialize)]
pub(super) struct CutRow {
    pub(super) kind: String,
    pub(super) model: Option<String>,
    pub(super) family: Option<String>,
    pub(super) planes: Option<String>,
    #[serde(default)]
    pub(super) triangles: u64,
    pub(super) hits: Option<f64>,
    pub(super) cap_triangles: Option<f64>,
    #[serde(default)]
    pub(super) cuts: u64,
    #[serde(default)]
    pub(super) failures: Vec<String>,
    pub(super) ms_median: Option<CutTimes>,
    pub(super) ms_p99: Option<CutTimes>,
    pub(super) slope: Option<f64>,
    pub(super) method: String,
}

/// Times of a cut's steps \[ms\].
#[derive(Debug, Deserialize)]
pub(super) struct CutTimes {
    pub(super) detect: f64,
    pub(super) split: f64,
    pub(super) cap: f64,
    #[serde(default)]
    pub(super) refine: f64,
    pub(super) separate: f64,
    pub(super) commit: f64,
    pub(super) search_tree: f64,
    pub(super) constraints: f64,
    pub(super) total: f64,
}

/// A row of `refine`.
#[derive(Debug, Deserialize)]
pub(super) struct RefineRow {
    pub(super) model: String,
    pub(super) planes: String,
    pub(super) level: f64,
    pub(super) covers: u64,
    pub(super) triangles: f64,
    pub(super) triangulation_ms: f64,
    pub(super) refinement_ms: f64,
    pub(super) smallest_angle: Option<f64>,
    pub(super) angle_5: Option<f64>,
    pub(super) angle_median: Option<f64>,
    pub(super) edge_mean: Option<f64>,
    pub(super) edge_longest: Option<f64>,
    #[serde(default)]
    pub(super) failures: Vec<String>,
}

/// A row of `step`.
#[derive(Debug, Deserialize)]
pub(super) struct StepRow {
    pub(super) model: String,
    pub(super) triangles: u64,
    pub(super) bodies: u64,
    pub(super) backend: String,
    pub(super) device: String,
    pub(super) schedule: String,
    pub(super) ms_per_frame: Option<f64>,
    pub(super) refusal: Option<String>,
}

/// A row of `accuracy`.
#[derive(Debug, Deserialize)]
pub(super) struct AccuracyRow {
    pub(super) scene: String,
    pub(super) backend: String,
    pub(super) scheme: String,
    pub(super) substeps: u32,
    pub(super) ms_per_frame: f64,
    pub(super) total_error: Option<TotalError>,
}

/// What a motion is off by.
#[derive(Debug, Deserialize)]
pub(super) struct TotalError {
    /// \[mean edges\].
    pub(super) position: Option<f64>,
}

/// A row of `stability`.
#[derive(Debug, Deserialize)]
pub(super) struct StabilityRow {
    pub(super) id: String,
    pub(super) torture: String,
    pub(super) law: String,
    pub(super) bound: Option<f64>,
    pub(super) worst: Option<f64>,
    pub(super) at: String,
    pub(super) backend: String,
    pub(super) passed: bool,
}

/// A row of `skip`.
#[derive(Debug, Deserialize)]
pub(super) struct SkipRow {
    pub(super) skip: String,
    pub(super) claim: String,
    pub(super) at: String,
    pub(super) bound: Option<f64>,
    pub(super) measured: Option<f64>,
    pub(super) passed: bool,
}

/// Reads a file of rows, of whatever bench; also the CSV that `accuracy` writes beside its plots.
///
/// # Errors
/// All of [`PageError`] that is about a file of results.
pub(super) fn read(path: &Path) -> Result<Source, PageError> {
    let text = std::fs::read_to_string(path).map_err(|source| PageError::Read {
        path: path.to_owned(),
        source,
    })?;
    let (rows, machines, commits) = if path.extension().is_some_and(|e| e == "csv") {
        let rows = super::csv::accuracy(path, &text)?;
        (Rows::Accuracy(rows.rows), Vec::new(), rows.commits)
    } else {
        let json = |source| PageError::Json {
            path: path.to_owned(),
            source,
        };
        let values: Value = serde_json::from_str(&text).map_err(json)?;
        let rows = rows(path, &values)?;
        (
            rows,
            each(&values, &["machine", "device"]),
            each(&values, &["commit"]),
        )
    };
    let count = rows.len();
    if count == 0 {
        let path = path.to_owned();
        return Err(PageError::Empty { path });
    }
    let file = path.file_name().unwrap_or_default();
    Ok(Source {
        file: file.to_string_lossy().into_owned(),
        rows,
        count,
        machines,
        commits,
    })
}

/// Rows of the bench whose fields the first one has.
fn rows(path: &Path, values: &Value) -> Result<Rows, PageError> {
    let first = match values.as_array() {
        Some(rows) => rows.first().ok_or_else(|| PageError::Empty {
            path: path.to_owned(),
        })?,
        None => values,
    };
    let has = |fields: &[&str]| fields.iter().all(|field| first.get(field).is_some());
    Ok(if has(&["pbd_fps", "pbd_cs_fps"]) {
        Rows::Table(typed(path, values)?)
    } else if has(&["torture", "law"]) {
        Rows::Stability(typed(path, values)?)
    } else if has(&["skip", "claim"]) {
        Rows::Skip(typed(path, values)?)
    } else if has(&["scene", "scheme"]) {
        Rows::Accuracy(typed(path, values)?)
    } else if has(&["schedule", "backend"]) {
        Rows::Step(typed(path, values)?)
    } else if has(&["triangulation_ms", "covers"]) {
        Rows::Refine(typed(path, values)?)
    } else if has(&["kind", "method"]) {
        Rows::Cut(typed(path, values)?)
    } else {
        let path = path.to_owned();
        return Err(PageError::Unknown { path });
    })
}

fn typed<T: DeserializeOwned>(path: &Path, values: &Value) -> Result<Vec<T>, PageError> {
    Vec::deserialize(values).map_err(|source| PageError::Json {
        path: path.to_owned(),
        source,
    })
}

/// The texts that rows have in the first of these fields that they have, each once.
fn each(values: &Value, fields: &[&str]) -> Vec<String> {
    let mut texts = Vec::new();
    for row in values.as_array().into_iter().flatten() {
        let text = fields.iter().find_map(|field| row.get(field)?.as_str());
        if let Some(text) = text.filter(|text| !texts.iter().any(|t| t == text)) {
            texts.push(text.to_owned());
        }
    }
    texts
}
