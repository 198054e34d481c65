//! Bending constraints: preserve the dihedral angle of two triangles.
//!
//! `C = theta - rest`, theta the signed angle between the normals at the edge `p0 p1`, the vertices
//! across being `p2` and `p3`. With `e = p1 - p0`, `n2 = e x (p2 - p0)` and `n3 = (p3 - p0) x e`:
//!
//! - `theta = atan2(-|e| (p2 - p0) . n3, n2 . n3)`, which keeps its digits when flat and when
//!   folded;
//! - `g2 = -|e| n2 / |n2|^2` and `g3 = -|e| n3 / |n3|^2` (Bridson et al. 2003);
//! - `g0 = -(1 - s) g2 - (1 - t) g3` and `g1 = -s g2 - t g3`, s and t being where the feet of `p2`
//!   and `p3` stand on the edge, from 0 at `p0` to 1 at `p1`. So the sum of gradients is zero.
//!
//! The error is the sum of the error before the substep and of `sum g . d`, the change by its
//! displacements `d`. The change is corrected at once. The older error is corrected at once only
//! where the edges are stiff enough to hold it or to follow. Next to edges softer than the hinge it
//! is corrected at rate [`RECOVERY`] at most, and more slowly next to limp edges: velocities follow
//! from displacements, so a larger correction is an impulse, which the next hinges amplify. In a
//! substep that is shorter than the previous ones a part of the older error remains, as for edges.

use super::arctangent::arctangent2;
use super::block::{BLOCK, Lanes, difference};
use super::displacements::Displacements;
use crate::constraints::batches::Part;
use crate::step::constants::Projection;
use crate::step::sweep::Kernel;
use incise_mesh::VertexId;
use std::f32::consts::{PI, TAU};

/// Triangles whose doubled area is below this fraction of their squared edges are ignored.
///
/// The normals of such slivers are rounding errors.
pub(crate) const FLAT: f32 = 1e-5;

/// Maximum change of angle per projection \[rad\].
///
/// A large step along the gradient moves vertices outward and adds energy to crumpled bodies.
pub(crate) const MAX_TURN: f32 = 0.1;

/// Rate at which older angle errors are corrected where bending is rigid and edges are soft
/// [rad/s]. A higher rate adds energy.
pub(crate) const RECOVERY: f32 = 3.0;

/// Edge stiffness, relative to the inertia of a step, that is enough to hold bending back.
pub(crate) const HOLD: f32 = 10.0;

/// Scale of the squared frequency ratio of edges and hinge above which errors are not limited.
///
/// The limit fades with the fourth power of this ratio. A shell is less stiff in bending than in
/// stretch, so its hinges need no limit. Where bending is stiffer, only a limit keeps it from
/// throwing vertices about, however short a substep is.
pub(crate) const FOLLOW: f32 = 0.3;

/// Frequency ratio at which the limit vanishes; its fourth power does not overflow.
pub(crate) const FREE: f32 = 1e4;

/// Squared frequency ratio below which edges are limp and angles recover more slowly.
///
/// Limp edges are slower than `sqrt(LIMP / HOLD) RECOVERY`, 9.5 rad/s.
pub(crate) const LIMP: f32 = 100.0;

/// Stiffness of rigid edges \[kg\]: more than the mass of any body, without overflow.
pub(crate) const FIRM: f32 = 1e30;

struct Block<const B: usize> {
    /// Vectors from the first vertex to the others.
    to: [[Lanes<B>; 3]; 3],
    /// Displacements of the others relative to the first.
    moved: [[Lanes<B>; 3]; 3],
    inv_mass: [Lanes<B>; 4],
    rest: Lanes<B>,
    lambda: Lanes<B>,
    /// Change of displacement of every vertex.
    change: [[Lanes<B>; 3]; 4],
}

/// The bending kernel.
#[derive(Debug)]
pub(crate) struct Bending;

impl Kernel<4> for Bending {
    #[inline(always)]
    fn project(
        x: &[[f32; 4]],
        d: &mut impl Displacements,
        part: Part<'_, 4>,
        projection: Projection,
    ) {
        run::<BLOCK>(x, d, part, projection);
    }

    #[inline(always)]
    fn project_serial(
        x: &[[f32; 4]],
        d: &mut impl Displacements,
        part: Part<'_, 4>,
        projection: Projection,
    ) {
        run::<1>(x, d, part, projection);
    }
}

#[inline(always)]
fn run<const B: usize>(
    x: &[[f32; 4]],
    d: &mut impl Displacements,
    part: Part<'_, 4>,
    projection: Projection,
) {
    let zero = [0.0; B];
    let mut block = Block {
        to: [[zero; 3]; 3],
        moved: [[zero; 3]; 3],
        inv_mass: [zero; 4],
        rest: zero,
        lambda: zero,
        change: [[zero; 3]; 4],
    };
    let mut kept = part.lambda.chunks_mut(B);
    for (vertices, rest) in part.vertices.chunks(B).zip(part.rest.chunks(B)) {
        block.rest[..rest.len()].copy_from_slice(rest);
        let kept = kept.next();
        match &kept {
            Some(kept) => block.lambda[..kept.len()].copy_from_slice(kept),
            None => block.lambda = zero,
        }
        // With rigid edges and equal substeps no old error remains, which saves its computation.
        if projection.edge_stiffness < FIRM || projection.error_carryover > 0.0 {
            gather::<B, true>(&mut block, x, d, vertices);
            project::<B, true>(&mut block, projection);
        } else {
            gather::<B, false>(&mut block, x, d, vertices);
            project::<B, false>(&mut block, projection);
        }
        scatter(&block, d, vertices);
        if let Some(kept) = kept {
            kept.copy_from_slice(&block.lambda[..kept.len()]);
        }
    }
}

#[inline(always)]
fn gather<const B: usize, const HAS_OLD_ERRORS: bool>(
    block: &mut Block<B>,
    x: &[[f32; 4]],
    d: &mut impl Displacements,
    vertices: &[[VertexId; 4]],
) {
    for (lane, v) in vertices.iter().enumerate().take(B) {
        let first = v[0].index();
        let (x0, d0) = (x[first], d.get(first));
        block.inv_mass[0][lane] = x0[3];
        for j in 0..3 {
            let other = v[j + 1].index();
            let (xj, dj) = (x[other], d.get(other));
            let to = difference(x0, d0, xj, dj);
            for (lanes, c) in block.to[j].iter_mut().zip(to) {
                lanes[lane] = c;
            }
            if HAS_OLD_ERRORS {
                for (k, lanes) in block.moved[j].iter_mut().enumerate() {
                    lanes[lane] = dj[k] - d0[k];
                }
            }
            block.inv_mass[j + 1][lane] = xj[3];
        }
    }
}

#[inline(always)]
fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn project<const B: usize, const HAS_OLD_ERRORS: bool>(
    block: &mut Block<B>,
    projection: Projection,
) {
    let Projection {
        factor,
        alpha,
        diagonal_scale,
        recovery,
        edge_stiffness,
        error_carryover,
        ..
    } = projection;
    for i in 0..B {
        let of = |lanes: &[Lanes<B>; 3]| [lanes[0][i], lanes[1][i], lanes[2][i]];
        let [e, a, b] = [0, 1, 2].map(|j: usize| of(&block.to[j]));
        let [d1, d2, d3] = [0, 1, 2].map(|j: usize| of(&block.moved[j]));
        let [w0, w1, w2, w3] = [0, 1, 2, 3].map(|j: usize| block.inv_mass[j][i]);
        let (n2, n3) = (cross(e, a), cross(b, e));
        let (ee, q2, q3) = (dot(e, e), dot(n2, n2), dot(n3, n3));
        let (cos, length) = (dot(n2, n3), ee.sqrt());
        let theta = arctangent2(-(length * dot(a, n3)), cos);
        let mut turn = theta - block.rest[i];
        turn = if turn > PI { turn - TAU } else { turn };
        turn = if turn <= -PI { turn + TAU } else { turn };

        let (big2, big3) = (ee + dot(a, a), ee + dot(b, b));
        let solid = (q2 > FLAT * FLAT * (big2 * big2)) & (q3 > FLAT * FLAT * (big3 * big3));
        let (f2, f3) = (length / q2, length / q3);
        let (g22, g33, g23) = (f2 * length, f3 * length, f2 * f3 * cos);
        let per_square = 1.0 / ee;
        let (s, t) = (dot(a, e) * per_square, dot(b, e) * per_square);
        let (s0, t0) = (1.0 - s, 1.0 - t);
        let g00 = s0 * s0 * g22 + t0 * t0 * g33 + 2.0 * (s0 * t0 * g23);
        let g11 = s * s * g22 + t * t * g33 + 2.0 * (s * t * g23);
        let weight = (w0 * g00 + w1 * g11) + (w2 * g22 + w3 * g33);

        let mut left = 0.0;
        if HAS_OLD_ERRORS {
            // Change of the angle in this substep: sum g . d.
            let off = |d: [f32; 3], s: f32| [d[0] - s * d1[0], d[1] - s * d1[1], d[2] - s * d1[2]];
            let added = -(f2 * dot(n2, off(d2, s)) + f3 * dot(n3, off(d3, t)));
            let before = turn - added;
            let soft = alpha / weight;
            let held = edge_stiffness * ((w0 + w1) + (w2 + w3));
            let limp = held / (LIMP * (recovery * recovery));
            let limp = if limp < 1.0 { limp } else { 1.0 };
            let follow = FOLLOW * (soft * held);
            let follow = if follow < FREE { follow } else { FREE };
            let free = (follow * follow) * (follow * follow);
            let most = recovery * (limp * (1.0 + free) + held);
            left = if before > most { before - most } else { left };
            left = if before < -most { before + most } else { left };
            let kept = error_carryover * before;
            left = if kept.abs() > left.abs() { kept } else { left };
        }
        let wish = factor * ((turn - left) + alpha * block.lambda[i]);
        let movable = solid & (weight > 0.0);
        let sum = diagonal_scale * weight + alpha;
        let under = if weight > sum { weight } else { sum };
        // The bound applies to the change of angle, `step * weight`.
        let most = MAX_TURN / weight;
        let mut step = wish / under;
        step = if step > most { most } else { step };
        step = if step < -most { -most } else { step };
        let step = if movable { step } else { 0.0 };
        block.lambda[i] -= step;
        // delta = w lambda g, and lambda = -step, g2 = -f2 n2.
        let c2 = if movable { step * f2 } else { 0.0 };
        let c3 = if movable { step * f3 } else { 0.0 };
        let (s, s0) = if movable { (s, s0) } else { (0.0, 0.0) };
        let (t, t0) = if movable { (t, t0) } else { (0.0, 0.0) };
        for k in 0..3 {
            let (u2, u3) = (c2 * n2[k], c3 * n3[k]);
            block.change[0][k][i] = -w0 * (s0 * u2 + t0 * u3);
            block.change[1][k][i] = -w1 * (s * u2 + t * u3);
            block.change[2][k][i] = w2 * u2;
            block.change[3][k][i] = w3 * u3;
        }
    }
}

#[inline(always)]
fn scatter<const B: usize>(
    block: &Block<B>,
    d: &mut impl Displacements,
    vertices: &[[VertexId; 4]],
) {
    for (lane, v) in vertices.iter().enumerate().take(B) {
        for (v, change) in v.iter().zip(&block.change) {
            let mut dv = d.get(v.index());
            for (c, lanes) in dv.iter_mut().zip(change) {
                *c += lanes[lane];
            }
            d.set(v.index(), dv);
        }
    }
}

#[cfg(test)]
mod tests;
