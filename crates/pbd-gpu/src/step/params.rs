//! Parameters and statistics of a frame.

use crate::error::StepError;
use crate::step::second_order::SUBSTEP_RATIO;
use crate::step::substeps::Substeps;
use incise_params::{Params, Range};
use std::num::NonZeroUsize;

incise_params::params! {
    /// Parameters of a frame. The y axis points up.
    ///
    /// By default there are 720 substeps a second of one iteration, near the smallest error in the
    /// same time (`docs/benchmarks.md`). Soft sheets gain from [`Integrator::Bdf2`]. More
    /// iterations in fewer substeps have larger errors (Macklin et al. 2019, "Small Steps in
    /// Physics Simulation").
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct SolverParams {
        /// Symmetric iterations per substep, usually 1 to 10.
        ///
        /// Each one projects edges, hinges and interior springs forward, then back in reverse
        /// order. This makes the product of these projections self-adjoint, so that no linear mode
        /// grows.
        ///
        /// Volumes, contacts and colliders follow once. They have up to 24 rounds where heavy
        /// pieces press thin ones, see [`LoadRatio`](crate::LoadRatio).
        iterations: u32 = 1, range: Self::COUNTS;
        /// Length of a substep; `None` is one substep per frame, as long as the frame.
        ///
        /// With `None`, frames of different lengths add energy. The default divides the frames of
        /// displays of 60, 72, 90, 120, 144 and 240 Hz.
        ///
        /// A frame takes the whole number of substeps that the time allows, and carries the
        /// remainder over to the next one. A constant length keeps the stiffness of rigid
        /// constraints constant: changes of it would add energy. Shorter substeps stiffen a body
        /// more than the same number of iterations.
        ///
        /// A [plane](crate::Collider::Plane) would flatten small bodies. So a body above one
        /// divides its substeps if it falls by more than 1/50 of its mean edge per iteration. With
        /// [`Material::volume`](crate::Material::volume) the limit is 1/500 of the thickness
        /// `2 V / A` of a piece, too.
        substep: Option<f32> = Some(1.0 / 720.0), range: Range::POSITIVE, unit: "s";
        /// Share of the last internal displacement that the prediction of a substep repeats.
        ///
        /// It removes most of the dissipation of implicit Euler. Values up to 1/2 keep every linear
        /// mode stable. [`Integrator::Bdf2`] and bodies in contact have none.
        lift: f32 = 0.48, range: Range::at_least(0.0).up_to(0.5);
        /// Gravitational acceleration.
        gravity: [f32; 3] = [0.0, -9.81, 0.0], unit: "m/s^2";
        /// Displacement per iteration and axis below which a substep ends its iterations early.
        ///
        /// `None` runs all iterations without the test. Near rest the displacements shrink with
        /// every iteration, so a skipped iteration changes a vertex by less than the residual. The
        /// GPU backend always runs all iterations.
        residual: Option<f32> = None, range: Range::NOT_NEGATIVE, unit: "m";
        /// Over-relaxation of the XPBD diagonal of compliant constraints, 1/2 to 1; 1 is XPBD.
        ///
        /// A projection divides by the greater of `w` and `compliance / h^2 + diagonal_scale w`,
        /// where `w = sum of |grad C|^2 / m`. With 1/2 the error of a single Gauss-Seidel iteration
        /// is of second order in the substep; with 1 bodies are softer and damped. Rigid
        /// constraints and PBD stiffness are unaffected, and more iterations converge to the same
        /// result.
        diagonal_scale: f32 = 0.5, range: Range::at_least(0.5).up_to(1.0);
        /// Restores the momenta of pieces that touch nothing, and limits the energy of bodies.
        ///
        /// Both remove errors of the substeps at the end of a frame. The limit is the energy at the
        /// start of the frame and that stored in constraints.
        conserve: bool = true;
        /// Enables [long range attachments](crate::LongRangeAttachment) of inextensible, pinned
        /// bodies.
        ///
        /// They cost one pass per iteration for such bodies.
        attachments: bool = true;
        /// Time integration of a substep.
        integrator: Integrator = Integrator::Euler;
        /// Maximum number of threads of a step on the CPU; `None` for all of the current rayon
        /// pool.
        ///
        /// The results do not depend on it. One thread is the calling thread: no pool is touched.
        /// Threads share the passes of large bodies, and small bodies of an island that has many;
        /// other small bodies take one.
        threads: Option<NonZeroUsize> = None, range: Range::at_least(1.0);
    }
}

incise_params::choices! {
    /// Time integration of a substep.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Integrator {
        /// Implicit Euler, of first order. It dissipates energy, more with longer substeps;
        /// [`SolverParams::lift`] removes most of that.
        Euler = "euler",
        /// BDF2, the second backward difference formula, of second order.
        ///
        /// It costs one more pass over the vertices per substep. The first substep, and any after a
        /// change of positions, velocities, masses or time step or a collision, is
        /// one of implicit Euler.
        ///
        /// Use it for compliant bodies. It does not dissipate energy, so unconverged errors of
        /// rigid constraints may add energy without bound. The GPU backend does not support it.
        Bdf2 = "bdf2",
    }
}

impl SolverParams {
    /// Returns the parameters of the paper: one substep of ten projections per frame.
    #[must_use]
    pub const fn paper() -> Self {
        Self {
            iterations: 5,
            substep: None,
            lift: 0.0,
            gravity: [0.0, -9.81, 0.0],
            residual: None,
            diagonal_scale: 1.0,
            conserve: false,
            attachments: false,
            integrator: Integrator::Euler,
            threads: None,
        }
    }

    /// Returns the parameters with `count` substeps in every frame of `dt` \[s\].
    #[must_use]
    pub const fn with_substeps(self, dt: f32, count: u32) -> Self {
        Self {
            substep: Some(dt / count as f32),
            ..self
        }
    }

    /// Returns the number of whole substeps in a frame of `dt` \[s\], without time left before.
    #[must_use]
    pub fn substeps(&self, dt: f32) -> u32 {
        Substeps::for_frame(0.0, dt, self).0.count
    }

    /// Returns whether the GPU backend can step bodies with these parameters.
    #[must_use]
    pub fn is_supported_on_gpu(&self) -> bool {
        self.integrator == Integrator::Euler
    }

    /// Maximum number of iterations, and of substeps of a frame.
    pub const MAX_COUNT: u32 = 1 << 20;

    /// Minimum length of a substep \[s\], the square root of the smallest normal number.
    ///
    /// With [`Integrator::Bdf2`] a substep counts as two thirds of its length.
    pub const MIN_SUBSTEP: f32 = 1.0 / (1_u64 << 63) as f32;

    /// Range of iterations.
    const COUNTS: Range = Range::at_least(1.0).up_to(Self::MAX_COUNT as f64);

    /// Checks all parameters and the time step `dt` \[s\].
    ///
    /// # Errors
    /// [`StepError`] for the first one out of range.
    pub fn check(&self, dt: f32) -> Result<(), StepError> {
        if !(dt.is_finite() && dt > 0.0) {
            return Err(StepError::BadTimeStep { value: dt });
        }
        self.check_ranges()?;
        let h = self.substep.unwrap_or(dt);
        if f64::from(dt) / f64::from(h) > f64::from(Self::MAX_COUNT) {
            return Err(StepError::SubstepTooShort { h });
        }
        let h = match self.integrator {
            Integrator::Euler => h,
            Integrator::Bdf2 => SUBSTEP_RATIO * h,
        };
        if h < Self::MIN_SUBSTEP {
            return Err(StepError::SubstepTooShort { h });
        }
        Ok(())
    }
}

/// Statistics of one frame.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StepStats {
    /// Number of substeps.
    pub substeps: u32,
    /// Number of passes over vertices or batches.
    pub passes: u32,
    /// Iterations skipped because of [`SolverParams::residual`].
    pub iterations_skipped: u32,
    /// Cells of solids projected.
    pub cell_projections: u64,
    /// Stretch constraints projected.
    pub stretch_projections: u64,
    /// Bending constraints projected.
    pub bending_projections: u64,
    /// Interior springs projected.
    pub interior_spring_projections: u64,
    /// Contacts tested, whether active or not.
    pub contact_projections: u64,
    /// Volume constraints projected.
    pub volume_projections: u64,
    /// Upper bound of the change of a coordinate in the frame, up to rounding \[m\].
    pub max_displacement: f32,
    /// Maximum change of a coordinate in a substep \[m\].
    pub max_substep_displacement: f32,
}
