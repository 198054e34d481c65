//! Bending: two triangles keep the angle between them.
//!
//! `C = theta - rest`, theta the signed angle between the normals at the edge `p0 p1`, the vertices
//! across being `p2` and `p3`. With `e = p1 - p0`, `n2 = e x (p2 - p0)` and `n3 = (p3 - p0) x e`:
//!
//! - `theta = atan2(-|e| (p2 - p0) . n3, n2 . n3)`, which keeps its digits when flat and when folded;
//! - `g2 = -|e| n2 / |n2|^2` and `g3 = -|e| n3 / |n3|^2` (Bridson et al. 2003);
//! - `g0 = -(1 - s) g2 - (1 - t) g3` and `g1 = -s g2 - t g3`, s and t being where the feet of `p2` and
//!   `p3` stand on the edge, from 0 at `p0` to 1 at `p1`. So the sum of gradients is zero.
//!
//! An error is what was there before the substep, and what its displacements `d` add, `sum g . d`. Beside edges that are
//! softer than the hinge the first comes back no faster than at [`RECOVERY`], and slower where they are limp: taken back at once
//! it is a blow, since velocities follow from displacements, and as no edge holds it the next hinge passes it on, larger. What
//! the substep adds is taken back at once in any case, and so is all where edges hold or can follow: there old errors are how a
//! load goes on from hinge to hinge. A substep shorter than those before it leaves a part of them, as edges do.

use super::arctangent::arctangent2;
use super::block::{BLOCK, Lanes, difference};
use super::displacements::Displacements;
use crate::constraints::Part;
use crate::material::Projection;
use crate::sweep::Kernel;
use incise_mesh::VertexId;
use std::f32::consts::{PI, TAU};

/// A triangle takes no part when its doubled area is below this share of its squared edges: its normal
/// is rounding then. Usually such triangles are slivers of a height of 1e-5 of their length.
pub(crate) const FLAT: f32 = 1e-5;

/// The largest change of angle that one projection makes \[rad\]. A gradient is a tangent: following
/// it for a large angle pushes vertices outwards and pumps energy into crumpled bodies. Measured on a
/// crumpled ball of stiffness 1: 0.06 J go on and on with 0.5 rad, 4e-6 J with 0.1 rad.
pub(crate) const MAX_TURN: f32 = 0.1;

/// How fast an angle comes back from an old error where bending is rigid and edges are soft [rad/s].
/// Measured on a ball that falls, of 15 compliances of stretch by 15 of bending: with 6 rad/s some gain
/// 2 % of the energy that there was, without a bound up to 1e11 times.
pub(crate) const RECOVERY: f32 = 3.0;

/// How much of an edge's own stiffness, by that of a step's inertia, is enough to hold bending back.
pub(crate) const HOLD: f32 = 10.0;

/// How far bending that edges can follow is held up no more: with the fourth power of so much of the squared frequency of edges
/// over that of the hinge, by [`HOLD`]. A shell that bends is less stiff than one that stretches, by the square of its thickness over its
/// edges: what it has stored comes back as fast as it can. Only where bending is the stiffer one nothing but a bound keeps it from
/// throwing vertices about, however short a substep is. Measured on the ball of [`RECOVERY`] and on a twisted ribbon, whose edges are 3 times as stiff as its hinges:
/// with 0.3 the ball keeps its energy and the ribbon is 0.05 edges off, with 0.2 the ribbon is 0.4 off.
pub(crate) const FOLLOW: f32 = 0.3;

/// Where edges follow so well, nothing is held up; its fourth power is far from the end of numbers.
pub(crate) const FREE: f32 = 1e4;

/// Edges that are slower than `sqrt(LIMP / HOLD) RECOVERY`, 9.5 rad/s, are limp: angles come back the less, the slower they are.
pub(crate) const LIMP: f32 = 100.0;

/// The hold of edges that do not stretch \[kg\]: more than any body weighs, less than the end of numbers.
pub(crate) const FIRM: f32 = 1e30;

struct Block<const B: usize> {
    /// From the first vertex to each of the others.
    to: [[Lanes<B>; 3]; 3],
    /// Their displacements, less that of the first.
    moved: [[Lanes<B>; 3]; 3],
    inv_mass: [Lanes<B>; 4],
    rest: Lanes<B>,
    lambda: Lanes<B>,
    /// The change of displacement of every vertex.
    change: [[Lanes<B>; 3]; 4],
}

/// The kernel, as sweeps call it.
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
}

/// Projects constraints that may share vertices, one after the other.
#[inline(always)]
pub(crate) fn bending_serial(
    x: &[[f32; 4]],
    d: &mut impl Displacements,
    part: Part<'_, 4>,
    projection: Projection,
) {
    run::<1>(x, d, part, projection);
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
        // Where edges are firm and substeps alike no old error is left, and what it takes to know that is left out.
        if projection.hold < FIRM || projection.old > 0.0 {
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
fn gather<const B: usize, const LEAVES: bool>(
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
            if LEAVES {
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
fn project<const B: usize, const LEAVES: bool>(block: &mut Block<B>, projection: Projection) {
    let Projection {
        factor,
        alpha,
        own_weight,
        recovery,
        hold,
        old,
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
        if LEAVES {
            // What the substep has added to the angle so far: sum g . d.
            let off = |d: [f32; 3], s: f32| [d[0] - s * d1[0], d[1] - s * d1[1], d[2] - s * d1[2]];
            let added = -(f2 * dot(n2, off(d2, s)) + f3 * dot(n3, off(d3, t)));
            let before = turn - added;
            let soft = alpha / weight;
            let held = hold * ((w0 + w1) + (w2 + w3));
            let limp = held / (LIMP * (recovery * recovery));
            let limp = if limp < 1.0 { limp } else { 1.0 };
            let follow = FOLLOW * (soft * held);
            let follow = if follow < FREE { follow } else { FREE };
            let free = (follow * follow) * (follow * follow);
            let most = recovery * (limp * (1.0 + free) + held);
            left = if before > most { before - most } else { left };
            left = if before < -most { before + most } else { left };
            let kept = old * before;
            left = if kept.abs() > left.abs() { kept } else { left };
        }
        let wish = factor * ((turn - left) + alpha * block.lambda[i]);
        let movable = solid & (weight > 0.0);
        let sum = own_weight * weight + alpha;
        let under = if weight > sum { weight } else { sum };
        // What a step turns the hinge by is `step * weight`: that is bounded, not what a soft hinge is bent by.
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
