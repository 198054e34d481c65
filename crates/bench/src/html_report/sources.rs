//! Reads files of rows: the JSON of every bench, and the CSV of `accuracy`.

use super::error::ReportError;
use crate::{cut, refine, skip, stability, step, table, work_precision};
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::path::Path;

/// The benches of the report in its order.
pub(super) const NAMES: [&str; 7] = [
    "table",
    "accuracy",
    "cut",
    "refine",
    "step",
    "stability",
    "skip",
];

/// Rows of one bench.
#[derive(Debug)]
pub(super) enum Rows {
    Table(Vec<table::row::Row>),
    Accuracy(Vec<work_precision::Row>),
    Cut(Vec<cut::row::Record>),
    Refine(Vec<refine::row::Row>),
    Step(Vec<step::row::Row>),
    Stability(Vec<stability::Row>),
    Skip(Vec<skip::row::Row>),
}

/// A file of rows.
#[derive(Debug)]
pub(super) struct Source {
    /// The file's name without its folder.
    pub(super) file: String,
    pub(super) rows: Rows,
    pub(super) count: usize,
    /// The machine or the device that the rows name.
    pub(super) machine: String,
    pub(super) commit: String,
}

impl Source {
    /// Returns the bench's name.
    pub(super) fn bench(&self) -> &'static str {
        let i = match &self.rows {
            Rows::Table(_) => 0,
            Rows::Accuracy(_) => 1,
            Rows::Cut(_) => 2,
            Rows::Refine(_) => 3,
            Rows::Step(_) => 4,
            Rows::Stability(_) => 5,
            Rows::Skip(_) => 6,
        };
        NAMES[i]
    }

    /// Returns the file, the commit and further words as a group title.
    pub(super) fn title(&self, more: &str) -> String {
        let Self { file, commit, .. } = self;
        match more {
            "" => format!("{file}, commit {commit}"),
            more => format!("{more}: {file}, commit {commit}"),
        }
    }
}

/// Reads a file of rows of any bench.
///
/// # Errors
/// [`ReportError::Read`] for a missing file; [`ReportError::NoRows`], [`ReportError::Json`] and
/// [`ReportError::Csv`] for a file of something else.
pub(super) fn read(path: &Path) -> Result<Source, ReportError> {
    let bytes = std::fs::read(path).map_err(|source| ReportError::Read {
        path: path.to_owned(),
        source,
    })?;
    let no_rows = || ReportError::NoRows {
        path: path.to_owned(),
    };
    let values: Vec<Value> = if path.extension().is_some_and(|e| e == "csv") {
        let rows = csv::Reader::from_reader(bytes.as_slice()).into_deserialize();
        let rows: Result<Vec<work_precision::Row>, csv::Error> = rows.collect();
        let rows = rows.map_err(|source| ReportError::Csv {
            path: path.to_owned(),
            source,
        })?;
        (rows.iter().filter(|row| !row.scene.is_empty()))
            .filter_map(|row| serde_json::to_value(row).ok())
            .collect()
    } else {
        let value: Value = serde_json::from_slice(&bytes).map_err(|source| ReportError::Json {
            path: path.to_owned(),
            source,
        })?;
        match value {
            Value::Array(rows) => rows,
            _ => return Err(no_rows()),
        }
    };
    let first = values.first().ok_or_else(no_rows)?;
    let has = |fields: &[&str]| fields.iter().all(|field| first.get(field).is_some());
    let rows = if has(&["pbd_fps", "pbd_cs_fps"]) {
        Rows::Table(typed(path, &values)?)
    } else if has(&["stress", "invariant"]) || has(&["torture", "law"]) {
        Rows::Stability(typed(path, &values)?)
    } else if has(&["skip", "claim"]) {
        Rows::Skip(typed(path, &values)?)
    } else if has(&["scene", "scheme"]) {
        Rows::Accuracy(typed(path, &values)?)
    } else if has(&["schedule", "backend"]) {
        Rows::Step(typed(path, &values)?)
    } else if has(&["triangulation_ms", "covers"]) {
        Rows::Refine(typed(path, &values)?)
    } else if has(&["kind", "method"]) {
        Rows::Cut(typed(path, &values)?)
    } else {
        return Err(no_rows());
    };
    Ok(Source {
        file: (path.file_name().unwrap_or_default().to_string_lossy()).into_owned(),
        rows,
        count: values.len(),
        machine: distinct(&values, &["machine", "device"]),
        commit: distinct(&values, &["commit"]),
    })
}

fn typed<T: DeserializeOwned>(path: &Path, values: &[Value]) -> Result<Vec<T>, ReportError> {
    let rows: Result<Vec<T>, _> = values.iter().map(T::deserialize).collect();
    rows.map_err(|source| ReportError::Json {
        path: path.to_owned(),
        source,
    })
}

/// Returns the distinct texts of rows in the first field that they have.
fn distinct(values: &[Value], fields: &[&str]) -> String {
    let mut texts: Vec<&str> = Vec::new();
    for row in values {
        let mut known = fields.iter().filter_map(|field| row.get(field)?.as_str());
        if let Some(text) = known.find(|text| !text.is_empty())
            && !texts.contains(&text)
        {
            texts.push(text);
        }
    }
    match texts.as_slice() {
        [] => "not recorded".to_owned(),
        texts => texts.join("; "),
    }
}
