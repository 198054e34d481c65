//! [`Scene`]: bodies, blades and their access by id. Frames are in `frame.rs`, blades in
//! `blade.rs`.

use crate::backend::BackendState;
use crate::blade::{Blade, BladeId};
use crate::body::{Body, BodyId};
use crate::contacts::{BladeFace, ContactDetection};
use crate::error::SceneError;
use crate::gpu_bodies::GpuBodies;
use crate::islands::Islands;
use crate::params::SceneParams;
use crate::residency::Residency;
use crate::sleep::Sleep;
use crate::stats::FrameStats;
use incise_cut::{CutError, CutOutcome};
use incise_mesh::{RayHit, Surface, Vec3, VertexId};
use incise_pbd_gpu::{Collider, Material, MovingCollider, PatchParams};
use std::sync::atomic::{AtomicU64, Ordering};

/// A cut that failed. The body is unchanged.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FailedCut {
    /// The blade that moved.
    pub blade: BladeId,
    /// The body in its way.
    pub body: BodyId,
    /// The reason.
    pub error: CutError,
}

/// The result of one blade's sweep in the last frame.
///
/// A sweep through several bodies has one result per body.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct SweepResult {
    /// The blade that moved.
    pub blade: BladeId,
    /// The body that was cut and the change of its surface; `None` for a sweep that missed.
    pub cut: Option<(BodyId, CutOutcome)>,
}

/// The bodies of a scene by index. `None` where one was removed: indices are not reused.
pub(crate) type Bodies = [Option<Box<Body>>];

/// The number of a scene in this process, part of its ids.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct SceneNumber(u64);

impl Default for SceneNumber {
    /// Returns a number that no other scene has.
    fn default() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        Self(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}

/// A simulation of soft bodies and blades, stepped frame by frame.
///
/// Every method that takes an id returns [`SceneError::UnknownBody`] or
/// [`SceneError::UnknownBlade`] for an id of another scene or of a removed body.
///
/// With the feature `serde`, read and write it by `save` and `load`: these complete the fields that
/// `Serialize` and `Deserialize` skip.
#[derive(Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Scene {
    /// Parameters of frames; may change between frames.
    pub params: SceneParams,
    /// Rigid obstacles for all bodies; may change between frames.
    ///
    /// They are at these places at the end of the next frame, to which they move from those with
    /// the same indices in the previous frame; the directions of planes, capsules and boxes change
    /// at once. Colliders of a list with another length do not move. A change wakes all bodies. CPU
    /// bodies are tested only against colliders near them.
    pub colliders: Vec<Collider>,
    /// The colliders of the previous frame.
    pub(crate) previous_colliders: Vec<Collider>,
    /// The colliders with their motion in this frame.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) moving_colliders: Vec<MovingCollider>,
    /// The blade faces that bodies collide with, and those of the previous frame.
    pub(crate) blade_faces: Vec<BladeFace>,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) previous_blade_faces: Vec<BladeFace>,
    /// Scratch memory: colliders near the current body.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) near_colliders: Vec<MovingCollider>,
    pub(crate) bodies: Vec<Option<Box<Body>>>,
    pub(crate) blades: Vec<Blade>,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) stats: FrameStats,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) failed_cuts: Vec<FailedCut>,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) cuts: Vec<SweepResult>,
    /// Scratch memory: indices of the bodies near the current sweep.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) near: Vec<usize>,
    pub(crate) sleep: Sleep,
    pub(crate) detection: ContactDetection,
    pub(crate) islands: Islands,
    /// The bodies that a GPU steps, if the scene has one.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) gpu: Option<Box<dyn GpuBodies>>,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) backend: BackendState,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) number: SceneNumber,
}

impl Scene {
    /// Creates an empty scene on the CPU; see [`Scene::with_backend`] for others.
    #[must_use]
    pub fn new(params: SceneParams) -> Self {
        Self {
            params,
            ..Self::default()
        }
    }

    /// Adds a body at rest.
    ///
    /// A large body is divided into patches by [`PatchParams::for_body`]. All coordinates in a
    /// scene are relative to the [origin](Surface::origin) of its first body; the surfaces of later
    /// ones are moved to it.
    ///
    /// # Errors
    /// [`SceneError::Constraint`] when the surface or the material cannot be simulated;
    /// [`SceneError`] of the GPU when it has no memory for the body. The scene is unchanged then.
    pub fn add_body(
        &mut self,
        surface: Surface,
        material: &Material,
    ) -> Result<BodyId, SceneError> {
        let patches = PatchParams::for_body(surface.topology().vertex_count());
        self.add_body_with_patches(surface, material, patches.as_ref())
    }

    /// Adds a body divided into given patches, see [`incise_pbd_gpu::Solver::with_patches`].
    ///
    /// # Errors
    /// As [`Scene::add_body`]; [`SceneError::Constraint`] also for patch parameters out of range.
    pub fn add_body_with_patches(
        &mut self,
        mut surface: Surface,
        material: &Material,
        patches: Option<&PatchParams>,
    ) -> Result<BodyId, SceneError> {
        if self.bodies().next().is_some() {
            surface.move_origin(self.origin());
        }
        self.insert(Body::new(surface, material, patches)?)
    }

    /// Returns the [origin](Surface::origin) of all coordinates in the scene \[m\].
    ///
    /// It is that of the bodies, and zero without bodies.
    #[must_use]
    pub fn origin(&self) -> [f64; 3] {
        let first = self.bodies.iter().flatten().next();
        first.map_or([0.0; 3], |body| body.surface().origin())
    }

    pub(crate) fn insert(&mut self, body: Body) -> Result<BodyId, SceneError> {
        let i = self.bodies.len();
        self.bodies.push(Some(Box::new(body)));
        self.sleep.add(i);
        if let Err(error) = self.move_to_gpu(i) {
            self.bodies.pop();
            return Err(error);
        }
        Ok(self.body_id(i))
    }

    /// Uploads a body to the GPU if it is large enough to be stepped there.
    pub(crate) fn move_to_gpu(&mut self, i: usize) -> Result<(), SceneError> {
        let id = self.body_id(i);
        if let (Some(gpu), Some(body)) = (&mut self.gpu, &mut self.bodies[i])
            && let Err(error) = gpu.add(id, body)
        {
            self.recover(Some(i), error)?;
        }
        Ok(())
    }

    /// Reads a body back, removes it from the scene and returns it.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`], and as [`Scene::read_back`]; the body stays then.
    pub fn remove_body(&mut self, id: BodyId) -> Result<Body, SceneError> {
        self.read_back(id)?;
        self.discard_body(id)
    }

    /// Removes a body without reading it back, for example after a GPU error.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`].
    pub fn discard_body(&mut self, id: BodyId) -> Result<Body, SceneError> {
        let i = self.index(id)?;
        let body = self.bodies[i].take();
        let body = body.ok_or(SceneError::UnknownBody { body: id })?;
        if let Some(gpu) = &mut self.gpu {
            gpu.remove(i);
        }
        self.sleep.remove(i);
        Ok(*body)
    }

    /// Returns the ids of all bodies in the order in which they were added.
    pub fn bodies(&self) -> impl Iterator<Item = BodyId> + '_ {
        let present = (self.bodies.iter().enumerate()).filter(|(_, body)| body.is_some());
        present.map(|(i, _)| self.body_id(i))
    }

    /// Returns the id of the body with an index, which counts the bodies that were added.
    ///
    /// `None` if there is none, or it was removed. Loading a saved scene keeps the indices.
    #[must_use]
    pub fn find_body(&self, index: usize) -> Option<BodyId> {
        let body = self.bodies.get(index)?.as_ref();
        body.map(|_| self.body_id(index))
    }

    /// Returns the id of a body by index.
    pub(crate) const fn body_id(&self, index: usize) -> BodyId {
        BodyId {
            scene: self.number,
            index,
        }
    }

    /// Returns the index of a body of this scene, present or removed.
    pub(crate) fn index(&self, id: BodyId) -> Result<usize, SceneError> {
        let is_present = self.bodies.get(id.index).is_some_and(Option::is_some);
        if id.scene == self.number && is_present {
            Ok(id.index)
        } else {
            Err(SceneError::UnknownBody { body: id })
        }
    }

    /// Returns a body: the CPU copy, which for a GPU body dates from the last readback.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`].
    pub fn body(&self, id: BodyId) -> Result<&Body, SceneError> {
        let i = self.index(id)?;
        let body = self.bodies[i].as_deref();
        body.ok_or(SceneError::UnknownBody { body: id })
    }

    pub(crate) fn body_mut(&mut self, id: BodyId) -> Result<&mut Body, SceneError> {
        let i = self.index(id)?;
        let body = self.bodies[i].as_deref_mut();
        body.ok_or(SceneError::UnknownBody { body: id })
    }

    /// Returns where the newest state of a body is.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`].
    pub fn residency(&self, id: BodyId) -> Result<Residency, SceneError> {
        let i = self.index(id)?;
        let gpu = self.gpu.as_ref();
        Ok(gpu.map_or(Residency::CpuOnly, |gpu| gpu.residency(i)))
    }

    /// Brings the CPU copy of a body up to date; waits for the GPU if it is not.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`]. [`SceneError::Step`] when positions are no longer finite,
    /// [`SceneError`] of the GPU when it fails; the copy is unchanged then. With
    /// [`crate::BackendChoice::Auto`] a GPU failure is no error: the scene continues on the CPU
    /// from the copy.
    pub fn read_back(&mut self, id: BodyId) -> Result<(), SceneError> {
        let i = self.index(id)?;
        if let (Some(gpu), Some(body)) = (&mut self.gpu, &mut self.bodies[i])
            && let Err(error) = gpu.read_back(i, body)
        {
            self.recover(None, error)?;
        }
        Ok(())
    }

    /// Reads a body back, wakes it and returns it for edits of pins, velocities and positions.
    ///
    /// The next [`Scene::cut`] or [`Scene::advance`] validates the edit.
    ///
    /// # Errors
    /// As [`Scene::read_back`].
    pub fn edit(&mut self, id: BodyId) -> Result<&mut Body, SceneError> {
        self.read_back(id)?;
        self.sleep.wake(id.index);
        self.detection.forget_overlaps(id.index);
        self.islands.forget(id.index);
        if let (Some(gpu), Some(body)) = (&mut self.gpu, &self.bodies[id.index]) {
            gpu.begin_edit(id.index, body.surface());
        }
        self.body_mut(id)
    }

    /// Undoes the last cut of a body with the [`Undo`](incise_mesh::Undo) of its
    /// [outcome](Self::cuts).
    ///
    /// The triangles from before the cut return. Vertices stay where they are now, except that
    /// pieces that have moved since the cut move together. Velocities stay. Incisions in the body
    /// end; their blades go on from their next motion.
    ///
    /// # Errors
    /// As [`Scene::read_back`]; [`SceneError::Undo`] when it does not belong to the body's last
    /// cut, [`SceneError::Constraint`] when the constraints cannot be restored,
    /// [`SceneError::Step`] when the pieces cannot move together.
    pub fn undo(&mut self, id: BodyId, undo: incise_mesh::Undo) -> Result<(), SceneError> {
        let params = self.params;
        let body = self.edit(id)?;
        body.validate_edit(id)?;
        body.refit();
        body.undo(id, undo, &params)
    }

    /// Returns the first triangle of a body that a ray hits, at the body's present position.
    ///
    /// # Errors
    /// As [`Scene::read_back`]; [`SceneError::RayNotFinite`].
    pub fn cast_ray(
        &mut self,
        id: BodyId,
        origin: Vec3,
        direction: Vec3,
    ) -> Result<Option<RayHit>, SceneError> {
        for (name, vector) in [("origin", origin), ("direction", direction)] {
            if let Some(&value) = vector.iter().find(|c| !c.is_finite()) {
                return Err(SceneError::RayNotFinite { name, value });
            }
        }
        self.read_back(id)?;
        let body = self.body_mut(id)?;
        body.refit();
        Ok(body.cast_ray(origin, direction))
    }

    /// Sets the position of a pinned vertex at the end of the next frame \[m\].
    ///
    /// Unlike [`Scene::edit`] this needs no readback, so a pin can be dragged in every frame. A
    /// changed target wakes the body.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`]; [`SceneError::Constraint`] when the vertex is not pinned or the
    /// target is not finite.
    pub fn set_pin_target(
        &mut self,
        id: BodyId,
        v: VertexId,
        to: [f32; 3],
    ) -> Result<(), SceneError> {
        let (_, solver) = self.body_mut(id)?.parts();
        let pins = solver.pins();
        let pin = pins.binary_search_by_key(&v, |pin| pin.vertex);
        let is_same = pin.is_ok_and(|k| pins[k].target == to);
        solver.set_pin_target(v, to)?;
        if !is_same {
            self.sleep.wake(id.index);
        }
        Ok(())
    }

    /// Returns whether a body sleeps, see [`crate::SleepParams`].
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`].
    pub fn is_asleep(&self, id: BodyId) -> Result<bool, SceneError> {
        Ok(self.sleep.is_asleep(self.index(id)?))
    }

    /// Wakes a body; for one that is awake restarts the time until it may fall asleep.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`].
    pub fn wake(&mut self, id: BodyId) -> Result<(), SceneError> {
        let i = self.index(id)?;
        self.sleep.wake(i);
        Ok(())
    }

    /// Waits until the GPU has finished all submitted work, for time measurements.
    ///
    /// # Errors
    /// [`SceneError`] of the GPU when it fails.
    pub fn wait_for_gpu(&mut self) -> Result<(), SceneError> {
        if let Some(gpu) = &self.gpu
            && let Err(error) = gpu.wait()
        {
            self.recover(None, error)?;
        }
        Ok(())
    }
}
