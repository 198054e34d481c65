//! [`VolumeGradients`]: keeps directions of the minimizer tangent to incompressible volumes.
//!
//! The pass of volumes moves vertices by their areas and masses, against the elastic forces of the
//! body. A direction that keeps volumes to first order leaves that pass the curvature only.

use crate::constraints::volumes::{PieceVolume, VolumeSet};
use incise_mesh::Vec3;

/// Gradients of the volumes of all pieces, which have no vertex in common.
#[derive(Debug, Clone, Default)]
pub(super) struct VolumeGradients {
    /// Gradient of the vertex's piece [m^2], 0 at fixed vertices, shape [vertex slots].
    gradients: Vec<Vec3>,
    /// The same times the approximate inverse Hessian.
    conjugates: Vec<Vec3>,
}

impl VolumeGradients {
    /// Makes a direction tangent to all volumes.
    ///
    /// `points` are the displaced positions \[m\]. `inverse` multiplies a vector by the inverse
    /// Hessian of which `direction` comes, so that the result solves the constrained problem.
    pub(super) fn project(
        &mut self,
        set: &VolumeSet,
        points: impl Fn(usize) -> Vec3,
        masses: &[f64],
        direction: &mut [Vec3],
        inverse: impl FnOnce(&mut Vec<Vec3>),
    ) {
        let Self {
            gradients,
            conjugates,
        } = self;
        gradients.clear();
        gradients.resize(masses.len(), Vec3::zeros());
        for spoke in &set.spokes {
            let v = spoke.vertex.index();
            if masses[v] > 0.0 {
                let corner = points(v);
                let mut sum = Vec3::zeros();
                let mut ring = spoke
                    .ring(&set.rings)
                    .iter()
                    .map(|v| points(v.index()) - corner);
                let mut a = ring.next().unwrap_or_default();
                for b in ring {
                    sum += a.cross(&b);
                    a = b;
                }
                gradients[v] = sum / 6.0;
            }
        }
        conjugates.clone_from(gradients);
        inverse(conjugates);
        for piece in &set.pieces {
            let along = dot(set, piece, gradients, direction);
            let square = dot(set, piece, gradients, conjugates);
            if square > 0.0 {
                for spoke in &set.spokes[piece.first..piece.end] {
                    let v = spoke.vertex.index();
                    direction[v] -= conjugates[v] * (along / square);
                }
            }
        }
    }

    /// Returns the memory \[bytes\].
    pub(super) fn bytes(&self) -> usize {
        size_of::<Vec3>() * (self.gradients.capacity() + self.conjugates.capacity())
    }
}

/// Returns the dot product of two vectors over a piece.
fn dot(set: &VolumeSet, piece: &PieceVolume, a: &[Vec3], b: &[Vec3]) -> f64 {
    let spokes = set.spokes[piece.first..piece.end].iter();
    let vertices = spokes.map(|spoke| spoke.vertex.index());
    vertices.map(|v| a[v].dot(&b[v])).sum()
}
