//! Arithmetic on one number per SIMD lane, with operators.

use pulp::Simd;
use std::ops::{Add, BitAnd, Div, Mul, Neg, Sub};

/// A number per lane. Every operation is rounded as in scalar code.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lanes<S: Simd> {
    simd: S,
    pub(crate) values: S::f32s,
}

/// A truth value per lane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mask<S: Simd> {
    simd: S,
    pub(crate) values: S::m32s,
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, values: S::f32s) -> Self {
        Self { simd, values }
    }

    /// Returns the instructions.
    #[inline(always)]
    pub(crate) fn simd(self) -> S {
        self.simd
    }

    /// Returns the same number in all lanes.
    #[inline(always)]
    pub(crate) fn splat(simd: S, number: f32) -> Self {
        Self::new(simd, simd.splat_f32s(number))
    }

    /// Returns zero in all lanes.
    #[inline(always)]
    pub(crate) fn zero(self) -> Self {
        Self::splat(self.simd, 0.0)
    }

    /// Returns the numbers of an array that has as many elements as there are lanes.
    #[inline(always)]
    pub(crate) fn from_array<const L: usize>(simd: S, numbers: [f32; L]) -> Self {
        Self::new(simd, S::as_simd_f32s(&numbers).0[0])
    }

    /// Returns the number of every lane.
    #[inline(always)]
    pub(crate) fn to_array<const L: usize>(self) -> [f32; L] {
        let mut numbers = [0.0; L];
        S::as_mut_simd_f32s(&mut numbers).0[0] = self.values;
        numbers
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Self::new(self.simd, self.simd.sqrt_f32s(self.values))
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        // `abs_f32s` of pulp calls functions that link-time optimization alone inlines.
        let magnitude = self.simd.splat_f32s(f32::from_bits(0x7fff_ffff));
        Self::new(self.simd, self.simd.and_f32s(magnitude, self.values))
    }

    /// Returns the lanes that are less; none with NaN.
    #[inline(always)]
    pub(crate) fn lt(self, other: Self) -> Mask<S> {
        Mask {
            simd: self.simd,
            values: self.simd.less_than_f32s(self.values, other.values),
        }
    }

    /// Returns the lanes that are greater; none with NaN.
    #[inline(always)]
    pub(crate) fn gt(self, other: Self) -> Mask<S> {
        other.lt(self)
    }

    /// Returns the lanes that are less or equal; none with NaN.
    #[inline(always)]
    pub(crate) fn le(self, other: Self) -> Mask<S> {
        Mask {
            simd: self.simd,
            values: self.simd.less_than_or_equal_f32s(self.values, other.values),
        }
    }
}

impl<S: Simd> Mask<S> {
    /// Returns `yes` in the lanes of the mask and `no` in the others.
    #[inline(always)]
    pub(crate) fn select(self, yes: Lanes<S>, no: Lanes<S>) -> Lanes<S> {
        let values = self.simd.select_f32s(self.values, yes.values, no.values);
        Lanes::new(self.simd, values)
    }

    /// Returns the lanes of either mask.
    #[inline(always)]
    pub(crate) fn or(self, other: Self) -> Self {
        Self {
            simd: self.simd,
            values: self.simd.or_m32s(self.values, other.values),
        }
    }

    /// Returns true if the mask has all lanes.
    #[inline(always)]
    pub(crate) fn all(self) -> bool {
        let other = self.simd.not_m32s(self.values);
        self.simd.first_true_m32s(other) == S::F32_LANES
    }

    /// Returns `yes` in the lanes of the mask and zero in the others.
    #[inline(always)]
    pub(crate) fn or_zero(self, yes: Lanes<S>) -> Lanes<S> {
        self.select(yes, yes.zero())
    }
}

impl<S: Simd> BitAnd for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self {
            simd: self.simd,
            values: self.simd.and_m32s(self.values, other.values),
        }
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(self.simd, self.simd.neg_f32s(self.values))
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

        impl<S: Simd> $operator<f32> for Lanes<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: f32) -> Self {
                self.$method(Self::splat(self.simd, other))
            }
        }

        impl<S: Simd> $operator<Lanes<S>> for f32 {
            type Output = Lanes<S>;

            #[inline(always)]
            fn $method(self, other: Lanes<S>) -> Lanes<S> {
                Lanes::splat(other.simd, self).$method(other)
            }
        }
    };
}

operator!(Add, add, add_f32s);
operator!(Sub, sub, sub_f32s);
operator!(Mul, mul, mul_f32s);
operator!(Div, div, div_f32s);
