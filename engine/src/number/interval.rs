//! Intervals that contain the exact result: arithmetic rounded outward.
//!
//! IEEE 754 rounds to the nearest number, so the exact result of +, -, x, / and the square root lies between the neighbours
//! of the computed result. The code does not widen a sum whose rounding error is zero. This rounding error is itself a
//! double, so the code can compute it (D. E. Knuth, *The Art of Computer Programming* 2, 4.2.2). Sine, cosine and the
//! inverse functions come from the platform. The code assumes that their error is at most two units in the last place.
//!
//! A result that is NaN, and a quotient whose divisor contains zero, become the interval of all real numbers, which certifies
//! nothing. A bound that overflows becomes infinite.

use super::{Real, Scalar};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// All numbers from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower bound.
    pub low: f64,
    /// The upper bound.
    pub high: f64,
}

impl Interval {
    /// Interval of all real numbers.
    pub const WHOLE: Interval = Interval {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
    };

    /// Interval that contains only one number.
    #[inline]
    pub fn point(value: f64) -> Self {
        Interval::bounds(value, value)
    }

    /// Interval between two numbers, or all real numbers if one of them is NaN.
    #[inline]
    pub fn bounds(low: f64, high: f64) -> Self {
        if low <= high {
            Interval { low, high }
        } else {
            Interval::WHOLE
        }
    }

    /// Smallest interval that contains both intervals.
    #[inline]
    pub fn hull(self, other: Self) -> Self {
        Interval::bounds(self.low.min(other.low), self.high.max(other.high))
    }

    /// Intersection of the two intervals. The intersection must not be empty. It is not empty if both intervals enclose the
    /// same number.
    #[inline]
    pub fn meet(self, other: Self) -> Self {
        Interval::bounds(self.low.max(other.low), self.high.min(other.high))
    }

    /// Intersection of the two intervals. `None` if it is empty.
    #[inline]
    pub fn common(self, other: Self) -> Option<Self> {
        let (low, high) = (self.low.max(other.low), self.high.min(other.high));
        (low <= high).then(|| Interval::bounds(low, high))
    }

    /// Returns true if zero lies outside the interval.
    #[inline]
    pub fn excludes_zero(self) -> bool {
        self.low > 0.0 || self.high < 0.0
    }

    /// Distance from the lower to the upper bound.
    #[inline]
    pub fn width(self) -> f64 {
        self.high - self.low
    }

    /// The largest absolute value.
    #[inline]
    pub fn magnitude(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    /// Middle of the interval, rounded.
    #[inline]
    pub fn middle(self) -> f64 {
        0.5 * self.low + 0.5 * self.high
    }

    /// Product with a finite number.
    #[inline]
    pub fn times(self, factor: f64) -> Self {
        let is_exact = |v: f64| v == 0.0 || v == 1.0;
        if is_exact(factor) || (self.low == self.high && is_exact(self.low)) {
            return self * Interval::point(factor);
        }
        let (low, high) = if factor > 0.0 {
            (self.low * factor, self.high * factor)
        } else {
            (self.high * factor, self.low * factor)
        };
        // If a factor is NaN, the result is the interval of all real numbers.
        Interval::bounds(low.next_down(), high.next_up())
    }

    /// Sine and cosine: the values at the middle, widened by half the width. These bounds are valid, because the slopes of
    /// sine and cosine are between -1 and 1.
    pub fn sin_cos(self) -> (Self, Self) {
        let middle = self.middle();
        let reach = (Interval::point(self.high) - Interval::point(middle))
            .hull(Interval::point(middle) - Interval::point(self.low))
            .magnitude();
        let around = Interval::bounds(-reach, reach);
        let (sine, cosine) = middle.sin_cos();
        (trusted(sine) + around, trusted(cosine) + around)
    }
}

/// Interval around a result of the platform's mathematics library that certainly contains the exact result.
#[inline]
fn trusted(value: f64) -> Interval {
    Interval::bounds(value.next_down().next_down(), value.next_up().next_up())
}

/// Interval between the smallest and the largest of four results, widened by their rounding errors. The results are
/// products or quotients of the ends of two intervals.
#[inline]
fn around(corners: [f64; 4]) -> Interval {
    if corners.iter().any(|c| c.is_nan()) {
        return Interval::WHOLE;
    }
    let low = corners.into_iter().fold(f64::INFINITY, f64::min);
    let high = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
    Interval::bounds(low.next_down(), high.next_up())
}

/// Exact rounding error of a sum, if no number overflows.
#[inline]
fn sum_error(a: f64, b: f64, sum: f64) -> f64 {
    let part = sum - a;
    (a - (sum - part)) + (b - part)
}

#[inline]
fn sum_down(a: f64, b: f64) -> f64 {
    let sum = a + b;
    if sum_error(a, b, sum) >= 0.0 {
        sum
    } else {
        sum.next_down()
    }
}

#[inline]
fn sum_up(a: f64, b: f64) -> f64 {
    -sum_down(-a, -b)
}

impl Add for Interval {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Interval::bounds(sum_down(self.low, other.low), sum_up(self.high, other.high))
    }
}

impl Neg for Interval {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Interval {
            low: -self.high,
            high: -self.low,
        }
    }
}

impl Sub for Interval {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Self;
    // Multiplication and division are separate functions. If both were inlined, a closed form would be a single function of
    // 160 kB.
    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        let is_zero = |i: Interval| i.low == 0.0 && i.high == 0.0;
        let is_one = |i: Interval| i.low == 1.0 && i.high == 1.0;
        let bounded = |i: Interval| i.low.is_finite() && i.high.is_finite();
        if is_one(self) {
            return other;
        }
        if is_one(other) {
            return self;
        }
        if (is_zero(self) && bounded(other)) || (is_zero(other) && bounded(self)) {
            return Interval {
                low: 0.0,
                high: 0.0,
            };
        }
        let products = [
            self.low * other.low,
            self.low * other.high,
            self.high * other.low,
            self.high * other.high,
        ];
        around(products)
    }
}

impl Div for Interval {
    type Output = Self;
    #[inline(never)]
    fn div(self, other: Self) -> Self {
        // The condition is also true if a bound of the divisor is NaN.
        if !other.excludes_zero() {
            return Interval::WHOLE;
        }
        let quotients = [
            self.low / other.low,
            self.low / other.high,
            self.high / other.low,
            self.high / other.high,
        ];
        around(quotients)
    }
}

impl Real for Interval {
    const SHARES_DIVISIONS: bool = false;

    #[inline]
    fn intersected_with(self, other: Self) -> Self {
        self.meet(other)
    }
    #[inline]
    fn constant(self, value: f64) -> Self {
        Interval::point(value)
    }
    /// Square root of the non-negative part of the interval. All real numbers if there is no such part.
    #[inline]
    fn sqrt(self) -> Self {
        if self.high < 0.0 {
            return Interval::WHOLE;
        }
        let low = self.low.max(0.0).sqrt();
        Interval::bounds(
            if low > 0.0 { low.next_down() } else { 0.0 },
            self.high.sqrt().next_up(),
        )
    }
    fn asin(self) -> Self {
        if !(self.low >= -1.0 && self.high <= 1.0) {
            return Interval::WHOLE;
        }
        trusted(self.low.asin()).hull(trusted(self.high.asin()))
    }
    /// Angle, from the angles at the four corners of the rectangle (`x`, `self`). If the rectangle excludes the origin and
    /// the negative x-axis, the angle is monotonic along every side.
    fn atan2(self, x: Self) -> Self {
        if !(x.low > 0.0 || self.low > 0.0 || self.high < 0.0) {
            return Interval::WHOLE;
        }
        let corner = |y: f64, x: f64| trusted(y.atan2(x));
        corner(self.low, x.low)
            .hull(corner(self.low, x.high))
            .hull(corner(self.high, x.low))
            .hull(corner(self.high, x.high))
    }
    #[inline]
    fn sign(self) -> Self {
        Interval::point(self.middle().sign())
    }
    #[inline]
    fn scaled(self, factor: f64) -> Self {
        // Halving is exact except near underflow. Near underflow, the code widens the product.
        if factor == 0.5 && self.low.abs().min(self.high.abs()) > f64::MIN_POSITIVE * 2.0 {
            return Interval {
                low: 0.5 * self.low,
                high: 0.5 * self.high,
            };
        }
        self * Interval::point(factor)
    }
    #[inline]
    fn squared(self) -> Self {
        let product = self * self;
        Interval::bounds(product.low.max(0.0), product.high)
    }
}

impl Scalar for Interval {
    #[inline]
    fn value(self) -> f64 {
        self.middle()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1/3, 0.1 + 0.2 and sqrt(2) are not doubles. The interval of 0.1 + 0.2 ends at two neighbouring doubles. Products of
    /// the other intervals contain 1 and 2.
    #[test]
    fn inexact_results_lie_inside() {
        let one = Interval::point(1.0);
        let third = one / one.constant(3.0);
        assert!((third * one.constant(3.0)).low < 1.0 && (third * one.constant(3.0)).high > 1.0);
        let sum = one.constant(0.1) + one.constant(0.2);
        assert_eq!(sum.high.to_bits() - sum.low.to_bits(), 1);
        let root = one.constant(2.0).sqrt();
        let square = root * root;
        assert!(square.low < 2.0 && square.high > 2.0);
    }

    #[test]
    fn exact_results_are_not_widened() {
        let one = Interval::point(1.0);
        assert_eq!(one + one.constant(0.5), Interval::point(1.5));
        assert_eq!(one * one.constant(0.3), Interval::point(0.3));
        assert_eq!(one.zero() * one.constant(0.3), Interval::point(0.0));
    }

    #[test]
    fn what_is_undefined_is_the_whole_line() {
        let zero = Interval::bounds(-1.0, 1.0);
        assert_eq!(zero / zero, Interval::WHOLE);
        assert_eq!(Interval::point(f64::NAN), Interval::WHOLE);
        assert_eq!(Interval::WHOLE * Interval::point(0.0), Interval::WHOLE);
        let large = Interval::point(f64::MAX);
        assert_eq!((large * large).high, f64::INFINITY);
    }
}
