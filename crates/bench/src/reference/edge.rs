//! Stretch: the length of an edge.

use super::measure::{Blocks, Kind, Measure, clamp_3};
use nalgebra::{Matrix3, Vector3};

/// The distance of two points \[m\] with its derivatives; none if they coincide, for then it has none.
#[must_use]
pub fn edge([a, b]: &[Vector3<f64>; 2]) -> Option<Measure<2>> {
    let apart = b - a;
    let length = apart.norm();
    if length <= 0.0 {
        return None;
    }
    let along = apart / length;
    let across = (Matrix3::identity() - along * along.transpose()) / length;
    Some(Measure {
        value: length,
        gradient: [-along, along],
        hessian: [[across, -across], [-across, across]],
    })
}

/// Edges, as steps use them.
pub(super) struct Edge;

impl Kind<2> for Edge {
    fn measure(points: &[Vector3<f64>; 2]) -> Option<Measure<2>> {
        edge(points)
    }

    fn error(value: f64, rest: f64) -> f64 {
        value - rest
    }

    fn clamp(hessian: &mut Blocks<2>) {
        let block = clamp_3(&hessian[0][0]);
        *hessian = [[block, -block], [-block, block]];
    }
}
