//! How far a run of a program is, on the error output: a bar on a terminal, a line for every part elsewhere.
//!
//! The programs of this workspace share it, so that all of them tell the same way and `--quiet` means the same. No
//! library does: what they have to say they return.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::cell::Cell;
use std::io::{self, Write};

/// Where progress is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// Nowhere: the user wants it quiet.
    Never,
    /// On terminals only: what takes seconds at most, and would only fill a log.
    OnTerminals,
    /// On terminals as a bar, elsewhere as lines, one for each of several parts.
    Everywhere,
}

/// A run in parts. The bar goes when it is dropped.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    parts: u64,
    begun: Cell<u64>,
    shown: Shown,
}

impl Progress {
    /// A run of so many parts, each of so many steps.
    #[must_use]
    pub fn new(parts: u64, steps: u64, shown: Shown) -> Self {
        // The template is a constant: what is wrong with it shows at once.
        let style = ProgressStyle::with_template("{msg:24!} {wide_bar} {percent}% {eta}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        let target = match shown {
            Shown::Never => ProgressDrawTarget::hidden(),
            // Hidden by itself when the error output is no terminal.
            Shown::OnTerminals | Shown::Everywhere => ProgressDrawTarget::stderr(),
        };
        Self {
            bar: ProgressBar::with_draw_target(Some(parts * steps), target).with_style(style),
            parts,
            begun: Cell::new(0),
            shown,
        }
    }

    /// That a part begins.
    pub fn begin(&self, part: &str) {
        self.begun.set(self.begun.get() + 1);
        self.bar.set_message(part.to_owned());
        self.bar.tick();
        // A part that is all there is has a beginning that everybody knows.
        let is_told = self.shown == Shown::Everywhere && self.parts > 1;
        if is_told && self.bar.is_hidden() {
            // Without an error output nobody waits for it.
            let _ = writeln!(io::stderr(), "{}/{} {part}", self.begun.get(), self.parts);
        }
    }

    /// That one step of a part is done.
    pub fn step(&self) {
        self.bar.inc(1);
    }

    /// Prints something else, with the bar out of the way meanwhile.
    pub fn aside<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }

    /// Takes the bar away, so that something else can be printed.
    pub fn end(&self) {
        self.bar.finish_and_clear();
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.end();
    }
}
