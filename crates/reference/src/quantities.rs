//! Energies, momentum, strains, volumes and constraint weights of a state.

use super::edge::Edge;
use super::hinge::Hinge;
use super::measure::Kind;
use super::model::{Constraints, Model, State};
use super::volume::Volumes;
use nalgebra::Vector3;

impl Model {
    /// Returns the kinetic energy \[J\].
    #[must_use]
    pub fn kinetic_energy(&self, state: &State) -> f64 {
        let each = self.mass.iter().zip(&state.v);
        each.map(|(m, v)| m * v.norm_squared() / 2.0).sum()
    }

    /// Returns the energy of gravity and of compliant constraints \[J\].
    #[must_use]
    pub fn potential_energy(&self, state: &State) -> f64 {
        let each = self.mass.iter().zip(&state.x);
        let gravity: f64 = each.map(|(m, x)| -m * self.gravity.dot(x)).sum();
        gravity
            + energy::<Edge, 2>(&self.stretch, &state.x)
            + energy::<Hinge, 4>(&self.bending, &state.x)
            + volume_energy(self, &state.x)
    }

    /// Returns the volume of every piece [m^3], shape \[pieces\].
    #[must_use]
    pub fn enclosed(&self, state: &State) -> Vec<f64> {
        let pieces = self.volumes.pieces.iter();
        pieces.map(|piece| piece.volume(&state.x)).collect()
    }

    /// Returns the linear momentum of free vertices [kg m/s].
    #[must_use]
    pub fn momentum(&self, state: &State) -> Vector3<f64> {
        let each = self.mass.iter().zip(&state.v);
        each.map(|(m, v)| v * *m).sum()
    }

    /// Returns the strain of every edge, shape \[edges\].
    #[must_use]
    pub fn strains(&self, state: &State) -> Vec<f64> {
        let each = self.stretch.vertices.iter().zip(&self.stretch.rest);
        each.map(|(&[a, b], rest)| (state.x[b] - state.x[a]).norm() / rest - 1.0)
            .collect()
    }

    /// Returns the sum of `|grad C|^2 / m` of every edge, hinge and piece, 0 without a gradient.
    ///
    /// XPBD compares it with the compliance over the squared substep. `C` of a piece is that of
    /// [`Model::volume_errors`].
    #[must_use]
    pub fn weights(&self, state: &State) -> [Vec<f64>; 3] {
        let pieces = self.volumes.pieces.iter();
        [
            weights::<Edge, 2>(self, &self.stretch, &state.x),
            weights::<Hinge, 4>(self, &self.bending, &state.x),
            pieces.map(|p| p.weight(&state.x, &self.mass)).collect(),
        ]
    }

    /// Returns the volume error of every piece over the root of its rest volume [m^1.5], shape
    /// \[pieces\]; its compliance is the compressibility.
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
