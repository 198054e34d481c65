//! The objective of a substep: its value and gradient by displacements, in 64 bits.

use super::EnergySets;
use super::energy::{Hinge, Line, add_energy};
use super::lanes::Row;
use crate::step::constants::StepConstants;
use incise_mesh::Vec3;

/// Compliances over the squared substep, `alpha` of XPBD [1/kg].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Compliances {
    pub(super) stretch: f64,
    /// Per squared angle [1/(kg m^2)].
    pub(super) bending: f64,
    pub(super) interior_springs: f64,
}

impl Compliances {
    /// Returns the compliances of a substep.
    pub(super) fn new(constants: &StepConstants) -> Self {
        Self {
            stretch: constants.stretch.alpha.into(),
            bending: constants.bending.alpha.into(),
            interior_springs: constants.interior_springs.alpha.into(),
        }
    }
}

/// The objective of a substep of one body.
#[derive(Debug, Clone, Copy)]
pub(super) struct Objective<'a> {
    sets: EnergySets<'a>,
    compliances: Compliances,
}

impl<'a> Objective<'a> {
    pub(super) fn new(sets: EnergySets<'a>, compliances: Compliances) -> Self {
        Self { sets, compliances }
    }

    /// Returns the value [kg m^2] and sets the gradient \[kg m\].
    ///
    /// `points` are the displaced positions \[m\], `inertia` are displacement minus prediction
    /// \[m\] and mass \[kg\], 0 of fixed vertices; all of shape [vertex slots].
    pub(super) fn evaluate(
        &self,
        points: &[Row],
        inertia: impl Iterator<Item = (Vec3, f64)>,
        gradient: &mut Vec<Row>,
    ) -> f64 {
        let mut value = 0.0;
        gradient.clear();
        gradient.extend(inertia.map(|(offset, mass)| {
            value += 0.5 * mass * offset.norm_squared();
            Row::from(offset * mass)
        }));
        let (sets, by) = (self.sets, self.compliances);
        value += add_energy::<Line, 2>(sets.stretch, 1.0 / by.stretch, points, gradient);
        if let Some(springs) = sets.interior_springs {
            value += add_energy::<Line, 2>(springs, 1.0 / by.interior_springs, points, gradient);
        }
        if let Some(bending) = sets.bending {
            value += add_energy::<Hinge, 4>(bending, 1.0 / by.bending, points, gradient);
        }
        value
    }
}
