//! Rows of all benches, as JSON lines and as printed tables.

use crate::machine;
use crate::options::OutputArguments;
use crate::text_table::text_table;
use incise_params::Value;
use incise_progress::{Progress, Visibility};
use serde::Serialize;
use std::error::Error;
use std::fmt;
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// An error of writing results.
#[derive(Debug, thiserror::Error)]
pub(crate) enum OutputError {
    /// A file cannot be created or opened.
    #[error("{}: cannot be written: {source}; nothing was measured", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// An open file cannot be written.
    #[error("{}: not written: {source}; the run ends", path.display())]
    Lost {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// A row is not an object with names as keys.
    #[error("a row cannot be written: {0}")]
    Row(#[from] serde_json::Error),
}

/// The backend of a row, and the machine or GPU that did the work.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Origin<'a> {
    pub(crate) backend: &'a str,
    pub(crate) device: &'a str,
}

/// A row: the header of all benches, the parameters of the run, and the fields of the bench.
#[derive(Serialize)]
struct Row<'a, P, F> {
    bench: &'static str,
    /// The model, scene, feature or case.
    name: &'a str,
    backend: &'a str,
    device: &'a str,
    machine: &'a str,
    commit: &'static str,
    version: &'static str,
    #[serde(flatten)]
    parameters: &'a P,
    #[serde(flatten)]
    fields: &'a F,
}

/// Writes the rows of a bench with its parameters.
pub(crate) struct Output<'a, P> {
    bench: &'static str,
    pub(crate) machine: String,
    pub(crate) parameters: P,
    out: &'a mut dyn Write,
    json: Option<(PathBuf, File)>,
    is_quiet: bool,
    /// Rows that are not printed yet.
    rows: Vec<Value>,
}

impl<'a, P: Serialize> Output<'a, P> {
    /// Opens the file of `--json` before anything is measured, so that a bad path is reported at
    /// once.
    ///
    /// # Errors
    /// [`OutputError::File`].
    pub(crate) fn open(
        bench: &'static str,
        arguments: &OutputArguments,
        parameters: P,
        out: &'a mut dyn Write,
    ) -> Result<Self, OutputError> {
        let json = arguments.json.as_deref().map(open_file).transpose()?;
        Ok(Self {
            bench,
            machine: machine::machine(),
            parameters,
            out,
            json,
            is_quiet: arguments.quiet,
            rows: Vec::new(),
        })
    }

    /// Returns the progress of a run of `parts`, each of `steps`.
    pub(crate) fn progress(&self, parts: usize, steps: u64) -> Progress {
        let shown = if self.is_quiet {
            Visibility::Never
        } else {
            Visibility::Everywhere
        };
        Progress::new(parts as u64, steps, shown)
    }

    /// Appends a row measured on the CPU to the file, and keeps it for [`Output::table`].
    ///
    /// # Errors
    /// [`OutputError::Lost`], [`OutputError::Row`].
    pub(crate) fn cpu_row(
        &mut self,
        name: &str,
        fields: &impl Serialize,
    ) -> Result<(), OutputError> {
        let device = self.machine.clone();
        let (backend, device) = ("cpu", device.as_str());
        self.row(name, Origin { backend, device }, fields)
    }

    /// Appends a row to the file, and keeps it for [`Output::table`].
    ///
    /// # Errors
    /// [`OutputError::Lost`], [`OutputError::Row`].
    pub(crate) fn row(
        &mut self,
        name: &str,
        origin: Origin<'_>,
        fields: &impl Serialize,
    ) -> Result<(), OutputError> {
        let line = self.json_row(name, origin, fields)?;
        // Read back in the order of its fields.
        self.rows.push(serde_json::from_str(&line)?);
        Ok(())
    }

    /// Appends a row to the file only, and returns it.
    ///
    /// # Errors
    /// [`OutputError::Lost`], [`OutputError::Row`].
    pub(crate) fn json_row(
        &mut self,
        name: &str,
        origin: Origin<'_>,
        fields: &impl Serialize,
    ) -> Result<String, OutputError> {
        let row = Row {
            bench: self.bench,
            name,
            backend: origin.backend,
            device: origin.device,
            machine: &self.machine,
            commit: machine::COMMIT,
            version: env!("CARGO_PKG_VERSION"),
            parameters: &self.parameters,
            fields,
        };
        let line = serde_json::to_string(&row)?;
        if let Some((path, file)) = &mut self.json {
            writeln!(file, "{line}").map_err(|source| OutputError::Lost {
                path: path.clone(),
                source,
            })?;
        }
        Ok(line)
    }

    /// Prints the rows since the last table that `is_shown`.
    ///
    /// # Errors
    /// As [`Output::print`].
    pub(crate) fn table_of(&mut self, is_shown: impl Fn(usize) -> bool) -> io::Result<()> {
        let rows = std::mem::take(&mut self.rows);
        let rows = (0..).zip(rows).filter(|(i, _)| is_shown(*i));
        let rows: Vec<Value> = rows.map(|(_, row)| row).collect();
        if rows.is_empty() {
            return Ok(());
        }
        self.print(format_args!("{}", text_table(&rows)))
    }

    /// Prints the rows since the last table.
    ///
    /// # Errors
    /// As [`Output::print`].
    pub(crate) fn table(&mut self) -> io::Result<()> {
        self.table_of(|_| true)
    }

    /// Prints a line. A run that writes a file goes on when its reader is gone.
    ///
    /// # Errors
    /// The system's error.
    pub(crate) fn print(&mut self, line: fmt::Arguments<'_>) -> io::Result<()> {
        if self.is_quiet {
            return Ok(());
        }
        match writeln!(self.out, "{line}").and_then(|()| self.out.flush()) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe && self.json.is_some() => Ok(()),
            done => done,
        }
    }
}

/// Opens a file for appending; creates it and its folder if they are absent.
fn open_file(path: &Path) -> Result<(PathBuf, File), OutputError> {
    let folder = path.parent().map_or(Ok(()), fs::create_dir_all);
    let opened = folder.and_then(|()| OpenOptions::new().append(true).create(true).open(path));
    match opened {
        Ok(file) => Ok((path.to_owned(), file)),
        Err(source) => Err(OutputError::File {
            path: path.to_owned(),
            source,
        }),
    }
}

/// Returns whether an error is that of a closed pipe, as of `| head`.
pub(crate) fn is_closed_pipe(error: &(dyn Error + 'static)) -> bool {
    let io: Option<&io::Error> = error.downcast_ref();
    io.is_some_and(|error| error.kind() == ErrorKind::BrokenPipe)
}
