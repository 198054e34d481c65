//! Parameters of a scene by name.

use super::Scene;
use crate::arguments::{set, to_js, value};
use crate::error::WebError;
use incise::params::{Parameter, Params, Value};
use std::num::NonZeroUsize;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen]
impl Scene {
    /// Sets parameters by name, such as `{ iterations: 2, contacts: { thickness: 0.2 } }`.
    ///
    /// `docs/parameters.md` lists them. A name may leave out leading parts: `"solver.substep"` is
    /// `substep`. Optional parameters are off with `null`, those with parameters of their own also
    /// with `false`, and on with `true`. A scene has one thread.
    ///
    /// # Errors
    /// Throws for an unknown name and a value out of range; nothing is changed then.
    #[wasm_bindgen(js_name = set)]
    pub fn set_by_object(&mut self, values: &JsValue) -> Result<(), WebError> {
        self.set(&value(values)?)
    }

    /// Returns a parameter by name.
    ///
    /// # Errors
    /// Throws for an unknown name.
    #[wasm_bindgen(js_name = get)]
    pub fn get_as_object(&self, name: &str) -> Result<JsValue, WebError> {
        Ok(to_js(&self.get(name)?))
    }

    /// Returns all parameters as an object.
    #[wasm_bindgen(getter)]
    #[must_use]
    pub fn params(&self) -> JsValue {
        to_js(&self.simulation.params.value())
    }
}

impl Scene {
    /// Sets parameters by name, see [`Scene::set_by_object`].
    ///
    /// # Errors
    /// [`WebError`] for an unknown name and a value out of range; nothing is changed then.
    pub fn set(&mut self, values: &Value) -> Result<(), WebError> {
        let mut params = self.simulation.params;
        set(&mut params, values)?;
        params.solver.threads = NonZeroUsize::new(1);
        params.check()?;
        self.simulation.params = params;
        Ok(())
    }

    /// Returns a parameter by name.
    ///
    /// # Errors
    /// [`WebError::Parameter`] for an unknown name.
    pub fn get(&self, name: &str) -> Result<Value, WebError> {
        Ok(self.simulation.params.get(name)?)
    }
}
