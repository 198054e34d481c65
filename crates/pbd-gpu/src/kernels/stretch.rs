//! Stretch constraints: preserve edge lengths (Mueller et al. 2007, section 3.3; XPBD multipliers).
//!
//! `C = |p_b - p_a| - rest`. The gradients have length 1 and opposite directions.
//!
//! In a substep that is shorter than the previous ones, edges correct only a part of their initial
//! error.

use super::block::{BLOCK, Lanes, difference};
use super::displacements::Displacements;
use crate::constraints::batches::Part;
use crate::step::constants::Projection;
use crate::step::sweep::Kernel;
use incise_mesh::VertexId;

struct Block<const B: usize> {
    edge: [[f32; 4]; B],
    inv_mass: [Lanes<B>; 2],
    rest: Lanes<B>,
    lambda: Lanes<B>,
    /// Impulse on the first vertex relative to the edge vector.
    scale: Lanes<B>,
}

/// The stretch kernel.
#[derive(Debug)]
pub(crate) struct Stretch;

impl Kernel<2> for Stretch {
    #[inline(always)]
    fn project(
        x: &[[f32; 4]],
        d: &mut impl Displacements,
        part: Part<'_, 2>,
        projection: Projection,
    ) {
        run::<BLOCK>(x, d, part, projection);
    }

    #[inline(always)]
    fn project_serial(
        x: &[[f32; 4]],
        d: &mut impl Displacements,
        part: Part<'_, 2>,
        projection: Projection,
    ) {
        run::<1>(x, d, part, projection);
    }
}

#[inline(always)]
fn run<const B: usize>(
    x: &[[f32; 4]],
    d: &mut impl Displacements,
    part: Part<'_, 2>,
    projection: Projection,
) {
    let zero = [0.0; B];
    let mut block = Block {
        edge: [[0.0; 4]; B],
        inv_mass: [zero; 2],
        rest: zero,
        lambda: zero,
        scale: zero,
    };
    let mut kept = part.lambda.chunks_mut(B);
    for (vertices, rest) in part.vertices.chunks(B).zip(part.rest.chunks(B)) {
        block.rest[..rest.len()].copy_from_slice(rest);
        let kept = kept.next();
        match &kept {
            Some(kept) => block.lambda[..kept.len()].copy_from_slice(kept),
            None => block.lambda = zero,
        }
        gather(&mut block, x, d, vertices);
        if projection.error_carryover > 0.0 {
            carry_over(&mut block, x, vertices, projection.error_carryover);
        }
        project(&mut block, projection);
        scatter(&block, d, vertices);
        if let Some(kept) = kept {
            kept.copy_from_slice(&block.lambda[..kept.len()]);
        }
    }
}

#[inline(always)]
fn gather<const B: usize>(
    block: &mut Block<B>,
    x: &[[f32; 4]],
    d: &mut impl Displacements,
    vertices: &[[VertexId; 2]],
) {
    for (lane, &[a, b]) in vertices.iter().enumerate().take(B) {
        let (a, b) = (a.index(), b.index());
        let (xa, xb) = (x[a], x[b]);
        let edge = difference(xa, d.get(a), xb, d.get(b));
        block.edge[lane] = edge;
        block.inv_mass[0][lane] = xa[3];
        block.inv_mass[1][lane] = xb[3];
    }
}

/// Moves rest lengths toward the lengths at the start of the substep, which leaves old errors.
#[inline(always)]
fn carry_over<const B: usize>(
    block: &mut Block<B>,
    x: &[[f32; 4]],
    vertices: &[[VertexId; 2]],
    fraction: f32,
) {
    for (lane, &[a, b]) in vertices.iter().enumerate().take(B) {
        let [x, y, z, _] = difference(x[a.index()], [0.0; 4], x[b.index()], [0.0; 4]);
        let length = (x * x + y * y + z * z).sqrt();
        block.rest[lane] += fraction * (length - block.rest[lane]);
    }
}

#[inline(always)]
fn project<const B: usize>(block: &mut Block<B>, projection: Projection) {
    let Projection {
        factor,
        alpha,
        diagonal_scale,
        ..
    } = projection;
    let [wa, wb] = &block.inv_mass;
    for i in 0..B {
        let [x, y, z, _] = block.edge[i];
        let length = (x * x + y * y + z * z).sqrt();
        let error = (length - block.rest[i]) + alpha * block.lambda[i];
        let diagonal = wa[i] + wb[i];
        let weight = diagonal_scale * diagonal + alpha;
        let weight = if diagonal > weight { diagonal } else { weight };
        // An edge of length zero has no direction; two pinned ends do not move.
        let divisor = length * weight;
        let scale = if divisor > 0.0 {
            factor * error / divisor
        } else {
            0.0
        };
        block.lambda[i] -= scale * length;
        block.scale[i] = scale;
    }
}

#[inline(always)]
fn scatter<const B: usize>(
    block: &Block<B>,
    d: &mut impl Displacements,
    vertices: &[[VertexId; 2]],
) {
    for (lane, &[a, b]) in vertices.iter().enumerate().take(B) {
        let towards_b = block.scale[lane] * block.inv_mass[0][lane];
        let towards_a = block.scale[lane] * block.inv_mass[1][lane];
        let edge = block.edge[lane];
        let mut da = d.get(a.index());
        for (c, e) in da.iter_mut().zip(edge) {
            *c += towards_b * e;
        }
        d.set(a.index(), da);
        let mut db = d.get(b.index());
        for (c, e) in db.iter_mut().zip(edge) {
            *c -= towards_a * e;
        }
        d.set(b.index(), db);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraints::batches::Batch;
    use crate::material::Stiffness;

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
        let edge = difference(x[0], d[0], x[1], d[1]);
        edge[..3].iter().map(|c| c * c).sum::<f32>().sqrt() - REST
    }

    #[test]
    fn one_projection_leaves_what_the_compliance_says() {
        for (compliance, h) in [(0.0, 0.01), (1e-4, 0.01), (1e-3, 0.02)] {
            let projection = Stiffness::Compliance(compliance).projection(1, h);
            let (x, mut batch) = spring();
            let mut d = vec![[0.0; 4]; 2];
            let before = error(&x, &d);
            Stretch::project(
                &x,
                &mut d,
                batch.part(projection.accumulates_lambda),
                projection,
            );
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
        Stretch::project(
            &x,
            &mut d,
            batch.part(projection.accumulates_lambda),
            projection,
        );
        let (once, lambda) = (d.clone(), batch.lambda[0]);
        let residual = error(&x, &d) + projection.alpha * lambda;
        assert!(residual.abs() < 1e-6, "C + alpha lambda = {residual}");
        for _ in 0..6 {
            Stretch::project(
                &x,
                &mut d,
                batch.part(projection.accumulates_lambda),
                projection,
            );
        }
        for (now, then) in d.iter().flatten().zip(once.iter().flatten()) {
            assert!((now - then).abs() < 1e-6);
        }
    }

    #[test]
    fn serial_and_blocks_have_the_same_bits() {
        let projection = Stiffness::Pbd(0.7).projection(3, 0.02);
        let (x, mut batch) = spring();
        let (mut one, mut other) = (vec![[0.0; 4]; 2], vec![[0.0; 4]; 2]);
        Stretch::project(
            &x,
            &mut one,
            batch.part(projection.accumulates_lambda),
            projection,
        );
        Stretch::project_serial(
            &x,
            &mut other,
            batch.part(projection.accumulates_lambda),
            projection,
        );
        assert_eq!(one, other);
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
            Stretch::project(
                &x,
                &mut d,
                batch.part(projection.accumulates_lambda),
                projection,
            );
            assert_eq!(d, vec![[0.0; 4]; 2], "{reason}");
        }
    }
}
