//! Two bundles side by side.
//!
//! One chain of dependent operations leaves a processor idle most of the time; two of them, independent of
//! each other, fill the gaps.

use super::{Outlined, Real, SimdReal, arc};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Two bundles, or two masks. Aligned so that no register in memory lies across two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Unrolled2<B>(pub B, pub B);

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl<B: $trait<Output = B>> $trait for Unrolled2<B> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Unrolled2(self.0.$method(other.0), self.1.$method(other.1))
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);
operator!(BitAnd, bitand);
operator!(BitOr, bitor);

impl<B: Neg<Output = B>> Neg for Unrolled2<B> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Unrolled2(-self.0, -self.1)
    }
}

impl<B: Not<Output = B>> Not for Unrolled2<B> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Unrolled2(!self.0, !self.1)
    }
}

impl<B: SimdReal> Real for Unrolled2<B> {
    const IN_REGISTERS: bool = B::IN_REGISTERS;

    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        Unrolled2(self.0.plus_product(a.0, b.0), self.1.plus_product(a.1, b.1))
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        Unrolled2(
            self.0.minus_product(a.0, b.0),
            self.1.minus_product(a.1, b.1),
        )
    }
    #[inline(always)]
    fn lit(self, value: f64) -> Self {
        Unrolled2(self.0.lit(value), self.1.lit(value))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Unrolled2(self.0.sqrt(), self.1.sqrt())
    }
    #[inline(always)]
    fn asin(self) -> Self {
        arc::asin(self)
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        arc::atan2(self, x)
    }
    #[inline(always)]
    fn sign(self) -> Self {
        Unrolled2(self.0.sign(), self.1.sign())
    }
}

impl<B: SimdReal> SimdReal for Unrolled2<B> {
    const LANES: usize = 2 * B::LANES;
    type Mask = Unrolled2<B::Mask>;

    #[inline(always)]
    fn load(self, from: &[f64]) -> Self {
        Unrolled2(self.0.load(from), self.1.load(&from[B::LANES..]))
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        self.0.store(to);
        self.1.store(&mut to[B::LANES..]);
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Unrolled2(self.0.abs(), self.1.abs())
    }
    #[inline(always)]
    fn copysign(self, other: Self) -> Self {
        Unrolled2(self.0.copysign(other.0), self.1.copysign(other.1))
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self::Mask {
        Unrolled2(self.0.less(other.0), self.1.less(other.1))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Unrolled2(
            B::select(mask.0, yes.0, no.0),
            B::select(mask.1, yes.1, no.1),
        )
    }
    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        B::all(mask.0) & B::all(mask.1)
    }
    #[inline(always)]
    fn outlined<P: Outlined>(self, piece: P) -> P::Output {
        self.0.outlined(piece)
    }
    #[inline(always)]
    fn lane(mask: Self::Mask, lane: usize) -> bool {
        match lane < B::LANES {
            true => B::lane(mask.0, lane),
            false => B::lane(mask.1, lane - B::LANES),
        }
    }
}
