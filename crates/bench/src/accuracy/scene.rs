//! A scene for the solver and the reference: body, initial motion, pins and schemes.

use crate::motion::{Body, DT};
use clap::ValueEnum;
use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, VertexId};
use incise_pbd_gpu::{Collider, Integrator, Material, Solver, SolverParams, Stiffness};
use incise_reference::{Model, State};
use serde::Serialize;
use std::error::Error;

/// A solver scheme.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Scheme {
    /// XPBD with compliances.
    Xpbd,
    /// XPBD with a diagonal scale of 0.5 and the default lift.
    XpbdHalf,
    /// XPBD with a diagonal scale of 0.5 and BDF2 substeps.
    XpbdHalfBdf2,
    /// Rigid patches, coarse to fine, in 64 bits: not in the product.
    Patches,
    /// The paper's stiffnesses of 0 to 1, those of an isolated constraint with the median weight
    /// and the same compliance.
    Pbd,
}

impl Scheme {
    /// Returns whether the GPU backend supports the scheme.
    pub(super) const fn is_on_gpu(self) -> bool {
        matches!(self, Self::Xpbd | Self::XpbdHalf | Self::Pbd)
    }

    /// Returns the largest number of iterations per frame, over all substeps: a cycle of patches
    /// takes as long as a thousand iterations of sweeps.
    pub(super) const fn most_iterations(self) -> u32 {
        match self {
            Self::Patches => 16,
            _ => u32::MAX,
        }
    }

    pub(super) const fn integrator(self) -> Integrator {
        match self {
            Self::XpbdHalfBdf2 => Integrator::Bdf2,
            _ => Integrator::Euler,
        }
    }
}

/// A body with its initial motion, pins and forces.
pub(super) struct Scene {
    pub(super) name: &'static str,
    /// Initial positions and rest positions.
    pub(super) surface: Surface,
    /// Compliances and mass.
    pub(super) material: Material,
    pub(super) pins: Vec<VertexId>,
    /// Velocity of every vertex [m/s]; empty for a body at rest.
    pub(super) velocities: Vec<[f32; 3]>,
    /// A cut before the first frame.
    pub(super) sweep: Option<Sweep>,
    pub(super) gravity: [f32; 3],
    /// Height of a horizontal plane \[m\].
    pub(super) ground: Option<f32>,
    pub(super) frames: u32,
    /// Steps a frame of the reference for total errors, each twice the one before.
    pub(super) fine: [u32; 3],
    /// Largest number of substeps with a converged reference: a converged step of a large body
    /// takes seconds.
    pub(super) max_reference_substeps: u32,
}

impl Scene {
    /// Returns a scene with a body at rest without pins.
    pub(super) fn new(name: &'static str, surface: Surface, material: Material) -> Self {
        Self {
            name,
            surface,
            material,
            pins: Vec::new(),
            velocities: Vec::new(),
            sweep: None,
            gravity: [0.0, -9.81, 0.0],
            ground: None,
            frames: 15,
            fine: [32, 64, 128],
            max_reference_substeps: 64,
        }
    }

    /// Returns the parameters of a scheme.
    pub(super) fn params_by(&self, scheme: Scheme, substeps: u32, iterations: u32) -> SolverParams {
        SolverParams {
            diagonal_scale: match scheme {
                Scheme::XpbdHalf | Scheme::XpbdHalfBdf2 => 0.5,
                _ => 1.0,
            },
            integrator: scheme.integrator(),
            lift: match scheme {
                Scheme::XpbdHalf => SolverParams::default().lift,
                _ => 0.0,
            },
            ..self.params(substeps, iterations)
        }
    }

    /// Returns the parameters of plain XPBD.
    pub(super) fn params(&self, substeps: u32, iterations: u32) -> SolverParams {
        SolverParams {
            iterations,
            gravity: self.gravity,
            ..SolverParams::paper()
        }
        .with_substeps(DT, substeps)
    }

    /// Returns the body at the start, with compliances.
    pub(super) fn body(&self) -> Result<Body, Box<dyn Error>> {
        self.body_of(&self.material)
    }

    /// Returns the body at the start, with a scheme's stiffnesses for substeps of `h` \[s\].
    pub(super) fn body_by(&self, scheme: Scheme, h: f64) -> Result<Body, Box<dyn Error>> {
        let body = self.body()?;
        if scheme != Scheme::Pbd {
            return Ok(body);
        }
        let model = Model::of(&body.solver, &body.surface, &self.params(1, 1))?;
        let state = State::of(&body.solver, &body.surface);
        let [edges, hinges, _] = model.weights(&state);
        let stretch = share(edges, model.stretch.compliance / (h * h));
        let bending = share(hinges, model.bending.compliance / (h * h));
        self.body_of(&Material {
            stretch: Stiffness::Pbd(stretch),
            bending: self.material.bending.map(|_| Stiffness::Pbd(bending)),
            ..self.material
        })
    }

    fn body_of(&self, material: &Material) -> Result<Body, Box<dyn Error>> {
        let mut surface = self.surface.clone();
        let mut solver = Solver::new(&mut surface, material)?;
        for &v in &self.pins {
            solver.pin(&mut surface, v)?;
        }
        let ground = self.ground.map(|height| Collider::ground(height).into());
        solver.set_colliders(ground.as_slice())?;
        for (v, &velocity) in surface.topology().vertices().zip(&self.velocities) {
            solver.set_velocity(v, velocity)?;
        }
        if let Some(sweep) = &self.sweep {
            let outcome = Cutter::new(&surface).cut(&mut surface, sweep, &CutParams::default())?;
            solver.apply_delta(&mut surface, &outcome.delta)?;
        }
        Ok(Body { surface, solver })
    }
}

/// Returns the share of the error that one projection removes at the median weight.
#[expect(
    clippy::cast_possible_truncation,
    reason = "a number between 0 and 1 is rounded to storage"
)]
fn share(mut weights: Vec<f64>, alpha: f64) -> f32 {
    weights.retain(|&w| w > 0.0);
    weights.sort_unstable_by(f64::total_cmp);
    weights
        .get(weights.len() / 2)
        .map_or(1.0, |w| (w / (w + alpha)) as f32)
}
