//! First derivatives with respect to a fixed number of inputs, all in one pass.

use super::{Outlined, Real, Scalar, Vector3, call_outlined, outlined};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value with its partial derivatives with respect to `N` inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<T, const N: usize> {
    /// The value.
    pub value: T,
    /// Derivatives of the value with respect to each input.
    pub partials: [T; N],
}

impl<T: Real, const N: usize> Dual<T, N> {
    /// Makes a constant, whose derivatives with respect to all inputs are zero.
    #[inline(always)]
    pub fn constant(value: T) -> Self {
        let fill = |value: T| Dual {
            value,
            partials: [value.zero(); N],
        };
        if Self::IS_LONG {
            call_outlined(value, fill)
        } else {
            fill(value)
        }
    }

    /// Makes input number `index`, with this value.
    #[inline(always)]
    pub fn input(value: T, index: usize) -> Self {
        let mut input = Dual::constant(value);
        input.partials[index] = value.one();
        input
    }

    #[inline(always)]
    fn chain(self, value: T, slope: T) -> Self {
        let mut partials = self.partials;
        for p in &mut partials {
            *p = *p * slope;
        }
        Dual { value, partials }
    }
}

impl<T: Real> Dual<T, 3> {
    /// Makes three inputs from the components of a vector.
    #[inline(always)]
    pub fn inputs(at: Vector3<T>) -> Vector3<Self> {
        Vector3::new(
            Dual::input(at.x, 0),
            Dual::input(at.y, 1),
            Dual::input(at.z, 2),
        )
    }
}

impl<T: Real, const N: usize> Dual<T, N> {
    /// True if all arithmetic operations are function calls. If it is false, sums, products and quotients are still calls for
    /// large `T` ([`Real::IS_LARGE`]).
    const IS_LONG: bool = N > 4 && !T::IN_REGISTERS;

    #[inline]
    fn plus(self, other: Self) -> Self {
        let mut partials = self.partials;
        for (k, p) in partials.iter_mut().enumerate() {
            *p = *p + other.partials[k];
        }
        Dual {
            value: self.value + other.value,
            partials,
        }
    }

    #[inline(always)]
    fn negated(self) -> Self {
        let mut partials = self.partials;
        for p in &mut partials {
            *p = -*p;
        }
        Dual {
            value: -self.value,
            partials,
        }
    }

    #[inline]
    fn minus(self, other: Self) -> Self {
        let mut partials = self.partials;
        for (k, p) in partials.iter_mut().enumerate() {
            *p = *p - other.partials[k];
        }
        Dual {
            value: self.value - other.value,
            partials,
        }
    }

    #[inline]
    fn times(self, other: Self) -> Self {
        let mut partials = self.partials;
        for (k, p) in partials.iter_mut().enumerate() {
            *p = *p * other.value + self.value * other.partials[k];
        }
        Dual {
            value: self.value * other.value,
            partials,
        }
    }

    #[inline]
    fn over(self, other: Self) -> Self {
        let inverse = other.value.one() / other.value;
        let value = self.value * inverse;
        let mut partials = self.partials;
        for (k, p) in partials.iter_mut().enumerate() {
            *p = (*p - value * other.partials[k]) * inverse;
        }
        Dual { value, partials }
    }

    #[inline]
    fn root(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, root.constant(0.5) / root)
    }

    #[inline(always)]
    fn arc_sine(self) -> Self {
        let slope = self.value.one() / (self.value.one() - self.value.squared()).sqrt();
        self.chain(self.value.asin(), slope)
    }

    #[inline(always)]
    fn angle_from(self, x: Self) -> Self {
        let inverse = self.value.one() / (self.value.squared() + x.value.squared());
        let (by_y, by_x) = (x.value * inverse, -self.value * inverse);
        let mut partials = self.partials;
        for (k, p) in partials.iter_mut().enumerate() {
            *p = *p * by_y + x.partials[k] * by_x;
        }
        Dual {
            value: self.value.atan2(x.value),
            partials,
        }
    }
}

/// Runs an operation inline, or for large numbers in a separate function. For numbers in registers, this function is
/// compiled for their instruction set.
macro_rules! perform {
    ($operation:ident($number:ident $(, $other:ident)?) if $is_large:expr) => {
        match $is_large {
            true => outlined!(
                [T: Real; N] $number.value;
                $number: Dual<T, N> = $number $(, $other: Dual<T, N> = $other)? => Dual<T, N> {
                    Dual::$operation($number $(, $other)?)
                }
            ),
            false => Dual::$operation($number $(, $other)?),
        }
    };
}

macro_rules! operator {
    ($trait:ident, $method:ident, $operation:ident) => {
        impl<T: Real, const N: usize> $trait for Dual<T, N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let number = self;
                perform!($operation(number, other) if T::IS_LARGE || Self::IS_LONG)
            }
        }
    };
}

operator!(Add, add, plus);
operator!(Sub, sub, minus);
operator!(Mul, mul, times);
operator!(Div, div, over);

impl<T: Real, const N: usize> Neg for Dual<T, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let number = self;
        perform!(negated(number) if Self::IS_LONG)
    }
}

impl<T: Real, const N: usize> Real for Dual<T, N> {
    const IN_REGISTERS: bool = T::IN_REGISTERS;
    const IS_LARGE: bool = true;
    const IS_NESTED: bool = T::IS_LARGE && !T::IN_REGISTERS;
    const SHARES_DIVISIONS: bool = T::SHARES_DIVISIONS;

    #[inline(always)]
    fn outlined<P: Outlined>(&self, piece: P) -> P::Output {
        self.value.outlined(piece)
    }
    #[inline(always)]
    fn outlined_as<P: Outlined>(like: &[Self], piece: P) -> P::Output {
        like[0].value.outlined(piece)
    }

    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        Dual::constant(self.value.constant(value))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let number = self;
        perform!(root(number) if true)
    }
    #[inline(always)]
    fn asin(self) -> Self {
        let number = self;
        perform!(arc_sine(number) if !T::IN_REGISTERS)
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        let y = self;
        perform!(angle_from(y, x) if !T::IN_REGISTERS)
    }
    #[inline(always)]
    fn sign(self) -> Self {
        Dual::constant(self.value.sign())
    }
    #[inline(always)]
    fn scaled(self, factor: f64) -> Self {
        let scale = |(number, factor): (Self, f64)| {
            let mut partials = number.partials;
            for p in &mut partials {
                *p = p.scaled(factor);
            }
            Dual {
                value: number.value.scaled(factor),
                partials,
            }
        };
        if Self::IS_LONG {
            call_outlined((self, factor), scale)
        } else {
            scale((self, factor))
        }
    }
}

impl<T: Scalar, const N: usize> Scalar for Dual<T, N> {
    #[inline(always)]
    fn value(self) -> f64 {
        self.value.value()
    }
}

#[cfg(test)]
mod tests {
    use super::super::Jet;
    use super::*;

    /// Dual numbers and jets give the same first derivative.
    #[test]
    fn agrees_with_jets() {
        fn formula<T: Real>(x: T) -> T {
            (x.sqrt() / (x.one() + x * x)).asin() + (x * x - x).atan2(x.constant(0.3) + x)
        }
        let by_dual = formula(Dual::<f64, 1>::input(0.6, 0));
        let by_jet = formula(Jet::<f64, 2>::variable(0.6));
        assert!((by_dual.value - by_jet[0]).abs() < 4.0 * f64::EPSILON);
        assert!((by_dual.partials[0] - by_jet[1]).abs() < 16.0 * f64::EPSILON);
    }
}
