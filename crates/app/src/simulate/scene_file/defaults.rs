//! Values of keys that a scene leaves out, which are also those of options.

use super::{ContactsFile, SceneFile};
use crate::caps::CapsOption;
use crate::numbers::Numbers;
use crate::simulate::Backend;
use crate::simulate::output::SimulateOutput;
use incise_pbd_gpu::SolverParams;
use incise_scene::ContactParams;
use std::collections::BTreeMap;
use std::num::NonZeroU32;

/// Returns the time step of a frame \[s\].
pub(super) fn dt() -> f64 {
    1.0 / 60.0
}

/// Returns the solver iterations per substep.
pub(super) fn iterations() -> NonZeroU32 {
    NonZeroU32::new(SolverParams::default().iterations).unwrap_or(NonZeroU32::MIN)
}

/// Returns the substeps per frame.
pub(super) fn substeps() -> NonZeroU32 {
    NonZeroU32::new(SolverParams::default().substeps).unwrap_or(NonZeroU32::MIN)
}

/// Returns the gravitational acceleration [m/s^2].
pub(super) fn gravity() -> Numbers<3> {
    Numbers(SolverParams::default().gravity.map(f64::from))
}

pub(super) fn zero() -> Numbers<3> {
    Numbers([0.0; 3])
}

pub(super) fn yes() -> bool {
    true
}

impl Default for ContactsFile {
    /// Returns contacts of the scene's default thickness.
    fn default() -> Self {
        Self {
            enabled: true,
            thickness: ContactParams::default().thickness,
            self_collision: None,
        }
    }
}

impl SceneFile {
    /// Creates a scene without bodies.
    pub(in crate::simulate) fn new(seconds: f64) -> Self {
        Self {
            seconds,
            dt: dt(),
            iterations: iterations(),
            substeps: substeps(),
            gravity: gravity(),
            ground: None,
            caps: CapsOption::default(),
            repair: yes(),
            backend: Backend::default(),
            adapter: None,
            materials: BTreeMap::new(),
            bodies: Vec::new(),
            colliders: Vec::new(),
            cuts: Vec::new(),
            blades: Vec::new(),
            contacts: ContactsFile::default(),
            output: SimulateOutput::default(),
            source: None,
        }
    }
}
