//! What a command says: its report on the standard output, how far it is on the error output.

use crate::json::write_report;
use incise_progress::{Progress, Shown};
use serde::Serialize;
use std::io::{self, Write};

/// Says it, or keeps quiet.
#[derive(Debug)]
pub(crate) struct Teller<W> {
    out: W,
    is_quiet: bool,
}

impl<W: Write> Teller<W> {
    /// Reports go to `out`; one who is quiet tells only what is asked for as JSON.
    pub(crate) fn new(out: W, is_quiet: bool) -> Self {
        Self { out, is_quiet }
    }

    /// The report of a command: as JSON if that is asked for, else for people.
    pub(crate) fn report<R: Serialize>(
        &mut self,
        report: &R,
        is_json: bool,
        print: impl FnOnce(&R, &mut W) -> io::Result<()>,
    ) -> io::Result<()> {
        match (is_json, self.is_quiet) {
            (true, _) => write_report(report, &mut self.out),
            (false, false) => print(report, &mut self.out),
            (false, true) => Ok(()),
        }
    }

    /// What is made for whoever asks, quiet or not.
    pub(crate) fn output(&mut self) -> &mut W {
        &mut self.out
    }

    /// The progress of long work: so many parts, each of so many steps.
    pub(crate) fn progress(&self, parts: u32, steps: u32) -> Progress {
        self.shown(parts, steps, Shown::Everywhere)
    }

    /// The progress of work that is long for large inputs only.
    pub(crate) fn stages(&self, stages: u32) -> Progress {
        self.shown(stages, 1, Shown::OnTerminals)
    }

    fn shown(&self, parts: u32, steps: u32, shown: Shown) -> Progress {
        let shown = if self.is_quiet { Shown::Never } else { shown };
        Progress::new(parts.into(), steps.into(), shown)
    }

    /// Writes what is still on its way.
    pub(crate) fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_is_quiet_tells_only_what_is_asked_for_as_json() {
        let said = |is_json, is_quiet| {
            let mut teller = Teller::new(Vec::new(), is_quiet);
            let told = teller.report(&[1], is_json, |_, out| writeln!(out, "one"));
            told.unwrap();
            String::from_utf8(teller.out).unwrap()
        };
        assert_eq!(said(false, false), "one\n");
        assert_eq!(said(false, true), "");
        assert_eq!(said(true, false), "[\n  1\n]\n");
        assert_eq!(said(true, true), said(true, false));
    }
}
