//! One pass over the constraints of one color, on one thread or many.

use crate::constraints::Part;
use crate::kernels::displacements::{Cell, Displacements, Exclusive, Shared};
use crate::material::Projection;
use pulp::{Arch, NullaryFnOnce};

/// A color with fewer constraints is swept by one thread: waking another takes longer than its work.
/// Only the number of constraints decides, never the number of threads.
const PARALLEL_FROM: usize = 8192;

/// The least that a thread is given, a multiple of the lanes of a block.
const GRAIN: usize = 2048;

/// What is done with constraints over `N` vertices.
pub(crate) trait Kernel<const N: usize> {
    /// Projects constraints that share no vertex, in blocks.
    fn project(
        x: &[[f32; 4]],
        d: &mut impl Displacements,
        part: Part<'_, N>,
        projection: Projection,
    );
}

/// Projects the constraints of one color.
#[inline(always)]
pub(crate) fn sweep<K: Kernel<N>, const N: usize>(
    arch: Arch,
    x: &[[f32; 4]],
    d: &mut [Cell],
    part: Part<'_, N>,
    projection: Projection,
) {
    if part.vertices.len() < PARALLEL_FROM {
        K::project(x, &mut Exclusive(d), part, projection);
    } else {
        spread::<K, N>(arch, x, Shared(d), part, projection);
    }
}

fn spread<K: Kernel<N>, const N: usize>(
    arch: Arch,
    x: &[[f32; 4]],
    d: Shared<'_>,
    part: Part<'_, N>,
    projection: Projection,
) {
    let count = part.vertices.len();
    if count < 2 * GRAIN {
        arch.dispatch(Piece::<K, N> {
            x,
            d,
            part,
            projection,
            kernel: std::marker::PhantomData,
        });
        return;
    }
    let (left, right) = part.split_at((count / 2).next_multiple_of(GRAIN));
    rayon::join(
        || spread::<K, N>(arch, x, d, left, projection),
        || spread::<K, N>(arch, x, d, right, projection),
    );
}

/// What one thread does, compiled for the instruction set that is found at run time.
struct Piece<'a, K, const N: usize> {
    x: &'a [[f32; 4]],
    d: Shared<'a>,
    part: Part<'a, N>,
    projection: Projection,
    kernel: std::marker::PhantomData<K>,
}

impl<K: Kernel<N>, const N: usize> NullaryFnOnce for Piece<'_, K, N> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        K::project(self.x, &mut self.d, self.part, self.projection);
    }
}

/// Whether a batch of so many constraints is given to several threads.
pub(crate) fn is_spread(constraints: usize) -> bool {
    constraints >= PARALLEL_FROM
}
