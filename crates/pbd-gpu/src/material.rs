//! Materials of bodies: density, stiffness, volume, interior springs, damping and friction.
//!
//! [`Solver::new`](crate::Solver::new) takes a [`Material`]; a step converts its stiffnesses to a
//! [`Projection`](crate::Projection) for the kernels once a frame.

mod presets;

use crate::error::ConstraintError;
use incise_params::{Params, Range};

incise_params::variants! {
    /// Density of a body; its mass follows from the rest shape.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub enum Density = Self::Area(1.0);
    names {}
    values {
        /// Mass per area of a shell [kg/m^2].
        Area(f32) = "per_area", range: Range::POSITIVE, unit: "kg/m^2";
        /// Mass per volume of a closed body [kg/m^3], distributed over the surface by rest area.
        Volume(f32) = "per_volume", range: Range::POSITIVE, unit: "kg/m^3";
    }
}

incise_params::variants! {
    /// Stiffness of a kind of constraint.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub enum Stiffness = Self::Pbd(1.0);
    names {}
    values {
        /// Stiffness `k` of position based dynamics, 0 to 1.
        ///
        /// All `n` projections of a substep, two per iteration, remove the fraction `k` of the
        /// error; one removes `1 - (1 - k)^(1/n)` (Mueller et al. 2007, section 3.3).
        Pbd(f32) = "stiffness", range: Range::FRACTION;
        /// Inverse stiffness of XPBD; 0 is rigid.
        ///
        /// Independent of time step and iterations (Macklin et al. 2016).
        Compliance(f32) = "compliance", range: Range::NOT_NEGATIVE,
            unit: "m/N, rad/(N m) for bending";
    }
}

impl Stiffness {
    /// Returns whether the constraint is rigid.
    pub(crate) fn is_rigid(self) -> bool {
        matches!(self, Self::Pbd(1.0) | Self::Compliance(0.0))
    }
}

incise_params::params! {
    /// Resistance of closed pieces to a change of their volume.
    ///
    /// By default a volume is incompressible and without excess pressure. Pieces with a boundary,
    /// and pieces whose rest volume is zero or lost in rounding, have no volume constraint.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct Volume {
        /// Inverse bulk modulus; 0 is incompressible, water has 5e-10.
        ///
        /// Independent of the size of a piece, the time step and the iterations.
        compressibility: f32 = 0.0, range: Range::NOT_NEGATIVE, unit: "1/Pa";
        /// Target volume over rest volume: 1 keeps it, 0 collapses, more than 1 inflates (Mueller
        /// et al. 2007, section 4.4).
        pressure: f32 = 1.0, range: Range::NOT_NEGATIVE;
    }
}

incise_params::params! {
    /// Springs between opposite vertices through a body, which keep its shape.
    ///
    /// By default there is one spring a vertex, as soft as flesh. [`Volume`] alone keeps the
    /// volume, not the shape.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct InteriorSprings {
        /// Fraction of vertices that have a spring of their own, 0 to 1.
        ///
        /// Read by the code that searches the surface for springs (`incise-scene`), not by the
        /// solver.
        density: f32 = 1.0, range: Range::FRACTION;
        /// Stiffness of the springs.
        stiffness: Stiffness = Stiffness::Compliance(1e-3);
    }
}

incise_params::params! {
    /// Elasticity of the inside of a closed body, by a lattice of cells.
    ///
    /// A solid has the shape, the mass and the volume of its material, also in pieces. Stretch,
    /// bending, volume, interior springs and damping of the [`Material`] have no effect then.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct Solid {
        /// Young's modulus.
        young_modulus: f32 = 1e5, range: Range::POSITIVE, unit: "Pa";
        /// Poisson's ratio, the share of a stretch by which a rod becomes thinner; near 1/2 the
        /// material keeps its volume.
        poisson_ratio: f32 = 0.45, range: Range::at_least(0.0).up_to(0.495);
        /// Relaxation time of the viscosity: stress grows by this time, Young's modulus and the
        /// rate of strain.
        ///
        /// A vibration of angular frequency `w` decays at the rate `w^2 / 2` times this.
        relaxation_time: f32 = 0.005, range: Range::NOT_NEGATIVE, unit: "s";
        /// Length of the edges of a cell; `None` for a third of the thickness `2 V / A` of the
        /// body.
        cell_size: Option<f32> = None, range: Range::POSITIVE, unit: "m";
        /// Maximum number of cells along the longest side of the body, which enlarges cells.
        cells_across: u32 = 16, range: Range::at_least(1.0).up_to(64.0);
    }
}

incise_params::params! {
    /// Material of a body.
    ///
    /// The default is a limp shell of 1 kg/m^2 that does not stretch; a closed one collapses on the
    /// ground. [`Material::soft_body`] has an inside, [`Material::shell`] and [`Material::cloth`]
    /// are for sheets. [`Material::PRESETS`] names all starting points.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct Material {
        /// Density, from which masses follow.
        density: Density = Density::Area(1.0);
        /// Stiffness of edges against a change of length.
        stretch: Stiffness = Stiffness::Pbd(1.0);
        /// Stiffness of interior edges against a change of angle. `None` has no arrays and no
        /// passes.
        bending: Option<Stiffness> = Some(Stiffness::Pbd(0.2));
        /// Resistance of closed pieces to a change of volume. `None` costs nothing.
        volume: Option<Volume> = None;
        /// Springs through the body. `None` costs nothing.
        interior_springs: Option<InteriorSprings> = None;
        /// Elasticity of the inside of a closed body; `None` for a body that is only a surface.
        solid: Option<Solid> = None;
        /// Decay rate of velocities relative to the rigid motion of a piece.
        ///
        /// Bodies rebound less with it. It damps no fall, spin, roll or slide.
        damping: f32 = 0.0, range: Range::NOT_NEGATIVE, unit: "1/s";
        /// Coulomb friction coefficient against colliders and contacts.
        friction: f32 = 0.5, range: Range::NOT_NEGATIVE;
    }
}

impl Material {
    /// Checks that every number is in its range.
    ///
    /// # Errors
    /// [`ConstraintError::Parameter`] with the first number that is not.
    pub fn check(&self) -> Result<(), ConstraintError> {
        Ok(self.check_ranges()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_numbers_are_named() {
        let refused = |change: fn(&mut Material)| {
            let mut material = Material {
                volume: Some(Volume::default()),
                interior_springs: Some(InteriorSprings::default()),
                ..Material::soft_body()
            };
            change(&mut material);
            material.check().unwrap_err().to_string()
        };
        for (change, message) in [
            (
                (|m| m.density = Density::Volume(-1.0)) as fn(&mut Material),
                "density.per_volume is -1; it must be a finite number above 0",
            ),
            (
                |m| m.stretch = Stiffness::Compliance(-1.0),
                "stretch.compliance is -1; it must be a finite number of at least 0",
            ),
            (
                |m| m.bending = Some(Stiffness::Pbd(2.0)),
                "bending.stiffness is 2; it must be from 0 to 1",
            ),
            (
                |m| m.friction = f32::NAN,
                "friction is NaN; it must be a finite number of at least 0",
            ),
            (
                |m| m.volume.as_mut().unwrap().pressure = -1.0,
                "volume.pressure is -1; it must be a finite number of at least 0",
            ),
            (
                |m| m.solid.as_mut().unwrap().poisson_ratio = 0.5,
                "solid.poisson_ratio is 0.5; it must be from 0 to 0.495",
            ),
            (
                |m| m.interior_springs.as_mut().unwrap().density = 1.5,
                "interior_springs.density is 1.5; it must be from 0 to 1",
            ),
        ] {
            assert_eq!(refused(change), message);
        }
    }
}
