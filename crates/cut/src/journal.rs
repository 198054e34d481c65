//! Cuts on record, to be done again.

mod bits;

use crate::cutter::{CutOutcome, Cutter};
use crate::error::CutError;
use crate::params::CutParams;
use crate::sweep::Sweep;
use bits::CutBits;
use incise_mesh::Surface;
use serde::{Deserialize, Serialize};

/// Why a journal could not be replayed to its end. The surface is as the last good cut left it.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// The surface is not the one that the journal was begun with.
    #[error(
        "the journal was begun with another surface; replay it on the one before its first cut"
    )]
    OtherSurface,
    /// A cut was refused.
    #[error("cut {cut} of the journal was refused: {error}")]
    Refused {
        /// Which cut, from 0.
        cut: usize,
        /// Why.
        error: CutError,
    },
    /// A cut gave something else than on record.
    #[error(
        "cut {cut} of the journal gave another surface than on record; vertices that moved between the cuts must move again"
    )]
    OtherOutcome {
        /// Which cut, from 0.
        cut: usize,
    },
}

/// A cut that was done.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(into = "CutBits", try_from = "CutBits")]
struct Entry {
    sweep: Sweep,
    params: CutParams,
    /// The surface's fingerprint afterwards.
    after: u64,
}

/// The cuts done to a surface, in order: their sweeps and parameters. On the surface that it began
/// with a journal does them again to the same bits, and says so if it cannot. Written in any format
/// of `serde`, floats keep their bits.
///
/// Motion is not on record. Whoever moves vertices between cuts replays them one by one, with
/// [`Journal::cut`] of [`Journal::cuts`].
///
/// ```
/// use incise_cut::{CutParams, Cutter, Journal, Sweep};
/// use incise_mesh::Surface;
///
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let mut body = Surface::from_triangles(&corners, &faces)?;
/// let mut again = body.clone();
///
/// let mut journal = Journal::new(&body);
/// let mut cutter = Cutter::new(&body);
/// for d in [0.2, 0.4] {
///     let sweep = Sweep::across_box([1.0, 0.1, 0.0], d, &body.bounds())?;
///     journal.cut(&mut cutter, &mut body, &sweep, &CutParams::default())?;
/// }
/// journal.replay(&mut again)?;
/// assert_eq!(again, body);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Journal {
    /// The fingerprint of the surface before the first cut.
    start: u64,
    entries: Vec<Entry>,
}

impl Journal {
    /// A journal without cuts of `surface` as it is.
    #[must_use]
    pub fn new(surface: &Surface) -> Self {
        Self {
            start: surface.fingerprint(),
            entries: Vec::new(),
        }
    }

    /// Cuts and puts the cut on record. One that misses or is refused changes nothing and is not.
    ///
    /// # Errors
    /// [`CutError`]; the surface is then bit for bit what it was.
    pub fn cut(
        &mut self,
        cutter: &mut Cutter,
        surface: &mut Surface,
        sweep: &Sweep,
        params: &CutParams,
    ) -> Result<CutOutcome, CutError> {
        let outcome = cutter.cut(surface, sweep, params)?;
        if !outcome.delta.is_empty() {
            self.record(surface, sweep, params);
        }
        Ok(outcome)
    }

    /// Puts a cut on record that was just done: `surface` is the one after it.
    pub fn record(&mut self, surface: &Surface, sweep: &Sweep, params: &CutParams) {
        self.entries.push(Entry {
            sweep: *sweep,
            params: *params,
            after: surface.fingerprint(),
        });
    }

    /// Takes the last cut off the record: it was undone. Tells what it was, if there was one.
    pub fn forget_last(&mut self) -> Option<(Sweep, CutParams)> {
        let entry = self.entries.pop()?;
        Some((entry.sweep, entry.params))
    }

    /// The cuts on record, in order.
    pub fn cuts(&self) -> impl ExactSizeIterator<Item = (&Sweep, &CutParams)> + '_ {
        self.entries.iter().map(|e| (&e.sweep, &e.params))
    }

    /// Does the cuts again. Returns their outcomes, in order.
    ///
    /// # Errors
    /// [`ReplayError`] when the surface is not the one that the journal began with, or when a cut does
    /// not give what it gave then.
    pub fn replay(&self, surface: &mut Surface) -> Result<Vec<CutOutcome>, ReplayError> {
        if surface.fingerprint() != self.start {
            return Err(ReplayError::OtherSurface);
        }
        let mut cutter = Cutter::new(surface);
        let mut outcomes = Vec::with_capacity(self.entries.len());
        for (cut, entry) in self.entries.iter().enumerate() {
            let outcome = cutter
                .cut(surface, &entry.sweep, &entry.params)
                .map_err(|error| ReplayError::Refused { cut, error })?;
            if surface.fingerprint() != entry.after {
                if let Some(undo) = outcome.undo {
                    undo.revert(surface)
                        .expect("the cut was the last edit of the surface");
                }
                return Err(ReplayError::OtherOutcome { cut });
            }
            outcomes.push(outcome);
        }
        Ok(outcomes)
    }
}
