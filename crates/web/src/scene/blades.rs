//! Blades and colliders of a [`Scene`].

use super::{Scene, index};
use crate::arguments::{EDGE, copy_f32, edge, index_of, value};
use crate::colliders::colliders;
use crate::error::WebError;
use incise::cut;
use incise::params::Value;
use incise::prelude::{BladeId, BladeMode};
use incise::scene::Blade;
use js_sys::Float32Array;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

/// Where a blade is after its last step in a body.
#[wasm_bindgen]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IncisionState {
    /// Outside of the body, and it has cut nothing since it was inside.
    Outside,
    /// At the tip of its cut in the body, or behind it on the way in, which begins outside.
    Inside,
    /// Ahead of the tip, because the last step was refused. It is tried again from the same tip.
    Blocked,
    /// Outside, and its cut is complete.
    Finished,
    /// Outside, and the tip of its cut is in the body.
    Abandoned,
}

impl From<cut::IncisionState> for IncisionState {
    fn from(state: cut::IncisionState) -> Self {
        match state {
            cut::IncisionState::Outside => Self::Outside,
            cut::IncisionState::Inside => Self::Inside,
            cut::IncisionState::Blocked => Self::Blocked,
            cut::IncisionState::Finished => Self::Finished,
            cut::IncisionState::Abandoned => Self::Abandoned,
        }
    }
}

/// The incision of a blade in a body.
#[wasm_bindgen]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Incision {
    /// Where the blade is after its last step.
    #[wasm_bindgen(readonly)]
    pub state: IncisionState,
    /// Number of refused steps since the last one that cut.
    #[wasm_bindgen(readonly, js_name = refusedSteps)]
    pub refused_steps: u32,
}

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

    /// Returns the incision of a blade in a body.
    ///
    /// A blade that has cut nothing, or whose incisions have ended, is `IncisionState.Outside`.
    ///
    /// # Errors
    /// Throws for an unknown blade or body.
    pub fn incision(&self, blade: f64, body: f64) -> Result<Incision, WebError> {
        let (blade, body) = (self.blade_of(blade)?, self.body_of(body)?.id);
        let incision = self.simulation.incision(blade, body)?;
        let state = incision.map(cut::Incision::state).unwrap_or_default();
        Ok(Incision {
            state: state.into(),
            refused_steps: incision.map_or(0, cut::Incision::refused_steps),
        })
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
