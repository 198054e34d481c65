//! Projects the constraints of one color on one or several threads.

use crate::constraints::batches::Part;
use crate::kernels::displacements::{Cell, Displacements, Exclusive, Shared};
use crate::step::constants::Projection;
use pulp::{Arch, NullaryFnOnce};

/// Minimum number of constraints of a color for several threads.
///
/// Below it the time to wake a thread is a significant part. It depends on the number of
/// constraints only, never on the number of threads, so that results are deterministic.
const MIN_PARALLEL: usize = 8192;

/// Minimum number of constraints per task; a multiple of the SIMD block.
const GRAIN: usize = 2048;

/// Projects constraints over `N` vertices.
pub(crate) trait Kernel<const N: usize> {
    /// Projects constraints that share no vertex, in blocks.
    fn project(
        x: &[[f32; 4]],
        d: &mut impl Displacements,
        part: Part<'_, N>,
        projection: Projection,
    );

    /// Projects constraints that may share vertices, serially.
    fn project_serial(
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
    if part.vertices.len() < MIN_PARALLEL {
        K::project(x, &mut Exclusive(d), part, projection);
    } else {
        sweep_parallel::<K, N>(arch, x, Shared(d), part, projection);
    }
}

fn sweep_parallel<K: Kernel<N>, const N: usize>(
    arch: Arch,
    x: &[[f32; 4]],
    d: Shared<'_>,
    part: Part<'_, N>,
    projection: Projection,
) {
    let count = part.vertices.len();
    if count < 2 * GRAIN {
        arch.dispatch(Task::<K, N> {
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
        || sweep_parallel::<K, N>(arch, x, d, left, projection),
        || sweep_parallel::<K, N>(arch, x, d, right, projection),
    );
}

/// Work of one thread, compiled for the instruction set that is detected at run time.
struct Task<'a, K, const N: usize> {
    x: &'a [[f32; 4]],
    d: Shared<'a>,
    part: Part<'a, N>,
    projection: Projection,
    kernel: std::marker::PhantomData<K>,
}

impl<K: Kernel<N>, const N: usize> NullaryFnOnce for Task<'_, K, N> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        K::project(self.x, &mut self.d, self.part, self.projection);
    }
}

/// Returns true if a batch of that many constraints runs on several threads.
pub(crate) fn is_parallel(constraints: usize) -> bool {
    constraints >= MIN_PARALLEL
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraints::batches::Batch;
    use crate::kernels::bending::Bending;
    use crate::kernels::stretch::Stretch;
    use crate::material::Stiffness;
    use incise_mesh::VertexId;

    /// Random constraints that share no vertex.
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
        let count = u32::try_from(MIN_PARALLEL).unwrap() + 77;
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
        let serial = run(|x, d, part, p| K::project(x, &mut Exclusive(d), part, p));
        let parallel = run(|x, d, part, p| sweep::<K, N>(Arch::new(), x, d, part, p));
        assert!(serial == parallel, "threads and vectors change nothing");
        assert!(
            serial.0.iter().flatten().any(|&b| b != 0),
            "something moved"
        );
    }

    #[test]
    fn any_instruction_set_and_any_number_of_threads_give_the_same_bits() {
        compare::<Stretch, 2>();
        compare::<Bending, 4>();
    }
}
