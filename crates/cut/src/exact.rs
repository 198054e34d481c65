//! The exact method: splits hit triangles along the sweep, so that no surface is lost.
//!
//! 1. [`crate::intersection`] finds the closed curves along which the sweep crosses the surface.
//! 2. [`split`] and [`open`] split the hit triangles; every curve becomes a rim on two sides.
//! 3. [`snap`] contracts rim edges much shorter than the local edge length.
//! 4. [`remesh`], if asked for, removes slivers around the rim.
//! 5. [`unfold`] and [`section`] lay the cross-section flat, [`cap`] meshes it and closes both
//!    sides. [`rest`] interpolates rest positions inside caps.
//! 6. [`crate::separate`] gives separated parts piece numbers of their own.
//!
//! All of it is one [`incise_mesh::Edit`], which restores every byte if a step fails. Time is
//! O(k log k) for k triangles hit and made, plus all triangles of separated parts but the largest.

mod cap;
mod contract;
mod open;
mod remesh;
mod rest;
mod rim;
mod section;
mod snap;
mod split;
mod unfold;

use crate::blade_position::blade_starts_inside;
use crate::error::CutError;
use crate::intersection::Intersection;
use crate::outcome::CutOutcome;
use crate::params::{CutParams, ExactParams};
use crate::separate::Separator;
use cap::{Cap, Rims};
use contract::Opened;
use incise_mesh::{HalfEdge, Surface};
use incise_refine::Section;
use open::Sides;
use remesh::Remesher;
use rim::Rim;
use snap::Snapper;
use split::Splitter;
use std::time::Instant;
use unfold::Unfold;

/// Scratch memory, kept between cuts.
#[derive(Debug, Clone, Default)]
pub(crate) struct Exact {
    splitter: Splitter,
    sides: Sides,
    rim: Rim,
    snapper: Snapper,
    remesher: Remesher,
    cap: Cap,
}

impl Exact {
    /// Returns the cross-section of the last cut and the target edge length at each point.
    pub(crate) fn section(&self) -> (Section<'_>, &[f64]) {
        (self.cap.section.section(), self.cap.section.lengths())
    }

    /// Cuts `surface` along closed intersection curves. See the module.
    ///
    /// # Errors
    /// [`CutError`]; the surface is then bit for bit what it was.
    pub(crate) fn cut(
        &mut self,
        surface: &mut Surface,
        at: Intersection<'_>,
        params: &CutParams,
        exact: &ExactParams,
        separator: &mut Separator,
        outcome: &mut CutOutcome,
    ) -> Result<(), CutError> {
        params.refine.check()?;
        let is_done = self.split(surface, at, params, exact, true, separator, outcome)?
            || self.split(surface, at, params, exact, false, separator, outcome)?;
        debug_assert!(is_done, "without merged nodes the loops are what they were");
        Ok(())
    }

    /// Splits the surface along the curves; remeshing merges nodes if it `may_merge`.
    ///
    /// Returns false if merging made loops touch or cross others, or no longer do so. Their caps
    /// would join separate pieces. The surface is then bit for bit unchanged.
    #[expect(
        clippy::too_many_arguments,
        reason = "its only caller passes its own arguments on"
    )]
    fn split(
        &mut self,
        surface: &mut Surface,
        Intersection {
            sweep,
            signs,
            trace,
        }: Intersection<'_>,
        params: &CutParams,
        exact: &ExactParams,
        may_merge: bool,
        separator: &mut Separator,
        outcome: &mut CutOutcome,
    ) -> Result<bool, CutError> {
        let begin = Instant::now();
        let report = &mut outcome.report;
        let mut edit = surface.edit();
        let is_valley = signs.is_valley;
        (self.sides).open(&mut edit, trace, is_valley, &mut self.splitter);
        self.rim.reset(trace);
        let mut opened = Opened {
            edit: &mut edit,
            nodes: &trace.nodes,
            sides: &mut self.sides,
            rim: &mut self.rim,
        };
        let unfold = Unfold::new(signs);
        let (area, rim_length) = unfold.section_size(trace);
        // The radius of a disc; NaN if the section is a point.
        let width = 2.0 * area / rim_length;
        let max_volume = snap::MAX_TOTAL_VOLUME * area * trace.mean_local().min(width);
        let snapped = self.snapper.snap(&mut opened, exact.snap, max_volume);
        report.snapped_vertices = snapped.vertices;
        report.merged_nodes = snapped.nodes;
        report.moved_volume = snapped.volume;
        report.split = begin.elapsed();
        let begin = Instant::now();
        let may_join = may_merge && exact.remesh > 0.0 && trace.loops.len() > 1;
        let groups = if may_join {
            let rims = Rims {
                nodes: &trace.nodes,
                sides: opened.sides,
                rim: opened.rim,
                unfold: &unfold,
                has_crease: signs.has_crease(),
            };
            self.cap.section.project(&rims, &params.refine);
            let topology = opened.edit.surface().topology();
            Some(self.cap.groups(&rims, topology, &params.refine)?)
        } else {
            None
        };
        let remeshed = (self.remesher).remesh(&mut opened, exact.remesh, width, may_merge);
        report.flipped_edges = remeshed.flips;
        report.collapsed_vertices = remeshed.vertices;
        report.moved_volume += remeshed.volume;
        report.collapsed_nodes = remeshed.nodes;
        report.moved_surface = remeshed.distance;
        report.short_rim_edges = Snapper::short_edges(&opened, exact.snap);
        report.remeshing = begin.elapsed();
        let begin = Instant::now();
        let rims = Rims {
            nodes: &trace.nodes,
            sides: &self.sides,
            rim: &self.rim,
            unfold: &unfold,
            has_crease: signs.has_crease(),
        };
        self.cap.section.project(&rims, &params.refine);
        let triangles = edit.surface().topology().triangle_count();
        let is_inside = || blade_starts_inside(edit.surface(), sweep);
        if self.cap.section.ends_inside(triangles, is_inside) {
            let triangle = trace.chords[0].triangle;
            return Err(CutError::PartialCut { triangle });
        }
        let topology = edit.surface().topology();
        let mesh = (self.cap.section).triangulate(&rims, topology, &params.refine, true)?;
        // A disc has no inner points.
        report.refined = mesh.report.self_intersecting_loops == 0 && mesh.report.unconverged == 0;
        self.cap.group_loops(&mesh);
        if remeshed.nodes > 0 && groups.is_some_and(|groups| groups != self.cap.last_groups()) {
            return Ok(false);
        }
        report.cap = begin.elapsed();
        let begin = Instant::now();
        // Side 0 of a loop has an even number, side 1 the next.
        let sides = self.rim.first.iter();
        let sides = sides.flat_map(|&node| self.sides.rim[node as usize].map(HalfEdge::triangle));
        let joined = self.cap.joined();
        let joined = joined.flat_map(|(a, b)| [(2 * a, 2 * b), (2 * a + 1, 2 * b + 1)]);
        separator.separate(&mut edit, sweep, sides, joined);
        report.separation = begin.elapsed();
        let begin = Instant::now();
        (self.cap).close(&mut edit, &rims, &mesh, params.cap_material);
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
