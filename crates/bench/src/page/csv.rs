//! The rows that `accuracy` writes beside its plots, one file a scene.

use super::error::PageError;
use super::rows::{AccuracyRow, TotalError};
use std::path::Path;

/// Rows, and the commits that they name, each once.
#[derive(Debug)]
pub(super) struct Csv {
    pub(super) rows: Vec<AccuracyRow>,
    pub(super) commits: Vec<String>,
}

/// Reads them.
///
/// # Errors
/// [`PageError::Unknown`] for a table of something else, [`PageError::Cell`] for a row that is short of a cell or has no
/// number where there should be one.
pub(super) fn accuracy(path: &Path, text: &str) -> Result<Csv, PageError> {
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let place = |name: &str| names.iter().position(|&n| n == name);
    let places = ["scene", "scheme", "ms_per_frame", "total_position"].map(place);
    if places.contains(&None) {
        let path = path.to_owned();
        return Err(PageError::Unknown { path });
    }
    let (mut rows, mut commits) = (Vec::new(), Vec::new());
    for (line, text) in (2..).zip(lines) {
        let cells: Vec<&str> = text.split(',').collect();
        let cell = |column: &'static str| {
            let cell = place(column).and_then(|i| cells.get(i));
            cell.copied().ok_or_else(|| PageError::Cell {
                path: path.to_owned(),
                line,
                column,
            })
        };
        let no_number = |column| PageError::Cell {
            path: path.to_owned(),
            line,
            column,
        };
        let (time, error) = ("ms_per_frame", "total_position");
        let position = match cell(error)? {
            "" => None,
            text => Some(text.parse().map_err(|_| no_number(error))?),
        };
        rows.push(AccuracyRow {
            scene: cell("scene")?.to_owned(),
            backend: cell("backend")?.to_owned(),
            scheme: cell("scheme")?.to_owned(),
            substeps: (cell("substeps")?.parse()).map_err(|_| no_number("substeps"))?,
            ms_per_frame: cell(time)?.parse().map_err(|_| no_number(time))?,
            total_error: Some(TotalError { position }),
        });
        let commit = cell("commit")?.to_owned();
        if !commits.contains(&commit) {
            commits.push(commit);
        }
    }
    Ok(Csv { rows, commits })
}
