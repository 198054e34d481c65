//! The objective of a substep: its value and gradient by displacements, in 64 bits.
//!
//! Bending is as in [`kernels::bending`](crate::kernels::bending), without its limits.

use super::EnergySets;
use crate::constraints::batches::{BendingSet, StretchSet};
use crate::kernels::bending::FLAT;
use crate::step::constants::StepConstants;
use incise_mesh::Vec3;
use std::f64::consts::{PI, TAU};

/// Compliances over the squared substep, `alpha` of XPBD [1/kg].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
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

    /// Returns the value [kg m^2] and sets the gradient \[kg m\], zero at fixed vertices.
    ///
    /// `points` are the displaced positions \[m\], `inertia` are displacement minus prediction
    /// \[m\] and mass \[kg\], 0 of fixed vertices; all of shape [vertex slots].
    pub(super) fn evaluate(
        &self,
        points: &[Vec3],
        inertia: impl Iterator<Item = (Vec3, f64)>,
        gradient: &mut Vec<Vec3>,
    ) -> f64 {
        let mut value = 0.0;
        gradient.clear();
        gradient.extend(inertia.map(|(offset, mass)| {
            value += 0.5 * mass * offset.norm_squared();
            offset * mass
        }));
        let EnergySets {
            stretch,
            bending,
            interior_springs,
        } = self.sets;
        let Compliances {
            stretch: edge,
            bending: angle,
            interior_springs: spring,
        } = self.compliances;
        value += add_edges(stretch, 1.0 / edge, points, gradient);
        if let Some(springs) = interior_springs {
            value += add_edges(springs, 1.0 / spring, points, gradient);
        }
        if let Some(bending) = bending {
            value += add_hinges(bending, 1.0 / angle, points, gradient);
        }
        value
    }
}

/// Adds the energy and the forces of edges.
fn add_edges(set: &StretchSet, stiffness: f64, x: &[Vec3], gradient: &mut [Vec3]) -> f64 {
    let mut sum = 0.0;
    for batch in set.all() {
        for (ends, &rest) in batch.vertices().iter().zip(batch.rest()) {
            let [a, b] = ends.map(|v| v.index());
            let edge = x[b] - x[a];
            let length = edge.norm();
            let error = length - f64::from(rest);
            sum += error * error;
            if length > 0.0 {
                let force = edge * (stiffness * error / length);
                gradient[a] -= force;
                gradient[b] += force;
            }
        }
    }
    0.5 * stiffness * sum
}

/// Adds the energy and the forces of hinges.
fn add_hinges(set: &BendingSet, stiffness: f64, x: &[Vec3], gradient: &mut [Vec3]) -> f64 {
    let mut sum = 0.0;
    for batch in set.all() {
        for (vertices, &rest) in batch.vertices().iter().zip(batch.rest()) {
            let ids = vertices.map(|v| v.index());
            let Some((angle, slopes)) = hinge(ids.map(|i| x[i])) else {
                continue;
            };
            let error = wrapped(angle - f64::from(rest));
            sum += error * error;
            let force = stiffness * error;
            for (i, slope) in ids.into_iter().zip(slopes) {
                gradient[i] += slope * force;
            }
        }
    }
    0.5 * stiffness * sum
}

/// Returns an angle between -pi and pi.
fn wrapped(angle: f64) -> f64 {
    if angle > PI {
        angle - TAU
    } else if angle <= -PI {
        angle + TAU
    } else {
        angle
    }
}

/// Returns the angle of a hinge \[rad\] and its gradient [1/m].
///
/// `None` where a triangle is a sliver without a normal.
pub(super) fn hinge(points: [Vec3; 4]) -> Option<(f64, [Vec3; 4])> {
    let [e, a, b] = [1, 2, 3].map(|i: usize| points[i] - points[0]);
    let (n2, n3) = (e.cross(&a), b.cross(&e));
    let square = e.norm_squared();
    let (q2, q3) = (n2.norm_squared(), n3.norm_squared());
    let is_flat =
        |q: f64, side: &Vec3| q <= (f64::from(FLAT) * (square + side.norm_squared())).powi(2);
    if is_flat(q2, &a) || is_flat(q3, &b) {
        return None;
    }
    let length = square.sqrt();
    let angle = (-length * a.dot(&n3)).atan2(n2.dot(&n3));
    let (g2, g3) = (n2 * (-length / q2), n3 * (-length / q3));
    let (s, t) = (a.dot(&e) / square, b.dot(&e) / square);
    let g1 = -(g2 * s + g3 * t);
    Some((angle, [-(g1 + g2 + g3), g1, g2, g3]))
}
