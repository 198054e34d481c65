//! SIMD blocks of constraints: gather, compute per lane, scatter.
//!
//! Particles are stored as rows `[x, y, z, w]`; kernels compute with [`Lanes`], one register per
//! component. A [`Gather`] transposes between both.

#[cfg(target_arch = "x86_64")]
mod avx2;

use super::lanes::{Lanes, Mask};
use super::particle_state::{ParticleState, ParticleStates};
use incise_mesh::VertexId;
use pulp::{Arch, Scalar, Simd, WithSimd};
use std::cell::Cell;

/// Constraints that share no vertex, one per lane.
pub(crate) struct Block<'a, S: Simd, const L: usize, const N: usize> {
    /// Vertices of every lane. Lanes without a constraint repeat the last one.
    pub(crate) vertices: &'a [[VertexId; N]; L],
    /// Number of constraints.
    pub(crate) count: usize,
    pub(crate) rest: Lanes<S>,
    pub(crate) lambda: Lanes<S>,
}

/// Transposes rows of particles to `L` lanes and back.
///
/// All implementations compute the same bits.
pub(crate) trait Gather<const L: usize>: Copy + Send + Sync {
    /// Instructions on `L` lanes.
    type S: Simd;

    /// A vector of four components.
    type Row: Copy;

    /// Returns the instructions.
    fn simd(self) -> Self::S;

    /// Returns true if the mask has all lanes.
    fn all(self, mask: Mask<Self::S>) -> bool;

    /// Returns the inverse masses of the first vertices [1/kg].
    fn inverse_masses<const N: usize>(
        self,
        particles: ParticleStates<'_>,
        vertices: &[[VertexId; N]; L],
    ) -> Lanes<Self::S>;

    /// Returns the vectors from the first to the `j`th vertices \[m\], and the inverse masses of
    /// the latter [1/kg].
    fn differences<const N: usize>(
        self,
        particles: ParticleStates<'_>,
        vertices: &[[VertexId; N]; L],
        j: usize,
    ) -> [Lanes<Self::S>; 4];

    /// Returns the displacements of the `j`th vertices relative to the first \[m\], and zero.
    fn displacements<const N: usize>(
        self,
        particles: ParticleStates<'_>,
        vertices: &[[VertexId; N]; L],
        j: usize,
    ) -> [Lanes<Self::S>; 4];

    /// Returns rows with the given components, the last one 0.
    fn to_rows(self, lanes: [Lanes<Self::S>; 3]) -> [Self::Row; L];

    /// Adds a row to the displacement of a particle.
    fn add_d(self, particles: ParticleStates<'_>, v: VertexId, row: Self::Row);

    /// Adds a row to another one.
    fn add_row(self, to: &Cell<[f32; 4]>, row: Self::Row);
}

/// Adds changes to the displacements of the `j`th vertices of a block.
#[inline(always)]
pub(crate) fn scatter<G: Gather<L>, const L: usize, const N: usize>(
    gather: G,
    particles: ParticleStates<'_>,
    block: &Block<'_, G::S, L, N>,
    j: usize,
    change: [Lanes<G::S>; 3],
) {
    let rows = gather.to_rows(change);
    if block.count == L {
        for (vertices, row) in block.vertices.iter().zip(rows) {
            gather.add_d(particles, vertices[j], row);
        }
    } else {
        for (vertices, row) in block.vertices.iter().zip(rows).take(block.count) {
            gather.add_d(particles, vertices[j], row);
        }
    }
}

/// Work that is compiled for the instruction set that is detected at run time.
pub(crate) trait WithGather {
    type Output;

    /// Does the work. It must be inlined, and so must the kernels that it calls.
    fn with<G: Gather<L>, const L: usize>(self, gather: G) -> Self::Output;
}

/// Does work with the widest instructions of this CPU.
pub(crate) fn dispatch<W: WithGather>(arch: Arch, work: W) -> W::Output {
    match arch {
        #[cfg(target_arch = "x86_64")]
        Arch::V3(simd) => avx2::dispatch(simd, work),
        _ => arch.dispatch(AnyCpu(work)),
    }
}

struct AnyCpu<W>(W);

impl<W: WithGather> WithSimd for AnyCpu<W> {
    type Output = W::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> W::Output {
        match S::F32_LANES {
            4 => self.0.with::<_, 4>(Transpose(simd)),
            8 => self.0.with::<_, 8>(Transpose(simd)),
            _ => self.0.with::<_, 1>(Transpose(Scalar)),
        }
    }
}

/// Transposition without intrinsics.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Transpose<S>(pub(crate) S);

impl<S: Simd> Transpose<S> {
    /// Returns the row of every pair of vertices as lanes.
    #[inline(always)]
    fn gather<const L: usize, const N: usize>(
        self,
        particles: ParticleStates<'_>,
        vertices: &[[VertexId; N]; L],
        j: usize,
        row: impl Fn(ParticleState, ParticleState) -> [f32; 4],
    ) -> [Lanes<S>; 4] {
        let mut lanes = [[0.0; L]; 4];
        for (i, vertices) in vertices.iter().enumerate() {
            let first = particles.get(vertices[0].index());
            let row = row(first, particles.get(vertices[j].index()));
            for (lanes, c) in lanes.iter_mut().zip(row) {
                lanes[i] = c;
            }
        }
        let [x, y, z, w] = lanes;
        [
            Lanes::from_array(self.0, x),
            Lanes::from_array(self.0, y),
            Lanes::from_array(self.0, z),
            Lanes::from_array(self.0, w),
        ]
    }
}

impl<S: Simd, const L: usize> Gather<L> for Transpose<S> {
    type S = S;
    type Row = [f32; 4];

    #[inline(always)]
    fn simd(self) -> S {
        self.0
    }

    #[inline(always)]
    fn all(self, mask: Mask<S>) -> bool {
        mask.all()
    }

    #[inline(always)]
    fn inverse_masses<const N: usize>(
        self,
        particles: ParticleStates<'_>,
        vertices: &[[VertexId; N]; L],
    ) -> Lanes<S> {
        let mut masses = [0.0; L];
        for (mass, vertices) in masses.iter_mut().zip(vertices) {
            *mass = particles.get(vertices[0].index()).x[3];
        }
        Lanes::from_array(self.0, masses)
    }

    #[inline(always)]
    fn differences<const N: usize>(
        self,
        particles: ParticleStates<'_>,
        vertices: &[[VertexId; N]; L],
        j: usize,
    ) -> [Lanes<S>; 4] {
        self.gather(particles, vertices, j, difference)
    }

    #[inline(always)]
    fn displacements<const N: usize>(
        self,
        particles: ParticleStates<'_>,
        vertices: &[[VertexId; N]; L],
        j: usize,
    ) -> [Lanes<S>; 4] {
        self.gather(particles, vertices, j, |a, b| {
            let (a, b) = (a.d, b.d);
            [b[0] - a[0], b[1] - a[1], b[2] - a[2], 0.0]
        })
    }

    #[inline(always)]
    fn to_rows(self, lanes: [Lanes<S>; 3]) -> [[f32; 4]; L] {
        let [x, y, z] = lanes;
        let (x, y, z): ([f32; L], [f32; L], [f32; L]) = (x.to_array(), y.to_array(), z.to_array());
        let mut rows = [[0.0; 4]; L];
        for i in 0..L {
            rows[i] = [x[i], y[i], z[i], 0.0];
        }
        rows
    }

    #[inline(always)]
    fn add_d(self, particles: ParticleStates<'_>, v: VertexId, row: [f32; 4]) {
        particles.add_d(v.index(), row);
    }

    #[inline(always)]
    fn add_row(self, to: &Cell<[f32; 4]>, row: [f32; 4]) {
        let sum = to.get();
        to.set([0, 1, 2, 3].map(|k: usize| sum[k] + row[k]));
    }
}

/// Returns the vector from `a` to `b`: `(x_b - x_a) + (d_b - d_a)` \[m\], and the inverse mass of
/// `b` [1/kg].
#[inline(always)]
pub(crate) fn difference(a: ParticleState, b: ParticleState) -> [f32; 4] {
    [
        (b.x[0] - a.x[0]) + (b.d[0] - a.d[0]),
        (b.x[1] - a.x[1]) + (b.d[1] - a.d[1]),
        (b.x[2] - a.x[2]) + (b.d[2] - a.d[2]),
        b.x[3],
    ]
}
