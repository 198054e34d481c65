//! [`Scene`]: bodies in motion, blades that cut them, and buffers for a renderer.

mod blades;
mod buffers;
mod parameters;

use crate::arguments::{
    VECTOR, copy_f64, copy_u8, finite, index_of, material, to_js, value, vector,
};
use crate::error::WebError;
use crate::mesh::Mesh;
pub use blades::{Incision, IncisionState};
use buffers::BodyBuffers;
use incise::mesh::{Vec3, VertexId};
use incise::params::{Report, Value};
use incise::pbd::Material;
use incise::prelude::{BodyId, SceneParams};
use incise::scene::{Scene as Simulation, UndoStack};
use js_sys::{Float64Array, Uint8Array};
use std::num::NonZeroUsize;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

/// A simulation of soft bodies and blades, stepped frame by frame. The y axis points up.
///
/// Coordinates are relative to the `origin` of the first mesh, which is zero unless it is far away.
/// Bodies and blades have numbers. Arrays are views into the memory of the module, without a copy.
/// The next call of any function of the module may make them invalid: use a view at once, or copy
/// it with `slice()`.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Scene {
    simulation: Simulation,
    /// `None` where a body was removed.
    bodies: Vec<Option<Body>>,
    undo: UndoStack,
    /// The vertex that is dragged.
    grabbed: Option<(BodyId, VertexId)>,
}

#[derive(Debug)]
struct Body {
    id: BodyId,
    buffers: BodyBuffers,
}

/// The vertex and the point of a body that a ray hits.
#[wasm_bindgen]
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Pick {
    /// The nearest corner of the triangle, for `grab`.
    #[wasm_bindgen(readonly)]
    pub vertex: u32,
    /// The distance in lengths of the ray's direction.
    #[wasm_bindgen(readonly)]
    pub distance: f64,
}

impl Default for Scene {
    fn default() -> Self {
        Self::new()
    }
}

impl Scene {
    fn body_of(&self, body: f64) -> Result<&Body, WebError> {
        let found = index_of(body).and_then(|i| self.bodies.get(i)?.as_ref());
        found.ok_or(WebError::UnknownBody { body })
    }

    /// Gives a body of the simulation its number and buffers.
    fn insert(&mut self, id: BodyId) -> Result<u32, WebError> {
        let buffers = BodyBuffers::new(self.simulation.body(id)?.surface());
        self.bodies.resize_with(id.index(), || None);
        self.bodies.push(Some(Body { id, buffers }));
        Ok(index(id.index()))
    }

    /// Adds a copy of a mesh as a body at rest, see [`Scene::add_body_of_object`].
    ///
    /// # Errors
    /// [`WebError`] if the material is out of range or the mesh cannot be simulated.
    pub fn add_body(&mut self, mesh: &Mesh, values: &Value) -> Result<u32, WebError> {
        let surface = mesh.surface().clone();
        let material = material(values, Material::for_surface(&surface))?;
        let id = self.simulation.add_body(surface, &material)?;
        self.insert(id)
    }

    /// Makes a scene of the bytes of [`Scene::save`].
    ///
    /// # Errors
    /// [`WebError::Load`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, WebError> {
        let mut scene = Self::new();
        scene.simulation = Simulation::load(bytes)?;
        scene.simulation.params.solver.threads = NonZeroUsize::new(1);
        let bodies: Vec<BodyId> = scene.simulation.bodies().collect();
        for id in bodies {
            scene.insert(id)?;
        }
        Ok(scene)
    }

    /// Returns the first point of a body that a ray hits, see [`Scene::pick_by_arrays`].
    ///
    /// # Errors
    /// [`WebError`], as there.
    pub fn pick(
        &mut self,
        body: f64,
        origin: &[f64],
        direction: &[f64],
    ) -> Result<Option<Pick>, WebError> {
        let id = self.body_of(body)?.id;
        let origin = Vec3::from(vector("the origin", origin)?);
        let direction = Vec3::from(vector("the direction", direction)?);
        let Some(hit) = self.simulation.cast_ray(id, origin, direction)? else {
            return Ok(None);
        };
        let topology = self.simulation.body(id)?.surface().topology();
        let corners = topology.triangle(hit.triangle);
        Ok(Some(Pick {
            vertex: corners[hit.nearest_corner()].0,
            distance: hit.distance,
        }))
    }
}

#[wasm_bindgen]
impl Scene {
    /// Creates an empty scene with contacts between bodies and pieces, on one thread.
    #[wasm_bindgen(constructor)]
    #[must_use]
    pub fn new() -> Self {
        let mut params = SceneParams {
            contacts: Some(Default::default()),
            ..SceneParams::default()
        };
        params.solver.threads = NonZeroUsize::new(1);
        Self {
            simulation: Simulation::new(params),
            bodies: Vec::new(),
            undo: UndoStack::new(usize::MAX),
            grabbed: None,
        }
    }

    /// Makes a scene of the bytes of `save`, which goes on with the same bits.
    ///
    /// Bodies and blades keep their numbers. No cut can be undone and no vertex is grabbed.
    ///
    /// # Errors
    /// Throws for other or damaged bytes.
    pub fn load(bytes: &Uint8Array) -> Result<Self, WebError> {
        Self::from_bytes(&copy_u8("bytes", bytes, None)?)
    }

    /// Returns the scene as bytes: bodies, blades, colliders and parameters.
    ///
    /// # Errors
    /// Throws if memory is too small.
    pub fn save(&mut self) -> Result<Vec<u8>, WebError> {
        Ok(self.simulation.save()?)
    }

    /// Adds a copy of a mesh as a body at rest and returns its number.
    ///
    /// All coordinates of a scene are relative to the `origin` of its first mesh, to which others
    /// are moved.
    ///
    /// `material` is the name of a preset, such as `soft-body`, `jelly` or `cloth`, or an object
    /// such as `{ preset: "cloth", damping: 2 }`, whose values replace those of the preset.
    /// `docs/parameters.md` lists them. By default a closed mesh is a `soft-body`, a mesh with a
    /// boundary is `cloth`.
    ///
    /// # Errors
    /// Throws if the mesh cannot be simulated; the scene is then unchanged.
    #[wasm_bindgen(js_name = addBody)]
    pub fn add_body_of_object(&mut self, mesh: &Mesh, material: &JsValue) -> Result<u32, WebError> {
        self.add_body(mesh, &value(material)?)
    }

    /// Removes a body; its number is not used again.
    ///
    /// # Errors
    /// Throws for an unknown body.
    #[wasm_bindgen(js_name = removeBody)]
    pub fn remove_body(&mut self, body: f64) -> Result<(), WebError> {
        let id = self.body_of(body)?.id;
        self.simulation.remove_body(id)?;
        self.bodies[id.index()] = None;
        self.undo.forget(id);
        self.grabbed = self.grabbed.filter(|(own, _)| *own != id);
        Ok(())
    }

    /// Returns a copy of a body in its present shape.
    ///
    /// # Errors
    /// Throws for an unknown body.
    pub fn mesh(&self, body: f64) -> Result<Mesh, WebError> {
        let body = self.simulation.body(self.body_of(body)?.id)?;
        Ok(body.surface().clone().into())
    }

    /// Returns the number of pieces of a body.
    ///
    /// # Errors
    /// Throws for an unknown body.
    #[wasm_bindgen(js_name = pieceCount)]
    pub fn piece_count(&self, body: f64) -> Result<usize, WebError> {
        let body = self.simulation.body(self.body_of(body)?.id)?;
        Ok(body.surface().piece_count())
    }

    /// Returns whether a body is at rest and sleeps.
    ///
    /// # Errors
    /// Throws for an unknown body.
    #[wasm_bindgen(js_name = isAsleep)]
    pub fn is_asleep(&self, body: f64) -> Result<bool, WebError> {
        Ok(self.simulation.is_asleep(self.body_of(body)?.id)?)
    }

    /// Wakes a body, for example after a change of gravity.
    ///
    /// # Errors
    /// Throws for an unknown body.
    pub fn wake(&mut self, body: f64) -> Result<(), WebError> {
        Ok(self.simulation.wake(self.body_of(body)?.id)?)
    }

    /// Steps by one frame: cuts along the sweeps of the blades, then moves the bodies.
    ///
    /// A refused cut is no exception, see `failedCuts`.
    ///
    /// # Errors
    /// Throws for a parameter out of range, and if a body cannot be stepped. The cuts of the frame
    /// may be done then.
    pub fn step(&mut self) -> Result<(), WebError> {
        self.undo.step(&mut self.simulation)?;
        Ok(())
    }

    /// Returns the number of cuts that can be undone.
    #[wasm_bindgen(getter, js_name = undoCount)]
    #[must_use]
    pub fn undo_count(&self) -> usize {
        self.undo.bodies().len()
    }

    /// Undoes the last cut. A blade that moves within a body makes one cut a frame.
    ///
    /// Vertices stay where they are, except that pieces that have moved apart move together.
    ///
    /// # Errors
    /// Throws if there is none, or the body does not allow it.
    pub fn undo(&mut self) -> Result<(), WebError> {
        let last = self.undo.bodies().next_back();
        let body = last.ok_or(WebError::NothingToUndo)?;
        Ok(self.undo.undo(&mut self.simulation, body)?)
    }

    /// Returns the first point of a body that a ray hits.
    ///
    /// # Errors
    /// Throws for an unknown body, vectors of another length than 3 and numbers that are not
    /// finite.
    #[wasm_bindgen(js_name = pick)]
    pub fn pick_by_arrays(
        &mut self,
        body: f64,
        origin: &Float64Array,
        direction: &Float64Array,
    ) -> Result<Option<Pick>, WebError> {
        let origin = copy_f64("the origin", origin, Some(VECTOR))?;
        self.pick(
            body,
            &origin,
            &copy_f64("the direction", direction, Some(VECTOR))?,
        )
    }

    /// Returns the point to which all coordinates are relative \[m\]; zero without bodies.
    #[wasm_bindgen(getter)]
    #[must_use]
    pub fn origin(&self) -> Vec<f64> {
        self.simulation.origin().to_vec()
    }

    /// Grabs a vertex of a body, which `drag` moves; releases the one before.
    ///
    /// # Errors
    /// Throws for an unknown body or vertex.
    pub fn grab(&mut self, body: f64, vertex: f64) -> Result<(), WebError> {
        let id = self.body_of(body)?.id;
        self.release()?;
        let unknown = WebError::UnknownVertex { vertex };
        let v = VertexId::from_index(index_of(vertex).ok_or(unknown)?);
        let (solver, surface) = self.simulation.edit(id)?.solver_mut();
        solver.pin(surface, v)?;
        self.grabbed = Some((id, v));
        Ok(())
    }

    /// Moves the grabbed vertex to a point \[m\] in the next frame; nothing without one.
    ///
    /// A cut may remove the vertex, which ends the drag. Move it by less than an edge a frame.
    ///
    /// # Errors
    /// Throws for numbers that are not finite.
    pub fn drag(&mut self, x: f32, y: f32, z: f32) -> Result<(), WebError> {
        finite("the point", &[x, y, z].map(f64::from))?;
        match self.grabbed {
            Some((id, v)) if self.is_pinned(id, v) => {
                Ok(self.simulation.set_pin_target(id, v, [x, y, z])?)
            }
            _ => {
                self.grabbed = None;
                Ok(())
            }
        }
    }

    /// Releases the grabbed vertex; nothing without one.
    ///
    /// # Errors
    /// Throws if the body cannot be edited.
    pub fn release(&mut self) -> Result<(), WebError> {
        if let Some((id, v)) = self.grabbed.take()
            && self.is_pinned(id, v)
        {
            let (solver, surface) = self.simulation.edit(id)?.solver_mut();
            solver.unpin(surface, v)?;
        }
        Ok(())
    }

    fn is_pinned(&self, id: BodyId, v: VertexId) -> bool {
        let body = self.simulation.body(id);
        body.is_ok_and(|body| {
            let pins = body.solver().pins();
            pins.binary_search_by_key(&v, |pin| pin.vertex).is_ok()
        })
    }

    /// Returns counters and times \[s\] of the last frame by name, such as `stats.seconds.solver`.
    ///
    /// `docs/parameters.md` lists them.
    #[wasm_bindgen(getter)]
    #[must_use]
    pub fn stats(&self) -> JsValue {
        to_js(&self.simulation.stats().value())
    }

    /// Returns the time of the last frame \[ms\], up to the resolution of the browser's clock.
    #[wasm_bindgen(getter, js_name = frameMilliseconds)]
    #[must_use]
    pub fn frame_milliseconds(&self) -> f64 {
        self.simulation.stats().total().as_secs_f64() * 1e3
    }

    /// Returns the part of the last frame that cut \[ms\].
    #[wasm_bindgen(getter, js_name = cutMilliseconds)]
    #[must_use]
    pub fn cut_milliseconds(&self) -> f64 {
        self.simulation.stats().cutting().as_secs_f64() * 1e3
    }

    /// Returns the number of cuts of the last frame.
    #[wasm_bindgen(getter)]
    #[must_use]
    pub fn cuts(&self) -> u32 {
        self.simulation.stats().cuts
    }

    /// Returns the number of contacts of the last frame.
    #[wasm_bindgen(getter)]
    #[must_use]
    pub fn contacts(&self) -> usize {
        self.simulation.stats().contacts
    }

    /// Returns the reasons of the cuts that were refused in the last frame.
    #[wasm_bindgen(getter, js_name = failedCuts)]
    #[must_use]
    pub fn failed_cuts(&self) -> Vec<String> {
        let failed = self.simulation.failed_cuts().iter();
        failed.map(|failed| failed.error.to_string()).collect()
    }
}

/// Returns a number of a list, which is shorter than memory.
fn index(i: usize) -> u32 {
    incise::mesh::index_u32(i)
}

#[cfg(test)]
mod tests;
