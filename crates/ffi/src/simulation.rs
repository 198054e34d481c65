//! [`SceneObject`]: a scene behind a handle, ids as indices, and the stack of undoable cuts.

use crate::handles::Object;
use crate::memory::{check_finite, count};
use crate::params::SceneParams;
use crate::status::{Error, Status};
use incise::cut::Incision;
use incise::mesh::{Surface, VertexId};
use incise::params::{Params, Value};
use incise::pbd::Material;
use incise::scene::{
    self, BackendRequest, BladeId, BladeMode, Body, BodyId, SceneError, UndoStack,
};

/// Bodies and blades, stepped frame by frame.
#[derive(Debug)]
pub struct Scene {
    _opaque: [u8; 0],
}

/// A scene and its undoable cuts. Indices of the interface are those of its ids.
#[derive(Debug)]
pub(crate) struct SceneObject {
    pub(crate) scene: scene::Scene,
    blade_mode: BladeMode,
    undo: UndoStack,
}

impl Object for SceneObject {
    type Handle = Scene;
    const NAME: &'static str = "scene";
}

impl SceneObject {
    pub(crate) fn new(params: &SceneParams) -> Result<Self, Error> {
        let request = BackendRequest {
            choice: params.backend()?,
            ..BackendRequest::default()
        };
        Ok(Self {
            scene: scene::Scene::with_backend(
                params.check(scene::SceneParams::default())?,
                &request,
            )?,
            blade_mode: params.blade_mode()?,
            undo: UndoStack::new(params.undo_limit as usize),
        })
    }

    /// Loads a saved scene, whose parameters of the interface are the defaults.
    pub(crate) fn load(bytes: &[u8]) -> Result<Self, Error> {
        let defaults = SceneParams::from(&scene::SceneParams::default());
        Ok(Self {
            scene: scene::Scene::load(bytes)?,
            ..Self::new(&defaults)?
        })
    }

    /// Sets the parameters from the next frame on.
    pub(crate) fn set_params(&mut self, params: &SceneParams) -> Result<(), Error> {
        let (checked, mode) = (params.check(self.scene.params)?, params.blade_mode()?);
        if mode != self.blade_mode {
            for blade in self.scene.blades() {
                self.scene.set_blade_mode(blade, mode)?;
            }
        }
        self.scene.params = checked;
        self.blade_mode = mode;
        self.undo.set_limit(params.undo_limit as usize);
        Ok(())
    }

    /// Sets a parameter by name from the next frame on.
    pub(crate) fn set(&mut self, name: &str, value: &Value) -> Result<(), Error> {
        let mut params = self.scene.params;
        params.set(name, value)?;
        params.check()?;
        self.scene.params = params;
        Ok(())
    }

    /// Returns a parameter by name.
    pub(crate) fn get(&self, name: &str) -> Result<Value, Error> {
        Ok(self.scene.params.get(name)?)
    }

    /// Sets a parameter of a body's material by name from the next frame on.
    pub(crate) fn set_body(&mut self, body: u32, name: &str, value: &Value) -> Result<(), Error> {
        let id = self.body_id(body)?;
        let mut material = *self.scene.body(id)?.solver().material();
        material.set(name, value)?;
        let (solver, surface) = self.scene.edit(id)?.solver_mut();
        let set = solver.set_material(surface, &material);
        Ok(set.map_err(SceneError::from)?)
    }

    /// Returns a parameter of a body's material by name.
    pub(crate) fn get_body(&self, body: u32, name: &str) -> Result<Value, Error> {
        let id = self.body_id(body)?;
        Ok(self.scene.body(id)?.solver().material().get(name)?)
    }

    /// Adds a body and returns its index.
    pub(crate) fn add_body(&mut self, surface: Surface, material: &Material) -> Result<u32, Error> {
        Ok(count(self.scene.add_body(surface, material)?.index()))
    }

    /// Returns the id of a body.
    pub(crate) fn body_id(&self, body: u32) -> Result<BodyId, Error> {
        let id = self.scene.find_body(body as usize);
        let text = format_args!("body {body} is not in the scene: pass an index of a present body");
        id.ok_or_else(|| Error::new(Status::OutOfRange, text))
    }

    /// Returns a body with its newest state.
    pub(crate) fn body(&mut self, body: u32) -> Result<&Body, Error> {
        let id = self.body_id(body)?;
        self.scene.read_back(id)?;
        Ok(self.scene.body(id)?)
    }

    pub(crate) fn remove_body(&mut self, body: u32) -> Result<(), Error> {
        let id = self.body_id(body)?;
        self.scene.remove_body(id)?;
        self.undo.forget(id);
        Ok(())
    }

    /// Returns a vertex of a body that triangles use.
    pub(crate) fn vertex(&mut self, body: u32, vertex: u32) -> Result<VertexId, Error> {
        let topology = self.body(body)?.surface().topology();
        let slots = topology.vertex_slots();
        if vertex as usize >= slots {
            return Err(out_of_range("vertex", vertex, slots));
        }
        Ok(VertexId(vertex))
    }

    /// Adds a blade and returns its index.
    pub(crate) fn add_blade(&mut self, edge: [f32; 6]) -> Result<u32, Error> {
        let id = self.scene.add_blade(to_edge(edge)?);
        self.scene.set_blade_mode(id, self.blade_mode)?;
        Ok(count(self.scene.blades().count() - 1))
    }

    fn blade_id(&self, blade: u32) -> Result<BladeId, Error> {
        let id = self.scene.blades().nth(blade as usize);
        id.ok_or_else(|| out_of_range("blade", blade, self.scene.blades().count()))
    }

    /// Moves a blade; `is_cutting` tells whether the next frame cuts along its sweep.
    pub(crate) fn move_blade(
        &mut self,
        blade: u32,
        edge: [f32; 6],
        is_cutting: bool,
    ) -> Result<(), Error> {
        let (id, edge) = (self.blade_id(blade)?, to_edge(edge)?);
        match is_cutting {
            true => self.scene.move_blade(id, edge)?,
            false => self.scene.teleport_blade(id, edge)?,
        }
        Ok(())
    }

    /// Returns the incision of a blade in a body; none before its first cut.
    pub(crate) fn incision(&self, blade: u32, body: u32) -> Result<Option<&Incision>, Error> {
        let (blade, body) = (self.blade_id(blade)?, self.body_id(body)?);
        Ok(self.scene.incision(blade, body)?)
    }

    pub(crate) fn set_blade_face(
        &mut self,
        blade: u32,
        face: Option<[f32; 3]>,
    ) -> Result<(), Error> {
        let id = self.blade_id(blade)?;
        Ok(self.scene.set_blade_face(id, face)?)
    }

    /// Steps by one frame and records the undos of its cuts.
    pub(crate) fn step(&mut self) -> Result<(), Error> {
        self.undo.step(&mut self.scene)?;
        Ok(())
    }

    /// Returns the number of cuts of a body that can be undone.
    pub(crate) fn undo_count(&self, body: u32) -> Result<u32, Error> {
        let id = self.body_id(body)?;
        Ok(count(self.undo.bodies().filter(|of| *of == id).count()))
    }

    /// Undoes the last cut of a body.
    pub(crate) fn undo(&mut self, body: u32) -> Result<(), Error> {
        let id = self.body_id(body)?;
        Ok(self.undo.undo(&mut self.scene, id)?)
    }

    /// Returns a line for each cut that failed in the last frame.
    pub(crate) fn failed_cuts(&self) -> String {
        let line = |failed: &scene::FailedCut| {
            format!(
                "blade {}, body {}: {}\n",
                failed.blade, failed.body, failed.error
            )
        };
        self.scene.failed_cuts().iter().map(line).collect()
    }
}

fn out_of_range(name: &str, index: u32, bound: usize) -> Error {
    let text = format_args!("{name} {index} is out of range: there are {bound}");
    Error::new(Status::OutOfRange, text)
}

fn to_edge(edge: [f32; 6]) -> Result<[[f32; 3]; 2], Error> {
    check_finite(&edge, "edge")?;
    let [ax, ay, az, bx, by, bz] = edge;
    Ok([[ax, ay, az], [bx, by, bz]])
}
