//! [`Lanes`] of 64-bit numbers, and their transposition from and to rows of vectors.
//!
//! As in [`kernels::block`](crate::kernels::block), all implementations compute the same bits.

#[cfg(target_arch = "x86_64")]
mod avx2;

use bytemuck::{Pod, Zeroable};
use incise_mesh::{Vec3, VertexId};
use pulp::{Arch, Scalar, Simd, WithSimd};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A vector with a fourth component of 0, as wide as a register.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C, align(32))]
pub(super) struct Row([f64; 4]);

impl From<Vec3> for Row {
    fn from(v: Vec3) -> Self {
        Self([v.x, v.y, v.z, 0.0])
    }
}

impl From<Row> for Vec3 {
    fn from(Row([x, y, z, _]): Row) -> Self {
        Self::new(x, y, z)
    }
}

/// A number per lane. Every operation is rounded as in scalar code.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lanes<S: Simd> {
    simd: S,
    values: S::f64s,
}

/// A truth value per lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mask<S: Simd> {
    simd: S,
    values: S::m64s,
}

/// A vector per lane.
pub(super) type Vector<S> = [Lanes<S>; 3];

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    fn new(simd: S, values: S::f64s) -> Self {
        Self { simd, values }
    }

    /// Returns the same number in all lanes.
    #[inline(always)]
    pub(super) fn splat(simd: S, number: f64) -> Self {
        Self::new(simd, simd.splat_f64s(number))
    }

    /// Returns the numbers of an array that has as many elements as there are lanes.
    #[inline(always)]
    pub(super) fn from_array<const L: usize>(simd: S, numbers: [f64; L]) -> Self {
        Self::new(simd, S::as_simd_f64s(&numbers).0[0])
    }

    /// Returns the number of every lane.
    #[inline(always)]
    pub(super) fn to_array<const L: usize>(self) -> [f64; L] {
        let mut numbers = [0.0; L];
        S::as_mut_simd_f64s(&mut numbers).0[0] = self.values;
        numbers
    }

    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        Self::new(self.simd, self.simd.sqrt_f64s(self.values))
    }

    #[inline(always)]
    pub(super) fn abs(self) -> Self {
        // `abs_f64s` of pulp calls functions that link-time optimization alone inlines.
        let magnitude = self.simd.splat_f64s(f64::from_bits(u64::MAX >> 1));
        Self::new(self.simd, self.simd.and_f64s(magnitude, self.values))
    }

    /// Returns the lanes that are less; none with NaN.
    #[inline(always)]
    pub(super) fn lt(self, other: Self) -> Mask<S> {
        let values = self.simd.less_than_f64s(self.values, other.values);
        Mask {
            simd: self.simd,
            values,
        }
    }
}

impl<S: Simd> Mask<S> {
    /// Returns `yes` in the lanes of the mask and `no` in the others.
    #[inline(always)]
    pub(super) fn select(self, yes: Lanes<S>, no: Lanes<S>) -> Lanes<S> {
        let values = self.simd.select_f64s(self.values, yes.values, no.values);
        Lanes::new(self.simd, values)
    }

    /// Returns `yes` in the lanes of the mask and zero in the others.
    #[inline(always)]
    pub(super) fn or_zero(self, yes: Lanes<S>) -> Lanes<S> {
        self.select(yes, Lanes::splat(self.simd, 0.0))
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(self.simd, self.simd.neg_f64s(self.values))
    }
}

macro_rules! operator {
    ($operator:ident, $method:ident, $operation:ident) => {
        impl<S: Simd> $operator for Lanes<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self::new(self.simd, self.simd.$operation(self.values, other.values))
            }
        }
    };
}

operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);

#[inline(always)]
pub(super) fn add<S: Simd>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(super) fn subtract<S: Simd>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn negative<S: Simd>(a: Vector<S>) -> Vector<S> {
    [-a[0], -a[1], -a[2]]
}

#[inline(always)]
pub(super) fn scale<S: Simd>(by: Lanes<S>, a: Vector<S>) -> Vector<S> {
    [by * a[0], by * a[1], by * a[2]]
}

#[inline(always)]
pub(super) fn cross<S: Simd>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline(always)]
pub(super) fn dot<S: Simd>(a: Vector<S>, b: Vector<S>) -> Lanes<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Transposes rows to `L` lanes and back.
pub(super) trait Gather<const L: usize>: Copy {
    /// Instructions on `L` lanes.
    type S: Simd;

    /// Returns the instructions.
    fn simd(self) -> Self::S;

    /// Returns the rows of the `j`th vertices as lanes.
    fn gather<const N: usize>(
        self,
        rows: &[Row],
        vertices: &[[VertexId; N]; L],
        j: usize,
    ) -> Vector<Self::S>;

    /// Adds lanes to the rows of the `j`th vertices of the first `count` constraints.
    fn add<const N: usize>(
        self,
        rows: &mut [Row],
        vertices: &[[VertexId; N]; L],
        j_and_count: (usize, usize),
        by: Vector<Self::S>,
    );
}

/// Work that is compiled for the instruction set that is detected at run time.
pub(super) trait WithGather {
    type Output;

    /// Does the work. It must be inlined, and so must the functions that it calls.
    fn with<G: Gather<L>, const L: usize>(self, gather: G) -> Self::Output;
}

/// Does work with the widest instructions of this CPU.
pub(super) fn dispatch<W: WithGather>(work: W) -> W::Output {
    match Arch::new() {
        #[cfg(target_arch = "x86_64")]
        Arch::V3(simd) => avx2::dispatch(simd, work),
        arch => arch.dispatch(AnyCpu(work)),
    }
}

struct AnyCpu<W>(W);

impl<W: WithGather> WithSimd for AnyCpu<W> {
    type Output = W::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> W::Output {
        match S::F64_LANES {
            2 => self.0.with::<_, 2>(Transpose(simd)),
            4 => self.0.with::<_, 4>(Transpose(simd)),
            _ => self.0.with::<_, 1>(Transpose(Scalar)),
        }
    }
}

/// Transposition without intrinsics.
#[derive(Debug, Clone, Copy)]
pub(super) struct Transpose<S>(pub(super) S);

impl<S: Simd, const L: usize> Gather<L> for Transpose<S> {
    type S = S;

    #[inline(always)]
    fn simd(self) -> S {
        self.0
    }

    #[inline(always)]
    fn gather<const N: usize>(
        self,
        rows: &[Row],
        vertices: &[[VertexId; N]; L],
        j: usize,
    ) -> Vector<S> {
        let mut lanes = [[0.0; L]; 3];
        for (i, vertices) in vertices.iter().enumerate() {
            for (lanes, c) in lanes.iter_mut().zip(rows[vertices[j].index()].0) {
                lanes[i] = c;
            }
        }
        let [x, y, z] = lanes;
        [
            Lanes::from_array(self.0, x),
            Lanes::from_array(self.0, y),
            Lanes::from_array(self.0, z),
        ]
    }

    #[inline(always)]
    fn add<const N: usize>(
        self,
        rows: &mut [Row],
        vertices: &[[VertexId; N]; L],
        (j, count): (usize, usize),
        by: Vector<S>,
    ) {
        let [x, y, z] = by;
        let (x, y, z): ([f64; L], [f64; L], [f64; L]) = (x.to_array(), y.to_array(), z.to_array());
        for (i, vertices) in vertices.iter().enumerate().take(count) {
            let Row(row) = &mut rows[vertices[j].index()];
            for (sum, c) in row.iter_mut().zip([x[i], y[i], z[i]]) {
                *sum += c;
            }
        }
    }
}
