//! Incisions: sweeps that end inside a body, and blades that move on from the tip of such a cut.

use super::Cutter;
use crate::error::CutError;
use crate::incision::{Approach, Extent, Incision, Step, StepSweep, motion_scale};
use crate::intersection::continued_tip::ContinuedTip;
use crate::intersection::facets::EdgeKind;
use crate::intersection::trace::Outside;
use crate::outcome::CutOutcome;
use crate::params::CutParams;
use crate::search::Search;
use crate::sweep::Sweep;
use incise_mesh::{Surface, index_u32};

/// Rises of the sweep beside a tip, tried in order [local edge lengths].
///
/// The first step that can be cut and starts outside of the body is taken. Sweeps along the whole
/// blade come first, sweeps that end beside the tip follow.
///
/// A high one keeps clear of a curved surface, a low one of another part of the body nearby.
/// At 0 the sweep goes back to the blade's last pose.
const RISES: [f64; 5] = [1.0, 0.25, 0.0625, 0.015_625, 0.0];

/// Displacements tried in turn until a step can be cut and its tip does not end on a mesh edge
/// [local edge lengths].
const DISPLACEMENTS: [f64; 4] = [0.0, 1e-3, -1e-3, 1e-2];

/// Minimum [`Continuation::clearance`] of the first round of displacements; the second accepts any.
const MIN_CLEARANCE: f64 = 2e-4;

/// The end of an earlier cut at which a sweep goes on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Continuation<'a> {
    pub(super) tip: &'a ContinuedTip,
    /// Minimum distance of the new ends from mesh edges, see `Trace::end_clearance`.
    pub(super) clearance: f64,
    pub(super) outside: Outside,
}

/// The parameters of an attempt to cut a step.
#[derive(Debug, Clone, Copy)]
struct Attempt {
    extent: Extent,
    /// Whether the blade's previous edge may pierce the surface.
    ///
    /// Not beside a tip: the sweep would cut a second slit and leave a bridge to the first.
    may_start_inside: bool,
}

/// Returns the attempts to cut a step, in order, from a tip or without one.
fn attempts(has_tip: bool, is_entry_at_rest: bool) -> Vec<Attempt> {
    let attempt = |rise, is_bounded, may_start_inside| Attempt {
        extent: Extent { rise, is_bounded },
        may_start_inside,
    };
    if has_tip {
        let [wide, bounded] = [false, true].map(|is_bounded| {
            let rises = RISES
                .into_iter()
                .filter(move |&rise| rise > 0.0 || !is_bounded);
            rises.map(move |rise| attempt(rise, is_bounded, false))
        });
        return wide.chain(bounded).collect();
    }
    // A blade without a tip has nothing beside which it could rise.
    let at_rest = [false, true].map(|is_bounded| attempt(0.0, is_bounded, false));
    let at_rest = at_rest.into_iter().filter(|_| is_entry_at_rest);
    at_rest.chain([attempt(0.0, false, true)]).collect()
}

impl Cutter {
    /// Cuts `surface` along `sweep`, which may end inside the body: an incision.
    ///
    /// The surface is slit along the sweep and gets two mirrored walls, which share the vertices of
    /// the slit's ends and of the incision's tip and coincide at first. Where the sweep does not
    /// end inside the body this is [`Self::cut`]. Where it would end on a mesh edge, it ends up to
    /// a hundredth of an edge beside it.
    ///
    /// # Errors
    /// [`CutError`]; [`CutError::PartialCut`] if the sweep's boundary lies inside the body as a
    /// whole. The surface is then bit for bit what it was.
    pub fn incise(
        &mut self,
        surface: &mut Surface,
        sweep: &Sweep,
        params: &CutParams,
    ) -> Result<CutOutcome, CutError> {
        let (tip, outside) = (ContinuedTip::default(), Outside::default());
        let outcome = self.try_displaced(surface, sweep, params, &tip, outside);
        outcome.map(|(outcome, _)| outcome)
    }

    /// Moves a blade on: cuts `surface` from the tip of `incision` to the blade's new pose \[m\].
    ///
    /// The first call only takes the pose. Where the blade ended inside the body, the next call
    /// goes on at the tip's present vertices, so the body may move in between. A motion of less
    /// than half an edge length is a miss and adds up. Where a step is impossible with the blade
    /// exactly there, the blade is displaced by up to a hundredth of an edge. When the tip leaves
    /// the body, the separated parts become pieces. A blade with a different number of points
    /// starts a new incision. After a solver has set the rest positions of new vertices, call
    /// [`Incision::follow_rest`].
    ///
    /// # Errors
    /// [`CutError`]; the surface is then bit for bit what it was. The incision keeps its tip, from
    /// which the next step is tried, see [`IncisionState::Blocked`](crate::IncisionState::Blocked).
    /// Call [`Incision::restart`] to go on from another pose.
    pub fn advance(
        &mut self,
        surface: &mut Surface,
        incision: &mut Incision,
        blade: &[[f32; 3]],
        params: &CutParams,
    ) -> Result<CutOutcome, CutError> {
        let is_fitted = self.is_fitted(surface);
        self.check_surface(surface, is_fitted)?;
        let sheets = self.sheets(surface);
        let mut scan = std::mem::take(&mut self.scan);
        let mut search = Search::new(&self.bvh, &mut scan, is_fitted);
        let begun = incision.begin_step(surface, blade, &mut search, &sheets);
        self.scan = scan;
        let Some(approach) = begun? else {
            return Ok(CutOutcome::default());
        };
        let result = self.step_in_shape(surface, incision, &approach, blade, params);
        if result.is_err() {
            incision.refuse(approach, blade);
        }
        result
    }

    /// Cuts from the tip of `incision` to a new pose, in the rest shape if the body is deformed.
    fn step_in_shape(
        &mut self,
        surface: &mut Surface,
        incision: &mut Incision,
        approach: &Approach,
        blade: &[[f32; 3]],
        params: &CutParams,
    ) -> Result<CutOutcome, CutError> {
        if approach.map.is_identity() {
            return self.step(surface, incision, approach, blade, params);
        }
        let defers_bvh = std::mem::replace(&mut self.defers_bvh, true);
        let result = surface
            .with_shapes_exchanged(|surface| self.step(surface, incision, approach, blade, params));
        self.defers_bvh = defers_bvh;
        let mut outcome = result?;
        if let Some(undo) = &mut outcome.undo {
            undo.exchange_shapes(surface);
            incision.follow_rest(surface);
            if !defers_bvh {
                self.update_bvh(surface, &outcome.delta);
            }
        }
        Ok(outcome)
    }

    /// Cuts from the tip of `incision` to a new pose, in the shape in which the positions are.
    fn step(
        &mut self,
        surface: &mut Surface,
        incision: &mut Incision,
        approach: &Approach,
        blade: &[[f32; 3]],
        params: &CutParams,
    ) -> Result<CutOutcome, CutError> {
        let is_entry_at_rest = !incision.is_inside() && !approach.map.is_identity();
        let mut first = None;
        for attempt in attempts(incision.is_inside(), is_entry_at_rest) {
            let uses_bvh = approach.map.is_identity() && self.is_fitted(surface);
            let mut search = Search::new(&self.bvh, &mut self.scan, uses_bvh);
            let extent = attempt.extent;
            let stroke = incision.step_sweep(surface, approach, blade, extent, &mut search)?;
            let Some(stroke) = stroke else { break };
            let StepSweep { sweep, tip, .. } = &stroke;
            let outside = Outside {
                previous: !attempt.may_start_inside,
                ribs: stroke.ends_outside,
            };
            match self.try_displaced(surface, sweep, params, tip, outside) {
                Err(error) if is_retried(&error, tip) => first = first.or(Some(error)),
                result => {
                    let (outcome, taken) = result?;
                    if !outcome.is_miss() {
                        let taken = if approach.map.is_identity() {
                            Some(taken)
                        } else {
                            stroke.present
                        };
                        let (facets, trace) = (&self.facets, &self.trace);
                        let parameters = &stroke.parameters;
                        let tip_along =
                            |side| self.exact.tip(surface, facets, trace, parameters, side);
                        let tip = tip_along(EdgeKind::Current);
                        // The previous edge of a step from a tip is that tip.
                        let is_entry = !incision.is_inside();
                        let start = is_entry.then(|| tip_along(EdgeKind::Previous));
                        let copies = |v| self.exact.copies(trace, v);
                        let step = Step {
                            local: motion_scale(surface, trace.max_local()),
                            approach,
                            borders: self.exact.borders(facets, &tip),
                            start: start.unwrap_or_default(),
                        };
                        incision.open_path(&step, copies, self.exact.rim_moves());
                        incision.finish_step(blade, tip, taken, &step);
                    } else if !incision.is_inside() {
                        incision.move_without_cut(blade);
                    }
                    return Ok(outcome);
                }
            }
        }
        first.map_or(Ok(CutOutcome::default()), Err)
    }

    /// Cuts along a sweep that goes on from `tip`, or along the first displaced one that can be
    /// cut, see [`DISPLACEMENTS`]. Returns that sweep as well.
    fn try_displaced(
        &mut self,
        surface: &mut Surface,
        sweep: &Sweep,
        params: &CutParams,
        tip: &ContinuedTip,
        outside: Outside,
    ) -> Result<(CutOutcome, Sweep), CutError> {
        let mut first = None;
        for clearance in [MIN_CLEARANCE, 0.0] {
            for displacement in DISPLACEMENTS {
                let taken = if displacement == 0.0 {
                    sweep.clone()
                } else {
                    let hits = self.candidates.iter().copied();
                    let length = displacement * surface.mean_edge_length_of(hits);
                    let count = sweep.current().len();
                    sweep.displaced(length, |i| tip.has_corner(index_u32(count + i)))?
                };
                let from = Continuation {
                    tip,
                    clearance,
                    outside,
                };
                match self.cut_along(surface, &taken, params, Some(from)) {
                    Err(error) if is_retried(&error, tip) => first = first.or(Some(error)),
                    result => return result.map(|outcome| (outcome, taken)),
                }
            }
        }
        Err(first.unwrap_or(CutError::OpenSection))
    }
}

/// Returns whether another sweep beside the refused one may be possible.
///
/// A sweep that goes on from a tip cannot lie in the body as a whole. It may seem so where it
/// passes a vertex or an edge.
fn is_retried(error: &CutError, tip: &ContinuedTip) -> bool {
    match error {
        CutError::TipBlocked { .. } | CutError::OpenSection | CutError::NotManifold { .. } => true,
        CutError::PartialCut { .. } => !tip.parts.is_empty(),
        _ => false,
    }
}
