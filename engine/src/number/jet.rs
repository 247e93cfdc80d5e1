//! Truncated Taylor series: a value with its derivatives with respect to one variable, the drive.
//!
//! `Jet([c0, c1, c2])` means `c0 + c1 e + c2 e^2 + O(e^3)`; the k-th derivative is `k! c_k`. The recurrences are the usual
//! recurrences for power series (A. Griewank, A. Walther, *Evaluating Derivatives*, 2nd ed., SIAM 2008, tables 13.1 and
//! 13.2). The code uses plain loops, because `array::map` and `from_fn` take ten times longer to compile. Products of the
//! shortest series are the most frequent, so the code contains them without loops.

#![allow(
    clippy::needless_range_loop,
    reason = "recurrences use indices, as in the literature"
)]

use super::{Outlined, Real, Scalar, call_outlined, outlined};
use crate::number::array_of;
use std::ops::{Add, Div, Index, Mul, Neg, Sub};

/// A Taylor series with `N` coefficients, and so with derivatives up to order `N - 1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet<T, const N: usize>(pub [T; N]);

impl<T: Real, const N: usize> Jet<T, N> {
    /// Makes a constant: every derivative is zero.
    #[inline]
    pub fn constant(value: T) -> Self {
        let mut series = [value.zero(); N];
        series[0] = value;
        Jet(series)
    }

    /// Makes the variable itself, at `value`: its first derivative is one.
    #[inline(always)]
    pub fn variable(value: T) -> Self {
        let mut series = Jet::constant(value);
        if N > 1 {
            series.0[1] = value.one();
        }
        series
    }

    /// Derivative of the given order.
    #[inline(always)]
    pub fn derivative(&self, order: usize) -> T {
        const FACTORIAL: [f64; 6] = [1.0, 1.0, 2.0, 6.0, 24.0, 120.0];
        self.0[order].scaled(FACTORIAL[order])
    }

    /// Derivative as a series. Its highest coefficient is unknown and set to zero.
    #[inline(always)]
    pub fn differentiated(self) -> Self {
        let mut rate = [self.0[0].zero(); N];
        for k in 1..N {
            rate[k - 1] = self.0[k].scaled(k as f64);
        }
        Jet(rate)
    }

    /// Makes the integral of the series `rate`, with the constant term `value`.
    #[inline(always)]
    fn integrated(value: T, rate: Self) -> Self {
        let mut series = [value; N];
        for k in 1..N {
            series[k] = rate.0[k - 1].scaled(1.0 / k as f64);
        }
        Jet(series)
    }
}

impl<const N: usize> Jet<f64, N> {
    /// Sine and cosine.
    pub fn sin_cos(self) -> (Self, Self) {
        let rate = self.differentiated();
        let (s, c) = self.0[0].sin_cos();
        let (mut sine, mut cosine) = (Jet::constant(s), Jet::constant(c));
        // Each of the two series is an integral of the other series, so every pass makes one more coefficient correct.
        for _ in 1..N {
            (sine, cosine) = (
                Jet::integrated(s, cosine * rate),
                Jet::integrated(c, -(sine * rate)),
            );
        }
        (sine, cosine)
    }
}

impl<T, const N: usize> Index<usize> for Jet<T, N> {
    type Output = T;
    #[inline(always)]
    fn index(&self, order: usize) -> &T {
        &self.0[order]
    }
}

/// Adds or subtracts coefficient by coefficient. For numbers in registers, the code is a small piece
/// ([`Outlined::IS_SMALL`]).
macro_rules! by_coefficients {
    ($trait:ident, $method:ident, $operation:ident, $operator:tt) => {
        impl<T: Real, const N: usize> Jet<T, N> {
            #[inline]
            fn $operation(mut self, other: Self) -> Self {
                if Self::IS_LONG {
                    for k in 0..N {
                        self.0[k] = self.0[k] $operator other.0[k];
                    }
                } else {
                    self.0[0] = self.0[0] $operator other.0[0];
                    if Self::IS_PAIR {
                        self.0[1] = self.0[1] $operator other.0[1];
                    }
                }
                self
            }
        }

        impl<T: Real, const N: usize> $trait for Jet<T, N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                match T::IN_REGISTERS {
                    true => outlined!(
                        small [T: Real; N] self.0[0];
                        a: Jet<T, N> = self, b: Jet<T, N> = other => Jet<T, N> { a.$operation(b) }
                    ),
                    false => self.$operation(other),
                }
            }
        }
    };
}

by_coefficients!(Add, add, plus, +);
by_coefficients!(Sub, sub, minus, -);

impl<T: Real, const N: usize> Neg for Jet<T, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        if T::IN_REGISTERS {
            outlined!(small [T: Real; N] self.0[0]; a: Jet<T, N> = self => Jet<T, N> { a.negated() })
        } else {
            self.negated()
        }
    }
}

impl<T: Real, const N: usize> Mul for Jet<T, N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        if T::IN_REGISTERS {
            outlined!(
                small [T: Real; N] self.0[0];
                a: Jet<T, N> = self, b: Jet<T, N> = other => Jet<T, N> { a.times(b) }
            )
        } else {
            self.times_outlined(other)
        }
    }
}

/// Constants that select branches at compile time. If a function compared `N` itself, the compiler would have to compile
/// both branches.
impl<T: Real, const N: usize> Jet<T, N> {
    const IS_SINGLE: bool = N == 1;
    const IS_PAIR: bool = N == 2;
    const IS_LONG: bool = N > 2;
    /// True if angle functions are called instead of inlined. For series in registers, inlining lets the compiler omit the
    /// value if the caller uses only the slope.
    const ANGLES_IN_CALLS: bool = T::IS_LARGE && (T::IS_NESTED || !T::IN_REGISTERS);
    /// True if products, quotients and roots are function calls (see [`call_outlined`]).
    const LARGE: bool = (size_of::<Self>() > 16 || T::IS_LARGE) && !T::IN_REGISTERS;

    #[inline]
    fn negated(mut self) -> Self {
        if Self::IS_LONG {
            for k in 0..N {
                self.0[k] = -self.0[k];
            }
        } else {
            self.0[0] = -self.0[0];
            if Self::IS_PAIR {
                self.0[1] = -self.0[1];
            }
        }
        self
    }

    #[inline]
    fn times_outlined(self, other: Self) -> Self {
        if Self::LARGE {
            call_outlined((self, other), |(a, b)| a.times(b))
        } else {
            self.times(other)
        }
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        let mut product = a;
        if Self::IS_LONG {
            for k in 0..N {
                product[k] = a[0] * b[k];
                for i in 0..k {
                    product[k] = product[k] + a[i + 1] * b[k - i - 1];
                }
            }
        } else {
            product[0] = a[0] * b[0];
            if Self::IS_PAIR {
                product[1] = a[0] * b[1] + a[1] * b[0];
            }
        }
        Jet(product)
    }
}

impl<T: Real, const N: usize> Div for Jet<T, N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        if Self::LARGE {
            call_outlined((self, other), |(a, b)| a.over(b))
        } else {
            self.over(other)
        }
    }
}

impl<T: Real, const N: usize> Jet<T, N> {
    #[inline(always)]
    fn over(self, other: Self) -> Self {
        let mut quotient = self.0;
        for k in 0..N {
            let mut rest = self.0[k];
            for i in 0..k {
                rest = rest - quotient[i] * other.0[k - i];
            }
            quotient[k] = rest / other.0[0];
        }
        Jet(quotient)
    }

    #[inline(always)]
    fn root(self) -> Self {
        let mut root = self.0;
        root[0] = self.0[0].sqrt();
        let twice = root[0] + root[0];
        for k in 1..N {
            let mut rest = self.0[k];
            for i in 1..k {
                rest = rest - root[i] * root[k - i];
            }
            root[k] = rest / twice;
        }
        Jet(root)
    }

    #[inline(always)]
    fn arc_sine(self) -> Self {
        let rate = self.differentiated() / (self.one() - self.squared()).sqrt();
        Jet::integrated(self.0[0].asin(), rate)
    }

    #[inline(always)]
    fn angle_from(self, x: Self) -> Self {
        let turned = x * self.differentiated() - self * x.differentiated();
        let rate = turned / (x.squared() + self.squared());
        Jet::integrated(self.0[0].atan2(x.0[0]), rate)
    }
}

impl<T: Real, const N: usize> Real for Jet<T, N> {
    const IN_REGISTERS: bool = T::IN_REGISTERS;
    const IS_LARGE: bool = true;
    const IS_NESTED: bool = T::IS_LARGE;
    const SHARES_DIVISIONS: bool = T::SHARES_DIVISIONS;

    #[inline(always)]
    fn outlined<P: Outlined>(&self, piece: P) -> P::Output {
        T::outlined_as(&self.0, piece)
    }

    #[inline(always)]
    fn outlined_as<P: Outlined>(like: &[Self], piece: P) -> P::Output {
        T::outlined_as(&like[0].0, piece)
    }

    #[inline(always)]
    fn intersected_with(self, other: Self) -> Self {
        if T::SHARES_DIVISIONS {
            self
        } else {
            Jet(array_of(|k| self.0[k].intersected_with(other.0[k])))
        }
    }

    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        Jet::constant(self.0[0].constant(value))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        if Self::LARGE {
            call_outlined(self, Self::root)
        } else {
            self.root()
        }
    }

    #[inline(always)]
    fn asin(self) -> Self {
        if Self::IS_SINGLE {
            return Jet::constant(self.0[0].asin());
        }
        if Self::ANGLES_IN_CALLS {
            outlined!([T: Real; N] self; series: Jet<T, N> = self => Jet<T, N> { series.arc_sine() })
        } else {
            self.arc_sine()
        }
    }

    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        if Self::IS_SINGLE {
            return Jet::constant(self.0[0].atan2(x.0[0]));
        }
        if Self::ANGLES_IN_CALLS {
            outlined!(
                [T: Real; N] self; y: Jet<T, N> = self, x: Jet<T, N> = x => Jet<T, N> { y.angle_from(x) }
            )
        } else {
            self.angle_from(x)
        }
    }

    #[inline(always)]
    fn sign(self) -> Self {
        Jet::constant(self.0[0].sign())
    }

    #[inline(always)]
    fn scaled(mut self, factor: f64) -> Self {
        for c in &mut self.0 {
            *c = c.scaled(factor);
        }
        self
    }
}

impl<T: Scalar, const N: usize> Scalar for Jet<T, N> {
    #[inline(always)]
    fn value(self) -> f64 {
        self.0[0].value()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Identities hold for all coefficients of the power series: sin^2 + cos^2 = 1, atan2(sin, cos) = x and asin(sin) = x.
    #[test]
    fn elementary_functions_invert_each_other() {
        let x = Jet([0.7, 1.0, -0.4, 0.3]);
        let (sine, cosine) = x.sin_cos();
        let one = sine.squared() + cosine.squared();
        let angle = sine.scaled(3.0).atan2(cosine.scaled(3.0));
        let (arc, root) = (sine.asin(), (x.squared() * x.squared()).sqrt() / x);
        for k in 0..4 {
            let expected = if k == 0 { 1.0 } else { 0.0 };
            assert!((one[k] - expected).abs() < 4.0 * f64::EPSILON, "{one:?}");
            assert!((angle[k] - x[k]).abs() < 8.0 * f64::EPSILON, "{angle:?}");
            assert!((arc[k] - x[k]).abs() < 16.0 * f64::EPSILON, "{arc:?}");
            assert!((root[k] - x[k]).abs() < 16.0 * f64::EPSILON, "{root:?}");
        }
    }

    /// The third derivative of 1/x at 2 is -6/16.
    #[test]
    fn derivatives_carry_the_factorial() {
        let x = Jet::<f64, 4>::variable(2.0);
        assert_eq!((x.one() / x).derivative(3), -6.0 / 16.0);
    }
}
