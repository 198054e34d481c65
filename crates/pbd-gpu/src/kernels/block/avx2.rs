//! Transposition with AVX2: 4 x 4 matrices in both halves of the registers.

use super::{Gather, WithGather};
use crate::kernels::lanes::{Lanes, Mask};
use crate::kernels::particle_state::ParticleStates;
use incise_mesh::VertexId;
use pulp::x86::V3;
use pulp::{NullaryFnOnce, cast};
use std::arch::x86_64::{__m128, __m256};
use std::cell::Cell;

/// Does work with AVX2.
pub(super) fn dispatch<W: WithGather>(simd: V3, work: W) -> W::Output {
    simd.vectorize(Avx2(simd, work))
}

struct Avx2<W>(V3, W);

impl<W: WithGather> NullaryFnOnce for Avx2<W> {
    type Output = W::Output;

    #[inline(always)]
    fn call(self) -> W::Output {
        self.1.with(self.0)
    }
}

impl Gather<8> for V3 {
    type S = Self;
    type Row = __m128;

    #[inline(always)]
    fn simd(self) -> Self {
        self
    }

    #[inline(always)]
    fn all(self, mask: Mask<Self>) -> bool {
        self.avx._mm256_movemask_ps(cast(mask.values)) == 0xff
    }

    #[inline(always)]
    fn inverse_masses<const N: usize>(
        self,
        particles: ParticleStates<'_>,
        vertices: &[[VertexId; N]; 8],
    ) -> Lanes<Self> {
        let [a, b, c, d, e, f, g, h] = vertices;
        let masses = [
            inverse_mass(particles, a),
            inverse_mass(particles, b),
            inverse_mass(particles, c),
            inverse_mass(particles, d),
            inverse_mass(particles, e),
            inverse_mass(particles, f),
            inverse_mass(particles, g),
            inverse_mass(particles, h),
        ];
        Lanes::new(self, cast(masses))
    }

    #[inline(always)]
    fn differences<const N: usize>(
        self,
        particles: ParticleStates<'_>,
        vertices: &[[VertexId; N]; 8],
        j: usize,
    ) -> [Lanes<Self>; 4] {
        gather(self, particles, vertices, j, difference)
    }

    #[inline(always)]
    fn displacements<const N: usize>(
        self,
        particles: ParticleStates<'_>,
        vertices: &[[VertexId; N]; 8],
        j: usize,
    ) -> [Lanes<Self>; 4] {
        gather(self, particles, vertices, j, displacement)
    }

    #[inline(always)]
    fn to_rows(self, lanes: [Lanes<Self>; 3]) -> [__m128; 8] {
        let [x, y, z] = lanes;
        let (x, y, z) = (cast(x.values), cast(y.values), cast(z.values));
        let [a, b, c, d] = transpose(self, [x, y, z, self.avx._mm256_setzero_ps()]);
        [
            self.avx._mm256_castps256_ps128(a),
            self.avx._mm256_castps256_ps128(b),
            self.avx._mm256_castps256_ps128(c),
            self.avx._mm256_castps256_ps128(d),
            self.avx._mm256_extractf128_ps::<1>(a),
            self.avx._mm256_extractf128_ps::<1>(b),
            self.avx._mm256_extractf128_ps::<1>(c),
            self.avx._mm256_extractf128_ps::<1>(d),
        ]
    }

    #[inline(always)]
    fn add_d(self, particles: ParticleStates<'_>, v: VertexId, row: __m128) {
        let d = cast(particles.get(v.index()).d);
        particles.set_d(v.index(), cast(self.sse._mm_add_ps(d, row)));
    }

    #[inline(always)]
    fn add_row(self, to: &Cell<[f32; 4]>, row: __m128) {
        to.set(cast(self.sse._mm_add_ps(cast(to.get()), row)));
    }
}

#[inline(always)]
fn inverse_mass<const N: usize>(particles: ParticleStates<'_>, vertices: &[VertexId; N]) -> f32 {
    particles.get(vertices[0].index()).x[3]
}

/// Returns the row of every pair of vertices as lanes.
///
/// `row` computes two rows, in the halves of a register, from two differences of records.
#[inline(always)]
fn gather<const N: usize>(
    simd: V3,
    particles: ParticleStates<'_>,
    vertices: &[[VertexId; N]; 8],
    j: usize,
    row: impl Fn(V3, [__m256; 2]) -> __m256,
) -> [Lanes<V3>; 4] {
    // A loop would store single rows and load pairs of them, which the CPU cannot forward.
    let [a, b, c, d, e, f, g, h] = vertices;
    let pairs = [
        row(simd, record_differences(simd, particles, [a, e], j)),
        row(simd, record_differences(simd, particles, [b, f], j)),
        row(simd, record_differences(simd, particles, [c, g], j)),
        row(simd, record_differences(simd, particles, [d, h], j)),
    ];
    let [x, y, z, w] = transpose(simd, pairs);
    [
        Lanes::new(simd, cast(x)),
        Lanes::new(simd, cast(y)),
        Lanes::new(simd, cast(z)),
        Lanes::new(simd, cast(w)),
    ]
}

/// Returns the records of the `j`th vertices minus those of the first, for two constraints.
///
/// The fourth component of the position is the inverse mass of the `j`th vertex.
#[inline(always)]
fn record_differences<const N: usize>(
    simd: V3,
    particles: ParticleStates<'_>,
    [low, high]: [&[VertexId; N]; 2],
    j: usize,
) -> [__m256; 2] {
    [
        record_difference(simd, particles, low, j),
        record_difference(simd, particles, high, j),
    ]
}

#[inline(always)]
fn record_difference<const N: usize>(
    simd: V3,
    particles: ParticleStates<'_>,
    vertices: &[VertexId; N],
    j: usize,
) -> __m256 {
    let (avx, first) = (simd.avx, cast(particles.get(vertices[0].index())));
    let without_mass = avx._mm256_blend_ps::<0b0000_1000>(first, avx._mm256_setzero_ps());
    let other = cast(particles.get(vertices[j].index()));
    avx._mm256_sub_ps(other, without_mass)
}

/// Returns relative positions at the start of the substep, and inverse masses.
#[inline(always)]
fn initial_difference(simd: V3, [low, high]: [__m256; 2]) -> __m256 {
    let high = simd.avx._mm256_castps256_ps128(high);
    simd.avx._mm256_insertf128_ps::<1>(low, high)
}

/// Returns relative displacements.
#[inline(always)]
fn displacement(simd: V3, [low, high]: [__m256; 2]) -> __m256 {
    simd.avx._mm256_permute2f128_ps::<0x31>(low, high)
}

/// Returns relative positions and inverse masses.
#[inline(always)]
fn difference(simd: V3, records: [__m256; 2]) -> __m256 {
    let (x, d) = (
        initial_difference(simd, records),
        displacement(simd, records),
    );
    simd.avx._mm256_add_ps(x, d)
}

/// Transposes the 4 x 4 matrices in both halves of four registers.
#[inline(always)]
fn transpose(simd: V3, [a, b, c, d]: [__m256; 4]) -> [__m256; 4] {
    let avx = simd.avx;
    let (ab, cd) = (avx._mm256_unpacklo_ps(a, b), avx._mm256_unpacklo_ps(c, d));
    let (ab_high, cd_high) = (avx._mm256_unpackhi_ps(a, b), avx._mm256_unpackhi_ps(c, d));
    [
        avx._mm256_shuffle_ps::<0x44>(ab, cd),
        avx._mm256_shuffle_ps::<0xEE>(ab, cd),
        avx._mm256_shuffle_ps::<0x44>(ab_high, cd_high),
        avx._mm256_shuffle_ps::<0xEE>(ab_high, cd_high),
    ]
}
