//! What was done in a session, to be done again.

use crate::command::{Command, Settings};
use crate::session::Session;
use incise_mesh::Surface;
use serde::{Deserialize, Serialize};
use std::io::{self, BufRead, Write};

/// One line of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Entry {
    /// The first: with what it began.
    Start {
        /// The surface's number, to the bit.
        surface: u64,
        /// What was chosen.
        settings: Settings,
    },
    /// A command, given when so many frames had been stepped.
    Given {
        /// Frames before it.
        frame: u64,
        /// What was done.
        command: Command,
    },
    /// The last: after so many frames everything was where this number says, see [`Session::fingerprint`].
    End {
        /// Frames of the session.
        frame: u64,
        /// Where everything was.
        state: u64,
    },
}

/// Commands with the numbers of their frames. Written as JSON, a line an entry, floats keep their bits.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    entries: Vec<Entry>,
}

/// Why a text is no recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// It cannot be read.
    #[error("it cannot be read: {0}")]
    Read(#[from] io::Error),
    /// A line says nothing that a recording says.
    #[error("line {line} is no line of a recording: {source}")]
    Line {
        /// Which, from 1.
        line: usize,
        /// Why.
        source: serde_json::Error,
    },
    /// It does not begin with its surface and settings, or frames do not ascend.
    #[error(
        "line {line} is out of order: a recording begins with its surface and ascends in frames"
    )]
    Order {
        /// Which, from 1.
        line: usize,
    },
    /// It is of another body.
    #[error("it was made of another body; open it with the one that it was made of")]
    OtherSurface,
}

impl Recording {
    pub(crate) fn new(surface: &Surface, settings: Settings) -> Self {
        let surface = number(surface);
        Self {
            entries: vec![Entry::Start { surface, settings }],
        }
    }

    pub(crate) fn note(&mut self, frame: u64, command: Command) {
        // Of places within a frame only the last one counts.
        if let (
            Some(Entry::Given {
                frame: f,
                command: last,
            }),
            true,
        ) = (
            self.entries.last_mut(),
            matches!(command, Command::Drag { .. }),
        ) && *f == frame
            && matches!(last, Command::Drag { .. })
        {
            *last = command;
            return;
        }
        self.entries.push(Entry::Given { frame, command });
    }

    pub(crate) fn push(&mut self, entry: Entry) {
        self.entries.push(entry);
    }

    /// The entries, in order.
    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Writes all of it.
    ///
    /// # Errors
    /// What the writer says.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        for entry in &self.entries {
            serde_json::to_writer(&mut *out, entry)?;
            writeln!(out)?;
        }
        Ok(())
    }

    /// Reads what [`Recording::write`] wrote.
    ///
    /// # Errors
    /// [`RecordingError`].
    pub fn read(text: impl BufRead) -> Result<Self, RecordingError> {
        let mut entries = Vec::new();
        let mut last = 0;
        for (i, text) in text.lines().enumerate() {
            let line = i + 1;
            let entry = serde_json::from_str(&text?)
                .map_err(|source| RecordingError::Line { line, source })?;
            let frame = match entry {
                Entry::Start { .. } => 0,
                Entry::Given { frame, .. } | Entry::End { frame, .. } => frame,
            };
            let is_start = matches!(entry, Entry::Start { .. });
            if is_start != entries.is_empty() || frame < last {
                return Err(RecordingError::Order { line });
            }
            last = frame;
            entries.push(entry);
        }
        if entries.is_empty() {
            return Err(RecordingError::Order { line: 1 });
        }
        Ok(Self { entries })
    }

    /// What was chosen at first.
    #[must_use]
    pub fn settings(&self) -> Settings {
        match self.entries.first() {
            Some(Entry::Start { settings, .. }) => *settings,
            _ => Settings::default(),
        }
    }

    /// The recording from its beginning, for the body that it was made of.
    ///
    /// # Errors
    /// [`RecordingError::OtherSurface`].
    pub fn replay(self, of: &Surface) -> Result<Replay, RecordingError> {
        match self.entries.first() {
            Some(Entry::Start { surface, .. }) if *surface == number(of) => Ok(Replay {
                entries: self.entries,
                next: 1,
            }),
            _ => Err(RecordingError::OtherSurface),
        }
    }
}

/// Tells surfaces apart by triangles and places.
pub(crate) fn number(surface: &Surface) -> u64 {
    let coordinates = surface.positions.iter().flat_map(|p| &p[..3]);
    coordinates.fold(surface.fingerprint(), |hash, c| {
        // FNV-1a by words.
        (hash ^ u64::from(c.to_bits())).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// A recording that is being done again.
#[derive(Debug, Clone)]
pub struct Replay {
    entries: Vec<Entry>,
    next: usize,
}

/// How far a replay is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// There is more.
    Running,
    /// Over; whether everything is where it was, to the bit. None if the recording does not say where that was.
    Over(Option<bool>),
}

impl Replay {
    /// Gives the commands of the frame that comes next. To be called before each [`Session::frame`], until it is over.
    ///
    /// # Errors
    /// As [`Session::fingerprint`].
    pub fn follow(&mut self, session: &mut Session) -> Result<Progress, incise_scene::SceneError> {
        while let Some(&entry) = self.entries.get(self.next) {
            match entry {
                Entry::Given { frame, command } if frame <= session.frames() => {
                    session.apply(command);
                }
                Entry::End { frame, state } if frame <= session.frames() => {
                    let is_same = session.fingerprint()? == state;
                    return Ok(Progress::Over(Some(is_same)));
                }
                Entry::Start { .. } => {}
                Entry::Given { .. } | Entry::End { .. } => return Ok(Progress::Running),
            }
            self.next += 1;
        }
        Ok(Progress::Over(None))
    }
}
