//! Stretch constraint: the length of an edge with its derivatives.

use super::measure::{Blocks, Kind, Measure, Slope, clamp_3};
use nalgebra::{Matrix3, Vector3};

/// Returns the distance of two points \[m\] with its derivatives; none if they coincide.
#[must_use]
pub fn edge(points: &[Vector3<f64>; 2]) -> Option<Measure<2>> {
    let Slope { value, gradient } = slope(points)?;
    let (length, along) = (value, gradient[1]);
    let across = (Matrix3::identity() - along * along.transpose()) / length;
    Some(Measure {
        value,
        gradient,
        hessian: [[across, -across], [-across, across]],
    })
}

fn slope([a, b]: &[Vector3<f64>; 2]) -> Option<Slope<2>> {
    let apart = b - a;
    let length = apart.norm();
    let along = apart / length;
    (length > 0.0).then_some(Slope {
        value: length,
        gradient: [-along, along],
    })
}

/// The edge constraint.
pub(super) struct Edge;

impl Kind<2> for Edge {
    fn measure(points: &[Vector3<f64>; 2]) -> Option<Measure<2>> {
        edge(points)
    }

    fn slope(points: &[Vector3<f64>; 2]) -> Option<Slope<2>> {
        slope(points)
    }

    fn error(value: f64, rest: f64) -> f64 {
        value - rest
    }

    fn clamp(hessian: &mut Blocks<2>) {
        let block = clamp_3(&hessian[0][0]);
        *hessian = [[block, -block], [-block, block]];
    }
}
