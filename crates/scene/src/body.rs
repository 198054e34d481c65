//! [`Body`]: a soft body of a [`crate::Scene`], its surface, solver and cutter kept consistent.

mod id;
#[cfg(feature = "serde")]
mod load;
mod parts;
mod pieces;

use crate::blade::{Blade, BladeMode};
use crate::contacts::ContactParams;
use crate::error::SceneError;
use crate::interior_springs::InteriorSpringSearch;
use crate::params::SceneParams;
use crate::piece_shapes::PieceShapes;
pub use id::BodyId;
use incise_cut::{CutError, CutOutcome, CutParams, Cutter, Incision, IncisionState, Sweep};
use incise_mesh::{Aabb, Bvh, RayHit, Surface, Undo, Vec3, VertexId};
use incise_pbd_gpu::{ConstraintError, Material, PatchParams, Solver};
pub(crate) use pieces::{piece_of, vertices_of};
use std::num::NonZeroUsize;
use std::time::Duration;
use web_time::Instant;

/// A soft body of one material. It stays one body when it is cut into pieces.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Body {
    surface: Surface,
    solver: Solver,
    cutter: Cutter,
    /// Incisions by the numbers of their blades.
    incisions: Vec<(usize, Incision)>,
    #[cfg_attr(feature = "serde", serde(skip))]
    spring_search: InteriorSpringSearch,
    /// As of the last [`Body::measure_pieces`].
    piece_shapes: PieceShapes,
    /// Whether vertices moved since the BVH was last refitted.
    stale: bool,
    /// A bounding box that the body has not left, if its motion since is known.
    loose_bounds: Option<LooseBounds>,
    /// Whether the body was handed out for edits that are not validated yet.
    #[cfg_attr(feature = "serde", serde(skip))]
    is_edited: bool,
    /// The surface's edit history at the last cut that the constraints followed.
    #[cfg_attr(feature = "serde", serde(skip))]
    topology_version: u64,
    /// [`Self::topology_version`] before the last cut; the present one after an undo.
    #[cfg_attr(feature = "serde", serde(skip))]
    version_before_cut: u64,
}

/// A bounding box and the maximum displacement since it was computed.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct LooseBounds {
    bounds: Aabb,
    /// Maximum displacement of a vertex along an axis \[m\].
    drift: f64,
}

/// The result of a cut, and the time of updating BVH and constraints.
pub(crate) struct BodyCut<E> {
    pub(crate) cut: Result<CutOutcome, E>,
    pub(crate) constraints: Duration,
}

impl Body {
    pub(crate) fn new(
        mut surface: Surface,
        material: &Material,
        patches: Option<&PatchParams>,
    ) -> Result<Self, ConstraintError> {
        let mut solver = Solver::with_patches(&mut surface, material, patches)?;
        let cutter = Cutter::new(&surface);
        let mut spring_search = InteriorSpringSearch::default();
        spring_search.fill(&surface, &mut solver, cutter.bvh())?;
        Ok(Self {
            topology_version: surface.fingerprint(),
            version_before_cut: surface.fingerprint(),
            surface,
            solver,
            cutter,
            incisions: Vec::new(),
            spring_search,
            piece_shapes: PieceShapes::default(),
            stale: false,
            loose_bounds: None,
            is_edited: false,
        })
    }

    /// Returns the surface; of a GPU body as of the last [`crate::Scene::read_back`].
    #[must_use]
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Returns masses, velocities and constraints; velocities are as old as the positions.
    #[must_use]
    pub fn solver(&self) -> &Solver {
        &self.solver
    }

    /// Returns the solver and the surface, to edit pins, velocities and positions.
    ///
    /// Do not edit the triangles: the constraints would not follow. The next [`crate::Scene::cut`]
    /// or [`crate::Scene::advance`] returns an error for such an edit and for positions that are
    /// not finite. [`crate::Scene::undo`] undoes cuts.
    pub fn solver_mut(&mut self) -> (&mut Solver, &mut Surface) {
        self.stale = true;
        self.is_edited = true;
        self.loose_bounds = None;
        (&mut self.solver, &mut self.surface)
    }

    /// Validates the edits since the last call, if there were any, and lets a solid follow them.
    ///
    /// # Errors
    /// [`SceneError::TopologyEdited`] and [`SceneError::PositionNotFinite`]; the next call
    /// validates again.
    pub(crate) fn validate_edit(&mut self, id: BodyId) -> Result<(), SceneError> {
        if !self.is_edited {
            return Ok(());
        }
        if self.surface.fingerprint() != self.topology_version {
            return Err(SceneError::TopologyEdited { body: id });
        }
        let is_finite = |v: &VertexId| self.surface.position(*v).iter().all(|c| c.is_finite());
        if let Some(vertex) = self.surface.topology().vertices().find(|v| !is_finite(v)) {
            return Err(SceneError::PositionNotFinite { body: id, vertex });
        }
        self.solver.adopt_edits(&mut self.surface);
        self.is_edited = false;
        Ok(())
    }

    /// Returns the surface's fingerprint after the last cut or undo.
    pub(crate) fn topology_version(&self) -> u64 {
        self.topology_version
    }

    /// Returns the surface's fingerprint before the last cut, or the present one after an undo.
    pub(crate) fn version_before_cut(&self) -> u64 {
        self.version_before_cut
    }

    /// Returns the number of constraints, see [`Solver::constraint_count`].
    pub(crate) fn constraints(&self) -> usize {
        self.solver.constraint_count()
    }

    /// Returns the surface and the solver, for changes that move no vertex.
    pub(crate) fn parts(&mut self) -> (&mut Surface, &mut Solver) {
        (&mut self.surface, &mut self.solver)
    }

    /// Returns the surface and the solver, for changes that move vertices.
    pub(crate) fn moved_parts(&mut self) -> (&mut Surface, &mut Solver) {
        self.stale = true;
        self.loose_bounds = None;
        self.parts()
    }

    /// Returns whether the body's bounding box overlaps `other`.
    ///
    /// Increments `aabbs_computed` if the last box, grown by the motion since, does not decide it.
    pub(crate) fn overlaps(&mut self, other: &Aabb, aabbs_computed: &mut u32) -> bool {
        if let Some(loose) = &self.loose_bounds
            && !loose.overlaps(other)
        {
            return false;
        }
        self.bounds(aabbs_computed).overlaps(other)
    }

    /// Returns the body's bounding box; computes it only if vertices have moved.
    pub(crate) fn bounds(&mut self, aabbs_computed: &mut u32) -> Aabb {
        if !self.stale {
            return self.cutter.bvh().bounds();
        }
        if let Some(LooseBounds { bounds, drift: 0.0 }) = self.loose_bounds {
            return bounds;
        }
        *aabbs_computed += 1;
        let bounds = self.surface.bounds();
        self.loose_bounds = Some(LooseBounds { bounds, drift: 0.0 });
        bounds
    }

    /// Refits the BVH if vertices have moved; returns whether they have.
    pub(crate) fn refit(&mut self) -> bool {
        if self.stale {
            self.cutter.refit(&self.surface);
            self.store_tight_bounds();
        } else {
            // Only inverse masses, which share an array with positions, may have changed.
            self.cutter.refit_moved(&self.surface, &[]);
        }
        std::mem::replace(&mut self.stale, false)
    }

    /// Prepares a cut and the search for interior springs after it; returns whether the BVH was
    /// refitted.
    ///
    /// The cut of a body that has moved needs no BVH, unless another query follows (`is_queried`).
    pub(crate) fn prepare_cut(&mut self, is_queried: bool) -> bool {
        let needs_bvh = is_queried || InteriorSpringSearch::needs_bvh(&self.solver);
        (needs_bvh || !self.stale) && self.refit()
    }

    /// Measures the shapes of the pieces if the topology has changed.
    pub(crate) fn measure_pieces(&mut self) {
        self.piece_shapes.update(&self.surface);
    }

    /// Returns the shapes of the pieces as of the last measurement.
    pub(crate) fn piece_shapes(&self) -> &PieceShapes {
        &self.piece_shapes
    }

    /// Returns the incision of a blade, if it has one.
    pub(crate) fn incision(&self, blade: usize) -> Option<&Incision> {
        let mut own = self.incisions.iter();
        own.find_map(|(number, incision)| (*number == blade).then_some(incision))
    }

    /// Returns whether a blade is inside the body, or was refused where it enters.
    pub(crate) fn has_incision(&self, blade: usize) -> bool {
        let goes_on = |incision: &Incision| {
            incision.is_inside() || incision.state() == IncisionState::Blocked
        };
        self.incision(blade).is_some_and(goes_on)
    }

    /// Ends the incision of a blade, if it has one.
    pub(crate) fn end_incision(&mut self, blade: usize) {
        self.incisions.retain(|(number, _)| *number != blade);
    }

    /// Ends all incisions.
    pub(crate) fn end_all_incisions(&mut self) {
        self.incisions.clear();
    }

    /// Cuts along the sweep of a blade on at most `threads` threads, and updates BVH, constraints
    /// and masses.
    ///
    /// The cut must be prepared.
    pub(crate) fn cut(
        &mut self,
        number: usize,
        blade: &Blade,
        sweep: &Sweep,
        params: &CutParams,
        threads: Option<NonZeroUsize>,
    ) -> Result<BodyCut<CutError>, SceneError> {
        self.cutter.set_threads(threads);
        self.cutter.set_defers_bvh(true);
        let mut stepped = None;
        let cut = match blade.mode {
            BladeMode::FullSlices => self.cutter.cut(&mut self.surface, sweep, params),
            BladeMode::Progressive => {
                let own = self.incisions.iter().position(|own| own.0 == number);
                let own = own.unwrap_or_else(|| {
                    self.incisions.push((number, Incision::default()));
                    self.incisions.len() - 1
                });
                let incision = &mut self.incisions[own].1;
                incision.resume(&blade.previous_edge());
                let edge = blade.edge();
                let cut = (self.cutter).advance(&mut self.surface, incision, &edge, params);
                stepped = incision.sweep().cloned();
                cut
            }
        };
        let has_cut = cut.as_ref().is_ok_and(|outcome| !outcome.is_miss());
        let followed = self.follow(cut, stepped.as_ref().unwrap_or(sweep), threads);
        let mut own = self.incisions.iter_mut().filter(|own| own.0 == number);
        if let Some((_, incision)) = own.next().filter(|_| has_cut) {
            incision.follow_rest(&self.surface);
        }
        followed
    }

    /// Cuts along `sweep` by a method of the caller, and updates BVH, constraints and masses.
    ///
    /// The BVH must be refitted.
    pub(crate) fn cut_with<E>(
        &mut self,
        sweep: &Sweep,
        cut: impl FnOnce(&mut Cutter, &mut Surface) -> Result<CutOutcome, E>,
        threads: Option<NonZeroUsize>,
    ) -> Result<BodyCut<E>, SceneError> {
        self.cutter.set_threads(threads);
        self.cutter.set_defers_bvh(true);
        let cut = cut(&mut self.cutter, &mut self.surface);
        self.follow(cut, sweep, threads)
    }

    /// Updates BVH, constraints and masses after a cut.
    fn follow<E>(
        &mut self,
        cut: Result<CutOutcome, E>,
        sweep: &Sweep,
        threads: Option<NonZeroUsize>,
    ) -> Result<BodyCut<E>, SceneError> {
        let version = self.surface.fingerprint();
        self.version_before_cut = std::mem::replace(&mut self.topology_version, version);
        let begin = Instant::now();
        if let Ok(outcome) = &cut
            && !outcome.is_miss()
        {
            if self.stale {
                self.loose_bounds = None;
            } else {
                self.store_tight_bounds();
            }
            let Self {
                surface,
                solver,
                spring_search,
                cutter,
                ..
            } = self;
            let delta = &outcome.delta;
            spring_search.follow_cut(surface, solver, cutter, sweep, delta, threads)?;
            // The vertices of cells that were divided may have moved a little.
            if solver.is_solid() {
                self.stale = true;
                self.loose_bounds = None;
            }
        }
        Ok(BodyCut {
            cut,
            constraints: begin.elapsed(),
        })
    }

    /// Returns the first triangle that a ray hits. The BVH must be refitted.
    pub(crate) fn cast_ray(&self, origin: Vec3, direction: Vec3) -> Option<RayHit> {
        let bvh = self.cutter.bvh();
        bvh.cast(&self.surface, origin, direction, |_| true)
    }

    /// Undoes a cut and updates constraints and masses. The BVH must be refitted.
    ///
    /// Pieces that have moved since the cut move together.
    pub(crate) fn undo(
        &mut self,
        id: BodyId,
        undo: Undo,
        params: &SceneParams,
    ) -> Result<(), SceneError> {
        let pieces = self.piece_of_vertices();
        let delta = self.cutter.undo(&mut self.surface, undo)?;
        self.topology_version = self.surface.fingerprint();
        self.version_before_cut = self.topology_version;
        // The vertices of their tips may be gone.
        self.end_all_incisions();
        self.store_tight_bounds();
        self.solver.apply_delta(&mut self.surface, &delta)?;
        let (surface, bvh) = (&self.surface, self.cutter.bvh());
        self.spring_search.fill(surface, &mut self.solver, bvh)?;
        let (dt, params) = (params.dt, &params.solver);
        let joined = (self.solver).join_after_undo(&mut self.surface, &pieces, dt, params);
        if joined != Ok(false) {
            self.stale = true;
            self.loose_bounds = None;
        }
        joined.map_err(|error| SceneError::Step { body: id, error })?;
        Ok(())
    }

    /// Returns whether triangles of the body may collide with each other.
    pub(crate) fn may_collide(&self, params: &ContactParams) -> bool {
        params.self_collision || self.surface.piece_count() > 1
    }

    /// Begins a step of the solver, which moves the vertices.
    pub(crate) fn begin_step(&mut self) {
        if !self.stale {
            self.store_tight_bounds();
        }
        self.stale = true;
    }

    /// Ends a step of the solver, whose statistics bound the motion unless it failed.
    pub(crate) fn end_step(&mut self, is_ok: bool) {
        let stats = self.solver.stats();
        match &mut self.loose_bounds {
            Some(loose) if is_ok => loose.add_drift(stats.max_displacement, stats.substeps),
            loose => *loose = None,
        }
    }

    /// Returns the BVH of the surface, as of the last refit.
    pub(crate) fn bvh(&self) -> &Bvh {
        self.cutter.bvh()
    }

    /// Takes the bounding box of the BVH, which must be refitted.
    fn store_tight_bounds(&mut self) {
        self.loose_bounds = Some(LooseBounds {
            bounds: self.cutter.bvh().bounds(),
            drift: 0.0,
        });
    }
}

impl LooseBounds {
    /// Returns whether the body may overlap `other`.
    fn overlaps(&self, other: &Aabb) -> bool {
        (0..3).all(|k| {
            f64::from(self.bounds.min[k]) - self.drift <= f64::from(other.max[k])
                && f64::from(other.min[k]) <= f64::from(self.bounds.max[k]) + self.drift
        })
    }

    /// Adds a motion of at most `displacement` \[m\] along each axis in `substeps` rounded steps.
    fn add_drift(&mut self, displacement: f32, substeps: u32) {
        let corners = self.bounds.min.into_iter().chain(self.bounds.max);
        let largest = corners.map(f32::abs).fold(0.0, f32::max);
        self.drift += f64::from(displacement) * (1.0 + 1e-6);
        self.drift +=
            (f64::from(largest) + self.drift) * f64::from(f32::EPSILON) * f64::from(substeps);
    }
}
