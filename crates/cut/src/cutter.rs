//! One cut from sweep to delta.

use crate::bvh::Bvh;
use crate::crossing::Signs;
use crate::error::CutError;
use crate::params::{CutMethod, CutParams};
use crate::rebuild::rebuild;
use crate::separate::separate;
use crate::strip::trace;
use crate::sweep::Sweep;
use incise_mesh::{Surface, TopologyDelta, TriangleId};
use std::time::{Duration, Instant};

/// What a cut found, did and cost.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CutReport {
    /// Triangles that the search tree offered.
    pub candidates: usize,
    /// Triangles that the sweep crosses.
    pub hits: usize,
    /// Closed loops of the cross-section.
    pub loops: usize,
    /// Sides of loops for which the paper's boundary would not have been a manifold, so that hit
    /// triangles were cut along the sweep instead.
    pub strict_lips: usize,
    /// Whether every cap reached its edge length.
    pub refined: bool,
    /// Time of the search and of the intersection.
    pub detection: Duration,
    /// Time of the new boundary, of the edit of the mesh and of the search tree that follows it.
    pub topology: Duration,
    /// Time of triangulating and refining the caps.
    pub refinement: Duration,
}

/// What a cut changed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CutOutcome {
    /// The change; empty when the sweep missed.
    pub delta: TopologyDelta,
    /// The triangles of the caps.
    pub cap: Vec<TriangleId>,
    /// What it cost.
    pub report: CutReport,
}

/// Cuts one surface again and again: its search tree and the memory of a query.
#[derive(Debug, Clone, Default)]
pub struct Cutter {
    bvh: Bvh,
    candidates: Vec<TriangleId>,
}

impl Cutter {
    /// A cutter for `surface`. O(n log n).
    #[must_use]
    pub fn new(surface: &Surface) -> Self {
        Self {
            bvh: Bvh::build(surface),
            candidates: Vec::new(),
        }
    }

    /// Follows the surface's motion: call it before [`Self::cut`] when vertices have moved. O(n).
    pub fn refit(&mut self, surface: &Surface) {
        self.bvh.refit(surface);
    }

    /// Follows the motion of a few triangles: these must be all that moved since the last refit.
    /// O(m log n) for m of them.
    pub fn refit_moved(&mut self, surface: &Surface, triangles: &[TriangleId]) {
        self.bvh.refit_moved(surface, triangles);
    }

    /// The search tree.
    #[must_use]
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// Cuts `surface` along `sweep`. A sweep that misses changes nothing and is no error; the
    /// outcome's delta is empty then and nothing was allocated once warm.
    ///
    /// # Errors
    /// [`CutError`]; the surface is then bit for bit what it was.
    pub fn cut(
        &mut self,
        surface: &mut Surface,
        sweep: &Sweep,
        params: &CutParams,
    ) -> Result<CutOutcome, CutError> {
        let begin = Instant::now();
        self.candidates.clear();
        self.bvh.query(surface, sweep, &mut self.candidates);
        if let Some(piece) = params.only_piece {
            self.candidates.retain(|&t| surface.piece(t) == piece);
        }
        let mut outcome = CutOutcome::default();
        outcome.report.candidates = self.candidates.len();
        let signs = Signs::new(sweep);
        let strips = trace(surface, &signs, &mut self.candidates)?;
        outcome.report.detection = begin.elapsed();
        if strips.is_empty() {
            return Ok(outcome);
        }
        outcome.report.loops = strips.len();
        outcome.report.hits = strips.iter().map(|s| s.hits.len()).sum();
        let begin = Instant::now();
        // Asked before the edit: a piece of which nothing is left must be told, too.
        let mut pieces: Vec<u32> = strips
            .iter()
            .map(|strip| surface.piece(strip.hits[0].triangle))
            .collect();
        pieces.sort_unstable();
        pieces.dedup();
        match params.method {
            CutMethod::Rebuild => rebuild(surface, &strips, &signs, sweep, params, &mut outcome)?,
        }
        separate(surface, &pieces, &mut outcome.delta);
        self.bvh.update(surface, &outcome.delta);
        outcome.report.topology = begin.elapsed() - outcome.report.refinement;
        Ok(outcome)
    }
}
