//! One pass over the constraints of one color, on one thread or many.

use crate::constraints::Part;
use crate::kernels::displacements::{Cell, Displacements, Exclusive, Shared};
use crate::material::Projection;
use pulp::{Arch, NullaryFnOnce};

/// A color with fewer constraints is swept by one thread. So many take one core about 50 us (stretch) to
/// 120 us (bending), against some 10 us to hand work to a sleeping thread. Only the number of
/// constraints decides, never the number of threads.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraints::Batch;
    use crate::kernels::bending::Bending;
    use crate::kernels::stretch::Stretch;
    use crate::material::Stiffness;
    use incise_mesh::VertexId;

    /// Constraints over vertices of their own, in a shape without pattern.
    fn scattered<const N: usize>(count: u32) -> (Vec<[f32; 4]>, Batch<N>) {
        let mut seed = 1_u32;
        let mut random = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / (1 << 24) as f32
        };
        let mut batch = Batch::default();
        let mut x = Vec::new();
        for _ in 0..count {
            batch.vertices.push(std::array::from_fn(|_| {
                x.push([random(), random(), random(), random()]);
                VertexId::from_index(x.len() - 1)
            }));
            batch.rest.push(random());
        }
        batch.reset_multipliers();
        (x, batch)
    }

    fn bits(cells: &mut [Cell]) -> Vec<[u32; 4]> {
        let bits = |cell: &mut Cell| cell.each_mut().map(|c| *c.get_mut());
        cells.iter_mut().map(bits).collect()
    }

    fn compare<K: Kernel<N>, const N: usize>() {
        let projection = Stiffness::Compliance(1e-3).projection(2, 0.05);
        let count = u32::try_from(PARALLEL_FROM).unwrap() + 77;
        let run = |how: fn(&[[f32; 4]], &mut [Cell], Part<'_, N>, Projection)| {
            let (x, mut batch) = scattered::<N>(count);
            let mut cells: Vec<Cell> = Vec::new();
            cells.resize_with(x.len(), Cell::default);
            for _ in 0..2 {
                how(&x, &mut cells, batch.part(true), projection);
            }
            let lambda: Vec<u32> = batch.lambda.iter().map(|l| l.to_bits()).collect();
            (bits(&mut cells), lambda)
        };
        let plain = run(|x, d, part, p| K::project(x, &mut Exclusive(d), part, p));
        let spread = run(|x, d, part, p| sweep::<K, N>(Arch::new(), x, d, part, p));
        assert!(plain == spread, "threads and wide vectors change nothing");
        assert!(plain.0.iter().flatten().any(|&b| b != 0), "something moved");
    }

    #[test]
    fn any_instruction_set_and_any_number_of_threads_give_the_same_bits() {
        compare::<Stretch, 2>();
        compare::<Bending, 4>();
    }
}
