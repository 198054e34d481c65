//! [`Cutter`]: cuts a surface along sweeps and keeps its BVH.

mod advance;
mod fit;

use crate::curves::Curves;
use crate::error::CutError;
use crate::exact::{Exact, has_walls};
use crate::intersection::Intersection;
use crate::intersection::continued_tip::ContinuedTip;
use crate::intersection::facets::Facets;
use crate::intersection::trace::{Curve, Trace};
use crate::outcome::CutOutcome;
use crate::params::{Caps, CutParams};
use crate::separate::Separator;
use crate::sweep::Sweep;
use advance::Continuation;
use fit::{PendingEdits, SurfaceVersion};
use incise_mesh::{BoxScan, Bvh, Edit, Surface, TriangleId, Vec3};
use incise_refine::Section;
use smallvec::SmallVec;
use std::num::NonZeroUsize;
use web_time::Instant;

/// Maximum ratio of the largest coordinates of a sweep and of the body.
///
/// Differences in 53 bits then keep all 24 bits of the body's coordinates.
const MAX_SWEEP_RATIO: f64 = (1u64 << 29) as f64;

/// Minimum number of triangles of a body for a cut on two threads.
const MIN_SHARED: usize = 1 << 14;

/// Cuts one surface repeatedly: its BVH and scratch memory.
///
/// Vertices may move between cuts: triangles near a sweep are then found by passes over the surface
/// instead of the BVH. [`Self::refit`] fits the BVH again, which is worth its time before more than
/// a few cuts or other queries at the same positions. Call it after an edit by anything else than
/// the cutter. Results do not depend on it.
///
/// With the feature `serde`, `finish_load` must follow its `Deserialize`.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Cutter {
    bvh: Bvh,
    /// The state of the surface that the BVH fits.
    version: SurfaceVersion,
    /// Edits of the surface after it had moved, which the BVH follows in the next refit.
    #[cfg_attr(feature = "serde", serde(skip))]
    pending: Option<PendingEdits>,
    #[cfg_attr(feature = "serde", serde(skip))]
    scan: BoxScan,
    #[cfg_attr(feature = "serde", serde(skip))]
    candidates: Vec<TriangleId>,
    #[cfg_attr(feature = "serde", serde(skip))]
    facets: Facets,
    #[cfg_attr(feature = "serde", serde(skip))]
    trace: Trace,
    exact: Exact,
    #[cfg_attr(feature = "serde", serde(skip))]
    separator: Separator,
    /// Whether the surface may have a boundary, so that it must be asked which pieces are sheets.
    has_sheets: bool,
    /// Whether the surface has walls of incisions, so that cuts are checked.
    has_walls: bool,
    /// Whether cuts leave the update of the BVH to [`Cutter::update_bvh`].
    #[cfg_attr(feature = "serde", serde(skip))]
    defers_bvh: bool,
    /// See [`Cutter::set_threads`].
    #[cfg_attr(feature = "serde", serde(skip, default = "one_thread"))]
    threads: Option<NonZeroUsize>,
}

/// Returns the default of [`Cutter::set_threads`].
const fn one_thread() -> Option<NonZeroUsize> {
    Some(NonZeroUsize::MIN)
}

impl Cutter {
    /// Builds the BVH of `surface`. O(n log n).
    #[must_use]
    pub fn new(surface: &Surface) -> Self {
        Self {
            bvh: Bvh::build(surface),
            version: SurfaceVersion::new(surface),
            pending: None,
            scan: BoxScan::default(),
            candidates: Vec::new(),
            facets: Facets::default(),
            trace: Trace::default(),
            exact: Exact::default(),
            separator: Separator::default(),
            has_sheets: !surface.topology().is_closed(),
            has_walls: has_walls(surface),
            defers_bvh: false,
            threads: one_thread(),
        }
    }

    /// Sets whether cuts defer the update of the BVH to [`Self::update_bvh`].
    ///
    /// The caller must then call it after each cut, for example in parallel with other work.
    pub fn set_defers_bvh(&mut self, defers_bvh: bool) {
        self.defers_bvh = defers_bvh;
    }

    /// Returns whether cuts defer the update of the BVH, see [`Self::set_defers_bvh`].
    #[must_use]
    pub fn defers_bvh(&self) -> bool {
        self.defers_bvh
    }

    /// Sets the maximum number of threads of a cut; the default is one.
    ///
    /// `None` allows the current rayon pool, and one uses no pool. At most two threads share a cut,
    /// of a body of at least 16,384 triangles. Results do not depend on it.
    pub fn set_threads(&mut self, threads: Option<NonZeroUsize>) {
        self.threads = threads;
    }

    /// Returns whether two threads share a cut of `surface`.
    fn is_shared(&self, surface: &Surface) -> bool {
        surface.topology().triangle_count() >= MIN_SHARED
            && self.threads.is_none_or(|threads| threads.get() > 1)
            && rayon::current_num_threads() > 1
    }

    /// Iterates over the cross-sections of the last cut and their target edge lengths \[m\].
    ///
    /// There is one for each triangle of the sweep that has any, with a length per point. Both caps
    /// cover it. Nothing before the first cut and in sheets.
    pub fn sections(&self) -> impl Iterator<Item = (Section<'_>, &[f64])> {
        self.exact.sections()
    }

    /// Checks that rounding of the sweep's corners does not move the cut.
    ///
    /// `largest` is the body's largest coordinate \[m\].
    fn check_sweep_size(sweep: &Sweep, largest: f64) -> Result<(), CutError> {
        for (corner, p) in sweep.points().iter().enumerate() {
            let reach = p.iter().fold(0.0, |m, x| f64::from(x.abs()).max(m));
            if reach > MAX_SWEEP_RATIO * largest {
                let times = reach / largest;
                return Err(CutError::SweepTooLarge { corner, times });
            }
        }
        Ok(())
    }

    /// Cuts `surface` along `sweep`, which passes through the body as a whole.
    ///
    /// A sweep that misses changes nothing, see [`CutOutcome::is_miss`], and allocates nothing once
    /// warm.
    ///
    /// # Errors
    /// [`CutError`], also [`CutError::PartialCut`] for a sweep that ends inside the body; the
    /// surface is then bit for bit what it was.
    pub fn cut(
        &mut self,
        surface: &mut Surface,
        sweep: &Sweep,
        params: &CutParams,
    ) -> Result<CutOutcome, CutError> {
        self.cut_along(surface, sweep, params, None)
    }

    fn cut_along(
        &mut self,
        surface: &mut Surface,
        sweep: &Sweep,
        params: &CutParams,
        from: Option<Continuation<'_>>,
    ) -> Result<CutOutcome, CutError> {
        params.check()?;
        if from.is_none() {
            if let Some(outcome) = self.try_cut(surface, sweep, params, from, true)? {
                return Ok(outcome);
            }
            // A neck without width is none where ties are broken the other way.
            self.facets.reverses_ties = true;
            let reversed = self.try_cut(surface, sweep, params, from, true);
            self.facets.reverses_ties = false;
            if let Ok(Some(outcome)) = reversed
                && !outcome.is_miss()
            {
                return Ok(outcome);
            }
        }
        let outcome = self.try_cut(surface, sweep, params, from, false)?;
        Ok(outcome.expect("necks are allowed"))
    }

    /// Cuts `surface`; `None` where the section has necks without width, unless they are allowed.
    /// The surface is then unchanged.
    fn try_cut(
        &mut self,
        surface: &mut Surface,
        sweep: &Sweep,
        params: &CutParams,
        from: Option<Continuation<'_>>,
        stops_at_necks: bool,
    ) -> Result<Option<CutOutcome>, CutError> {
        let begin = Instant::now();
        let none = ContinuedTip::default();
        let tip = from.map_or(&none, |from| from.tip);
        self.find_curves(surface, sweep, params.only_piece, tip)?;
        if let Some(triangle) = self.trace.open_end(surface) {
            let Some(from) = from else {
                return Err(CutError::PartialCut { triangle });
            };
            if self.trace.end_clearance() < from.clearance {
                return Err(CutError::TipBlocked { triangle });
            }
            let inside = self.trace.end_outside(surface, &self.facets, from.outside);
            if let Some(triangle) = inside {
                return Err(CutError::TipBlocked { triangle });
            }
        }
        let mut outcome = CutOutcome::default();
        outcome.report.candidates = self.candidates.len();
        outcome.report.hits = self.trace.hits();
        let has_end = |curve: &&Curve| self.trace.has_end(curve);
        outcome.report.slits = self.trace.curves.iter().filter(has_end).count();
        outcome.report.loops = self.trace.curves.len() - outcome.report.slits;
        if self.trace.curves.is_empty() {
            outcome.report.detection = begin.elapsed();
            return Ok(Some(outcome));
        }
        let is_sheet = self.sheets(surface);
        self.find_capped(surface, params.caps, &is_sheet);
        outcome.report.detection = begin.elapsed();
        let is_shared = self.is_shared(surface);
        let topology = self.known_topology();
        let is_fitted = self.is_fitted(surface);
        let (separator, outcome_mut) = (&mut self.separator, &mut outcome);
        let at = Intersection {
            bvh: (is_fitted && !tip.is_in_rest_shape()).then_some(&self.bvh),
            sweep,
            facets: &self.facets,
            trace: &self.trace,
            is_sheet: &is_sheet,
            may_share_walls: self.has_walls || outcome_mut.report.slits > 0,
            is_shared,
            stops_at_necks,
        };
        let done = (self.exact).cut(surface, at, params, separator, outcome_mut);
        // A cut that is taken back counts as an edit.
        self.set_topology(surface.fingerprint());
        if !done? {
            return Ok(None);
        }
        if !outcome.is_miss() {
            self.has_sheets |= params.caps == Caps::None;
            self.has_walls |= outcome.report.slits > 0;
            if self.defers_bvh {
                // The old version: a cut before `update_bvh` then fails.
                self.set_topology(topology);
            } else {
                let begin = Instant::now();
                self.update_bvh(surface, &outcome.delta);
                outcome.report.bvh_update = begin.elapsed();
            }
        }
        Ok(Some(outcome))
    }

    /// Finds the intersection curves of a sweep and the surface, which stays as it is.
    ///
    /// They preview a cut of `only_piece` or of all pieces, and are the input of other methods to
    /// cut. The sweep may end inside the body.
    ///
    /// # Errors
    /// [`CutError`] as of [`Self::cut`], for the surface, the sweep and coordinates.
    pub fn intersect(
        &mut self,
        surface: &Surface,
        sweep: &Sweep,
        only_piece: Option<u32>,
    ) -> Result<Curves<'_>, CutError> {
        self.find_curves(surface, sweep, only_piece, &ContinuedTip::default())?;
        let is_sheet = self.sheets(surface);
        Ok(Curves::new(&self.trace, self.candidates.len(), is_sheet))
    }

    /// Gives each part that an edit along `sweep` has separated a piece number of its own.
    ///
    /// `seeds` has a triangle of each part. Of the parts of a piece the largest keeps the number;
    /// of equals, the one with the first triangle. The largest part is not traversed as a whole.
    pub fn number_parts(&mut self, edit: &mut Edit<'_>, sweep: &Sweep, seeds: &[TriangleId]) {
        if !seeds.is_empty() {
            self.separator.find_parts(edit.surface(), sweep, seeds, &[]);
            self.separator.number_parts(edit);
        }
    }

    /// Finds the curves along `sweep`, which goes on from `tip`.
    fn find_curves(
        &mut self,
        surface: &Surface,
        sweep: &Sweep,
        only_piece: Option<u32>,
        tip: &ContinuedTip,
    ) -> Result<(), CutError> {
        let uses_bvh = self.is_fitted(surface) && !tip.is_in_rest_shape();
        let largest = self.check_surface(surface, uses_bvh)?;
        self.candidates.clear();
        if uses_bvh {
            (self.bvh).query(surface, sweep.triangles(), &mut self.candidates);
            let corners: SmallVec<[[Vec3; 3]; 2]> = sweep.triangles().collect();
            // Displacements depend on the candidates, which must not depend on the BVH.
            BoxScan::retain_hull(surface, corners.as_flattened(), &mut self.candidates);
        } else {
            (self.scan).query_triangles(surface, sweep.triangles(), &mut self.candidates);
        }
        if let Some(piece) = only_piece {
            self.candidates.retain(|&t| surface.piece(t) == piece);
        }
        if !self.candidates.is_empty() {
            Self::check_sweep_size(sweep, largest)?;
        }
        self.facets.read(sweep, tip);
        (self.trace).find(surface, &self.facets, &mut self.candidates)
    }

    /// Returns whether each piece is a sheet, or nothing if none is.
    fn sheets(&self, surface: &Surface) -> Vec<bool> {
        if self.has_sheets {
            surface.open_pieces()
        } else {
            Vec::new()
        }
    }

    /// Finds the curves that bound sections with caps.
    fn find_capped(&mut self, surface: &Surface, caps: Caps, is_sheet: &[bool]) {
        self.trace.set_capped(surface, |piece, is_closed| {
            let is_body = is_sheet.get(piece as usize) != Some(&true);
            match caps {
                Caps::Bodies => is_body,
                Caps::AllLoops => is_body || is_closed,
                Caps::None => false,
            }
        });
    }
}
