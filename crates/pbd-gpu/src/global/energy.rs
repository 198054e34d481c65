//! Energies and forces of constraints, one constraint per lane.
//!
//! Bending is as in [`kernels::bending`](crate::kernels::bending), without its limits.

use super::arctangent::arctangent2;
use super::lanes::{
    Gather, Lanes, Row, Transpose, WithGather, add, cross, dispatch, dot, negative, scale, subtract,
};
use crate::constraints::batches::{Batch, ConstraintSet};
use crate::kernels::bending::FLAT;
use incise_mesh::VertexId;
use pulp::{Scalar, Simd};
use std::f64::consts::{PI, TAU};
use std::marker::PhantomData;

/// Number of partial sums of the energy, at least as many as there are lanes.
const SUMS: usize = 4;

/// Constraints that share no vertex, one per lane.
pub(super) struct Block<'a, S: Simd, const L: usize, const N: usize> {
    /// Vertices of every lane. Lanes without a constraint repeat the last one.
    vertices: &'a [[VertexId; N]; L],
    count: usize,
    rest: Lanes<S>,
    stiffness: Lanes<S>,
}

/// A kind of constraint over `N` vertices.
pub(super) trait Energy<const N: usize> {
    /// Adds the gradient of half of the squared error times the stiffness; returns the error.
    fn add<G: Gather<L>, const L: usize>(
        gather: G,
        points: &[Row],
        gradient: &mut [Row],
        block: &Block<'_, G::S, L, N>,
    ) -> Lanes<G::S>;
}

/// Stretch constraints and springs.
pub(super) struct Line;

impl Energy<2> for Line {
    #[inline(always)]
    fn add<G: Gather<L>, const L: usize>(
        gather: G,
        points: &[Row],
        gradient: &mut [Row],
        block: &Block<'_, G::S, L, 2>,
    ) -> Lanes<G::S> {
        let a = gather.gather(points, block.vertices, 0);
        let b = gather.gather(points, block.vertices, 1);
        let edge = subtract(b, a);
        let length = dot(edge, edge).sqrt();
        let error = length - block.rest;
        let has_direction = Lanes::splat(gather.simd(), 0.0).lt(length);
        let per_length = has_direction.or_zero(block.stiffness * error / length);
        let force = scale(per_length, edge);
        let (vertices, count) = (block.vertices, block.count);
        gather.add(gradient, vertices, (0, count), negative(force));
        gather.add(gradient, vertices, (1, count), force);
        error
    }
}

/// Bending constraints.
pub(super) struct Hinge;

impl Energy<4> for Hinge {
    #[inline(always)]
    fn add<G: Gather<L>, const L: usize>(
        gather: G,
        points: &[Row],
        gradient: &mut [Row],
        block: &Block<'_, G::S, L, 4>,
    ) -> Lanes<G::S> {
        let simd = gather.simd();
        let number = |number| Lanes::splat(simd, number);
        let p0 = gather.gather(points, block.vertices, 0);
        let e = subtract(gather.gather(points, block.vertices, 1), p0);
        let a = subtract(gather.gather(points, block.vertices, 2), p0);
        let b = subtract(gather.gather(points, block.vertices, 3), p0);
        let (n2, n3) = (cross(e, a), cross(b, e));
        let (square, q2, q3) = (dot(e, e), dot(n2, n2), dot(n3, n3));
        let length = square.sqrt();
        let angle = arctangent2(simd, -(length * dot(a, n3)), dot(n2, n3));
        let turn = angle - block.rest;
        let turn = number(PI).lt(turn).select(turn - number(TAU), turn);
        let turn = turn.lt(number(-PI)).select(turn + number(TAU), turn);
        // Slivers without a normal have neither energy nor force.
        let flat = number(f64::from(FLAT));
        let (flat2, flat3) = (flat * (square + dot(a, a)), flat * (square + dot(b, b)));
        let (solid2, solid3) = ((flat2 * flat2).lt(q2), (flat3 * flat3).lt(q3));
        let solid = |by: Lanes<G::S>| solid2.or_zero(solid3.or_zero(by));
        let error = solid(turn);
        let force = -(block.stiffness * error * length);
        let g2 = scale(solid(force / q2), n2);
        let g3 = scale(solid(force / q3), n3);
        let per_square = solid(number(1.0) / square);
        let (s, t) = (dot(a, e) * per_square, dot(b, e) * per_square);
        let g1 = negative(add(scale(s, g2), scale(t, g3)));
        let g0 = negative(add(g1, add(g2, g3)));
        let (vertices, count) = (block.vertices, block.count);
        gather.add(gradient, vertices, (0, count), g0);
        gather.add(gradient, vertices, (1, count), g1);
        gather.add(gradient, vertices, (2, count), g2);
        gather.add(gradient, vertices, (3, count), g3);
        error
    }
}

/// Adds the gradient of all constraints of a set to `gradient` and returns their energy.
pub(super) fn add_energy<K: Energy<N>, const N: usize>(
    set: &ConstraintSet<N>,
    stiffness: f64,
    points: &[Row],
    gradient: &mut [Row],
) -> f64 {
    let mut sums = [0.0; SUMS];
    for batch in set.batches() {
        dispatch(Part::<K, N>::new(
            (batch, stiffness),
            points,
            gradient,
            &mut sums,
        ));
    }
    // Constraints of the overflow may share vertices.
    Part::<K, N>::new((set.overflow(), stiffness), points, gradient, &mut sums)
        .with::<_, 1>(Transpose(Scalar));
    0.5 * stiffness * ((sums[0] + sums[1]) + (sums[2] + sums[3]))
}

/// The constraints of a batch.
struct Part<'a, K, const N: usize> {
    batch: &'a Batch<N>,
    stiffness: f64,
    points: &'a [Row],
    gradient: &'a mut [Row],
    /// Sums of squared errors of every [`SUMS`]th constraint.
    sums: &'a mut [f64; SUMS],
    kind: PhantomData<K>,
}

impl<'a, K, const N: usize> Part<'a, K, N> {
    fn new(
        (batch, stiffness): (&'a Batch<N>, f64),
        points: &'a [Row],
        gradient: &'a mut [Row],
        sums: &'a mut [f64; SUMS],
    ) -> Self {
        Self {
            batch,
            stiffness,
            points,
            gradient,
            sums,
            kind: PhantomData,
        }
    }
}

impl<K: Energy<N>, const N: usize> WithGather for Part<'_, K, N> {
    type Output = ();

    #[inline(always)]
    fn with<G: Gather<L>, const L: usize>(self, gather: G) {
        let Self {
            batch,
            stiffness,
            points,
            gradient,
            sums,
            ..
        } = self;
        let simd = gather.simd();
        let stiffness = Lanes::splat(simd, stiffness);
        let (vertices, rest) = (batch.vertices(), batch.rest());
        let mut start = 0;
        while start < vertices.len() {
            let end = vertices.len().min(start + L);
            let next = &vertices[start..end];
            let padded;
            let block = Block {
                vertices: match next.try_into() {
                    Ok(full) => full,
                    Err(_) => {
                        padded = pad(next);
                        &padded
                    }
                },
                count: next.len(),
                rest: load::<_, L>(simd, &rest[start..end]),
                stiffness,
            };
            let error = K::add(gather, points, gradient, &block);
            let squares: [f64; L] = (error * error).to_array();
            if block.count == L {
                for (lane, square) in squares.into_iter().enumerate() {
                    sums[(start + lane) % SUMS] += square;
                }
            } else {
                for (lane, square) in squares.into_iter().enumerate().take(block.count) {
                    sums[(start + lane) % SUMS] += square;
                }
            }
            start = end;
        }
    }
}

/// Returns at most `L` numbers and zeros as lanes.
#[inline(always)]
fn load<S: Simd, const L: usize>(simd: S, numbers: &[f32]) -> Lanes<S> {
    let mut lanes = [0.0; L];
    match <&[f32; L]>::try_from(numbers) {
        Ok(full) => {
            for i in 0..L {
                lanes[i] = f64::from(full[i]);
            }
        }
        Err(_) => {
            for (lane, &number) in lanes.iter_mut().zip(numbers) {
                *lane = f64::from(number);
            }
        }
    }
    Lanes::from_array(simd, lanes)
}

/// Returns the vertices of `L` constraints; the last ones are repeated.
#[cold]
fn pad<const L: usize, const N: usize>(vertices: &[[VertexId; N]]) -> [[VertexId; N]; L] {
    std::array::from_fn(|lane| vertices[lane.min(vertices.len() - 1)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Material;
    use crate::solver::Solver;
    use incise_mesh::{Vec3, icosphere};

    /// Compares the widest lanes of this CPU with scalar code.
    fn compare<K: Energy<N>, const N: usize>(set: &ConstraintSet<N>, points: &[Row]) {
        for batch in set.batches() {
            let run = |is_scalar: bool| {
                let (mut gradient, mut sums) = (vec![Row::default(); points.len()], [0.0; SUMS]);
                let part = Part::<K, N>::new((batch, 3.0), points, &mut gradient, &mut sums);
                if is_scalar {
                    part.with::<_, 1>(Transpose(Scalar));
                } else {
                    dispatch(part);
                }
                (gradient, sums)
            };
            assert!(run(true) == run(false), "a batch of {}", batch.len());
            let is_moved = run(true).1.iter().sum::<f64>() > 0.0;
            assert!(is_moved || batch.is_empty(), "errors are not 0");
        }
    }

    #[test]
    fn any_instruction_set_gives_the_same_bits() {
        let mut surface = icosphere(3, 0.5);
        let mut solver = Solver::new(&mut surface, &Material::soft_body()).unwrap();
        let vertices = surface.topology().vertices();
        let displaced = vertices.map(|v| {
            let x = surface.position(v);
            Row::from(x + Vec3::new((7.0 * x.y).sin(), (40.0 * x.z).cos(), x.x) * 0.05)
        });
        let points: Vec<Row> = displaced.collect();
        let (_, constraints, _) = solver.step_parts();
        compare::<Line, 2>(&constraints.stretch, &points);
        compare::<Hinge, 4>(constraints.bending.as_ref().unwrap(), &points);
    }
}
