//! Blades and colliders of a [`Scene`].

use super::{Scene, index};
use crate::arguments::{EDGE, copy_f32, edge, index_of, value};
use crate::colliders::colliders;
use crate::error::WebError;
use incise::params::Value;
use incise::prelude::{BladeId, BladeMode};
use incise::scene::Blade;
use js_sys::Float32Array;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen]
impl Scene {
    /// Adds a blade and returns its number.
    ///
    /// `from_to` has the start and the end of its edge \[m\], 6 numbers. The blade may stop inside
    /// a body and go on from there, see `setFullSlices`.
    ///
    /// # Errors
    /// Throws for another length and numbers that are not finite.
    #[wasm_bindgen(js_name = addBlade)]
    pub fn add_blade_of_array(&mut self, from_to: &Float32Array) -> Result<u32, WebError> {
        self.add_blade(&copy_f32("the edge", from_to, Some(EDGE))?)
    }

    /// Moves a blade; the next step cuts along its sweep.
    ///
    /// # Errors
    /// Throws for an unknown blade, another length than 6 and numbers that are not finite.
    #[wasm_bindgen(js_name = moveBlade)]
    pub fn move_blade_to_array(
        &mut self,
        blade: f64,
        from_to: &Float32Array,
    ) -> Result<(), WebError> {
        self.move_blade(blade, &copy_f32("the edge", from_to, Some(EDGE))?)
    }

    /// Moves a blade without cutting. Ends its incisions.
    ///
    /// # Errors
    /// Throws for an unknown blade, another length than 6 and numbers that are not finite.
    #[wasm_bindgen(js_name = teleportBlade)]
    pub fn teleport_blade_to_array(
        &mut self,
        blade: f64,
        from_to: &Float32Array,
    ) -> Result<(), WebError> {
        self.teleport_blade(blade, &copy_f32("the edge", from_to, Some(EDGE))?)
    }

    /// Sets whether a blade cuts full slices alone: a sweep that ends inside a body is refused.
    ///
    /// # Errors
    /// Throws for an unknown blade.
    #[wasm_bindgen(js_name = setFullSlices)]
    pub fn set_full_slices(&mut self, blade: f64, full_slices: bool) -> Result<(), WebError> {
        let mode = match full_slices {
            true => BladeMode::FullSlices,
            false => BladeMode::Progressive,
        };
        Ok((self.simulation).set_blade_mode(self.blade_of(blade)?, mode)?)
    }

    /// Replaces the rigid obstacles, a list of objects with one shape each.
    ///
    /// They are `{ plane: { point, normal } }`, `{ sphere: { center, radius } }`,
    /// `{ capsule: { ends, radius } }` and `{ box: { center, half, axes } }`, where `axes` may be
    /// left out. A list of the same length moves them within the next frame.
    ///
    /// # Errors
    /// Throws for other objects and for shapes that are not solid; nothing is changed then.
    #[wasm_bindgen(js_name = setColliders)]
    pub fn set_colliders_of_objects(&mut self, colliders: &JsValue) -> Result<(), WebError> {
        self.set_colliders(&value(colliders)?)
    }
}

impl Scene {
    /// Adds a blade of 6 numbers, see [`Scene::add_blade_of_array`].
    ///
    /// # Errors
    /// [`WebError`], as there.
    pub fn add_blade(&mut self, from_to: &[f32]) -> Result<u32, WebError> {
        let edge = edge(from_to)?;
        Blade::check_edge(&edge)?;
        self.simulation.add_blade(edge);
        Ok(index(self.simulation.blades().count() - 1))
    }

    /// Replaces the rigid obstacles, see [`Scene::set_colliders_of_objects`].
    ///
    /// # Errors
    /// [`WebError`], as there.
    pub fn set_colliders(&mut self, values: &Value) -> Result<(), WebError> {
        self.simulation.colliders = colliders(values)?;
        Ok(())
    }

    /// Moves a blade, see [`Scene::move_blade_to_array`].
    ///
    /// # Errors
    /// [`WebError`], as there.
    pub fn move_blade(&mut self, blade: f64, from_to: &[f32]) -> Result<(), WebError> {
        let id = self.blade_of(blade)?;
        Ok(self.simulation.move_blade(id, edge(from_to)?)?)
    }

    /// Moves a blade without cutting, see [`Scene::teleport_blade_to_array`].
    ///
    /// # Errors
    /// [`WebError`], as there.
    pub fn teleport_blade(&mut self, blade: f64, from_to: &[f32]) -> Result<(), WebError> {
        let id = self.blade_of(blade)?;
        Ok(self.simulation.teleport_blade(id, edge(from_to)?)?)
    }

    fn blade_of(&self, blade: f64) -> Result<BladeId, WebError> {
        let found = index_of(blade).and_then(|i| self.simulation.blades().nth(i));
        found.ok_or(WebError::UnknownBlade { blade })
    }
}
