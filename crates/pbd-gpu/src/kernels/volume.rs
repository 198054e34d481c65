//! Volume constraints: preserve the volume of closed pieces (Mueller et al. 2007, section 4.4).
//!
//! `C = V - pressure rest`, with XPBD multipliers. The gradient at a vertex is a sixth of the sum
//! of `a x b` over its triangles, with `a` and `b` the edges that leave the vertex. It does not
//! depend on the point of reference; the vertex itself keeps precision far from the origin. `V` is
//! homogeneous of degree 3, hence a third of the sum of gradient times position, relative to the
//! first vertex of the piece.
//!
//! All vertices of a piece move at once, after sums over all of them: chunks of [`CHUNK`] vertices,
//! each reduced by a tree, then the chunks by the same tree. The fixed order makes the sums equal
//! on any number of threads and on any GPU.
//!
//! Sums count a vertex that touches a collider as fixed if its outward normal points into it, so
//! that the collider takes nothing of a volume after this pass. Where it slips, it counts as free
//! to move along the collider: on a plane these parts of all gradients cancel, and without friction
//! the piece must not be pushed. A vertex [supported](crate::SupportedSide) by a piece counts as
//! fixed if its normal points down.
//!
//! A growing volume still moves vertices into colliders. Their pass undoes it, and their friction
//! counts the load. Otherwise blocks creep downhill. Supported vertices do not move
//! down: columns would collapse. Nor do those of pieces thinner than their fall in a substep, which
//! friction would keep flat.
//!
//! `steps` decides how much of an error a substep corrects.

pub(crate) mod motion;
pub(crate) mod steps;
mod tree;

use super::colliders::{dot, separation, touches};
use super::particle_state::{ParticleState, ParticleStates};
use crate::constraints::colliders::{ColliderRecord, PLANE};
use crate::constraints::volumes::{RingVertex, VolumeSet};
use crate::parallel::Leader;
use crate::parallel::passes::volume_gradients;
use crate::step::constants::VolumeProjection;
use incise_mesh::VertexId;
pub(crate) use motion::Round;
use pulp::{Arch, NullaryFnOnce};
use std::cell::Cell;
use std::ops::Range;
pub(crate) use steps::{LOADS, RECOVERY};
use steps::{greater, recovery, steps};
use tree::total_of;
pub(crate) use tree::tree;

/// Leaves of a reduction tree.
pub(crate) const CHUNK: usize = 256;

/// Factor of the sum of `a x b` in the gradient.
pub(crate) const SIXTH: f32 = 1.0 / 6.0;
/// Factor of the sum of gradient times position in the volume.
pub(crate) const THIRD: f32 = 1.0 / 3.0;

/// Sum of gradient times position [m^3], sum of `|grad C|^2 / m`, maximum of `|grad C| / m`.
type Sums = [f32; 3];

/// Scratch memory of the projection.
#[derive(Debug, Default)]
pub(crate) struct VolumeScratch {
    /// Gradient [m^2] and inverse mass [1/kg], shape \[spokes\].
    gradients: Vec<[f32; 4]>,
    /// Sums of the chunks of the current piece, shape \[chunks\].
    partial: Vec<Sums>,
    /// The same for its motion.
    motions: Vec<[f32; 4]>,
}

impl VolumeScratch {
    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        self.gradients.capacity() + self.partial.capacity() + self.motions.capacity()
    }
}

/// The colliders and carrying pieces that bound the motion of vertices.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VolumeObstacles<'a> {
    /// A vector along gravity.
    pub(crate) gravity: [f32; 3],
    pub(crate) colliders: &'a [ColliderRecord],
    /// Vertices that a piece carries, shape [vertex slots]; empty without contacts.
    pub(crate) carried: &'a [Cell<bool>],
    /// Time of the frame at the end of the substep \[s\].
    pub(crate) time: f32,
}

/// Input of the pass for one piece.
#[derive(Debug, Clone, Copy)]
struct PieceInput<'a> {
    particles: ParticleStates<'a>,
    /// See [`RingVertex::ring`].
    rings: &'a [VertexId],
    /// Vertex that positions are relative to.
    center: usize,
    obstacles: VolumeObstacles<'a>,
    /// Velocities; the fourth component is the remaining friction bound of colliders \[m\].
    velocities: &'a [[f32; 4]],
}

/// Projects the volume of every piece.
///
/// Returns the maximum change of the position of a vertex \[m\], without displacements.
///
/// Not inlined, so that it does not affect the code of the passes that every body has.
#[inline(never)]
pub(crate) fn volumes(
    (leader, arch): (&mut Leader<'_>, Arch),
    (particles, velocities): (ParticleStates<'_>, &[[f32; 4]]),
    set: &mut VolumeSet,
    (by, round, obstacles): (VolumeProjection, Round, VolumeObstacles<'_>),
    scratch: &mut VolumeScratch,
) -> f32 {
    let mut max_change = 0.0;
    let states = set.lambda.iter_mut().zip(&mut set.displacements);
    for (piece, (lambda, displacement)) in set.pieces.iter().zip(states) {
        let spokes = &set.spokes[piece.first..piece.end];
        let chunks = spokes.len().div_ceil(CHUNK);
        scratch.gradients.resize(spokes.len(), [0.0; 4]);
        scratch.partial.resize(chunks, [0.0; 3]);
        let Some(center) = spokes.first() else {
            continue;
        };
        let input = PieceInput {
            particles,
            rings: &set.rings,
            center: center.vertex.index(),
            obstacles,
            velocities,
        };
        let sums = sum::<false>((leader, arch), input, spokes, scratch);
        let missing = (sums[0] * THIRD - by.pressure * piece.rest).abs();
        let presses = by.alpha == 0.0 && by.pressure != 1.0;
        let before = if presses || missing > recovery(piece, by) {
            sum::<true>((leader, arch), input, spokes, scratch)[0]
        } else {
            sums[0]
        };
        let lambda_before = if by.accumulates_lambda { *lambda } else { 0.0 };
        let steps = steps(sums, before, piece, by, lambda_before);
        if by.accumulates_lambda {
            *lambda -= steps[0];
        }
        if round.has_others() {
            let spokes = (spokes, by.sink);
            round.proceed(particles, spokes, displacement, &mut scratch.motions);
        }
        let reacts = steps[0] < 0.0 && piece.reach > by.sink;
        apply(input, spokes, (&scratch.gradients, steps), reacts);
        max_change = greater(max_change, steps[1].abs() * sums[2]);
    }
    max_change
}

/// Returns the sums of a piece and stores its gradients; or the sums at the start of the substep.
#[inline(always)]
fn sum<const BEFORE: bool>(
    (leader, arch): (&mut Leader<'_>, Arch),
    input: PieceInput<'_>,
    spokes: &[RingVertex],
    scratch: &mut VolumeScratch,
) -> Sums {
    let gradients = VolumeGradients::<BEFORE> {
        input,
        spokes,
        gradients: Cell::from_mut(&mut *scratch.gradients).as_slice_of_cells(),
        partial: Cell::from_mut(&mut *scratch.partial).as_slice_of_cells(),
    };
    volume_gradients(leader, arch, gradients);
    total_of(&scratch.partial, greater)
}

/// Computes gradients and sums of chunks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VolumeGradients<'a, const BEFORE: bool> {
    input: PieceInput<'a>,
    pub(crate) spokes: &'a [RingVertex],
    /// Shape \[spokes\].
    gradients: &'a [Cell<[f32; 4]>],
    /// Shape \[chunks\].
    partial: &'a [Cell<Sums>],
}

impl<const BEFORE: bool> VolumeGradients<'_, BEFORE> {
    /// Returns the work for a range of spokes, which starts with a chunk.
    pub(crate) fn slice(self, range: Range<usize>) -> Self {
        Self {
            input: self.input,
            spokes: &self.spokes[range.clone()],
            gradients: &self.gradients[range.clone()],
            partial: &self.partial[range.start / CHUNK..range.end.div_ceil(CHUNK)],
        }
    }
}

impl<const BEFORE: bool> NullaryFnOnce for VolumeGradients<'_, BEFORE> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let mut columns = [[0.0; CHUNK]; 3];
        let spokes = self.spokes.chunks(CHUNK);
        let gradients = self.gradients.chunks(CHUNK);
        for ((spokes, gradients), partial) in spokes.zip(gradients).zip(self.partial) {
            for (i, (spoke, gradient)) in spokes.iter().zip(gradients).enumerate() {
                let (g, sums) = around::<BEFORE>(&self.input, spoke);
                if !BEFORE {
                    gradient.set(g);
                }
                for (column, sum) in columns.iter_mut().zip(sums) {
                    column[i] = sum;
                }
            }
            partial.set(tree(&mut columns, spokes.len(), greater));
        }
    }
}

/// Returns gradient and inverse mass at a spoke, and its terms of the sums.
#[inline(always)]
fn around<const BEFORE: bool>(input: &PieceInput<'_>, spoke: &RingVertex) -> ([f32; 4], Sums) {
    let PieceInput {
        particles,
        rings,
        center,
        obstacles,
        velocities,
    } = input;
    let v = spoke.vertex.index();
    let state = |i: usize| {
        let state = particles.get(i);
        if BEFORE { state.at_start() } else { state }
    };
    let origin = state(v);
    let edge = |i: usize| origin.vector_to(state(i));
    let mut ring = spoke.ring(rings).iter().map(|v| edge(v.index()));
    let mut a = ring.next().unwrap_or_default();
    let mut sum = [0.0; 3];
    for b in ring {
        sum[0] += a[1] * b[2] - a[2] * b[1];
        sum[1] += a[2] * b[0] - a[0] * b[2];
        sum[2] += a[0] * b[1] - a[1] * b[0];
        a = b;
    }
    let [gx, gy, gz] = sum.map(|c| c * SIXTH);
    // Vector from the vertex to the center, hence the other sign of the sum.
    let back = edge(*center);
    let place = gx * back[0] + gy * back[1] + gz * back[2];
    let w = origin.x[3];
    let gradient = [gx, gy, gz];
    let is_carried = obstacles.is_carried(v);
    let [fx, fy, fz] = if BEFORE {
        gradient
    } else {
        obstacles.free_gradient(is_carried, gradient, origin, velocities[v][3])
    };
    let square = fx * fx + fy * fy + fz * fz;
    let [gx, gy, gz] = if is_carried { [fx, fy, fz] } else { gradient };
    ([gx, gy, gz, w], [-place, w * square, w * square.sqrt()])
}

impl VolumeObstacles<'_> {
    /// Returns whether a piece carries a vertex.
    #[inline(always)]
    fn is_carried(&self, v: usize) -> bool {
        self.carried.get(v).is_some_and(Cell::get)
    }

    /// Returns the part of a gradient that a vertex can follow, with `held` of friction left \[m\].
    #[inline(always)]
    fn free_gradient(
        &self,
        is_carried: bool,
        gradient: [f32; 3],
        ParticleState { x, d }: ParticleState,
        held: f32,
    ) -> [f32; 3] {
        if is_carried && dot(gradient, self.gravity) > 0.0 {
            return [0.0; 3];
        }
        let slips = !is_carried && held == 0.0;
        let mut free = gradient;
        for collider in self.colliders {
            // Most vertices are not pressed into a plane, whose normal is the same everywhere.
            let is_pressed = collider.kind != PLANE || dot(free, collider.extent) < 0.0;
            if !is_pressed {
                continue;
            }
            let q = collider.relative(x, self.time);
            let (distance, n) = separation(q, [d[0], d[1], d[2]], collider);
            let along = dot(free, n);
            if along < 0.0 && touches(distance, q) {
                let slide = [0, 1, 2].map(|k: usize| free[k] - along * n[k]);
                free = if slips { slide } else { [0.0; 3] };
            }
        }
        free
    }
}

/// Moves the vertices of a piece by the steps of displacements and of positions.
///
/// If the piece `reacts`, displacements go into colliders, whose pass undoes them.
/// Positions never do.
#[inline(always)]
fn apply(
    input: PieceInput<'_>,
    spokes: &[RingVertex],
    (gradients, [step, shift]): (&[[f32; 4]], [f32; 2]),
    reacts: bool,
) {
    let PieceInput {
        particles,
        obstacles,
        velocities,
        ..
    } = input;
    for (spoke, &[gx, gy, gz, w]) in spokes.iter().zip(gradients) {
        let v = spoke.vertex.index();
        let gradient = [gx, gy, gz];
        let mut state = particles.get(v);
        let free = if reacts && shift == 0.0 {
            gradient
        } else {
            obstacles.free_gradient(obstacles.is_carried(v), gradient, state, velocities[v][3])
        };
        let followed = if reacts { gradient } else { free };
        let [by, moved] = [-(w * step), -(w * shift)];
        for (d, g) in state.d.iter_mut().zip(followed) {
            *d += by * g;
        }
        if shift != 0.0 {
            for (x, g) in state.x.iter_mut().zip(free) {
                *x += moved * g;
            }
        }
        particles.set(v, state);
    }
}
