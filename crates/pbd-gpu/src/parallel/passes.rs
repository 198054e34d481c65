//! Passes whose chunks run on several threads.

use super::team::{Leader, with_team};
use crate::constraints::batches::Part;
use crate::constraints::cells::{CELLS_PER_BLOCK, CellBatch};
use crate::constraints::contacts::ContactRecord;
use crate::kernels::block::{Transpose, WithGather, dispatch};
use crate::kernels::cells::CellConstants;
use crate::kernels::colliders::Planes;
use crate::kernels::contacts::contacts as project_contacts;
use crate::kernels::particle_state::ParticleStates;
use crate::kernels::volume::{CHUNK, VolumeGradients, VolumeScratch};
use crate::patches::content::PatchContent;
use crate::step::cell_sweep::CellSweep;
use crate::step::constants::{Projection, StepConstants};
use crate::step::stage::{Stage, SteppedBody};
use crate::step::sweep::{Kernel, PatchSweep, Sweep};
use pulp::{Arch, Scalar};
use std::cell::Cell;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Minimum number of elements of a pass, or of vertices of all small bodies, for several threads.
///
/// Below it the exchange of cache lines between cores costs more than the second core gains.
const MIN_SHARED: usize = 1024;

/// Work of a cell, in edges.
pub(crate) const CELL_WORK: usize = 16;

/// Chunks per thread, so that a thread which falls behind can be relieved.
const CHUNKS_PER_MEMBER: usize = 2;

/// Multiple of the number of constraints of a chunk, so that its blocks are full.
const CHUNK_STEP: usize = 64;

/// A value that threads may share although its type has cells.
struct Shared<T>(T);

// SAFETY: the functions of this module create it. Each states why no two threads access the same
// element, unless both only read it.
unsafe impl<T> Sync for Shared<T> {}

impl<T> Shared<T> {
    /// Returns the value. A method, so that closures capture all of `self`.
    fn get(&self) -> &T {
        &self.0
    }
}

/// Projects the constraints of one color.
pub(crate) fn sweep_color<K: Kernel<N>, const N: usize>(
    leader: &mut Leader<'_>,
    arch: Arch,
    particles: ParticleStates<'_>,
    part: Part<'_, N>,
    projection: Projection,
) {
    let count = part.vertices.len();
    let size = chunk_size(count, leader.members());
    // The constraints of a color share no vertex, and every chunk has its own constraints. So
    // particles and multipliers are accessed by one thread each.
    let shared = Shared((particles, part));
    leader.run(count.div_ceil(size), &|chunk| {
        let (particles, part) = *shared.get();
        let start = chunk * size;
        let part = part.slice(start..count.min(start + size));
        dispatch(arch, Sweep::<K, N>::blocks(particles, part, projection));
    });
}

/// Projects the cells of one color.
pub(crate) fn sweep_cells(
    leader: &mut Leader<'_>,
    arch: Arch,
    particles: ParticleStates<'_>,
    node_forces: &[Cell<[f32; 4]>],
    batch: &mut CellBatch,
    constants: &CellConstants,
) {
    let (count, blocks) = (batch.len(), batch.blocks.len());
    let size = if leader.members() == 1 || !are_cells_shared(count) {
        blocks.max(1)
    } else {
        blocks.div_ceil(leader.members() * CHUNKS_PER_MEMBER)
    };
    // The cells of a color share no node, and every chunk has its own blocks.
    let shared = Shared((particles, node_forces, batch.blocks.as_mut_ptr()));
    leader.run(blocks.div_ceil(size), &|chunk| {
        let (particles, node_forces, all) = *shared.get();
        let range = chunk * size..blocks.min((chunk + 1) * size);
        let first = range.start * CELLS_PER_BLOCK;
        // SAFETY: the range ends within the slice, those of chunks do not overlap, and every chunk
        // runs once.
        let blocks = unsafe { std::slice::from_raw_parts_mut(all.add(range.start), range.len()) };
        let work = CellSweep {
            particles,
            node_forces,
            count: (count - first).min(blocks.len() * CELLS_PER_BLOCK),
            blocks,
            constants,
        };
        dispatch(arch, work);
    });
}

/// Projects cells that may share nodes, one after the other.
pub(crate) fn sweep_cells_serially(
    particles: ParticleStates<'_>,
    node_forces: &[Cell<[f32; 4]>],
    batch: &mut CellBatch,
    constants: &CellConstants,
) {
    let count = batch.len();
    let sweep = CellSweep {
        particles,
        node_forces,
        blocks: &mut batch.blocks,
        count,
        constants,
    };
    sweep.with::<_, 1>(Transpose(Scalar));
}

/// Projects the constraints of all patches of a layer, in reverse order if `is_back`.
pub(crate) fn sweep_patches(
    leader: &mut Leader<'_>,
    arch: Arch,
    particles: ParticleStates<'_>,
    patches: &mut [PatchContent],
    constants: &StepConstants,
    is_back: bool,
) {
    let &StepConstants {
        stretch, bending, ..
    } = constants;
    let count = patches.len();
    // The patches of a layer share no vertex and no constraint.
    let shared = Shared((particles, patches.as_mut_ptr()));
    leader.run(count, &|i| {
        let (particles, patches) = *shared.get();
        // SAFETY: `i` is less than the length of the slice, and every chunk runs once.
        let patch = unsafe { &mut *patches.add(i) };
        dispatch(
            arch,
            PatchSweep {
                particles,
                patch,
                stretch,
                bending,
                is_back,
            },
        );
    });
}

/// Projects those contacts of one color whose ascending indices are in `facing`.
pub(crate) fn sweep_contacts(
    leader: &mut Leader<'_>,
    particles: ParticleStates<'_>,
    carried: &[Cell<bool>],
    corrections: &[Cell<[f32; 4]>],
    contacts: &mut [ContactRecord],
    facing: &[u32],
    planes: Planes<'_>,
) {
    let count = contacts.len();
    let size = chunk_size(count, leader.members());
    // The contacts of a color share no vertex.
    let shared = Shared((particles, (carried, corrections), contacts.as_mut_ptr()));
    leader.run(count.div_ceil(size), &|chunk| {
        let (particles, (carried, corrections), contacts) = *shared.get();
        let range = chunk * size..count.min((chunk + 1) * size);
        // SAFETY: the range ends within the slice, those of chunks do not overlap, and every chunk
        // runs once.
        let contacts =
            unsafe { std::slice::from_raw_parts_mut(contacts.add(range.start), range.len()) };
        let place = |end: usize| facing.partition_point(|&i| (i as usize) < end);
        let facing = &facing[place(range.start)..place(range.end)];
        let first = range.start;
        project_contacts(
            particles,
            carried,
            corrections,
            contacts,
            first,
            facing,
            planes,
        );
    });
}

/// Returns the number of chunks in which a team shares the bodies of an island.
pub(crate) fn body_chunks(leader: &Leader<'_>) -> usize {
    match leader.members() {
        1 => 1,
        members => members * CHUNKS_PER_MEMBER,
    }
}

/// Runs a stage for all small bodies, in one chunk per element of `volumes`.
///
/// Returns the first small body with a position that is not finite.
pub(crate) fn share_bodies(
    leader: &mut Leader<'_>,
    stage: Stage<'_>,
    bodies: &mut [SteppedBody<'_>],
    volumes: &mut [VolumeScratch],
) -> Option<usize>
where
    for<'a> SteppedBody<'a>: Send,
{
    let (count, chunks) = (bodies.len(), volumes.len());
    let failed = AtomicUsize::new(usize::MAX);
    // A stage of a body reads and writes the states of its own vertices only, and every chunk has
    // its own bodies.
    let shared = Shared((stage, bodies.as_mut_ptr(), volumes.as_mut_ptr()));
    leader.run(chunks, &|chunk| {
        let (stage, bodies, volumes) = *shared.get();
        let range = count * chunk / chunks..count * (chunk + 1) / chunks;
        // SAFETY: the range ends within the slice, those of chunks do not overlap, and every chunk
        // runs once.
        let bodies =
            unsafe { std::slice::from_raw_parts_mut(bodies.add(range.start), range.len()) };
        // SAFETY: `chunk` is less than the length of the slice, and every chunk runs once.
        let scratch = unsafe { &mut *volumes.add(chunk) };
        with_team(NonZeroUsize::new(1), |alone| {
            for body in bodies.iter_mut().filter(|body| !body.is_large) {
                if !stage.run(body, alone, scratch) {
                    failed.fetch_min(body.index, Ordering::Relaxed);
                }
            }
        });
    });
    Some(failed.into_inner()).filter(|&body| body < count)
}

/// Computes the gradients of a volume constraint.
pub(crate) fn volume_gradients<const BEFORE: bool>(
    leader: &mut Leader<'_>,
    arch: Arch,
    gradients: VolumeGradients<'_, BEFORE>,
) {
    let count = gradients.spokes.len();
    let size = chunk_size(count, leader.members()).next_multiple_of(CHUNK);
    // Particles are only read; every chunk writes its own gradients and sums.
    let shared = Shared(gradients);
    leader.run(count.div_ceil(size), &|chunk| {
        let start = chunk * size;
        arch.dispatch(shared.get().slice(start..count.min(start + size)));
    });
}

/// Returns the number of elements of a chunk; all of them for one thread.
fn chunk_size(count: usize, members: usize) -> usize {
    if members == 1 || !is_shared(count) {
        return count.max(1);
    }
    let even = count.div_ceil(members * CHUNKS_PER_MEMBER);
    even.next_multiple_of(CHUNK_STEP)
}

/// Returns whether several threads project that many cells of a color.
pub(crate) fn are_cells_shared(count: usize) -> bool {
    is_shared(count * CELL_WORK)
}

/// Returns whether several threads run a pass of that many elements.
pub(crate) fn is_shared(count: usize) -> bool {
    count >= MIN_SHARED
}
