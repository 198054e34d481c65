//! One cut from sweep to delta.

use crate::bvh::Bvh;
use crate::error::CutError;
use crate::exact::Exact;
use crate::params::{CutMethod, CutParams};
use crate::rebuild::rebuild;
use crate::sweep::Sweep;
use incise_mesh::{Surface, TopologyDelta, TriangleId, Undo, UndoError};
use incise_refine::Section;
use std::time::{Duration, Instant};

/// By how much the largest coordinate of a sweep may be larger than the body's. Differences between the two, which
/// are numbers of 53 bits, then still have all that a coordinate of 24 bits has.
const FARTHEST: f64 = (1u64 << 29) as f64;

/// What a cut found, did and cost.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CutReport {
    /// Triangles that the search tree offered.
    pub candidates: usize,
    /// Triangles that the sweep crosses.
    pub hits: usize,
    /// Closed loops of the cross-section.
    pub loops: usize,
    /// The exact method: vertices of the surface that were taken into the rim.
    pub snapped_vertices: usize,
    /// The exact method: intersection points that were merged into others.
    pub merged_nodes: usize,
    /// The exact method: edges around the rim that remeshing flipped.
    pub flipped_edges: usize,
    /// The exact method: vertices beside the rim that remeshing contracted onto others.
    pub collapsed_vertices: usize,
    /// The exact method: intersection points that remeshing merged into others.
    pub collapsed_nodes: usize,
    /// The exact method: no point of the surface was moved farther by remeshing, nor is any point of the
    /// new surface farther from the old \[m\].
    pub moved_surface: f64,
    /// The exact method: volume that snapping and remeshing moved from one side of the sweep to the other or
    /// off the body, without sign \[m^3\].
    pub moved_volume: f64,
    /// The exact method: rim edges that stay shorter than snapping asks for, since the surface would not
    /// stay what it is else.
    pub short_rim_edges: usize,
    /// The paper's method: sides of loops for which its boundary would not have been a manifold, so that
    /// hit triangles were cut along the sweep instead.
    pub strict_lips: usize,
    /// Whether every cap reached its edge length.
    pub refined: bool,
    /// Time of the search and of the intersection.
    pub detection: Duration,
    /// Time of the new boundary and of the edit of the mesh.
    pub split: Duration,
    /// Time of remeshing around the rim.
    pub remeshing: Duration,
    /// Time of triangulating the caps.
    pub cap: Duration,
    /// Time of refining the caps.
    pub refinement: Duration,
    /// Time of finding the pieces.
    pub separation: Duration,
    /// Time of deriving the delta and the way back.
    pub commit: Duration,
    /// Time of bringing the search tree up to date.
    pub search_tree: Duration,
}

impl CutReport {
    /// Time of everything.
    #[must_use]
    pub fn total(&self) -> Duration {
        self.detection
            + self.split
            + self.remeshing
            + self.commit
            + self.cap
            + self.refinement
            + self.separation
            + self.search_tree
    }
}

/// What a cut changed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CutOutcome {
    /// The change; empty when the sweep missed.
    pub delta: TopologyDelta,
    /// The triangles of the caps.
    pub cap: Vec<TriangleId>,
    /// Takes the cut back; none when the sweep missed.
    pub undo: Option<Undo>,
    /// What it cost.
    pub report: CutReport,
}

/// Cuts one surface again and again: its search tree and the memory of a query.
#[derive(Debug, Clone, Default)]
pub struct Cutter {
    bvh: Bvh,
    candidates: Vec<TriangleId>,
    exact: Exact,
}

impl Cutter {
    /// A cutter for `surface`. O(n log n).
    #[must_use]
    pub fn new(surface: &Surface) -> Self {
        Self {
            bvh: Bvh::build(surface),
            ..Self::default()
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

    /// The cross-section of the last cut of the exact method, laid flat, and how long edges were to get at
    /// its points \[m\]: what both of its caps cover. Empty before the first.
    #[must_use]
    pub fn section(&self) -> (Section<'_>, &[f64]) {
        self.exact.section()
    }

    /// The search tree.
    #[must_use]
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// Takes a cut back, see [`Undo::revert`]; the search tree follows. Returns the change.
    ///
    /// # Errors
    /// [`UndoError`]; nothing is changed then.
    pub fn undo(&mut self, surface: &mut Surface, undo: Undo) -> Result<TopologyDelta, UndoError> {
        let delta = undo.revert(surface)?;
        self.bvh.update(surface, &delta);
        Ok(delta)
    }

    /// Refuses a sweep whose corners are too far out for the body to be cut where they say.
    fn check_reach(&self, sweep: &Sweep) -> Result<(), CutError> {
        let bounds = self.bvh.bounds();
        let coordinates = bounds.min.iter().chain(&bounds.max);
        let largest = coordinates.fold(0.0, |m, x| f64::from(x.abs()).max(m));
        for (corner, p) in sweep.corners().iter().enumerate() {
            let reach = p.iter().fold(0.0, |m, x| f64::from(x.abs()).max(m));
            if reach > FARTHEST * largest {
                let times = reach / largest;
                return Err(CutError::SweepTooLarge { corner, times });
            }
        }
        Ok(())
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
        if !(0.0..0.5).contains(&params.snap) {
            return Err(CutError::SnapOutOfRange { snap: params.snap });
        }
        if !(0.0..0.5).contains(&params.remesh) {
            let remesh = params.remesh;
            return Err(CutError::RemeshOutOfRange { remesh });
        }
        let begin = Instant::now();
        self.candidates.clear();
        self.bvh.query(surface, sweep, &mut self.candidates);
        if let Some(piece) = params.only_piece {
            self.candidates.retain(|&t| surface.piece(t) == piece);
        }
        if !self.candidates.is_empty() {
            self.check_reach(sweep)?;
        }
        let mut outcome = CutOutcome::default();
        outcome.report.candidates = self.candidates.len();
        outcome.report.detection = begin.elapsed();
        let candidates = &mut self.candidates;
        match params.method {
            CutMethod::Exact => {
                (self.exact).cut(surface, sweep, params, candidates, &mut outcome)?
            }
            CutMethod::Rebuild => rebuild(surface, sweep, params, candidates, &mut outcome)?,
        }
        if !outcome.delta.is_empty() {
            let begin = Instant::now();
            self.bvh.update(surface, &outcome.delta);
            outcome.report.search_tree = begin.elapsed();
        }
        Ok(outcome)
    }
}
