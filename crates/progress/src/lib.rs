//! Progress output of the command-line programs, on standard error.
//!
//! Shows a progress bar on a terminal and one line per part elsewhere. The programs of this
//! workspace share it, so that progress and `--quiet` look the same everywhere. Libraries do not
//! use it: they return reports and never print.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::cell::Cell;
use std::io::{self, Write};

/// Streams that show progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Visibility {
    /// Nowhere, as with `--quiet`.
    Never,
    /// On terminals only, for runs of a few seconds.
    OnTerminals,
    /// As a bar on terminals, elsewhere as one line per part if there are several.
    Everywhere,
}

/// Progress of a run in parts. Dropping it removes the bar.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    part_count: u64,
    started: Cell<u64>,
    visibility: Visibility,
}

impl Progress {
    /// Starts a run of `parts` parts with `steps` steps each.
    #[must_use]
    pub fn new(parts: u64, steps: u64, visibility: Visibility) -> Self {
        let style = ProgressStyle::with_template("{msg:24!} {wide_bar} {percent}% {eta}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        let target = match visibility {
            Visibility::Never => ProgressDrawTarget::hidden(),
            // indicatif hides the bar if standard error is not a terminal.
            Visibility::OnTerminals | Visibility::Everywhere => ProgressDrawTarget::stderr(),
        };
        Self {
            bar: ProgressBar::with_draw_target(Some(parts * steps), target).with_style(style),
            part_count: parts,
            started: Cell::new(0),
            visibility,
        }
    }

    /// Starts a part.
    pub fn begin(&self, part: &str) {
        self.started.set(self.started.get() + 1);
        self.bar.set_message(part.to_owned());
        self.bar.tick();
        let prints_lines = self.visibility == Visibility::Everywhere && self.part_count > 1;
        if prints_lines && self.bar.is_hidden() {
            let (started, parts) = (self.started.get(), self.part_count);
            // A closed standard error is not an error of the run.
            let _ = writeln!(io::stderr(), "{started}/{parts} {part}");
        }
    }

    /// Completes one step of the current part.
    pub fn step(&self) {
        self.bar.inc(1);
    }

    /// Hides the bar while `print` prints, and returns its result.
    pub fn suspend<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }

    /// Ends the run and removes the bar.
    pub fn end(&self) {
        self.bar.finish_and_clear();
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.end();
    }
}
