//! Recordings of sessions as lines of JSON, and their replay.

use crate::command::{Command, Settings};
use crate::session::Session;
use incise_mesh::Surface;
use serde::{Deserialize, Serialize};
use std::io::{self, BufRead, Write};

/// One line of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Entry {
    /// First entry: the initial surface and settings.
    Start {
        /// Hash of the surface's connectivity and positions.
        surface: u64,
        /// Initial settings.
        settings: Settings,
    },
    /// A command and its time.
    Command {
        /// Number of frames before the command.
        frame: u64,
        /// Command.
        command: Command,
    },
    /// Last entry: the final state.
    End {
        /// Number of frames of the session.
        frame: u64,
        /// Hash of the state, see [`Session::fingerprint`].
        state: u64,
    },
}

/// The commands of a session with their frame numbers.
///
/// The text format has one JSON object per line and preserves floats bit for bit.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    entries: Vec<Entry>,
}

/// An error of reading or replaying a recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The recording cannot be read.
    #[error("cannot be read: {0}")]
    Read(#[from] io::Error),
    /// A line is not a valid entry.
    #[error("line {line} is not a valid entry: {source}")]
    Line {
        /// Line number, from 1.
        line: usize,
        /// Cause.
        source: serde_json::Error,
    },
    /// The first entry is not a start entry, or frame numbers decrease.
    #[error(
        "line {line} is out of order: the first line must be the start entry, and frame numbers \
         must not decrease"
    )]
    Order {
        /// Line number, from 1.
        line: usize,
    },
    /// The recording belongs to another surface.
    #[error("recorded with another body; open it with that body")]
    OtherSurface,
}

impl Recording {
    pub(crate) fn new(surface: &Surface, settings: Settings) -> Self {
        let surface = surface_hash(surface);
        Self {
            entries: vec![Entry::Start { surface, settings }],
        }
    }

    /// Appends a command; of consecutive drags within a frame, only the last is kept.
    pub(crate) fn record(&mut self, frame: u64, command: Command) {
        if let (
            Some(Entry::Command {
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
        self.entries.push(Entry::Command { frame, command });
    }

    pub(crate) fn push(&mut self, entry: Entry) {
        self.entries.push(entry);
    }

    /// Returns the entries in order.
    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Writes the recording as lines of JSON.
    ///
    /// # Errors
    /// An error of the writer.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        for entry in &self.entries {
            serde_json::to_writer(&mut *out, entry)?;
            writeln!(out)?;
        }
        Ok(())
    }

    /// Reads the format of [`Recording::write`].
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
                Entry::Command { frame, .. } | Entry::End { frame, .. } => frame,
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

    /// Returns the initial settings.
    #[must_use]
    pub fn settings(&self) -> Settings {
        match self.entries.first() {
            Some(Entry::Start { settings, .. }) => *settings,
            _ => Settings::default(),
        }
    }

    /// Starts a replay on the surface that was recorded.
    ///
    /// # Errors
    /// [`RecordingError::OtherSurface`] for another surface.
    pub fn replay(self, of: &Surface) -> Result<Replay, RecordingError> {
        match self.entries.first() {
            Some(Entry::Start { surface, .. }) if *surface == surface_hash(of) => Ok(Replay {
                entries: self.entries,
                next: 1,
            }),
            _ => Err(RecordingError::OtherSurface),
        }
    }
}

/// Returns a hash of connectivity and positions.
pub(crate) fn surface_hash(surface: &Surface) -> u64 {
    let coordinates = surface.positions().iter().flat_map(|p| &p[..3]);
    coordinates.fold(surface.fingerprint(), |hash, c| {
        // FNV-1a by words.
        (hash ^ u64::from(c.to_bits())).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// A recording that is being replayed.
#[derive(Debug, Clone)]
pub struct Replay {
    entries: Vec<Entry>,
    next: usize,
}

/// Progress of a replay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReplayProgress {
    /// More entries follow.
    Running,
    /// The replay is complete.
    ///
    /// The value is true if the final state is bit-identical, and `None` if the recording has no
    /// end entry.
    Finished(Option<bool>),
}

impl Replay {
    /// Applies the commands of the next frame.
    ///
    /// Call this before each [`Session::frame`] until the replay is finished.
    ///
    /// # Errors
    /// As [`Session::fingerprint`].
    pub fn advance(
        &mut self,
        session: &mut Session,
    ) -> Result<ReplayProgress, incise_scene::SceneError> {
        while let Some(&entry) = self.entries.get(self.next) {
            match entry {
                Entry::Command { frame, command } if frame <= session.frames() => {
                    session.apply(command);
                }
                Entry::End { frame, state } if frame <= session.frames() => {
                    let is_same = session.fingerprint()? == state;
                    return Ok(ReplayProgress::Finished(Some(is_same)));
                }
                Entry::Start { .. } => {}
                Entry::Command { .. } | Entry::End { .. } => return Ok(ReplayProgress::Running),
            }
            self.next += 1;
        }
        Ok(ReplayProgress::Finished(None))
    }
}
