//! Parameters of a scene as properties, which are checked when they are set.

use super::Scene;
use crate::arguments::{count, cut_method, method_name};
use crate::error::WebError;
use incise::prelude::{ContactParams, SceneParams, SleepParams};
use wasm_bindgen::prelude::wasm_bindgen;

impl Scene {
    /// Changes the parameters, or nothing if one is out of range.
    fn change(&mut self, change: impl FnOnce(&mut SceneParams)) -> Result<(), WebError> {
        let mut params = self.simulation.params;
        change(&mut params);
        params.check()?;
        self.simulation.params = params;
        Ok(())
    }
}

#[wasm_bindgen]
impl Scene {
    /// Duration of a frame \[s\].
    #[wasm_bindgen(getter)]
    #[must_use]
    pub fn dt(&self) -> f32 {
        self.simulation.params.dt
    }

    /// Sets the duration of a frame \[s\].
    ///
    /// # Errors
    /// Throws for a value out of range; nothing is changed then.
    #[wasm_bindgen(setter)]
    pub fn set_dt(&mut self, seconds: f32) -> Result<(), WebError> {
        self.change(|params| params.dt = seconds)
    }

    /// Substeps of a frame; more are stiffer.
    #[wasm_bindgen(getter)]
    #[must_use]
    pub fn substeps(&self) -> u32 {
        self.simulation.params.solver.substeps
    }

    /// Sets the substeps of a frame.
    ///
    /// # Errors
    /// Throws for a value out of range; nothing is changed then.
    #[wasm_bindgen(setter)]
    pub fn set_substeps(&mut self, substeps: f64) -> Result<(), WebError> {
        let substeps = count("substeps", substeps)?;
        self.change(|params| params.solver.substeps = substeps)
    }

    /// Iterations of a substep.
    #[wasm_bindgen(getter)]
    #[must_use]
    pub fn iterations(&self) -> u32 {
        self.simulation.params.solver.iterations
    }

    /// Sets the iterations of a substep.
    ///
    /// # Errors
    /// Throws for a value out of range; nothing is changed then.
    #[wasm_bindgen(setter)]
    pub fn set_iterations(&mut self, iterations: f64) -> Result<(), WebError> {
        let iterations = count("iterations", iterations)?;
        self.change(|params| params.solver.iterations = iterations)
    }

    /// Sets the gravitational acceleration [m/s^2].
    ///
    /// # Errors
    /// Throws for a value out of range; nothing is changed then.
    #[wasm_bindgen(js_name = setGravity)]
    pub fn set_gravity(&mut self, x: f32, y: f32, z: f32) -> Result<(), WebError> {
        self.change(|params| params.solver.gravity = [x, y, z])
    }

    /// Height of the floor \[m\]; `undefined` without one.
    #[wasm_bindgen(getter)]
    #[must_use]
    pub fn floor(&self) -> Option<f32> {
        self.simulation.params.solver.ground
    }

    /// Sets the height of the floor \[m\], or removes it with `undefined`.
    ///
    /// # Errors
    /// Throws for a value out of range; nothing is changed then.
    #[wasm_bindgen(setter)]
    pub fn set_floor(&mut self, height: Option<f32>) -> Result<(), WebError> {
        self.change(|params| params.solver.ground = height)
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
