//! What a substep's multipliers and positions disagree on: metric e4, the second equation of XPBD.

use super::scene::Body;
use incise_bench::{Model, State, hinge};
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Multipliers of edges, of hinges and of pieces, in the order of a model's constraints.
pub(super) type Multipliers = [Vec<f64>; 3];

impl Body {
    /// The multipliers that the last substep ended with. None where constraints give way and it kept none.
    pub(super) fn multipliers(&self, model: &Model) -> Option<Multipliers> {
        let wide = |all: &[f32]| all.iter().map(|&x| f64::from(x)).collect::<Vec<f64>>();
        let stretch = self.solver.stretch();
        let stretch = stretch.batches().iter().chain([stretch.overflow()]);
        let stretch: Vec<f64> = stretch
            .flat_map(|batch| wide(batch.multipliers()))
            .collect();
        let bending = self.solver.bending().into_iter();
        let bending = bending.flat_map(|set| set.batches().iter().chain([set.overflow()]));
        let bending: Vec<f64> = bending
            .flat_map(|batch| wide(batch.multipliers()))
            .collect();
        // A model's constraint function is the volume over the root of that at rest.
        let pieces = &model.volumes.pieces;
        let volume = wide(self.solver.volumes().multipliers()).into_iter();
        let volume = volume
            .zip(pieces)
            .map(|(lambda, piece)| lambda * piece.rest().abs().sqrt());
        Some([
            complete(
                stretch,
                model.stretch.vertices.len(),
                model.stretch.compliance,
            )?,
            complete(
                bending,
                model.bending.vertices.len(),
                model.bending.compliance,
            )?,
            complete(
                volume.collect(),
                pieces.len(),
                model.volumes.compressibility,
            )?,
        ])
    }
}

/// Multipliers of so many constraints; those of rigid ones count for nothing.
fn complete(found: Vec<f64>, count: usize, compliance: f64) -> Option<Vec<f64>> {
    if compliance <= 0.0 {
        Some(vec![0.0; count])
    } else {
        (found.len() == count).then_some(found)
    }
}

/// `C + alpha lambda` at the end of a substep of `h` \[s\] from a state, over `C` of its prediction: 0 where the second equation of a
/// substep is solved, and 1 where nothing was done. Every constraint counts by the root of `w + alpha`, `w` being the sum of `|grad C|^2 / m`,
/// so that edges, angles and volumes can be added up. None where the prediction is right already.
pub(super) fn dual(
    model: &Model,
    start: &State,
    h: f64,
    end: &[Vector3<f64>],
    multipliers: &Multipliers,
) -> Option<f64> {
    let slowed = 1.0 + model.damping * h;
    let alphas = [
        model.stretch.compliance,
        model.bending.compliance,
        model.volumes.compressibility,
    ];
    let alphas = alphas.map(|compliance| compliance / (h * h) * slowed);
    let weights = model.weights(start);
    let size = |x: &[Vector3<f64>], part: f64| {
        let mut sum = 0.0;
        for (k, errors) in errors(model, x).into_iter().enumerate() {
            let each = errors.into_iter().zip(&multipliers[k]).zip(&weights[k]);
            for ((error, lambda), weight) in each {
                let below = weight + alphas[k];
                if let Some(error) = error.filter(|_| below > 0.0) {
                    sum += (error + part * alphas[k] * lambda).powi(2) / below;
                }
            }
        }
        sum.sqrt()
    };
    let predicted: Vec<Vector3<f64>> = (start.x.iter().zip(&start.v).zip(&model.mass))
        .map(|((x, v), mass)| {
            let moves = if *mass > 0.0 { h / slowed } else { 0.0 };
            x + (v + model.gravity * h) * moves
        })
        .collect();
    let first = size(&predicted, 0.0);
    (first > 0.0).then(|| size(end, 1.0) / first)
}

/// How far edges \[m\], hinges \[rad\] and volumes [m^1.5] are from rest; none where a hinge has no angle.
fn errors(model: &Model, x: &[Vector3<f64>]) -> [Vec<Option<f64>>; 3] {
    let edges = model.stretch.vertices.iter().zip(&model.stretch.rest);
    let edges = edges.map(|(&[a, b], rest)| Some((x[b] - x[a]).norm() - rest));
    let hinges = model.bending.vertices.iter().zip(&model.bending.rest);
    let hinges = hinges.map(|(vertices, rest)| {
        let turn = hinge(&vertices.map(|v| x[v]))?.value - rest;
        // Angles that differ by a turn are the same.
        Some(turn - (turn / TAU).round() * TAU)
    });
    let pieces = model.volume_errors(x).into_iter().map(Some);
    [edges.collect(), hinges.collect(), pieces.collect()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise_bench::Constraints;

    /// Two masses of 1 kg hang from a nail, one below the other, by springs of 1 m.
    fn chain(compliance: f64) -> (Model, State) {
        let stretch = Constraints {
            vertices: vec![[0, 1], [1, 2]],
            rest: vec![1.0, 1.0],
            compliance,
        };
        let model = Model {
            mass: vec![0.0, 1.0, 1.0],
            stretch,
            gravity: Vector3::new(0.0, -10.0, 0.0),
            ..Model::default()
        };
        let at = [0.0, -1.0, -2.0].map(|y| Vector3::new(0.0, y, 0.0));
        (model, State::at(at.into()))
    }

    #[test]
    fn one_round_of_projections_leaves_what_the_last_one_spoils() {
        let (h, compliance) = (0.1, 0.02);
        let (model, start) = chain(compliance);
        let alpha = compliance / (h * h);
        // Gravity draws both down by 0.1, which the upper edge alone feels: C is 0.1 and 0. Its projection gives
        // -0.1 / (1 + alpha), and lifts the upper mass by it; the lower edge is too long by as much then, which its own
        // projection shares among both masses.
        let upper = -0.1 / (1.0 + alpha);
        let lower = upper / (2.0 + alpha);
        let y = [-1.1 - upper + lower, -2.1 - lower];
        let end = [0.0, y[0], y[1]].map(|y| Vector3::new(0.0, y, 0.0));
        let multipliers = [vec![upper, lower], Vec::new(), Vec::new()];
        // The lower equation holds; the upper one held until the upper mass came down by the lower multiplier.
        let expected = lower.abs() / 0.1;
        let found = dual(&model, &start, h, &end, &multipliers).unwrap();
        assert!((found - expected).abs() < 1e-12, "{found}, not {expected}");
    }

    #[test]
    fn nothing_done_is_one_and_solved_is_none() {
        let (model, start) = chain(0.02);
        let h = 0.1;
        let predicted = [0.0, -1.1, -2.1].map(|y| Vector3::new(0.0, y, 0.0));
        let zero = [vec![0.0; 2], Vec::new(), Vec::new()];
        let found = dual(&model, &start, h, &predicted, &zero).unwrap();
        assert!((found - 1.0).abs() < 1e-12, "{found}");
        // At rest the springs carry 20 N and 10 N.
        let hung = [0.0, -1.4, -2.6].map(|y| Vector3::new(0.0, y, 0.0));
        let forces = [vec![-20.0 * h * h, -10.0 * h * h], Vec::new(), Vec::new()];
        let found = dual(&model, &start, h, &hung, &forces).unwrap();
        assert!(found < 1e-12, "{found}");
        let weightless = Model {
            gravity: Vector3::zeros(),
            ..model
        };
        let found = dual(&weightless, &start, h, &start.x, &zero);
        assert_eq!(found, None, "there is nothing to solve");
    }
}
