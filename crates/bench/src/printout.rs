//! Standard output that may be closed early.

use std::io::{self, ErrorKind, Write};

/// A writer that ends the run without an error when its pipe is closed, as by `| head`.
///
/// A run that writes files too goes on without printing.
#[derive(Debug)]
pub(crate) struct Printout<W> {
    to: W,
    /// Whether the run writes files too.
    goes_on: bool,
    has_reader: bool,
}

impl<W: Write> Printout<W> {
    /// Prints to `to`; a run that `goes_on` does not end with a closed pipe.
    pub(crate) fn new(to: W, goes_on: bool) -> Self {
        Self {
            to,
            goes_on,
            has_reader: true,
        }
    }

    /// Returns whether a closed pipe ended the run.
    pub(crate) fn was_left(&self) -> bool {
        !self.has_reader && !self.goes_on
    }

    /// Returns the result of a write; a write to a closed pipe succeeds if the run goes on.
    fn seen<T>(&mut self, done: io::Result<T>, unseen: T) -> io::Result<T> {
        match done {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                self.has_reader = false;
                if self.goes_on { Ok(unseen) } else { Err(error) }
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
    fn other_errors_are_errors() {
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
