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
//! from displacements, so a larger correction is an impulse, which the next hinges amplify.

use super::arctangent::arctangent2;
use super::block::{Block, Gather, Transpose, scatter};
use super::lanes::{Lanes, Mask};
use super::particle_state::ParticleStates;
use crate::step::constants::Projection;
use crate::step::sweep::Kernel;
use pulp::{Scalar, Simd};
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

/// The bending kernel.
#[derive(Debug)]
pub(crate) struct Bending;

impl Kernel<4> for Bending {
    #[inline(always)]
    fn project<G: Gather<L>, const L: usize, const HISTORY: bool>(
        gather: G,
        particles: ParticleStates<'_>,
        block: &mut Block<'_, G::S, L, 4>,
        projection: Projection,
    ) {
        let simd = gather.simd();
        let zero = Lanes::splat(simd, 0.0);
        let Projection {
            factor,
            alpha,
            diagonal_scale,
            ..
        } = projection;
        let w0 = gather.inverse_masses(particles, block.vertices);
        let [e @ .., w1] = gather.differences(particles, block.vertices, 1);
        let [a @ .., w2] = gather.differences(particles, block.vertices, 2);
        let [b @ .., w3] = gather.differences(particles, block.vertices, 3);

        let Hinge {
            n2,
            n3,
            f2,
            f3,
            s,
            t,
            turn,
            weight,
            is_solid,
        } = Hinge::new(gather, [e, a, b], [w0, w1, w2, w3], block.rest);
        let (s0, t0) = (1.0 - s, 1.0 - t);

        let mut left = zero;
        // With rigid edges no old error remains, which saves its computation.
        if HISTORY && projection.edge_stiffness < FIRM {
            // Change of the angle in this substep: sum g . d.
            let [d1 @ .., _] = gather.displacements(particles, block.vertices, 1);
            let [d2 @ .., _] = gather.displacements(particles, block.vertices, 2);
            let [d3 @ .., _] = gather.displacements(particles, block.vertices, 3);
            let (m2, m3) = (subtract(d2, scale(s, d1)), subtract(d3, scale(t, d1)));
            let added = -(f2 * dot(n2, m2) + f3 * dot(n3, m3));
            let inv_mass = (w0 + w1) + (w2 + w3);
            left = remaining_error(turn - added, weight, inv_mass, projection);
        }
        let wish = factor * ((turn - left) + alpha * block.lambda);
        let movable = is_solid & weight.gt(zero);
        let sum = diagonal_scale * weight + alpha;
        let under = weight.gt(sum).select(weight, sum);
        let mut step = wish / under;
        // The bound applies to the change of angle, `step * weight`, which `wish` exceeds by a
        // rounding error at most.
        if !gather.all(wish.abs().lt(zero + 0.99 * MAX_TURN)) {
            let most = MAX_TURN / weight;
            step = step.gt(most).select(most, step);
            step = step.lt(-most).select(-most, step);
        }
        let step = movable.or_zero(step);
        block.lambda = block.lambda - step;
        // delta = w lambda g, and lambda = -step, g2 = -f2 n2.
        let (c2, c3) = (movable.or_zero(step * f2), movable.or_zero(step * f3));
        let (s, s0) = (movable.or_zero(s), movable.or_zero(s0));
        let (t, t0) = (movable.or_zero(t), movable.or_zero(t0));
        let (u2, u3) = (scale(c2, n2), scale(c3, n3));
        let (change0, change1) = (
            scale(-w0, add(scale(s0, u2), scale(t0, u3))),
            scale(-w1, add(scale(s, u2), scale(t, u3))),
        );
        scatter(gather, particles, block, 0, change0);
        scatter(gather, particles, block, 1, change1);
        scatter(gather, particles, block, 2, scale(w2, u2));
        scatter(gather, particles, block, 3, scale(w3, u3));
    }
}

/// A vector per lane.
type Vector<S> = [Lanes<S>; 3];

/// A hinge in its present shape.
struct Hinge<S: Simd> {
    /// Normals of its triangles, not of length 1.
    n2: Vector<S>,
    n3: Vector<S>,
    /// Factors of the normals in the gradients.
    f2: Lanes<S>,
    f3: Lanes<S>,
    /// Feet of the vertices across on the edge.
    s: Lanes<S>,
    t: Lanes<S>,
    /// Angle minus rest angle \[rad\].
    turn: Lanes<S>,
    /// Sum of `|grad C|^2 / m`.
    weight: Lanes<S>,
    /// Whether the triangles are no slivers.
    is_solid: Mask<S>,
}

impl<S: Simd> Hinge<S> {
    /// Measures a hinge from the vectors to its vertices from the first one, its inverse masses
    /// and its rest angle.
    #[inline(always)]
    fn new<G: Gather<L, S = S>, const L: usize>(
        gather: G,
        [e, a, b]: [Vector<S>; 3],
        [w0, w1, w2, w3]: [Lanes<S>; 4],
        rest: Lanes<S>,
    ) -> Self {
        let zero = Lanes::splat(gather.simd(), 0.0);
        let (n2, n3) = (cross(e, a), cross(b, e));
        let (ee, q2, q3) = (dot(e, e), dot(n2, n2), dot(n3, n3));
        let (cos, length) = (dot(n2, n3), ee.sqrt());
        let theta = arctangent2(gather, -(length * dot(a, n3)), cos);
        let mut turn = theta - rest;
        if !gather.all(turn.abs().lt(zero + PI)) {
            turn = turn.gt(zero + PI).select(turn - TAU, turn);
            turn = turn.le(zero - PI).select(turn + TAU, turn);
        }

        let (big2, big3) = (ee + dot(a, a), ee + dot(b, b));
        let solid2 = q2.gt(FLAT * FLAT * (big2 * big2));
        let solid3 = q3.gt(FLAT * FLAT * (big3 * big3));
        let (f2, f3) = (length / q2, length / q3);
        let (g22, g33, g23) = (f2 * length, f3 * length, f2 * f3 * cos);
        let per_square = 1.0 / ee;
        let (s, t) = (dot(a, e) * per_square, dot(b, e) * per_square);
        let (s0, t0) = (1.0 - s, 1.0 - t);
        let g00 = s0 * s0 * g22 + t0 * t0 * g33 + 2.0 * (s0 * t0 * g23);
        let g11 = s * s * g22 + t * t * g33 + 2.0 * (s * t * g23);
        Self {
            n2,
            n3,
            f2,
            f3,
            s,
            t,
            turn,
            weight: (w0 * g00 + w1 * g11) + (w2 * g22 + w3 * g33),
            is_solid: solid2 & solid3,
        }
    }
}

/// Returns the error of a hinge \[rad\] and its sum of `|grad C|^2 / m`, 0 for a sliver.
///
/// `x` are the positions and inverse masses of its vertices.
pub(crate) fn hinge_error(x: [[f32; 4]; 4], rest: f32) -> (f32, f32) {
    let gather = Transpose(Scalar);
    let lanes = |c: f32| Lanes::splat(Scalar, c);
    let to = |j: usize| [0, 1, 2].map(|k: usize| lanes((x[j][k] - x[0][k]) + 0.0));
    let masses = [0, 1, 2, 3].map(|j: usize| lanes(x[j][3]));
    let hinge = Hinge::new::<_, 1>(gather, [to(1), to(2), to(3)], masses, lanes(rest));
    let [turn] = hinge.turn.to_array();
    let [weight] = hinge.is_solid.or_zero(hinge.weight).to_array();
    (turn, weight)
}

/// Returns the part of an error from before the substep that a projection leaves \[rad\].
#[inline(always)]
fn remaining_error<S: Simd>(
    before: Lanes<S>,
    weight: Lanes<S>,
    inv_mass: Lanes<S>,
    projection: Projection,
) -> Lanes<S> {
    let recovery = projection.recovery;
    let soft = projection.alpha / weight;
    let held = projection.edge_stiffness * inv_mass;
    let limp = held / (LIMP * (recovery * recovery));
    let limp = limp
        .lt(before.zero() + 1.0)
        .select(limp, before.zero() + 1.0);
    let follow = FOLLOW * (soft * held);
    let follow = follow
        .lt(before.zero() + FREE)
        .select(follow, before.zero() + FREE);
    let free = (follow * follow) * (follow * follow);
    let most = recovery * (limp * (1.0 + free) + held);
    let left = before.gt(most).or_zero(before - most);
    before.lt(-most).select(before + most, left)
}

#[inline(always)]
fn add<S: Simd>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn subtract<S: Simd>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn scale<S: Simd>(by: Lanes<S>, a: Vector<S>) -> Vector<S> {
    [by * a[0], by * a[1], by * a[2]]
}

#[inline(always)]
fn cross<S: Simd>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline(always)]
fn dot<S: Simd>(a: Vector<S>, b: Vector<S>) -> Lanes<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests;
