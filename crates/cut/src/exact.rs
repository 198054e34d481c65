//! The exact method: hit triangles are split along the sweep, so that no surface is lost.
//!
//! 1. [`trace`]: where the sweep meets the surface, by exact [`signs`].
//! 2. [`split`] and [`open`]: hit triangles in parts, two lips along every curve.
//! 3. [`snap`]: rim edges that are much shorter than the surface's own are contracted.
//! 4. [`remesh`]: if asked for, slivers around the rim go where the surface hardly moves for that.
//! 5. [`cap`]: the cross-section, laid flat by [`unfold`], is covered once and closes both lips; what that is
//!    in the body at rest is found by [`rest`].
//! 6. [`separate`]: what is no longer connected gets piece numbers of its own.
//!
//! All of it is one [`incise_mesh::Edit`], which restores every byte if any step fails. Time is
//! O(k log k) for k triangles hit and made, and for separation the triangles of all parts but the largest.

mod cap;
mod chart;
mod contract;
mod node;
mod open;
mod remesh;
mod rest;
mod rim;
mod separate;
mod signs;
mod snap;
mod split;
mod touch;
mod trace;
mod unfold;

use crate::cutter::CutOutcome;
use crate::error::CutError;
use crate::inside::starts_inside;
use crate::params::CutParams;
use crate::sweep::Sweep;
use cap::{Cap, Rims};
use contract::Opened;
use incise_mesh::{Surface, TriangleId};
use incise_refine::Section;
use open::Lips;
use remesh::Remesher;
use rim::Rim;
use separate::Separator;
use signs::Signs;
use snap::Snapper;
use split::Splitter;
use std::time::Instant;
use trace::Trace;
use unfold::Unfold;

/// Memory that serves one cut after the other.
#[derive(Debug, Clone, Default)]
pub(crate) struct Exact {
    trace: Trace,
    splitter: Splitter,
    lips: Lips,
    rim: Rim,
    snapper: Snapper,
    remesher: Remesher,
    cap: Cap,
    separator: Separator,
}

impl Exact {
    /// The section of the last cut and the target lengths at its points.
    pub(crate) fn section(&self) -> (Section<'_>, &[f64]) {
        self.cap.section()
    }

    /// Cuts `surface` along `sweep`. See the module.
    ///
    /// # Errors
    /// [`CutError`]; the surface is then bit for bit what it was.
    pub(crate) fn cut(
        &mut self,
        surface: &mut Surface,
        sweep: &Sweep,
        params: &CutParams,
        candidates: &mut Vec<TriangleId>,
        outcome: &mut CutOutcome,
    ) -> Result<(), CutError> {
        let begin = Instant::now();
        let signs = Signs::new(sweep);
        self.trace.find(surface, &signs, candidates)?;
        if let Some(triangle) = self.trace.open_end {
            return Err(CutError::PartialCut { triangle });
        }
        let report = &mut outcome.report;
        report.hits = self.trace.hits();
        report.loops = self.trace.loops.len();
        report.detection += begin.elapsed();
        if self.trace.loops.is_empty() {
            return Ok(());
        }
        params.refine.check()?;
        let is_done = self.split(surface, sweep, &signs, params, true, outcome)?
            || self.split(surface, sweep, &signs, params, false, outcome)?;
        debug_assert!(is_done, "without merged nodes the loops are what they were");
        Ok(())
    }

    /// Splits the surface along the trace. False when remeshing, which merges nodes if it `may_merge`, has made
    /// loops touch or cross others or no longer do so, so that their caps would join pieces that were apart; the
    /// surface is then bit for bit what it was.
    fn split(
        &mut self,
        surface: &mut Surface,
        sweep: &Sweep,
        signs: &Signs,
        params: &CutParams,
        may_merge: bool,
        outcome: &mut CutOutcome,
    ) -> Result<bool, CutError> {
        let begin = Instant::now();
        let report = &mut outcome.report;
        let mut edit = surface.edit();
        let is_valley = signs.is_valley;
        (self.lips).open(&mut edit, &self.trace, is_valley, &mut self.splitter);
        self.rim.reset(&self.trace);
        let mut opened = Opened {
            edit: &mut edit,
            nodes: &self.trace.nodes,
            lips: &mut self.lips,
            rim: &mut self.rim,
        };
        let unfold = Unfold::new(signs);
        let (area, rim_length) = self.trace.section_size(&unfold);
        // A disc's width so is its radius; a number that is none where all is one point.
        let width = 2.0 * area / rim_length;
        let budget = snap::BUDGET * area * self.trace.mean_local().min(width);
        let snapped = self.snapper.snap(&mut opened, params.snap, budget);
        report.snapped_vertices = snapped.vertices;
        report.merged_nodes = snapped.nodes;
        report.moved_volume = snapped.volume;
        report.split = begin.elapsed();
        let begin = Instant::now();
        let may_join = may_merge && params.remesh > 0.0 && self.trace.loops.len() > 1;
        let groups = if may_join {
            let rims = Rims {
                nodes: &self.trace.nodes,
                lips: opened.lips,
                rim: opened.rim,
                unfold: &unfold,
                has_crease: signs.has_crease(),
            };
            self.cap.flatten(&rims, &params.refine);
            let topology = opened.edit.surface().topology();
            Some(self.cap.groups(&rims, topology, &params.refine)?)
        } else {
            None
        };
        let remeshed = (self.remesher).remesh(&mut opened, params.remesh, width, may_merge);
        report.flipped_edges = remeshed.flips;
        report.collapsed_vertices = remeshed.vertices;
        report.moved_volume += remeshed.volume;
        report.collapsed_nodes = remeshed.nodes;
        report.moved_surface = remeshed.distance;
        report.short_rim_edges = Snapper::short_edges(&opened, params.snap);
        report.remeshing = begin.elapsed();
        let begin = Instant::now();
        let rims = Rims {
            nodes: &self.trace.nodes,
            lips: &self.lips,
            rim: &self.rim,
            unfold: &unfold,
            has_crease: signs.has_crease(),
        };
        self.cap.flatten(&rims, &params.refine);
        let triangles = edit.surface().topology().triangle_count();
        let is_inside = || starts_inside(edit.surface(), sweep);
        if self.cap.ends_inside(triangles, is_inside) {
            let triangle = self.trace.chords[0].triangle;
            return Err(CutError::PartialCut { triangle });
        }
        let topology = edit.surface().topology();
        let cover = self.cap.cover(&rims, topology, &params.refine)?;
        // A disc has no inner points.
        report.refined = cover.report.discs == 0 && cover.report.unfinished == 0;
        self.cap.join_loops(&cover);
        if remeshed.nodes > 0 && groups.is_some_and(|groups| groups != self.cap.groups_joined()) {
            return Ok(false);
        }
        report.cap = begin.elapsed();
        let begin = Instant::now();
        // Lip 0 of a loop has an even number, lip 1 the next.
        let lips = self.rim.first.iter();
        let lips = lips.flat_map(|&node| self.lips.rim[node as usize]);
        let joined = self.cap.joined();
        let joined = joined.flat_map(|(a, b)| [(2 * a, 2 * b), (2 * a + 1, 2 * b + 1)]);
        (self.separator).separate(&mut edit, sweep, lips, joined);
        report.separation = begin.elapsed();
        let begin = Instant::now();
        (self.cap).close(&mut edit, &rims, &cover, params.cap_material);
        report.cap += begin.elapsed();
        let begin = Instant::now();
        let (delta, undo) = edit.finish();
        outcome.delta = delta;
        outcome.undo = Some(undo);
        outcome.cap = self.cap.triangles.concat();
        report.commit = begin.elapsed();
        Ok(true)
    }
}
