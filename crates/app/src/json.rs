//! Reports and errors as JSON, and the paths in them.

use serde::ser::SerializeSeq;
use serde::{Serialize, Serializer};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Writes a report and ends the line.
pub(crate) fn write_report(report: &impl Serialize, out: &mut impl Write) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *out, report)?;
    writeln!(out)
}

/// The error that ended a command.
#[derive(Debug, Serialize)]
pub(crate) struct ErrorReport<'a> {
    error: &'a str,
    exit_code: u8,
    /// Warnings before the error.
    warnings: Vec<String>,
}

impl<'a> ErrorReport<'a> {
    /// Creates the report of an error message.
    pub(crate) fn new(error: &'a str, exit_code: u8, warnings: Vec<String>) -> Self {
        Self {
            error: error.trim(),
            exit_code,
            warnings,
        }
    }

    /// Prints the error to the standard error, on one line.
    pub(crate) fn print(&self) {
        let line = serde_json::json!(self);
        // A closed standard error leaves the exit code.
        let _ = writeln!(io::stderr(), "{line}");
    }
}

/// Serializes a path as text; invalid Unicode becomes U+FFFD, as on a terminal.
pub(crate) fn lossy<S: Serializer>(
    path: impl AsRef<Path>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&path.as_ref().to_string_lossy())
}

/// Serializes paths as [`lossy`] text.
pub(crate) fn all_lossy<S: Serializer>(
    paths: &[PathBuf],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let mut list = serializer.serialize_seq(Some(paths.len()))?;
    for path in paths {
        list.serialize_element(&path.to_string_lossy())?;
    }
    list.end()
}
