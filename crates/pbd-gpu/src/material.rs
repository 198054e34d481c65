//! What a body is made of.

use crate::error::ConstraintError;
use crate::kernels::bending::{FIRM, HOLD, RECOVERY};
use crate::kernels::volume;

/// How a body's mass follows from its shape at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Density {
    /// A shell [kg/m^2].
    Area(f32),
    /// A closed body [kg/m^3]. Its mass sits in the surface, shared out by rest area.
    Volume(f32),
}

/// How hard a constraint pulls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stiffness {
    /// The stiffness `k` of position based dynamics, 0 to 1: the part of the error that all iterations of
    /// a substep remove together. One projection removes `1 - (1 - k)^(1/n)` of it, n = iterations
    /// (Mueller et al. 2007, section 3.3).
    Pbd(f32),
    /// The inverse stiffness of XPBD, independent of time step and iterations (Macklin et al. 2016):
    /// [m/N] for stretch, [rad/(N m)] for bending. 0 is rigid.
    Compliance(f32),
}

impl Stiffness {
    fn check(self) -> Result<(), ConstraintError> {
        match self {
            Self::Pbd(value) if !(0.0..=1.0).contains(&value) => {
                Err(ConstraintError::StiffnessOutOfRange { value })
            }
            Self::Compliance(value) if !(value.is_finite() && value >= 0.0) => {
                Err(ConstraintError::NegativeCompliance { value })
            }
            _ => Ok(()),
        }
    }

    /// Whether what is held so does not give way at all.
    pub(crate) fn is_rigid(self) -> bool {
        matches!(self, Self::Pbd(1.0) | Self::Compliance(0.0))
    }

    /// What one projection uses, for `iterations` of a substep of `h` \[s\].
    pub(crate) fn projection(self, iterations: u32, h: f32) -> Projection {
        match self {
            Self::Pbd(k) => Projection {
                factor: projected_share(k, iterations),
                alpha: 0.0,
                own_weight: 1.0,
                old: 0.0,
                keeps: false,
                recovery: RECOVERY * h,
                hold: FIRM,
            },
            Self::Compliance(compliance) => Projection {
                factor: 1.0,
                alpha: compliance / (h * h),
                own_weight: 1.0,
                old: 0.0,
                keeps: compliance > 0.0 && iterations > 1,
                recovery: RECOVERY * h,
                hold: FIRM,
            },
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a number between 0 and 1 is rounded to storage"
)]
fn projected_share(k: f32, iterations: u32) -> f32 {
    (1.0 - (1.0 - f64::from(k)).powf(1.0 / f64::from(iterations))) as f32
}

/// A stiffness as the kernels use it: `delta_lambda = -factor (C + alpha lambda) / max(w, alpha + own_weight w)` with
/// `w = sum of |grad C|^2 / m`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projection {
    /// The part of the error that one projection removes.
    pub factor: f32,
    /// `alpha_tilde = compliance / h^2`, times `1 + damping h` where velocities are damped.
    pub alpha: f32,
    /// As in [`SolverParams`](crate::SolverParams).
    pub own_weight: f32,
    /// The part of the errors that a substep begins with that it leaves; 0 but where shorter substeps follow a long one and
    /// the constraint is rigid.
    pub old: f32,
    /// Whether multipliers are remembered from one iteration to the next. A single iteration or a
    /// rigid constraint needs none.
    pub keeps: bool,
    /// How much of an angle's old error comes back in a substep where bending is rigid and edges are soft
    /// \[rad\]; of bending only.
    pub recovery: f32,
    /// By how much edges hold bending back \[kg\]; of bending only.
    pub hold: f32,
}

impl Projection {
    /// Of constraints that a body does not have.
    pub(crate) const NONE: Self = Self {
        factor: 0.0,
        alpha: 0.0,
        own_weight: 1.0,
        old: 0.0,
        keeps: false,
        recovery: 0.0,
        hold: 0.0,
    };

    /// Bending beside edges of that `alpha`.
    pub(crate) fn beside_edges(self, alpha: f32) -> Self {
        let hold = HOLD / alpha;
        Self {
            hold: if hold < FIRM { hold } else { FIRM },
            ..self
        }
    }
}

/// What the inside of a body does against a change of its volume, piece by piece. Pieces with a boundary, and those that
/// enclose nothing at rest, have no inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Volume {
    /// How much of its volume a piece gives way for every pascal that there is more in it than at rest [1/Pa]: the inverse
    /// bulk modulus, 5e-10 of water. Independent of the size of a piece, the time step and the iterations. 0 keeps the volume.
    pub compressibility: f32,
    /// How many times its rest volume a piece strives for: 1 is as at rest, 0 without any, more inflates it
    /// (Mueller et al. 2007, section 4.4).
    pub pressure: f32,
}

impl Default for Volume {
    /// The volume at rest, kept.
    fn default() -> Self {
        Self {
            compressibility: 0.0,
            pressure: 1.0,
        }
    }
}

/// A [`Volume`] as the kernels use it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VolumeProjection {
    /// `compressibility / h^2` of a rest volume of 1 m^3, times `1 + damping h` where velocities are damped.
    pub alpha: f32,
    /// As in [`Volume`].
    pub pressure: f32,
    /// As in [`SolverParams`](crate::SolverParams).
    pub own_weight: f32,
    /// How much of its rest volume an old error may come back by in a substep; more than there is of a compressible one.
    pub returned: f32,
    /// As in [`Projection`].
    pub old: f32,
    /// As in [`Projection`].
    pub keeps: bool,
}

impl VolumeProjection {
    /// Of a body that has no volumes.
    pub(crate) const NONE: Self = Self {
        alpha: 0.0,
        pressure: 1.0,
        own_weight: 1.0,
        returned: 0.0,
        old: 0.0,
        keeps: false,
    };
}

impl Volume {
    /// What one projection uses, for `iterations` of a substep of `h` \[s\].
    pub(crate) fn projection(self, iterations: u32, h: f32) -> VolumeProjection {
        let is_rigid = self.compressibility == 0.0;
        VolumeProjection {
            alpha: self.compressibility / (h * h),
            pressure: self.pressure,
            returned: if is_rigid { volume::RECOVERY * h } else { FIRM },
            keeps: !is_rigid && iterations > 1,
            ..VolumeProjection::NONE
        }
    }

    fn check(self) -> Result<(), ConstraintError> {
        let numbers = [
            ("compressibility", self.compressibility),
            ("pressure", self.pressure),
        ];
        match numbers
            .into_iter()
            .find(|&(_, n)| !(n.is_finite() && n >= 0.0))
        {
            Some((name, value)) => Err(ConstraintError::NegativeCoefficient { name, value }),
            None => Ok(()),
        }
    }
}

/// Struts between vertices that look at each other through a body: a body with them keeps its shape and not its volume alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Struts {
    /// How many struts there are to be a vertex, 0 to 1. Whoever searches the surface for them reads it; the
    /// solver does not.
    pub density: f32,
    /// How they resist a change of length.
    pub stiffness: Stiffness,
}

impl Default for Struts {
    /// One a vertex, as soft as flesh.
    fn default() -> Self {
        Self {
            density: 1.0,
            stiffness: Stiffness::Compliance(1e-3),
        }
    }
}

/// What a body is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Mass.
    pub density: Density,
    /// How edges resist a change of length.
    pub stretch: Stiffness,
    /// How interior edges resist a change of angle. `None` costs nothing: no arrays, no passes.
    pub bending: Option<Stiffness>,
    /// How pieces resist a change of the volume that they enclose. `None` costs nothing.
    pub volume: Option<Volume>,
    /// What holds the sides of a body apart. `None` costs nothing.
    pub struts: Option<Struts>,
    /// The rate at which velocities decay [1/s].
    pub damping: f32,
    /// Coulomb's coefficient against the ground.
    pub friction: f32,
}

impl Default for Material {
    /// A limp shell of 1 kg/m^2 that does not stretch.
    fn default() -> Self {
        Self {
            density: Density::Area(1.0),
            stretch: Stiffness::Pbd(1.0),
            bending: Some(Stiffness::Pbd(0.2)),
            volume: None,
            struts: None,
            damping: 0.0,
            friction: 0.5,
        }
    }
}

impl Material {
    /// Checks every number.
    ///
    /// # Errors
    /// The first one out of its range.
    pub fn check(&self) -> Result<(), ConstraintError> {
        let (Density::Area(value) | Density::Volume(value)) = self.density;
        if !(value.is_finite() && value > 0.0) {
            return Err(ConstraintError::BadDensity { value });
        }
        self.stretch.check()?;
        if let Some(bending) = self.bending {
            bending.check()?;
        }
        if let Some(volume) = self.volume {
            volume.check()?;
        }
        if let Some(Struts { density, stiffness }) = self.struts {
            if !(0.0..=1.0).contains(&density) {
                return Err(ConstraintError::BadStruts { value: density });
            }
            stiffness.check()?;
        }
        for (name, value) in [("damping", self.damping), ("friction", self.friction)] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(ConstraintError::NegativeCoefficient { name, value });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn n_projections_remove_what_the_stiffness_says() {
        for (k, n) in [(0.2, 1), (0.2, 10), (0.9, 7), (1.0, 10), (0.0, 3)] {
            let share = f64::from(Stiffness::Pbd(k).projection(n, 0.01).factor);
            let left = (1.0 - share).powi(n.cast_signed());
            assert!((left - (1.0 - f64::from(k))).abs() < 1e-6, "k {k}, n {n}");
        }
    }

    #[test]
    fn bad_numbers_are_named() {
        let bad = |change: fn(&mut Material)| {
            let mut material = Material::default();
            change(&mut material);
            material.check().unwrap_err()
        };
        let value = -1.0;
        assert_eq!(
            bad(|m| m.density = Density::Volume(-1.0)),
            ConstraintError::BadDensity { value }
        );
        assert_eq!(
            bad(|m| m.stretch = Stiffness::Compliance(-1.0)),
            ConstraintError::NegativeCompliance { value }
        );
        assert_eq!(
            bad(|m| m.bending = Some(Stiffness::Pbd(-1.0))),
            ConstraintError::StiffnessOutOfRange { value }
        );
        assert_eq!(
            bad(|m| m.friction = -1.0),
            ConstraintError::NegativeCoefficient {
                name: "friction",
                value
            }
        );
        let struts = |density| Material {
            struts: Some(Struts {
                density,
                ..Struts::default()
            }),
            ..Material::default()
        };
        assert!(struts(1.0).check().is_ok());
        let bad = struts(1.5).check().unwrap_err();
        assert_eq!(bad, ConstraintError::BadStruts { value: 1.5 });
        let volume = |change: fn(&mut Volume)| {
            let mut volume = Volume::default();
            change(&mut volume);
            let material = Material {
                volume: Some(volume),
                ..Material::default()
            };
            material.check().unwrap_err().to_string()
        };
        assert!(volume(|v| v.pressure = -1.0).contains("pressure -1"));
        assert!(volume(|v| v.compressibility = f32::NAN).contains("compressibility NaN"));
        assert!(Material::default().check().is_ok());
    }
}
