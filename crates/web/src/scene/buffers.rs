//! [`BodyBuffers`]: vertex and index buffers of a body, brought up to date when they are asked for.

use super::Scene;
use crate::arguments::index_of;
use crate::error::WebError;
use crate::memory_views::{view_f32, view_u32};
use incise::mesh::{RenderBuffers, RenderParams, Surface};
use js_sys::{Float32Array, Uint32Array};
use wasm_bindgen::prelude::wasm_bindgen;

/// The buffers of a body, and the state of the surface that they show.
#[derive(Debug)]
pub(super) struct BodyBuffers {
    buffers: RenderBuffers,
    topology: u64,
    motion: u64,
    /// Counts the changes of the index buffers.
    revision: u32,
}

impl BodyBuffers {
    pub(super) fn new(surface: &Surface) -> Self {
        Self {
            buffers: RenderBuffers::new(surface, RenderParams::default()),
            topology: surface.fingerprint(),
            motion: surface.motion_version(),
            revision: 0,
        }
    }

    /// Follows the surface: builds the buffers again after a cut, else moves their vertices.
    fn update(&mut self, surface: &Surface) {
        if self.topology != surface.fingerprint() {
            self.buffers.rebuild(surface);
            self.revision = self.revision.wrapping_add(1);
        } else if self.motion != surface.motion_version() {
            self.buffers.refresh(surface);
        }
        self.topology = surface.fingerprint();
        self.motion = surface.motion_version();
    }
}

impl Scene {
    /// Returns the buffers of a body, up to date.
    pub(super) fn buffers(&mut self, body: f64) -> Result<&RenderBuffers, WebError> {
        Ok(&self.updated(body)?.buffers)
    }

    fn updated(&mut self, body: f64) -> Result<&BodyBuffers, WebError> {
        let own = index_of(body).and_then(|i| self.bodies.get_mut(i)?.as_mut());
        let own = own.ok_or(WebError::UnknownBody { body })?;
        own.buffers.update(self.simulation.body(own.id)?.surface());
        Ok(&own.buffers)
    }
}

#[wasm_bindgen]
impl Scene {
    /// Returns a number that changes when a cut or an undo changes the index buffers of a body.
    ///
    /// # Errors
    /// Throws for an unknown body.
    pub fn revision(&mut self, body: f64) -> Result<u32, WebError> {
        Ok(self.updated(body)?.revision)
    }

    /// Returns a view of the positions of a body for a renderer \[m\], three a vertex.
    ///
    /// Vertices on creases, such as the rim of a cut, occur once for each side.
    ///
    /// # Errors
    /// Throws for an unknown body.
    pub fn positions(&mut self, body: f64) -> Result<Float32Array, WebError> {
        Ok(view_f32(self.buffers(body)?.positions().as_flattened()))
    }

    /// Returns a view of the unit normals of a body, three a vertex.
    ///
    /// # Errors
    /// Throws for an unknown body.
    pub fn normals(&mut self, body: f64) -> Result<Float32Array, WebError> {
        Ok(view_f32(self.buffers(body)?.normals().as_flattened()))
    }

    /// Returns a view of the vertex numbers of the skin of a body, three a triangle.
    ///
    /// # Errors
    /// Throws for an unknown body.
    #[wasm_bindgen(js_name = skinIndices)]
    pub fn skin_indices(&mut self, body: f64) -> Result<Uint32Array, WebError> {
        Ok(view_u32(self.buffers(body)?.skin_indices()))
    }

    /// Returns a view of the vertex numbers of the caps of a body, three a triangle.
    ///
    /// # Errors
    /// Throws for an unknown body.
    #[wasm_bindgen(js_name = capIndices)]
    pub fn cap_indices(&mut self, body: f64) -> Result<Uint32Array, WebError> {
        Ok(view_u32(self.buffers(body)?.cap_indices()))
    }
}
