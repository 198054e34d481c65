//! Output of a command: reports on standard output, progress and warnings on standard error.

use crate::json::write_report;
use incise_progress::{Progress, Visibility};
use serde::Serialize;
use std::cell::RefCell;
use std::fmt::Display;
use std::io::{self, Write};

/// The options `--quiet` and `--json`, which every command has.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct OutputOptions {
    /// Print warnings and errors only.
    pub(crate) is_quiet: bool,
    /// Print reports and errors as JSON, and nothing else.
    pub(crate) is_json: bool,
}

/// Prints reports, warnings and progress as the output options ask.
#[derive(Debug)]
pub(crate) struct Reporter<W> {
    out: W,
    options: OutputOptions,
    /// Warnings of a run with `--json`.
    warnings: RefCell<Vec<String>>,
}

impl<W: Write> Reporter<W> {
    /// Creates a reporter that writes reports to `out`.
    pub(crate) fn new(out: W, options: OutputOptions) -> Self {
        Self {
            out,
            options,
            warnings: RefCell::default(),
        }
    }

    /// Writes the report of a command: as JSON with `--json`, else as text unless `--quiet`.
    pub(crate) fn report<R: Serialize>(
        &mut self,
        report: &R,
        print: impl FnOnce(&R, &mut W) -> io::Result<()>,
    ) -> io::Result<()> {
        match (self.options.is_json, self.options.is_quiet) {
            (true, _) => write_report(report, &mut self.out),
            (false, false) => print(report, &mut self.out),
            (false, true) => Ok(()),
        }
    }

    /// Prints a warning; with `--json` keeps it for [`Self::warnings`], because reports have it.
    pub(crate) fn warn(&self, warning: impl Display) {
        if self.options.is_json {
            self.warnings.borrow_mut().push(warning.to_string());
        } else {
            print_message(warning);
        }
    }

    /// Returns the warnings of a run with `--json`.
    pub(crate) fn warnings(&self) -> Vec<String> {
        self.warnings.borrow().clone()
    }

    /// Returns the standard output, for output that `--quiet` does not suppress.
    pub(crate) fn output(&mut self) -> &mut W {
        &mut self.out
    }

    /// Starts the progress of long work in `parts` parts of `steps` steps each.
    pub(crate) fn progress(&self, parts: u32, steps: u32) -> Progress {
        self.start(parts, steps, Visibility::Everywhere)
    }

    /// Starts the progress of work that takes long for large inputs only.
    pub(crate) fn stages(&self, stages: u32) -> Progress {
        self.start(stages, 1, Visibility::OnTerminals)
    }

    fn start(&self, parts: u32, steps: u32, shown: Visibility) -> Progress {
        let is_hidden = self.options.is_quiet || self.options.is_json;
        let shown = if is_hidden { Visibility::Never } else { shown };
        Progress::new(parts.into(), steps.into(), shown)
    }

    /// Flushes the standard output.
    pub(crate) fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Prints a warning or an error to the standard error.
pub(crate) fn print_message(message: impl Display) {
    // A closed standard error leaves the exit code and the JSON report.
    let _ = writeln!(io::stderr(), "incise: {message}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quiet_output_keeps_json_reports() {
        let output = |is_json, is_quiet| {
            let mut reporter = Reporter::new(Vec::new(), OutputOptions { is_quiet, is_json });
            let written = reporter.report(&[1], |_, out| writeln!(out, "one"));
            written.unwrap();
            String::from_utf8(reporter.out).unwrap()
        };
        assert_eq!(output(false, false), "one\n");
        assert_eq!(output(false, true), "");
        assert_eq!(output(true, false), "[\n  1\n]\n");
        assert_eq!(output(true, true), output(true, false));
    }
}
