//! What people read, and what becomes of it when they stop reading.

use std::io::{self, ErrorKind, Write};

/// A writer that knows whether anybody reads. `incise-bench stability | head` has seen enough after ten lines: the run
/// ends there, which is no fault, unless it writes files too and so has more to do than to print.
#[derive(Debug)]
pub(crate) struct Printout<W> {
    to: W,
    /// Whether the run is for files as well.
    goes_on: bool,
    has_reader: bool,
}

impl<W: Write> Printout<W> {
    /// Prints to `to`; a run that `goes_on` does not end with its reader.
    pub(crate) fn new(to: W, goes_on: bool) -> Self {
        Self {
            to,
            goes_on,
            has_reader: true,
        }
    }

    /// Whether the run ended since nobody reads it.
    pub(crate) fn was_left(&self) -> bool {
        !self.has_reader && !self.goes_on
    }

    /// What a write says, or that all was written where nobody waits for it.
    fn seen<T>(&mut self, done: io::Result<T>, unseen: T) -> io::Result<T> {
        match done {
            Err(fault) if fault.kind() == ErrorKind::BrokenPipe => {
                self.has_reader = false;
                if self.goes_on { Ok(unseen) } else { Err(fault) }
            }
            done => done,
        }
    }
}

impl<W: Write> Write for Printout<W> {
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        let done = self.to.write(text);
        self.seen(done, text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let done = self.to.flush();
        self.seen(done, ())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads two lines and goes.
    struct Head(u32);

    impl Write for Head {
        fn write(&mut self, text: &[u8]) -> io::Result<usize> {
            if self.0 == 0 {
                return Err(ErrorKind::BrokenPipe.into());
            }
            self.0 -= 1;
            Ok(text.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_run_ends_with_its_reader_unless_it_writes_files() {
        let run = |goes_on| {
            let mut out = Printout::new(Head(2), goes_on);
            let written = (0..5).take_while(|_| out.write_all(b"row\n").is_ok());
            (written.count(), out.was_left())
        };
        assert_eq!(run(false), (2, true));
        assert_eq!(run(true), (5, false));
    }

    #[test]
    fn other_faults_are_faults() {
        struct Full;
        impl Write for Full {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(ErrorKind::StorageFull.into())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        for goes_on in [false, true] {
            let mut out = Printout::new(Full, goes_on);
            assert!(out.write_all(b"row\n").is_err(), "not printed");
            assert!(!out.was_left(), "and not for want of a reader");
        }
    }
}
