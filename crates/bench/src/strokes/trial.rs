//! [`Trial`]: one stroke, its steps, and the surface after it.

use crate::failure::Failure;
use incise_cut::{CutError, CutOutcome};
use incise_mesh::{Surface, TriangleId, Vec3};
use std::fmt::{Debug, Display};

/// Maximum change of a body's volume by a stroke at rest [volumes].
const MAX_VOLUME_CHANGE: f64 = 1e-4;

/// A stroke with its steps.
#[derive(Debug)]
pub(super) struct Trial {
    pub(super) number: u32,
    /// Steps with a motion.
    pub(super) steps: usize,
    /// Steps that cut.
    pub(super) cutting: usize,
    /// Refused steps.
    pub(super) failures: Vec<Failure>,
    /// Whether the stroke passes through the whole body.
    pub(super) is_full: bool,
    /// Whether the body does not move, so that its volume stays.
    pub(super) is_at_rest: bool,
    /// Triangles of the uncut body.
    pub(super) triangles: usize,
    is_sheet: bool,
    volume: f64,
    /// The body after the stroke; empty after a panic.
    pub(super) surface: Surface,
}

impl Trial {
    pub(super) fn new(number: u32) -> Self {
        Self {
            number,
            steps: 0,
            cutting: 0,
            failures: Vec::new(),
            is_full: false,
            is_at_rest: false,
            triangles: 0,
            is_sheet: false,
            volume: 0.0,
            surface: Surface::default(),
        }
    }

    /// Records the uncut body.
    pub(super) fn begin(&mut self, surface: &Surface) {
        self.triangles = surface.topology().triangle_count();
        self.is_sheet = surface.open_pieces().contains(&true);
        self.volume = surface.rest_volume_of(surface.topology().triangles());
    }

    /// Counts the outcome of a step; a refused one with its error.
    pub(super) fn record(&mut self, outcome: &Result<CutOutcome, CutError>) {
        match outcome {
            Ok(outcome) => self.cutting += usize::from(!outcome.is_miss()),
            Err(error) => self.fail(error),
        }
    }

    /// Counts an error at the present step.
    pub(super) fn fail(&mut self, error: &(impl Debug + Display)) {
        let at = format_args!("stroke {}, step {}", self.number, self.steps);
        Failure::add_error(&mut self.failures, error, at);
    }

    /// Counts a failure of a name at the present step.
    pub(super) fn fail_by(&mut self, name: &str, message: &str) {
        let (number, step) = (self.number, self.steps);
        let first = || format!("stroke {number}, step {step}: {message}");
        Failure::add(&mut self.failures, name, first);
    }

    /// Returns the corners of triangles in the rest shape \[m\].
    pub(super) fn rest_triangles(
        &self,
        is_meant: impl Fn(TriangleId) -> bool,
    ) -> impl Iterator<Item = [Vec3; 3]> {
        let topology = self.surface.topology();
        let corners = |t| topology.triangle(t).map(|v| self.surface.rest_position(v));
        topology
            .triangles()
            .filter(move |&t| is_meant(t))
            .map(corners)
    }

    /// Returns the second largest piece, as a part of the body; `None` for one piece.
    pub(super) fn second_piece(&self) -> Option<f64> {
        let surface = &self.surface;
        let size = |piece: u32| {
            let own = surface.topology().triangles();
            let own = own.filter(|&t| surface.piece(t) == piece);
            match self.is_sheet {
                true => own.count() as f64,
                false => surface.rest_volume_of(own),
            }
        };
        let used = (0..surface.piece_bound()).filter(|&piece| surface.piece_triangles(piece) > 0);
        let mut sizes: Vec<f64> = used.map(size).collect();
        sizes.sort_unstable_by(|a, b| b.total_cmp(a));
        sizes
            .get(1)
            .map(|second| second / sizes.iter().sum::<f64>())
    }

    /// Returns name and message of the first broken invariant, unless the stroke panicked.
    pub(super) fn defect(&self) -> Option<(&'static str, String)> {
        let surface = &self.surface;
        if surface.topology().triangle_count() == 0 {
            return None;
        }
        let valid = match self.is_sheet {
            true => surface.validate(),
            false => surface.validate_closed(),
        };
        if let Err(error) = valid {
            return Some(("InvalidSurface", error.to_string()));
        }
        let volume = surface.rest_volume_of(surface.topology().triangles());
        let change = volume / self.volume - 1.0;
        let is_kept = change.abs() <= MAX_VOLUME_CHANGE || self.is_sheet || !self.is_at_rest;
        (!is_kept).then(|| ("VolumeChanged", format!("by {change:.1e} of it")))
    }
}
