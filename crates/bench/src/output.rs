//! Rows of all benches, as JSON lines and as printed tables, and the progress of a run.

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

/// A row: the header of all benches, the parameters of the run, and the fields of the bench.
#[derive(Serialize)]
struct Row<'a, P, F> {
    bench: &'static str,
    /// The model, scene, feature or case.
    name: &'a str,
    backend: &'a str,
    /// The machine or GPU that did the work.
    device: &'a str,
    machine: &'a str,
    /// The commit of the build, marked `-dirty` for modified sources; `unknown` outside of a
    /// repository.
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
    machine: String,
    backend: &'static str,
    device: String,
    pub(crate) parameters: P,
    out: &'a mut dyn Write,
    json: Option<(PathBuf, File)>,
    is_quiet: bool,
    /// The progress bar, which every printed text hides for its time.
    pub(crate) progress: Progress,
    /// Rows that are not printed yet.
    rows: Vec<Value>,
}

impl<'a, P: Serialize> Output<'a, P> {
    /// Opens the file of `--json` before anything is measured, so that a bad path is reported at
    /// once. Rows are those of the CPU until [`Output::set_backend`].
    ///
    /// # Errors
    /// A message for a file that cannot be opened.
    pub(crate) fn open(
        bench: &'static str,
        arguments: &OutputArguments,
        parameters: P,
        out: &'a mut dyn Write,
    ) -> Result<Self, Box<dyn Error>> {
        let json = arguments.json.as_deref().map(open_file).transpose()?;
        let machine = machine();
        Ok(Self {
            bench,
            device: machine.clone(),
            machine,
            backend: "cpu",
            parameters,
            out,
            json,
            is_quiet: arguments.quiet,
            progress: Progress::new(0, 0, Visibility::Never),
            rows: Vec::new(),
        })
    }

    /// Sets the backend of the next rows, and the GPU if it has one.
    pub(crate) fn set_backend(&mut self, backend: &'static str, gpu: Option<String>) {
        self.backend = backend;
        self.device = gpu.unwrap_or_else(|| self.machine.clone());
    }

    /// Shows the progress of a run of `parts`, each of `steps`.
    pub(crate) fn start(&mut self, parts: usize, steps: u64) {
        let shown = if self.is_quiet {
            Visibility::Never
        } else {
            Visibility::Everywhere
        };
        self.progress = Progress::new(parts as u64, steps, shown);
    }

    /// Appends a row to the file, and keeps it for [`Output::table`].
    ///
    /// # Errors
    /// As [`Output::json_row`].
    pub(crate) fn row(
        &mut self,
        name: &str,
        fields: &impl Serialize,
    ) -> Result<(), Box<dyn Error>> {
        let line = self.json_row(name, fields)?;
        // Read back in the order of its fields.
        self.rows.push(serde_json::from_str(&line)?);
        Ok(())
    }

    /// Appends a row to the file only, and returns it.
    ///
    /// # Errors
    /// A message for a file that cannot be written, or for a row that is not an object with names
    /// as keys.
    pub(crate) fn json_row(
        &mut self,
        name: &str,
        fields: &impl Serialize,
    ) -> Result<String, Box<dyn Error>> {
        let line = serde_json::to_string(&Row {
            bench: self.bench,
            name,
            backend: self.backend,
            device: &self.device,
            machine: &self.machine,
            commit: env!("INCISE_COMMIT"),
            version: env!("CARGO_PKG_VERSION"),
            parameters: &self.parameters,
            fields,
        })?;
        if let Some((path, file)) = &mut self.json {
            writeln!(file, "{line}").map_err(|error| {
                format!("{}: not written: {error}; the run ends", path.display())
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
        let out = &mut self.out;
        let print = || writeln!(out, "{line}").and_then(|()| out.flush());
        match self.progress.suspend(print) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe && self.json.is_some() => Ok(()),
            done => done,
        }
    }
}

/// Opens a file for appending; creates it and its folder if they are absent.
fn open_file(path: &Path) -> Result<(PathBuf, File), String> {
    let folder = path.parent().map_or(Ok(()), fs::create_dir_all);
    let opened = folder.and_then(|()| OpenOptions::new().append(true).create(true).open(path));
    let named = opened.map(|file| (path.to_owned(), file));
    named.map_err(|error| {
        let path = path.display();
        format!("{path}: cannot be written: {error}; nothing was measured")
    })
}

/// Returns the CPU's name and its number of threads.
fn machine() -> String {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'))
        .map_or(std::env::consts::ARCH, |(_, name)| name.trim());
    format!("{name}, {threads} threads")
}

/// Returns whether an error is that of a closed pipe, as of `| head`.
pub(crate) fn is_closed_pipe(error: &(dyn Error + 'static)) -> bool {
    let io: Option<&io::Error> = error.downcast_ref();
    io.is_some_and(|error| error.kind() == ErrorKind::BrokenPipe)
}
