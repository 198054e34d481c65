//! The scene: what it holds and how it is set up.

use crate::backend::BackendState;
use crate::blade::{Blade, BladeId};
use crate::body::{Body, BodyId};
use crate::contacts::Flat;
use crate::device::Device;
use crate::error::SceneError;
use crate::params::SceneParams;
use crate::sleep::Sleep;
use crate::stats::FrameStats;
use incise_cut::{CutError, CutOutcome, RayHit};
use incise_mesh::{Surface, Vec3, VertexId};
use incise_pbd_gpu::{Collider, Material, PatchParams};

/// A cut that could not be done. The body is as it was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refusal {
    /// Which body.
    pub body: BodyId,
    /// Why.
    pub error: CutError,
}

/// The bodies of a scene by their ids. None where one was removed: ids are not given out again.
pub(crate) type Bodies = [Option<Box<Body>>];

/// Bodies, blades and how they are stepped.
#[derive(Debug, Default)]
pub struct Scene {
    /// How frames are stepped; may change between frames.
    pub params: SceneParams,
    /// What all bodies stay out of; may change between frames. Bodies near one that came, went or changed wake. Of a
    /// body that the processor steps those that are far are left out.
    pub colliders: Vec<Collider>,
    /// Those of the frame before.
    pub(crate) known_colliders: Vec<Collider>,
    /// The flats of blades, and those of the frame before.
    pub(crate) flats: Vec<Flat>,
    pub(crate) known_flats: Vec<Flat>,
    /// Colliders near the body at hand. Its content matters to nobody between bodies.
    pub(crate) near_colliders: Vec<Collider>,
    pub(crate) bodies: Vec<Option<Box<Body>>>,
    pub(crate) blades: Vec<Blade>,
    pub(crate) stats: FrameStats,
    pub(crate) refusals: Vec<Refusal>,
    pub(crate) outcomes: Vec<(BodyId, CutOutcome)>,
    /// Bodies that the sweep at hand comes to. Its content matters to nobody between sweeps.
    pub(crate) near: Vec<usize>,
    pub(crate) sleep: Sleep,
    /// The device that bodies live on, if any do.
    pub(crate) device: Option<Device>,
    pub(crate) backend: BackendState,
}

impl Scene {
    /// An empty scene that the processor steps; [`Scene::with_backend`] has the others.
    #[must_use]
    pub fn new(params: SceneParams) -> Self {
        Self {
            params,
            ..Self::default()
        }
    }

    /// Adds a body at rest.
    ///
    /// # Errors
    /// [`SceneError::Constraint`] when the surface or the material cannot be simulated, and what the
    /// device says when it has no room; the scene is as it was then.
    pub fn add_body(
        &mut self,
        surface: Surface,
        material: &Material,
    ) -> Result<BodyId, SceneError> {
        self.place(Body::new(surface, material, None)?)
    }

    /// As [`Scene::add_body`], with the body divided into patches, see [`incise_pbd_gpu::Solver::with_patches`]: worth it
    /// for large bodies on a device.
    ///
    /// # Errors
    /// As [`Scene::add_body`]; [`SceneError::Constraint`] also when the parameters are out of range.
    pub fn add_body_with_patches(
        &mut self,
        surface: Surface,
        material: &Material,
        patches: &PatchParams,
    ) -> Result<BodyId, SceneError> {
        self.place(Body::new(surface, material, Some(patches))?)
    }

    fn place(&mut self, body: Body) -> Result<BodyId, SceneError> {
        let i = self.bodies.len();
        self.bodies.push(Some(Box::new(body)));
        self.sleep.add(i);
        if let Err(error) = self.settle(i) {
            self.bodies.pop();
            return Err(error);
        }
        Ok(BodyId(i))
    }

    /// Gives a body to the device if it is to live there.
    pub(crate) fn settle(&mut self, i: usize) -> Result<(), SceneError> {
        if let (Some(device), Some(body)) = (&mut self.device, &mut self.bodies[i])
            && let Err(error) = device.add(i, body)
        {
            self.recover(Some(i), error)?;
        }
        Ok(())
    }

    /// Takes a body out of the scene, up to date. Its id is not used again. None if it was removed before.
    ///
    /// # Errors
    /// As [`Scene::read`]; the body stays then.
    ///
    /// # Panics
    /// When the id is another scene's.
    pub fn remove_body(&mut self, id: BodyId) -> Result<Option<Body>, SceneError> {
        if self.bodies[id.0].is_some() {
            self.read(id)?;
        }
        Ok(self.discard_body(id))
    }

    /// As [`Scene::remove_body`], as it was when it was last read: for one that cannot be read any more, say.
    ///
    /// # Panics
    /// When the id is another scene's.
    pub fn discard_body(&mut self, id: BodyId) -> Option<Body> {
        if let Some(device) = &mut self.device {
            device.remove(id.0);
        }
        self.sleep.remove(id.0);
        self.bodies[id.0].take().map(|body| *body)
    }

    /// Adds a blade with its edge from start to end \[m\].
    pub fn add_blade(&mut self, edge: [[f32; 3]; 2]) -> BladeId {
        self.blades.push(Blade::new(edge));
        BladeId(self.blades.len() - 1)
    }

    /// A body: the host's copy, which of a body on a device is as old as the last [`Scene::read`].
    ///
    /// # Panics
    /// When the id is another scene's, or the body was removed.
    #[must_use]
    pub fn body(&self, id: BodyId) -> &Body {
        match &self.bodies[id.0] {
            Some(body) => body,
            None => panic!("body {} was removed", id.0),
        }
    }

    /// Whether the host's copy of a body is where the body is. Always so for one that the processor
    /// steps.
    #[must_use]
    pub fn is_fresh(&self, id: BodyId) -> bool {
        (self.device.as_ref()).is_none_or(|device| device.is_fresh(id.0))
    }

    /// Brings the host's copy of a body up to date. Does nothing if it is; else waits for the device.
    ///
    /// # Errors
    /// [`SceneError::Step`] when the body has left the numbers; [`SceneError::Gpu`] when the device
    /// fails. The copy is as it was then. With [`crate::BackendChoice::Auto`] a device that fails is no
    /// error: the scene goes on from the copy.
    ///
    /// # Panics
    /// When the id is another scene's, or the body was removed.
    pub fn read(&mut self, id: BodyId) -> Result<(), SceneError> {
        let _exists = self.body(id);
        if let (Some(device), Some(body)) = (&mut self.device, &mut self.bodies[id.0])
            && let Err(error) = device.read(id.0, body)
        {
            self.recover(None, error)?;
        }
        Ok(())
    }

    /// A body, up to date, to pin vertices, set velocities or put vertices elsewhere. The next frame
    /// begins with what was edited; a body that slept is awake in it.
    ///
    /// # Errors
    /// As [`Scene::read`].
    ///
    /// # Panics
    /// When the id is another scene's, or the body was removed.
    pub fn edit(&mut self, id: BodyId) -> Result<&mut Body, SceneError> {
        self.read(id)?;
        self.sleep.wake(id.0);
        match &mut self.bodies[id.0] {
            Some(body) => {
                if let Some(device) = &mut self.device {
                    device.hand_out(id.0, body.surface());
                }
                Ok(body)
            }
            None => panic!("body {} was removed", id.0),
        }
    }

    /// Takes the last cut of a body back, with the [`Undo`](incise_mesh::Undo) of its [outcome](Self::outcomes): the old triangles
    /// where the vertices are now. The next frame begins with that.
    ///
    /// # Errors
    /// As [`Scene::read`]; [`SceneError::Undo`] when it is not of the body's last cut, [`SceneError::Constraint`] when its
    /// constraints cannot follow.
    ///
    /// # Panics
    /// When the id is another scene's, or the body was removed.
    pub fn undo(&mut self, id: BodyId, undo: incise_mesh::Undo) -> Result<(), SceneError> {
        let body = self.edit(id)?;
        body.refit();
        body.undo(undo)
    }

    /// The triangle of a body that a ray meets first, where the body is now: what is under a pointer. Nothing moves or wakes.
    ///
    /// # Errors
    /// As [`Scene::read`].
    ///
    /// # Panics
    /// When the id is another scene's, or the body was removed.
    pub fn cast(
        &mut self,
        id: BodyId,
        origin: Vec3,
        direction: Vec3,
    ) -> Result<Option<RayHit>, SceneError> {
        self.read(id)?;
        Ok(self.bodies[id.0].as_mut().and_then(|body| {
            body.refit();
            body.cast(origin, direction)
        }))
    }

    /// Where a pinned vertex is to be at the end of the next frame \[m\]. Unlike [`Scene::edit`] this
    /// needs nothing from the device, so a pin may be dragged in every frame. A target elsewhere than before wakes
    /// the body.
    ///
    /// # Errors
    /// [`SceneError::Constraint`] when the vertex is not pinned or the target is not finite.
    ///
    /// # Panics
    /// When the id is another scene's, or the body was removed.
    pub fn set_pin_target(
        &mut self,
        id: BodyId,
        v: VertexId,
        to: [f32; 3],
    ) -> Result<(), SceneError> {
        match &mut self.bodies[id.0] {
            Some(body) => {
                let solver = body.parts().1;
                let pins = solver.pins();
                let known = pins.binary_search_by_key(&v, |pin| pin.vertex);
                let is_there = known.is_ok_and(|k| pins[k].target == to);
                solver.set_pin_target(v, to)?;
                if !is_there {
                    self.sleep.wake(id.0);
                }
                Ok(())
            }
            None => panic!("body {} was removed", id.0),
        }
    }

    /// Whether a body sleeps, see [`crate::SleepParams`].
    ///
    /// # Panics
    /// When the id is another scene's.
    #[must_use]
    pub fn is_asleep(&self, id: BodyId) -> bool {
        self.sleep.is_asleep(id.0)
    }

    /// Wakes a body, which goes on from where it is. One that is awake stays so for as long as if it had just woken.
    ///
    /// # Panics
    /// When the id is another scene's.
    pub fn wake(&mut self, id: BodyId) {
        self.sleep.wake(id.0);
    }

    /// A blade.
    ///
    /// # Panics
    /// When the id is another scene's.
    #[must_use]
    pub fn blade(&self, id: BladeId) -> &Blade {
        &self.blades[id.0]
    }

    /// All blades, in the order in which they were added.
    pub fn blades(&self) -> impl Iterator<Item = BladeId> + use<> {
        (0..self.blades.len()).map(BladeId)
    }

    /// Restricts a blade to one piece of the bodies, or frees it.
    ///
    /// # Panics
    /// When the id is another scene's.
    pub fn set_blade_piece(&mut self, id: BladeId, only_piece: Option<u32>) {
        self.blades[id.0].only_piece = only_piece;
    }

    /// Gives a blade a flat: a parallelogram from its edge to its back, so far away \[m\], that bodies touch from both sides where
    /// [`crate::SceneParams::contacts`] says how; pieces lie against it while it is between them, and it pushes them before it.
    /// It rubs as one that does not move along itself. `None`, as at first, leaves the edge alone.
    ///
    /// # Panics
    /// When the id is another scene's.
    pub fn set_blade_back(&mut self, id: BladeId, back: Option<[f32; 3]>) {
        self.blades[id.0].back = back;
    }

    /// Moves a blade: the next frame cuts along the way.
    ///
    /// # Panics
    /// When the id is another scene's.
    pub fn move_blade(&mut self, id: BladeId, edge: [[f32; 3]; 2]) {
        self.blades[id.0].move_to(edge);
    }

    /// Puts a blade elsewhere without cutting.
    ///
    /// # Panics
    /// When the id is another scene's.
    pub fn jump_blade(&mut self, id: BladeId, edge: [[f32; 3]; 2]) {
        self.blades[id.0].jump_to(edge);
    }

    /// Waits until the device has done everything that it was asked for: [`Scene::advance`] returns
    /// before. For who measures time.
    ///
    /// # Errors
    /// [`SceneError::Gpu`] when the device fails.
    pub fn wait(&mut self) -> Result<(), SceneError> {
        if let Some(device) = &self.device
            && let Err(error) = device.wait()
        {
            self.recover(None, error)?;
        }
        Ok(())
    }

    /// What the last frame did.
    #[must_use]
    pub fn stats(&self) -> &FrameStats {
        &self.stats
    }

    /// Cuts that the last frame could not do, for example because a sweep ended inside a body.
    #[must_use]
    pub fn refusals(&self) -> &[Refusal] {
        &self.refusals
    }

    /// Cuts that the last frame did.
    #[must_use]
    pub fn outcomes(&self) -> &[(BodyId, CutOutcome)] {
        &self.outcomes
    }
}
