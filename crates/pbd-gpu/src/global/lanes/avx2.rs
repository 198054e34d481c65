//! Transposition of 4 x 4 matrices with AVX2.

use super::{Gather, Lanes, Row, Vector, WithGather};
use incise_mesh::VertexId;
use pulp::x86::V3;
use pulp::{NullaryFnOnce, cast};
use std::arch::x86_64::__m256d;

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

impl Gather<4> for V3 {
    type S = Self;

    #[inline(always)]
    fn simd(self) -> Self {
        self
    }

    #[inline(always)]
    fn gather<const N: usize>(
        self,
        rows: &[Row],
        vertices: &[[VertexId; N]; 4],
        j: usize,
    ) -> Vector<Self> {
        // A loop would store single numbers and load four of them, which the CPU cannot forward.
        let [a, b, c, d] = vertices;
        let rows = [
            cast(rows[a[j].index()]),
            cast(rows[b[j].index()]),
            cast(rows[c[j].index()]),
            cast(rows[d[j].index()]),
        ];
        let [x, y, z, _] = transpose(self, rows);
        [
            Lanes::new(self, cast(x)),
            Lanes::new(self, cast(y)),
            Lanes::new(self, cast(z)),
        ]
    }

    #[inline(always)]
    fn add<const N: usize>(
        self,
        rows: &mut [Row],
        vertices: &[[VertexId; N]; 4],
        (j, count): (usize, usize),
        by: Vector<Self>,
    ) {
        let [x, y, z] = by;
        let (x, y, z) = (cast(x.values), cast(y.values), cast(z.values));
        let [x, y, z, w] = transpose(self, [x, y, z, self.avx._mm256_setzero_pd()]);
        let [a, b, c, d] = vertices;
        add_row(self, &mut rows[a[j].index()], x);
        if count > 1 {
            add_row(self, &mut rows[b[j].index()], y);
        }
        if count > 2 {
            add_row(self, &mut rows[c[j].index()], z);
        }
        if count > 3 {
            add_row(self, &mut rows[d[j].index()], w);
        }
    }
}

#[inline(always)]
fn add_row(simd: V3, row: &mut Row, by: __m256d) {
    *row = cast(simd.avx._mm256_add_pd(cast(*row), by));
}

/// Transposes a 4 x 4 matrix.
#[inline(always)]
fn transpose(simd: V3, [a, b, c, d]: [__m256d; 4]) -> [__m256d; 4] {
    let avx = simd.avx;
    let (ab, cd) = (avx._mm256_unpacklo_pd(a, b), avx._mm256_unpacklo_pd(c, d));
    let (ab_high, cd_high) = (avx._mm256_unpackhi_pd(a, b), avx._mm256_unpackhi_pd(c, d));
    [
        avx._mm256_permute2f128_pd::<0x20>(ab, cd),
        avx._mm256_permute2f128_pd::<0x20>(ab_high, cd_high),
        avx._mm256_permute2f128_pd::<0x31>(ab, cd),
        avx._mm256_permute2f128_pd::<0x31>(ab_high, cd_high),
    ]
}
