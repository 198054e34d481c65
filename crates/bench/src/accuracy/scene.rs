//! A body, how it starts and how it is held: the same for the solver and for its reference.

use incise_bench::{Model, State};
use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, VertexId};
use incise_pbd_gpu::{Integrator, Material, Solver, SolverParams, Stiffness};
use std::error::Error;

/// Time of a frame \[s\].
pub(super) const DT: f32 = 1.0 / 60.0;

/// How constraints pull.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scheme {
    /// By compliances.
    Xpbd,
    /// The same, every constraint projected against half of its own weight.
    Half,
    /// The same with substeps of second order.
    Second,
    /// By the paper's stiffnesses of 0 to 1: in the middle of all constraints, what the same compliance leaves of
    /// a constraint that is alone.
    Pbd,
}

impl Scheme {
    pub(super) const ALL: [Self; 4] = [Self::Xpbd, Self::Half, Self::Second, Self::Pbd];

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Xpbd => "xpbd",
            Self::Half => "xpbd-half",
            Self::Second => "xpbd-half-bdf2",
            Self::Pbd => "pbd",
        }
    }
}

/// A scene.
pub(super) struct Scene {
    pub(super) name: &'static str,
    /// Where it starts; rest positions are its own.
    pub(super) surface: Surface,
    /// Compliances and mass.
    pub(super) material: Material,
    pub(super) pins: Vec<VertexId>,
    /// By vertex [m/s]; empty where all are at rest.
    pub(super) velocities: Vec<[f32; 3]>,
    /// What cuts it before the first frame.
    pub(super) sweep: Option<Sweep>,
    pub(super) gravity: [f32; 3],
    pub(super) ground: Option<f32>,
    pub(super) frames: u32,
    /// Steps of a frame that total errors are told from, each twice the one before.
    pub(super) fine: [u32; 3],
    /// Solver errors are told for no more substeps than these: a converged step of a large body takes seconds.
    pub(super) most_rungs: u32,
}

/// A scene's body with a solver.
#[derive(Clone)]
pub(super) struct Body {
    pub(super) surface: Surface,
    pub(super) solver: Solver,
}

impl Scene {
    /// A scene of nothing but a body that is at rest and free.
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
            most_rungs: 64,
        }
    }

    /// How frames are stepped by a scheme.
    pub(super) fn params_by(&self, scheme: Scheme, substeps: u32, iterations: u32) -> SolverParams {
        let own_weight = match scheme {
            Scheme::Half | Scheme::Second => 0.5,
            Scheme::Xpbd | Scheme::Pbd => 1.0,
        };
        let integrator = match scheme {
            Scheme::Second => Integrator::Bdf2,
            _ => Integrator::Euler,
        };
        SolverParams {
            own_weight,
            integrator,
            ..self.params(substeps, iterations)
        }
    }

    /// How frames are stepped, plainly.
    pub(super) fn params(&self, substeps: u32, iterations: u32) -> SolverParams {
        SolverParams {
            iterations,
            substeps,
            gravity: self.gravity,
            ground: self.ground,
            ..SolverParams::paper()
        }
    }

    /// The body at the start, of compliances.
    pub(super) fn body(&self) -> Result<Body, Box<dyn Error>> {
        self.body_of(&self.material)
    }

    /// The body at the start, of what a scheme takes for the compliances with substeps of `h` \[s\].
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

/// What a projection with this compliance over `h^2` removes of the middle constraint's error.
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
