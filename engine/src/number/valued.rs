//! Numbers of one or several lanes, with or without derivatives. Formulas can compare their plain values.

use super::{Dual, Interval, Jet, Lanes, Real, SimdReal, Tracked, registers::Registers};
use std::fmt::Debug;

/// A number with a plain value in each lane.
///
/// Formulas that depend on a comparison use this trait. A formula may branch on [`SimdReal::all`] and skip the branch that
/// no lane needs. Numbers outside SIMD registers have one lane. If lanes differ, [`Valued::choose`] selects lane by lane.
pub trait Valued: Real {
    /// Type of the value without its derivatives.
    type Plain: SimdReal + Debug;

    /// The value without its derivatives.
    fn plain_value(self) -> Self::Plain;
    /// The constant with this value in each lane, with the type and size of `self`.
    fn of_plain(self, value: Self::Plain) -> Self;
    /// Selects `yes` in the lanes of the mask, else `no`.
    fn choose(mask: MaskOf<Self>, yes: Self, no: Self) -> Self;
    /// Lanes in which the value is less than a constant; false for NaN.
    #[inline(always)]
    fn is_below(self, limit: f64) -> MaskOf<Self> {
        let value = self.plain_value();
        value.less(value.constant(limit))
    }
    /// Lanes in which the value is greater than a constant; false for NaN.
    #[inline(always)]
    fn is_above(self, limit: f64) -> MaskOf<Self> {
        let value = self.plain_value();
        value.constant(limit).less(value)
    }
}

/// Truth value for each lane of a number.
pub type MaskOf<T> = <<T as Valued>::Plain as SimdReal>::Mask;

/// Larger of two numbers that are not negative. If a number is NaN, the result is NaN, so that a size with NaN never counts
/// as small.
#[inline(always)]
#[expect(
    clippy::eq_op,
    reason = "the difference is NaN if the number is not finite"
)]
pub(crate) fn larger<P: SimdReal>(a: P, b: P) -> P {
    // a - a is 0, or NaN if a is not finite.
    P::select(b.less(a), a, b + (a - a))
}

/// Implements the trait for numbers of one lane.
macro_rules! one_lane {
    ($($number:ty),*) => {
        $(
            impl Valued for $number {
                type Plain = f64;
                #[inline(always)]
                fn plain_value(self) -> f64 {
                    super::Scalar::value(self)
                }
                #[inline(always)]
                fn of_plain(self, value: f64) -> Self {
                    self.constant(value)
                }
                #[inline(always)]
                fn choose(mask: bool, yes: Self, no: Self) -> Self {
                    if mask { yes } else { no }
                }
            }
        )*
    };
}

one_lane!(f64, Interval, Tracked<'_>);

impl<S: Registers> Valued for Lanes<S> {
    type Plain = Self;
    #[inline(always)]
    fn plain_value(self) -> Self {
        self
    }
    #[inline(always)]
    fn of_plain(self, value: Self) -> Self {
        value
    }
    #[inline(always)]
    fn choose(mask: MaskOf<Self>, yes: Self, no: Self) -> Self {
        <Self as SimdReal>::select(mask, yes, no)
    }
}

impl<T: Valued, const N: usize> Valued for Jet<T, N> {
    type Plain = T::Plain;
    #[inline(always)]
    fn plain_value(self) -> T::Plain {
        self.0[0].plain_value()
    }
    #[inline(always)]
    fn of_plain(self, value: T::Plain) -> Self {
        Jet::constant(self.0[0].of_plain(value))
    }
    #[inline(always)]
    fn choose(mask: MaskOf<T>, yes: Self, no: Self) -> Self {
        let mut chosen = no;
        for k in 0..N {
            chosen.0[k] = T::choose(mask, yes.0[k], no.0[k]);
        }
        chosen
    }
}

impl<T: Valued, const N: usize> Valued for Dual<T, N> {
    type Plain = T::Plain;
    #[inline(always)]
    fn plain_value(self) -> T::Plain {
        self.value.plain_value()
    }
    #[inline(always)]
    fn of_plain(self, value: T::Plain) -> Self {
        Dual::constant(self.value.of_plain(value))
    }
    #[inline(always)]
    fn choose(mask: MaskOf<T>, yes: Self, no: Self) -> Self {
        let mut chosen = no;
        chosen.value = T::choose(mask, yes.value, no.value);
        for k in 0..N {
            chosen.partials[k] = T::choose(mask, yes.partials[k], no.partials[k]);
        }
        chosen
    }
}
