//! The BVH of a [`Cutter`]: whether it fits the surface, and how it follows motion and edits.

use super::Cutter;
use crate::error::CutError;
use crate::exact::has_walls;
#[cfg(feature = "serde")]
use incise_mesh::InvalidBvh;
use incise_mesh::{
    Bvh, Surface, SurfaceEdits, TopologyDelta, TriangleId, Undo, UndoError, VertexId,
};

/// A state of a surface: equal for equal triangles and positions, and for no others.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct SurfaceVersion {
    /// [`Surface::fingerprint`]: the edits.
    topology: u64,
    /// [`Surface::motion_version`]: the motion.
    #[cfg_attr(feature = "serde", serde(skip))]
    motion: u64,
}

impl SurfaceVersion {
    pub(super) fn new(surface: &Surface) -> Self {
        Self {
            topology: surface.fingerprint(),
            motion: surface.motion_version(),
        }
    }
}

/// Edits that the BVH has not followed, and the fingerprint of the surface after them.
#[derive(Debug, Clone)]
pub(super) struct PendingEdits {
    edits: SurfaceEdits,
    topology: u64,
}

impl Cutter {
    /// Returns the BVH of the surface as of the last [`Self::refit`], with the cuts since then.
    ///
    /// Cuts after motion are missing.
    #[must_use]
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// Fits the BVH to the surface as it is now.
    ///
    /// O(n) after motion, and O(k log k) for k triangles of cuts after it. Rebuilds the BVH in
    /// O(n log n) after an edit by anything but this cutter, and for another surface.
    pub fn refit(&mut self, surface: &Surface) {
        if self.known_topology() != surface.fingerprint() {
            self.bvh.rebuild(surface);
            self.pending = None;
            self.has_sheets = !surface.topology().is_closed();
            self.has_walls = has_walls(surface);
            self.exact.forget();
        } else if let Some(pending) = self.pending.take() {
            self.bvh.refit_edited(surface, &pending.edits);
        } else {
            self.bvh.refit(surface);
        }
        self.version = SurfaceVersion::new(surface);
    }

    /// Fits the BVH to the motion of a few triangles. O(m log n) for m of them.
    ///
    /// These must be all that moved since the last refit. None are needed after a change of inverse
    /// masses, which share an array with positions. After an edit by anything else than the cutter,
    /// and after a cut of moved triangles, this is [`Self::refit`].
    pub fn refit_moved(&mut self, surface: &Surface, triangles: &[TriangleId]) {
        if self.pending.is_some() || self.version.topology != surface.fingerprint() {
            self.refit(surface);
            return;
        }
        self.bvh.refit_moved(surface, triangles);
        self.version = SurfaceVersion::new(surface);
    }

    /// Updates the BVH after a cut that deferred it, or after an edit by anything else.
    ///
    /// `delta` must be the only edit since the last update, and no vertex may have moved since the
    /// edit. An edit by anything else must leave closed surfaces closed. O(k log k) for k changed
    /// triangles.
    pub fn update_bvh(&mut self, surface: &Surface, delta: &TopologyDelta) {
        self.follow_edit(surface, delta, self.is_fitted(surface));
    }

    /// Undoes a cut, see [`Undo::revert`], and updates the BVH. Returns the change.
    ///
    /// # Errors
    /// [`UndoError`]; nothing is changed then.
    pub fn undo(&mut self, surface: &mut Surface, undo: Undo) -> Result<TopologyDelta, UndoError> {
        let is_current = self.known_topology() == surface.fingerprint();
        let is_fitted = self.is_fitted(surface);
        let delta = undo.revert(surface)?;
        if is_current {
            self.follow_edit(surface, &delta, is_fitted);
            // The undone edit may have been any, such as one that filled a hole.
            self.has_sheets = !surface.topology().is_closed();
            self.exact.forget();
        } else {
            self.refit(surface);
        }
        Ok(delta)
    }

    /// Updates the BVH if it fitted the surface before an edit, or else stores the edit.
    fn follow_edit(&mut self, surface: &Surface, delta: &TopologyDelta, is_fitted: bool) {
        let topology = surface.fingerprint();
        if is_fitted {
            self.bvh.update(surface, delta);
            self.version.topology = topology;
        } else {
            let pending = self.pending.get_or_insert_with(|| PendingEdits {
                edits: SurfaceEdits::default(),
                topology,
            });
            pending.edits.push(delta);
            pending.topology = topology;
        }
    }

    /// Completes a cutter that was read with serde, for its surface, which must be valid. O(n).
    ///
    /// Its BVH fits the present positions. It is built again if the surface was edited after it had
    /// moved, or by something else than the cutter.
    ///
    /// # Errors
    /// [`InvalidBvh`] if it is not a cutter of the surface.
    #[cfg(feature = "serde")]
    pub fn finish_load(&mut self, surface: &Surface) -> Result<(), InvalidBvh> {
        if self.version.topology != surface.fingerprint() {
            *self = Self::new(surface);
            return Ok(());
        }
        self.version = SurfaceVersion::new(surface);
        self.bvh.finish_load(surface)
    }

    /// Returns the fingerprint of the surface after the last edit that is known.
    pub(super) fn known_topology(&self) -> u64 {
        let pending = self.pending.as_ref();
        pending.map_or(self.version.topology, |pending| pending.topology)
    }

    /// Sets the fingerprint of the surface after an edit.
    pub(super) fn set_topology(&mut self, topology: u64) {
        match &mut self.pending {
            Some(pending) => pending.topology = topology,
            None => self.version.topology = topology,
        }
    }

    /// Returns whether the BVH fits the positions of the surface, whose edits are known.
    pub(super) fn is_fitted(&self, surface: &Surface) -> bool {
        self.pending.is_none() && self.version.motion == surface.motion_version()
    }

    /// Checks that all edits are known and all positions are finite. Returns the largest
    /// coordinate \[m\]. O(1) with a BVH that fits, else O(n).
    ///
    /// # Errors
    /// [`CutError::SurfaceEdited`] and [`CutError::VertexNotFinite`].
    pub(super) fn check_surface(&self, surface: &Surface, uses_bvh: bool) -> Result<f64, CutError> {
        if self.known_topology() != surface.fingerprint() {
            return Err(CutError::SurfaceEdited);
        }
        let bounds = self.bvh.bounds();
        let (largest, is_all_finite) = if uses_bvh {
            let coordinates = bounds.min.iter().chain(&bounds.max);
            let largest = coordinates.fold(0.0_f32, |m, x| x.abs().max(m));
            (largest, self.bvh.is_finite())
        } else {
            let largest = surface.largest_coordinate();
            (largest, largest.is_finite())
        };
        let is_finite = |v: &VertexId| surface.position(*v).iter().all(|x| x.is_finite());
        if !is_all_finite
            && let Some(vertex) = surface.topology().vertices().find(|v| !is_finite(v))
        {
            return Err(CutError::VertexNotFinite { vertex });
        }
        Ok(f64::from(largest))
    }
}
