//! Materials of bodies: density, stiffness, volume, interior springs, damping and friction.
//!
//! [`Solver::new`](crate::Solver::new) takes a [`Material`]; a step converts its stiffnesses to a
//! [`Projection`](crate::Projection) for the kernels once a frame.

use crate::error::ConstraintError;

/// Density of a body; its mass follows from the rest shape.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Density {
    /// Mass per area of a shell [kg/m^2].
    Area(f32),
    /// Mass per volume of a closed body [kg/m^3], distributed over the surface by rest area.
    Volume(f32),
}

/// Stiffness of a kind of constraint.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Stiffness {
    /// Stiffness `k` of position based dynamics, 0 to 1.
    ///
    /// All `n` iterations of a substep together remove the fraction `k` of the error; one
    /// projection removes `1 - (1 - k)^(1/n)` (Mueller et al. 2007, section 3.3).
    Pbd(f32),
    /// Inverse stiffness of XPBD: [m/N] for stretch, [rad/(N m)] for bending. 0 is rigid.
    ///
    /// Independent of time step and iterations (Macklin et al. 2016).
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

    /// Returns whether the constraint is rigid.
    pub(crate) fn is_rigid(self) -> bool {
        matches!(self, Self::Pbd(1.0) | Self::Compliance(0.0))
    }
}

/// Resistance of closed pieces to a change of their volume.
///
/// Pieces with a boundary, and pieces whose rest volume is zero or lost in rounding, have no volume
/// constraint.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Volume {
    /// Inverse bulk modulus [1/Pa]; 0 is incompressible, water has 5e-10.
    ///
    /// Independent of the size of a piece, the time step and the iterations.
    pub compressibility: f32,
    /// Target volume over rest volume: 1 keeps it, 0 collapses, more than 1 inflates (Mueller et
    /// al. 2007, section 4.4).
    pub pressure: f32,
}

impl Default for Volume {
    /// Returns an incompressible volume without excess pressure.
    fn default() -> Self {
        Self {
            compressibility: 0.0,
            pressure: 1.0,
        }
    }
}

impl Volume {
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

/// Springs between opposite vertices through a body, which keep its shape.
///
/// [`Volume`] alone keeps the volume, not the shape.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct InteriorSprings {
    /// Fraction of vertices that have a spring of their own, 0 to 1.
    ///
    /// Read by the code that searches the surface for springs (`incise-scene`), not by the solver.
    pub density: f32,
    /// Stiffness of the springs.
    pub stiffness: Stiffness,
}

impl Default for InteriorSprings {
    /// Returns one spring a vertex, as soft as flesh.
    fn default() -> Self {
        Self {
            density: 1.0,
            stiffness: Stiffness::Compliance(1e-3),
        }
    }
}

/// Material of a body.
///
/// [`Material::soft_body`], [`Material::shell`] and [`Material::cloth`] are starting points.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Material {
    /// Density, from which masses follow.
    pub density: Density,
    /// Stiffness of edges against a change of length.
    pub stretch: Stiffness,
    /// Stiffness of interior edges against a change of angle. `None` has no arrays and no passes.
    pub bending: Option<Stiffness>,
    /// Resistance of closed pieces to a change of volume. `None` costs nothing.
    pub volume: Option<Volume>,
    /// Springs through the body. `None` costs nothing.
    pub interior_springs: Option<InteriorSprings>,
    /// Rate at which velocities decay [1/s]; bodies rebound less with it.
    pub damping: f32,
    /// Coulomb friction coefficient against ground, colliders and contacts.
    pub friction: f32,
}

impl Default for Material {
    /// Returns a limp shell of 1 kg/m^2 that does not stretch; a closed one collapses on the
    /// ground.
    fn default() -> Self {
        Self {
            density: Density::Area(1.0),
            stretch: Stiffness::Pbd(1.0),
            bending: Some(Stiffness::Pbd(0.2)),
            volume: None,
            interior_springs: None,
            damping: 0.0,
            friction: 0.5,
        }
    }
}

impl Material {
    /// Returns a solid soft body that keeps its volume and its shape on the ground.
    ///
    /// Edges do not stretch, closed pieces are incompressible, and springs through the body hold
    /// its sides apart. `incise-scene` finds the springs; a solver of its own gets them by
    /// [`Solver::add_interior_springs`](crate::Solver::add_interior_springs).
    #[must_use]
    pub fn soft_body() -> Self {
        Self {
            volume: Some(Volume::default()),
            interior_springs: Some(InteriorSprings {
                density: 1.0,
                stiffness: Stiffness::Compliance(1e-6),
            }),
            damping: 1.0,
            ..Self::default()
        }
    }

    /// Returns a stiff shell of 1 kg/m^2 that keeps its curvature.
    #[must_use]
    pub fn shell() -> Self {
        Self {
            bending: Some(Stiffness::Pbd(1.0)),
            ..Self::default()
        }
    }

    /// Returns cloth of 0.2 kg/m^2 that does not stretch and bends freely.
    #[must_use]
    pub fn cloth() -> Self {
        Self {
            density: Density::Area(0.2),
            bending: None,
            ..Self::default()
        }
    }

    /// Checks that every number is in its range.
    ///
    /// # Errors
    /// [`ConstraintError`] with the first number that is not.
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
        if let Some(InteriorSprings { density, stiffness }) = self.interior_springs {
            if !(0.0..=1.0).contains(&density) {
                return Err(ConstraintError::BadSpringDensity { value: density });
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
        let interior_springs = |density| Material {
            interior_springs: Some(InteriorSprings {
                density,
                ..InteriorSprings::default()
            }),
            ..Material::default()
        };
        assert!(interior_springs(1.0).check().is_ok());
        let bad = interior_springs(1.5).check().unwrap_err();
        assert_eq!(bad, ConstraintError::BadSpringDensity { value: 1.5 });
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
