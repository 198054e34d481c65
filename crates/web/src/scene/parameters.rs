//! Parameters of a scene as properties. A step checks them.

use super::Scene;
use crate::arguments::{cut_method, method_name};
use crate::error::WebError;
use incise::prelude::{ContactParams, SleepParams};
use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen]
impl Scene {
    /// Duration of a frame \[s\].
    #[wasm_bindgen(getter)]
    #[must_use]
    pub fn dt(&self) -> f32 {
        self.simulation.params.dt
    }

    /// Sets the duration of a frame \[s\].
    #[wasm_bindgen(setter)]
    pub fn set_dt(&mut self, seconds: f32) {
        self.simulation.params.dt = seconds;
    }

    /// Substeps of a frame; more are stiffer.
    #[wasm_bindgen(getter)]
    #[must_use]
    pub fn substeps(&self) -> u32 {
        self.simulation.params.solver.substeps
    }

    /// Sets the substeps of a frame.
    #[wasm_bindgen(setter)]
    pub fn set_substeps(&mut self, count: u32) {
        self.simulation.params.solver.substeps = count;
    }

    /// Iterations of a substep.
    #[wasm_bindgen(getter)]
    #[must_use]
    pub fn iterations(&self) -> u32 {
        self.simulation.params.solver.iterations
    }

    /// Sets the iterations of a substep.
    #[wasm_bindgen(setter)]
    pub fn set_iterations(&mut self, count: u32) {
        self.simulation.params.solver.iterations = count;
    }

    /// Sets the gravitational acceleration [m/s^2].
    #[wasm_bindgen(js_name = setGravity)]
    pub fn set_gravity(&mut self, x: f32, y: f32, z: f32) {
        self.simulation.params.solver.gravity = [x, y, z];
    }

    /// Height of the floor \[m\]; `undefined` without one.
    #[wasm_bindgen(getter)]
    #[must_use]
    pub fn floor(&self) -> Option<f32> {
        self.simulation.params.solver.ground
    }

    /// Sets the height of the floor \[m\], or removes it with `undefined`.
    #[wasm_bindgen(setter)]
    pub fn set_floor(&mut self, height: Option<f32>) {
        self.simulation.params.solver.ground = height;
    }

    /// Sets whether bodies and pieces touch each other, and the walls of incisions, too.
    #[wasm_bindgen(js_name = setContacts)]
    pub fn set_contacts(&mut self, enabled: bool, within_pieces: bool) {
        self.simulation.params.contacts = enabled.then(|| ContactParams {
            self_collision: within_pieces,
            ..ContactParams::default()
        });
    }

    /// Sets whether bodies at rest fall asleep, which saves their frames.
    #[wasm_bindgen(js_name = setSleep)]
    pub fn set_sleep(&mut self, enabled: bool) {
        self.simulation.params.sleep = enabled.then(SleepParams::default);
    }

    /// Refinement level of caps: `2x-coarser`, `1.5x-coarser`, `original`, `1.5x-finer`,
    /// `2x-finer` or a factor of the edge length as text.
    #[wasm_bindgen(getter)]
    #[must_use]
    pub fn level(&self) -> String {
        self.simulation.params.cut.refine.level.to_string()
    }

    /// Sets the refinement level of caps.
    ///
    /// # Errors
    /// Throws for another name.
    #[wasm_bindgen(setter)]
    pub fn set_level(&mut self, level: &str) -> Result<(), WebError> {
        self.simulation.params.cut.refine.level = level.parse()?;
        Ok(())
    }

    /// Method of cuts: `exact` or `paper`. The paper's cuts full slices alone.
    #[wasm_bindgen(getter)]
    #[must_use]
    pub fn method(&self) -> String {
        method_name(self.simulation.params.cut.method).to_owned()
    }

    /// Sets the method of cuts.
    ///
    /// # Errors
    /// Throws for another name.
    #[wasm_bindgen(setter)]
    pub fn set_method(&mut self, method: &str) -> Result<(), WebError> {
        self.simulation.params.cut.method = cut_method(method)?;
        Ok(())
    }
}
