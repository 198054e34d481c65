//! How far a run is, on the error output: a bar on a terminal, a line for every part elsewhere.

use indicatif::{ProgressBar, ProgressStyle};
use std::cell::Cell;
use std::io::{self, Write};

/// A run in parts.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
    parts: u64,
    begun: Cell<u64>,
}

impl Progress {
    /// A run of so many parts, each of so many steps.
    pub(crate) fn new(parts: u64, steps: u64) -> Self {
        // The template is a constant: what is wrong with it shows at once.
        let style = ProgressStyle::with_template("{msg:24!} {wide_bar} {percent}% {eta}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        // Hidden by itself when the error output is no terminal.
        Self {
            bar: ProgressBar::new(parts * steps).with_style(style),
            parts,
            begun: Cell::new(0),
        }
    }

    /// That a part begins.
    pub(crate) fn begin(&self, part: &str) {
        self.begun.set(self.begun.get() + 1);
        self.bar.set_message(part.to_owned());
        self.bar.tick();
        if self.bar.is_hidden() {
            // Without an error output nobody waits for it.
            let _ = writeln!(io::stderr(), "{}/{} {part}", self.begun.get(), self.parts);
        }
    }

    /// That one step of a part is done.
    pub(crate) fn step(&self) {
        self.bar.inc(1);
    }

    /// Prints something else, with the bar out of the way meanwhile.
    #[cfg(feature = "reference")]
    pub(crate) fn aside<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }

    /// Takes the bar away, so that something else can be printed.
    pub(crate) fn end(&self) {
        self.bar.finish_and_clear();
    }
}
