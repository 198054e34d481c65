//! Projects constraints in SIMD blocks.

use crate::constraints::batches::Part;
use crate::kernels::bending::Bending;
use crate::kernels::block::{Block, Gather, WithGather};
use crate::kernels::lanes::Lanes;
use crate::kernels::particle_state::ParticleStates;
use crate::kernels::stretch::Stretch;
use crate::patches::content::PatchContent;
use crate::step::constants::Projection;
use incise_mesh::VertexId;
use std::marker::PhantomData;

/// Projects constraints over `N` vertices.
pub(crate) trait Kernel<const N: usize> {
    /// Projects the constraints of a block.
    ///
    /// `HISTORY` is [`Projection::has_history`]; without it the code of other cases is left out.
    fn project<G: Gather<L>, const L: usize, const HISTORY: bool>(
        gather: G,
        particles: ParticleStates<'_>,
        block: &mut Block<'_, G::S, L, N>,
        projection: Projection,
    );
}

/// The projection of constraints, compiled for the instruction set that is detected at run time.
pub(crate) struct Sweep<'a, K, const N: usize> {
    particles: ParticleStates<'a>,
    part: Part<'a, N>,
    projection: Projection,
    is_serial: bool,
    /// Whether blocks are projected from last to first.
    is_reversed: bool,
    kernel: PhantomData<K>,
}

impl<'a, K: Kernel<N>, const N: usize> Sweep<'a, K, N> {
    /// Projects constraints that share no vertex, in full blocks.
    pub(crate) fn blocks(
        particles: ParticleStates<'a>,
        part: Part<'a, N>,
        projection: Projection,
    ) -> Self {
        Self {
            particles,
            part,
            projection,
            is_serial: false,
            is_reversed: false,
            kernel: PhantomData,
        }
    }

    /// Projects constraints that may share vertices, one after another.
    pub(crate) fn serial(
        particles: ParticleStates<'a>,
        part: Part<'a, N>,
        projection: Projection,
    ) -> Self {
        Self {
            is_serial: true,
            ..Self::blocks(particles, part, projection)
        }
    }
}

impl<K, const N: usize> Sweep<'_, K, N> {
    /// Returns the sweep over the same blocks in reverse order.
    pub(crate) fn reversed(self) -> Self {
        Self {
            is_reversed: true,
            ..self
        }
    }
}

impl<K: Kernel<N>, const N: usize> WithGather for Sweep<'_, K, N> {
    type Output = ();

    #[inline(always)]
    fn with<G: Gather<L>, const L: usize>(self, gather: G) {
        if self.projection.has_history() {
            self.project_all::<G, L, true>(gather);
        } else {
            self.project_all::<G, L, false>(gather);
        }
    }
}

impl<K: Kernel<N>, const N: usize> Sweep<'_, K, N> {
    #[inline(always)]
    fn project_all<G: Gather<L>, const L: usize, const HISTORY: bool>(self, gather: G) {
        let Self {
            particles,
            part,
            projection,
            ..
        } = self;
        let size = if self.is_serial { 1 } else { L };
        let count = part.vertices.len();
        let blocks = count.div_ceil(size);
        for i in 0..blocks {
            let i = if self.is_reversed { blocks - 1 - i } else { i };
            let next = part.slice(i * size..count.min((i + 1) * size));
            let padded;
            let mut block = Block {
                vertices: match next.vertices.try_into() {
                    Ok(full) => full,
                    Err(_) => {
                        padded = pad(next.vertices);
                        &padded
                    }
                },
                count: next.vertices.len(),
                rest: load::<G, L>(gather, next.rest),
                lambda: Lanes::splat(gather.simd(), 0.0),
            };
            if HISTORY && !next.lambda.is_empty() {
                let mut lambda = [0.0; L];
                for (lambda, kept) in lambda.iter_mut().zip(next.lambda) {
                    *lambda = kept.get();
                }
                block.lambda = Lanes::from_array(gather.simd(), lambda);
            }
            K::project::<G, L, HISTORY>(gather, particles, &mut block, projection);
            if HISTORY {
                let lambda: [f32; L] = block.lambda.to_array();
                for (kept, lambda) in next.lambda.iter().zip(lambda) {
                    kept.set(lambda);
                }
            }
        }
    }
}

/// The projection of all constraints of a patch.
pub(crate) struct PatchSweep<'a> {
    pub(crate) particles: ParticleStates<'a>,
    pub(crate) patch: &'a mut PatchContent,
    pub(crate) stretch: Projection,
    pub(crate) bending: Projection,
    /// Whether to project in reverse order.
    pub(crate) is_back: bool,
}

impl WithGather for PatchSweep<'_> {
    type Output = ();

    #[inline(always)]
    fn with<G: Gather<L>, const L: usize>(self, gather: G) {
        let (particles, patch) = (self.particles, self.patch);
        if self.is_back {
            for run in patch.bending.runs(self.bending.accumulates_lambda).rev() {
                let sweep = Sweep::<Bending, 4>::blocks(particles, run, self.bending);
                sweep.reversed().with(gather);
            }
            for run in patch.stretch.runs(self.stretch.accumulates_lambda).rev() {
                let sweep = Sweep::<Stretch, 2>::blocks(particles, run, self.stretch);
                sweep.reversed().with(gather);
            }
            return;
        }
        for run in patch.stretch.runs(self.stretch.accumulates_lambda) {
            Sweep::<Stretch, 2>::blocks(particles, run, self.stretch).with(gather);
        }
        for run in patch.bending.runs(self.bending.accumulates_lambda) {
            Sweep::<Bending, 4>::blocks(particles, run, self.bending).with(gather);
        }
    }
}

/// Returns at most `L` numbers and zeros as lanes.
#[inline(always)]
fn load<G: Gather<L>, const L: usize>(gather: G, numbers: &[f32]) -> Lanes<G::S> {
    let mut lanes = [0.0; L];
    match numbers.try_into() {
        Ok(full) => lanes = full,
        Err(_) => lanes[..numbers.len()].copy_from_slice(numbers),
    }
    Lanes::from_array(gather.simd(), lanes)
}

/// Returns the vertices of `L` constraints; the last ones are repeated.
#[cold]
fn pad<const L: usize, const N: usize>(vertices: &[[VertexId; N]]) -> [[VertexId; N]; L] {
    std::array::from_fn(|lane| vertices[lane.min(vertices.len() - 1)])
}

/// Projects constraints that share no vertex, for tests of single kernels.
#[cfg(test)]
pub(crate) fn sweep<K: Kernel<N>, const N: usize>(
    particles: ParticleStates<'_>,
    part: Part<'_, N>,
    projection: Projection,
) {
    let work = Sweep::<K, N>::blocks(particles, part, projection);
    crate::kernels::block::dispatch(pulp::Arch::new(), work);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraints::batches::Batch;
    use crate::kernels::bending::Bending;
    use crate::kernels::block::Transpose;
    use crate::kernels::particle_state::ParticleState;
    use crate::kernels::stretch::Stretch;
    use crate::material::Stiffness;
    use pulp::Scalar;

    /// Returns random particles and constraints that share none.
    fn scattered<const N: usize>(count: usize) -> (Vec<ParticleState>, Batch<N>) {
        let mut seed = 1_u32;
        let mut random = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / (1 << 24) as f32
        };
        let mut batch = Batch::default();
        let mut particles = Vec::new();
        for _ in 0..count {
            batch.vertices.push(std::array::from_fn(|_| {
                let x = [random(), random(), random(), random()];
                particles.push(ParticleState { x, d: [0.0; 4] });
                VertexId::from_index(particles.len() - 1)
            }));
            batch.rest.push(random());
        }
        batch.reset_multipliers();
        (particles, batch)
    }

    fn compare<K: Kernel<N>, const N: usize>(count: usize) {
        let projection = Projection {
            ..Stiffness::Compliance(1e-3).projection(2, 0.05)
        };
        let run = |sweep: &dyn Fn(ParticleStates<'_>, Part<'_, N>)| {
            let (mut particles, mut batch) = scattered::<N>(count);
            for _ in 0..2 {
                sweep(ParticleStates::new(&mut particles), batch.part(true));
            }
            let lambda: Vec<u32> = batch.lambda.iter().map(|l| l.to_bits()).collect();
            let bits = |state: &ParticleState| state.d.map(f32::to_bits);
            (particles.iter().map(bits).collect::<Vec<_>>(), lambda)
        };
        let serial = run(&|p, part| {
            Sweep::<K, N>::serial(p, part, projection).with::<_, 1>(Transpose(Scalar));
        });
        assert!(
            serial.0.iter().flatten().any(|&b| b != 0),
            "something moved"
        );
        let blocks = run(&|p, part| sweep::<K, N>(p, part, projection));
        assert!(serial == blocks, "blocks of {count} constraints differ");
    }

    #[test]
    fn any_instruction_set_and_any_tail_give_the_same_bits() {
        for count in [1, 7, 8, 20, 3077] {
            compare::<Stretch, 2>(count);
            compare::<Bending, 4>(count);
        }
    }
}
