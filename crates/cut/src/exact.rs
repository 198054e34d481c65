//! Splits hit triangles along the sweep, so that no surface is lost, and closes both sides.
//!
//! 1. [`crate::intersection`] finds the curves along which the sweep crosses the surface.
//! 2. [`split`] and [`open`] split the hit triangles; every curve becomes a rim on two sides.
//! 3. [`snap`] contracts rim edges much shorter than the local edge length.
//! 4. [`remesh`], if asked for, removes slivers around the rim.
//! 5. [`chains`] finds the parts of sweep edges inside the body, [`section`] the section of the
//!    body in the plane of each facet, with coordinates from [`frames`]. [`cap`] meshes the
//!    sections and closes both sides. [`rest`] interpolates rest positions inside the body.
//! 6. [`crate::separate`] gives separated parts piece numbers of their own.
//!
//! A curve may end where the sweep ends. Both sides then share the vertex at the end; in a body,
//! the walls meet along the tip, the sweep's boundary inside the body. Sheets get neither caps nor
//! walls. [`verify`] checks the result near walls.
//!
//! All of it is one [`incise_mesh::Edit`], which restores every byte if a step fails. Time is
//! O(k log k) for k triangles hit and made, plus all triangles of separated parts but the largest.

mod cap;
mod chains;
mod contract;
mod frames;
mod open;
mod pinch;
mod remesh;
mod rest;
mod rim;
mod section;
mod snap;
mod sparse_set;
mod split;
mod tip;
mod verify;
mod volumes;
mod walls;

use crate::blade_position::is_in_body;
use crate::error::CutError;
use crate::intersection::Intersection;
use crate::intersection::trace::Curve;
use crate::outcome::CutOutcome;
use crate::params::CutParams;
use crate::separate::Separator;
use crate::sizing;
use crate::sweep::Sweep;
use cap::Cap;
use chains::{Chains, Opening};
use contract::Opened;
use frames::Frames;
use incise_mesh::{Edit, HalfEdge, Surface, TriangleId};
use incise_refine::{RefineParams, Section};
use open::Sides;
use remesh::Remesher;
use rim::Rim;
use section::{Rims, target_lengths};
use snap::Snapper;
use split::Splitter;
pub(crate) use verify::has_walls;
use walls::{Around, Walls};
pub(crate) use walls::{MAX_OFFSET, RimMove};
use web_time::Instant;

/// A search for the parts of cut pieces beside the meshing of caps, which must not join others.
struct Search<'a> {
    separator: &'a mut Separator,
    /// Pairs of sides that caps join; `None` until they are meshed.
    joined: Option<Vec<(usize, usize)>>,
    seeds: Vec<TriangleId>,
}

impl Search<'_> {
    fn run(&mut self, surface: &Surface, sweep: &Sweep) {
        if let Some(joined) = &self.joined {
            (self.separator).find_parts(surface, sweep, &self.seeds, joined);
        }
    }
}

/// Changes of the rim that a cut may make.
#[derive(Debug, Clone, Copy)]
struct Liberties {
    /// Remeshing may merge nodes.
    merge: bool,
    /// Nodes at one point may share a vertex.
    pinch: bool,
}

/// Outcome of a split.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Split {
    Done,
    /// The section has necks without width, see [`pinch`].
    Necks,
    /// Merging made loops touch or cross others, or no longer do so. Their caps would join separate
    /// pieces.
    Regrouped,
}

/// Scratch memory, kept between cuts.
#[derive(Debug, Clone, Default)]
pub(crate) struct Exact {
    splitter: Splitter,
    sides: Sides,
    rim: Rim,
    snapper: Snapper,
    remesher: Remesher,
    frames: Frames,
    column: volumes::Column,
    lengths: Vec<f64>,
    chains: Chains,
    cap: Cap,
    walls: Walls,
}

/// Saves whether the surface has cavities. The rest is scratch memory.
#[cfg(feature = "serde")]
impl serde::Serialize for Exact {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.chains.has_cavities.serialize(serializer)
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Exact {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut exact = Self::default();
        exact.chains.has_cavities = Option::deserialize(deserializer)?;
        Ok(exact)
    }
}

impl Exact {
    /// Iterates over the sections of the last cut and the target edge length at each point.
    pub(crate) fn sections(&self) -> impl Iterator<Item = (Section<'_>, &[f64])> {
        let sections = self.cap.section.sections().iter();
        sections.map(|section| (section.section(), section.lengths.as_slice()))
    }

    /// Returns the moves of vertices along the rim by the last cut, in their order.
    pub(crate) fn rim_moves(&self) -> &[RimMove] {
        self.walls.moved()
    }

    /// Forgets what is known about a surface that was edited by something else.
    pub(crate) fn forget(&mut self) {
        self.chains.has_cavities = None;
    }

    /// Cuts `surface` along intersection curves. See the module.
    ///
    /// Returns false at necks of the section, if asked to stop there. The surface is then bit for
    /// bit what it was.
    ///
    /// # Errors
    /// [`CutError`]; the surface is then bit for bit what it was.
    pub(crate) fn cut(
        &mut self,
        surface: &mut Surface,
        at: Intersection<'_>,
        params: &CutParams,
        separator: &mut Separator,
        outcome: &mut CutOutcome,
    ) -> Result<bool, CutError> {
        let pieces = surface.piece_bound();
        let mut may = Liberties {
            merge: true,
            // Remeshing needs all triangles of a vertex in the fan of its node.
            pinch: params.remesh == 0.0,
        };
        loop {
            match self.split(surface, at, params, may, separator, outcome) {
                Ok(Split::Done) => break,
                Ok(Split::Necks) => return Ok(false),
                Ok(Split::Regrouped) => may.merge = false,
                Err(_) if may.pinch && !self.rim.pinches.is_empty() => may.pinch = false,
                Err(error) => return Err(error),
            }
        }
        if surface.piece_bound() != pieces {
            // A part of a body that intersects itself can be inside out, like a cavity.
            self.chains.has_cavities = None;
        }
        Ok(true)
    }

    /// Splits the surface along the curves.
    ///
    /// Unless it is [`Split::Done`], the surface is bit for bit unchanged.
    fn split(
        &mut self,
        surface: &mut Surface,
        at: Intersection<'_>,
        params: &CutParams,
        may: Liberties,
        separator: &mut Separator,
        outcome: &mut CutOutcome,
    ) -> Result<Split, CutError> {
        let begin = Instant::now();
        let Intersection {
            sweep,
            facets,
            trace,
            is_sheet,
            is_shared,
            ..
        } = at;
        let report = &mut outcome.report;
        self.frames.read(facets);
        let shape = facets.tip().rest_shape();
        self.snapper.find_shared(surface, shape, &trace.nodes);
        let parts = if params.snap > 0.0 || params.remesh > 0.0 {
            let may_move = |curve: &Curve| params.remesh > 0.0 || self.snapper.may_snap(curve);
            volumes::smaller_parts(surface, &at, &self.frames, &mut self.column, may_move)
        } else {
            Vec::new()
        };
        let mut edit = surface.edit();
        let goes_on = !facets.tip().parts.is_empty();
        // Sheets get no walls.
        let mut walls = trace.curves.iter().filter(|curve| curve.is_capped);
        let is_incision = walls.any(|curve| goes_on || trace.has_end(curve));
        if is_incision || edit.surface().channel(sizing::CHANNEL).is_some() {
            let hit = trace.chords.iter().map(|chord| chord.triangle);
            sizing::prepare(&mut edit, shape, hit);
        }
        (self.sides).open(&mut edit, trace, facets, &mut self.splitter)?;
        sizing::mark(&mut edit, self.sides.vertices.iter().flatten().copied());
        self.rim.reset(trace);
        let mut opened = Opened {
            edit: &mut edit,
            nodes: &trace.nodes,
            sides: &mut self.sides,
            rim: &mut self.rim,
        };
        let snapped = (self.snapper).snap(&mut opened, facets, params.snap, &parts);
        report.snapped_vertices = snapped.vertices;
        report.merged_points = snapped.nodes;
        report.moved_volume = snapped.volume;
        if may.pinch && params.snap > 0.0 {
            let pinched = pinch::join_nodes(&mut opened, &self.frames);
            if pinched.necks > 0 && at.stops_at_necks {
                return Ok(Split::Necks);
            }
            report.merged_points += pinched.nodes;
        }
        report.split = begin.elapsed();
        let begin = Instant::now();
        let may_join = may.merge && params.remesh > 0.0 && trace.curves.len() > 1;
        let groups = if may_join {
            // Groups depend on the curves alone, so meshes without new points are enough.
            self.mesh_sections(&mut edit, at, &params.refine, false, None)?;
            Some(self.cap.groups().to_vec())
        } else {
            None
        };
        let mut opened = Opened {
            edit: &mut edit,
            nodes: &trace.nodes,
            sides: &mut self.sides,
            rim: &mut self.rim,
        };
        let width = self.frames.section_width(trace);
        let widths: Vec<f64> = parts.iter().map(|part| width.min(part.thickness)).collect();
        let remeshed = (self.remesher).remesh(&mut opened, params.remesh, &widths, may.merge);
        report.flipped_edges = remeshed.flips;
        report.collapsed_vertices = remeshed.vertices;
        report.moved_volume += remeshed.volume;
        report.collapsed_points = remeshed.nodes;
        report.moved_surface = remeshed.distance;
        report.short_rim_edges = Snapper::short_edges(&opened, params.snap);
        report.remeshing = begin.elapsed();
        let begin = Instant::now();
        let mut search = is_shared.then(|| Search {
            separator,
            joined: groups.as_ref().map(|_| self.cap.joined().collect()),
            seeds: self.seeds(),
        });
        report.refined =
            self.mesh_sections(&mut edit, at, &params.refine, true, search.as_mut())?;
        let triangles = edit.surface().topology().triangle_count();
        let is_inside = || is_in_body(edit.surface(), is_sheet, sweep.points()[0]);
        if self.cap.section.ends_inside(triangles, is_inside) {
            let triangle = trace.chords[0].triangle;
            return Err(CutError::PartialCut { triangle });
        }
        if remeshed.nodes > 0 && groups.is_some_and(|groups| groups != self.cap.groups()) {
            return Ok(Split::Regrouped);
        }
        report.cap = begin.elapsed();
        let begin = Instant::now();
        let mut joined: Vec<(usize, usize)> = self.cap.joined().collect();
        joined.extend(self.joined_at_pinches());
        if search.is_none_or(|search| search.joined.as_ref() != Some(&joined)) {
            separator.find_parts(edit.surface(), sweep, &self.seeds(), &joined);
        }
        separator.number_parts(&mut edit);
        report.separation = begin.elapsed();
        let begin = Instant::now();
        let rims = Rims {
            nodes: &trace.nodes,
            curves: &trace.curves,
            sides: &self.sides,
            rim: &self.rim,
            facets,
            frames: &self.frames,
            chains: &self.chains,
        };
        (self.cap).close(&mut edit, &rims, params)?;
        let around = Around {
            rim: &self.rim,
            sides: &self.sides,
            caps: &self.cap.triangles,
            crosses_walls: self.snapper.crosses_walls(),
        };
        (self.walls).coarsen(&mut edit, shape, around, &params.refine);
        report.cap += begin.elapsed();
        let begin = Instant::now();
        let (delta, undo) = edit.finish();
        let may_be_open = trace.curves.iter().any(|curve| !curve.is_capped);
        if (at.may_share_walls || !self.rim.pinches.is_empty())
            && let Some(vertex) = verify::find_defect(surface, &delta, may_be_open)
        {
            undo.revert(surface).expect("the last edit can be undone");
            return Err(CutError::NotManifold { vertex });
        }
        outcome.delta = delta;
        outcome.undo = Some(undo);
        outcome.cap = self.cap.triangles.concat();
        let topology = surface.topology();
        outcome.cap.retain(|&t| topology.is_triangle(t));
        report.commit = begin.elapsed();
        Ok(Split::Done)
    }

    /// Returns a triangle on each side of each curve, then one beside each edge at a pinch.
    ///
    /// Side 0 of a curve has an even number, side 1 the next.
    fn seeds(&self) -> Vec<TriangleId> {
        let nodes = self.rim.first.iter();
        let sides = nodes.flat_map(|&node| self.sides.rim[node as usize].map(HalfEdge::triangle));
        let pinched = self.pinched_edges();
        let pinched = pinched.map(|(node, side)| self.sides.rim[node as usize][side].triangle());
        sides.chain(pinched).collect()
    }

    /// Iterates over the rim edges at pinches, by their first nodes, and the sides.
    fn pinched_edges(&self) -> impl Iterator<Item = (u32, usize)> + '_ {
        let pinches = self.rim.pinches.iter();
        pinches.flat_map(|&(nodes, side)| {
            let edges = nodes.map(|n| [n, self.rim.prev[n as usize]]);
            edges.into_iter().flatten().map(move |node| (node, side))
        })
    }

    /// Returns pairs of numbers of seeds in one part of the surface: those at a pinch, which only
    /// the cap connects, and those of their curve.
    fn joined_at_pinches(&self) -> Vec<(usize, usize)> {
        let first = 2 * self.rim.first.len();
        let edges = self.pinched_edges().enumerate();
        edges
            .map(|(i, (node, side))| {
                let curve = self.rim.curve_of[node as usize] as usize;
                (2 * curve + side, first + i)
            })
            .collect()
    }

    /// Meshes the sections of the opened surface, which get new points if `is_refined`.
    ///
    /// Returns whether they reached their target lengths. `search` runs in parallel, if present.
    ///
    /// # Errors
    /// [`CutError`].
    fn mesh_sections(
        &mut self,
        edit: &mut Edit<'_>,
        Intersection {
            sweep,
            facets,
            trace,
            is_sheet,
            ..
        }: Intersection<'_>,
        refine: &RefineParams,
        is_refined: bool,
        mut search: Option<&mut Search<'_>>,
    ) -> Result<bool, CutError> {
        target_lengths(&trace.nodes, &self.rim, refine, &mut self.lengths);
        self.sides.vertices.truncate(trace.nodes.len());
        let opening = Opening {
            sweep,
            is_sheet,
            facets,
            nodes: &trace.nodes,
            curves: &trace.curves,
            rim: &self.rim,
            refine,
            lengths: &self.lengths,
        };
        self.chains.find(edit, &opening, &mut self.sides)?;
        let rims = Rims {
            nodes: &trace.nodes,
            curves: &trace.curves,
            sides: &self.sides,
            rim: &self.rim,
            facets,
            frames: &self.frames,
            chains: &self.chains,
        };
        self.cap.section.project(&rims, &self.lengths)?;
        let surface = edit.surface();
        if let Some(search) = &mut search
            && search.joined.is_none()
            && !self.cap.section.has_holes()
            && !trace.curves.iter().any(|curve| trace.has_end(curve))
        {
            // Caps without holes join nothing in one plane.
            search.joined = Some(self.joined_at_pinches());
        }
        let mut mesh = || (self.cap).triangulate(&rims, surface.topology(), refine, is_refined);
        let has_converged = match search {
            Some(search) if search.joined.is_some() => rayon::in_place_scope(|scope| {
                scope.spawn(|_| search.run(surface, sweep));
                mesh()
            }),
            _ => mesh(),
        };
        Ok(has_converged?)
    }
}
