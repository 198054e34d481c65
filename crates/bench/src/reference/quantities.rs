//! What can be said of a state: energy, momentum, strain.

use super::edge::Edge;
use super::hinge::Hinge;
use super::measure::Kind;
use super::model::{Constraints, Model, State};
use super::volume::Volumes;
use nalgebra::Vector3;

impl Model {
    /// Kinetic energy \[J\].
    #[must_use]
    pub fn kinetic_energy(&self, state: &State) -> f64 {
        let each = self.mass.iter().zip(&state.v);
        each.map(|(m, v)| m * v.norm_squared() / 2.0).sum()
    }

    /// The energy of gravity, and of the constraints that give way \[J\].
    #[must_use]
    pub fn potential_energy(&self, state: &State) -> f64 {
        let each = self.mass.iter().zip(&state.x);
        let gravity: f64 = each.map(|(m, x)| -m * self.gravity.dot(x)).sum();
        gravity
            + energy::<Edge, 2>(&self.stretch, &state.x)
            + energy::<Hinge, 4>(&self.bending, &state.x)
            + volume_energy(self, &state.x)
    }

    /// The volume that every piece encloses [m^3], shape \[pieces\].
    #[must_use]
    pub fn enclosed(&self, state: &State) -> Vec<f64> {
        let pieces = self.volumes.pieces.iter();
        pieces.map(|piece| piece.volume(&state.x)).collect()
    }

    /// Linear momentum of all that moves [kg m/s].
    #[must_use]
    pub fn momentum(&self, state: &State) -> Vector3<f64> {
        let each = self.mass.iter().zip(&state.v);
        each.map(|(m, v)| v * *m).sum()
    }

    /// How much longer than at rest every edge is, over its rest length; shape \[edges\].
    #[must_use]
    pub fn strains(&self, state: &State) -> Vec<f64> {
        let each = self.stretch.vertices.iter().zip(&self.stretch.rest);
        each.map(|(&[a, b], rest)| (state.x[b] - state.x[a]).norm() / rest - 1.0)
            .collect()
    }

    /// By edge, by hinge and by piece, the sum of `|grad C|^2 / m`, which XPBD's projections weigh against the compliance over
    /// the square of the substep. 0 where there is no gradient. `C` of a piece is as [`Model::volume_errors`] has it.
    #[must_use]
    pub fn weights(&self, state: &State) -> [Vec<f64>; 3] {
        let pieces = self.volumes.pieces.iter();
        [
            weights::<Edge, 2>(self, &self.stretch, &state.x),
            weights::<Hinge, 4>(self, &self.bending, &state.x),
            pieces.map(|p| p.weight(&state.x, &self.mass)).collect(),
        ]
    }

    /// How far the volume of every piece is from what it strives for, over the root of its rest volume [m^1.5], shape \[pieces\]:
    /// so the compliance of all is the compressibility.
    #[must_use]
    pub fn volume_errors(&self, x: &[Vector3<f64>]) -> Vec<f64> {
        let Volumes {
            pieces, pressure, ..
        } = &self.volumes;
        pieces
            .iter()
            .map(|piece| piece.error(x, *pressure))
            .collect()
    }
}

fn volume_energy(model: &Model, x: &[Vector3<f64>]) -> f64 {
    if model.volumes.compressibility <= 0.0 {
        return 0.0;
    }
    let errors = model.volume_errors(x).into_iter();
    errors.map(|error| error * error).sum::<f64>() / (2.0 * model.volumes.compressibility)
}

fn energy<K: Kind<N>, const N: usize>(constraints: &Constraints<N>, x: &[Vector3<f64>]) -> f64 {
    if constraints.compliance <= 0.0 {
        return 0.0;
    }
    let each = constraints.vertices.iter().zip(&constraints.rest);
    let square = |(vertices, rest): (&[usize; N], &f64)| {
        let slope = K::slope(&vertices.map(|v| x[v]))?;
        Some(K::error(slope.value, *rest).powi(2))
    };
    each.filter_map(square).sum::<f64>() / (2.0 * constraints.compliance)
}

fn weights<K: Kind<N>, const N: usize>(
    model: &Model,
    constraints: &Constraints<N>,
    x: &[Vector3<f64>],
) -> Vec<f64> {
    let weight = |vertices: &[usize; N]| {
        let slope = K::slope(&vertices.map(|v| x[v]));
        let gradient = slope.map_or([Vector3::zeros(); N], |slope| slope.gradient);
        let each = vertices.iter().zip(gradient);
        each.filter(|(v, _)| model.mass[**v] > 0.0)
            .map(|(v, g)| g.norm_squared() / model.mass[*v])
            .sum()
    };
    constraints.vertices.iter().map(weight).collect()
}
