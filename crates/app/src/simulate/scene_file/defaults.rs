//! Values of keys that a scene leaves out, which are also those of options.

use super::SceneFile;
use crate::numbers::Numbers;
use crate::simulate::Backend;
use crate::simulate::output::SimulateOutput;
use std::collections::BTreeMap;

/// Returns the time step of a frame \[s\].
pub(super) fn dt() -> f64 {
    1.0 / 60.0
}

pub(super) fn zero() -> Numbers<3> {
    Numbers([0.0; 3])
}

pub(super) fn yes() -> bool {
    true
}

impl SceneFile {
    /// Creates a scene without bodies.
    pub(in crate::simulate) fn new(seconds: f64) -> Self {
        Self {
            seconds,
            dt: dt(),
            repair: yes(),
            backend: Backend::default(),
            adapter: None,
            materials: BTreeMap::new(),
            bodies: Vec::new(),
            colliders: Vec::new(),
            cuts: Vec::new(),
            blades: Vec::new(),
            output: SimulateOutput::default(),
            params: BTreeMap::new(),
            source: None,
        }
    }
}
