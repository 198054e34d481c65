//! Stretch constraints: preserve edge lengths (Mueller et al. 2007, section 3.3; XPBD multipliers).
//!
//! `C = |p_b - p_a| - rest`. The gradients have length 1 and opposite directions.

use super::block::{Block, Gather, scatter};
use super::lanes::Lanes;
use super::particle_state::ParticleStates;
use crate::step::constants::Projection;
use crate::step::sweep::Kernel;

/// The stretch kernel.
#[derive(Debug)]
pub(crate) struct Stretch;

impl Kernel<2> for Stretch {
    #[inline(always)]
    fn project<G: Gather<L>, const L: usize, const HISTORY: bool>(
        gather: G,
        particles: ParticleStates<'_>,
        block: &mut Block<'_, G::S, L, 2>,
        projection: Projection,
    ) {
        let Projection {
            factor,
            alpha,
            diagonal_scale,
            ..
        } = projection;
        let wa = gather.inverse_masses(particles, block.vertices);
        let [x, y, z, wb] = gather.differences(particles, block.vertices, 1);
        let length = (x * x + y * y + z * z).sqrt();
        let error = (length - block.rest) + alpha * block.lambda;
        let diagonal = wa + wb;
        let weight = diagonal_scale * diagonal + alpha;
        let weight = diagonal.gt(weight).select(diagonal, weight);
        // An edge of length zero has no direction; two pinned ends do not move.
        let divisor = length * weight;
        let has_direction = divisor.gt(Lanes::splat(gather.simd(), 0.0));
        let scale = has_direction.or_zero(factor * error / divisor);
        block.lambda = block.lambda - scale * length;
        let (for_a, for_b) = (scale * wa, -(scale * wb));
        let change = |by: Lanes<G::S>| [by * x, by * y, by * z];
        scatter(gather, particles, block, 0, change(for_a));
        scatter(gather, particles, block, 1, change(for_b));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraints::batches::Batch;
    use crate::kernels::block::difference;
    use crate::kernels::particle_state::{ParticleState, on_arrays};
    use crate::material::Stiffness;
    use crate::step::sweep::sweep;
    use incise_mesh::VertexId;

    const REST: f32 = 1.0;

    fn spring() -> (Vec<[f32; 4]>, Batch<2>) {
        let x = vec![[5.0, 1.0, 2.0, 0.5], [5.3, 1.4, 3.2, 2.0]];
        let batch = Batch {
            vertices: vec![[VertexId(0), VertexId(1)]],
            rest: vec![REST],
            edges: Vec::new(),
            lambda: vec![0.0],
        };
        (x, batch)
    }

    fn error(x: &[[f32; 4]], d: &[[f32; 4]]) -> f32 {
        let state = |i: usize| ParticleState { x: x[i], d: d[i] };
        let edge = difference(state(0), state(1));
        edge[..3].iter().map(|c| c * c).sum::<f32>().sqrt() - REST
    }

    #[test]
    fn one_projection_leaves_what_the_compliance_says() {
        for (compliance, h) in [(0.0, 0.01), (1e-4, 0.01), (1e-3, 0.02)] {
            let projection = Stiffness::Compliance(compliance).projection(1, h);
            let (x, mut batch) = spring();
            let mut d = vec![[0.0; 4]; 2];
            let before = error(&x, &d);
            on_arrays(&x, &mut d, |p| {
                sweep::<Stretch, 2>(p, batch.part(projection.accumulates_lambda), projection)
            });
            let expected = before * projection.alpha / (2.5 + projection.alpha);
            assert!(
                (error(&x, &d) - expected).abs() < 1e-6,
                "compliance {compliance}"
            );
            let momentum = d[0][0] / 0.5 + d[1][0] / 2.0;
            assert!(momentum.abs() < 1e-7, "both ends get the same impulse");
        }
    }

    #[test]
    fn kept_multipliers_make_it_a_fixed_point() {
        let projection = Stiffness::Compliance(1e-3).projection(7, 0.02);
        let (x, mut batch) = spring();
        let mut d = vec![[0.0; 4]; 2];
        on_arrays(&x, &mut d, |p| {
            sweep::<Stretch, 2>(p, batch.part(projection.accumulates_lambda), projection)
        });
        let (once, lambda) = (d.clone(), batch.lambda[0]);
        let residual = error(&x, &d) + projection.alpha * lambda;
        assert!(residual.abs() < 1e-6, "C + alpha lambda = {residual}");
        for _ in 0..6 {
            on_arrays(&x, &mut d, |p| {
                sweep::<Stretch, 2>(p, batch.part(projection.accumulates_lambda), projection)
            });
        }
        for (now, then) in d.iter().flatten().zip(once.iter().flatten()) {
            assert!((now - then).abs() < 1e-6);
        }
    }

    #[test]
    fn coincident_and_pinned_ends_stay() {
        let projection = Stiffness::Pbd(1.0).projection(1, 0.02);
        for (x, reason) in [
            (vec![[1.0; 4]; 2], "no direction"),
            (vec![[0.0; 4], [3.0, 0.0, 0.0, 0.0]], "no mobility"),
        ] {
            let (_, mut batch) = spring();
            let mut d = vec![[0.0; 4]; 2];
            on_arrays(&x, &mut d, |p| {
                sweep::<Stretch, 2>(p, batch.part(projection.accumulates_lambda), projection)
            });
            assert_eq!(d, vec![[0.0; 4]; 2], "{reason}");
        }
    }
}
