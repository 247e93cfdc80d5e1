//! Numbers of twice the precision: an unevaluated sum of two doubles, about 32 digits. The benchmark uses them to measure the
//! errors of doubles.
//!
//! T. J. Dekker, A floating-point technique for extending the available precision, Numer. Math. 18, 1971. The square root takes
//! one Newton step from the square root of the double.

use hardpoint_engine::number::{Real, Scalar, Valued};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The sum of two doubles, the second at most half a unit in the last place of the first.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct DoubleDouble {
    /// Double nearest to the number.
    pub high: f64,
    /// Number minus `high`.
    pub low: f64,
}

/// Exact a + b. Requires |a| >= |b|.
fn quick_sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    DoubleDouble {
        high,
        low: b - (high - a),
    }
}

/// Exact a + b.
fn sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    let part = high - a;
    DoubleDouble {
        high,
        low: (a - (high - part)) + (b - part),
    }
}

/// Exact a b.
fn product(a: f64, b: f64) -> DoubleDouble {
    let split = |x: f64| {
        let large = 134_217_729.0 * x;
        let top = large - (large - x);
        (top, x - top)
    };
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    let high = a * b;
    DoubleDouble {
        high,
        low: ((ah * bh - high) + ah * bl + al * bh) + al * bl,
    }
}

impl From<f64> for DoubleDouble {
    fn from(high: f64) -> Self {
        DoubleDouble { high, low: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (sum(self.high, other.high), sum(self.low, other.low));
        let first = quick_sum(high.high, high.low + low.high);
        quick_sum(first.high, first.low + low.low)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        DoubleDouble {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let p = product(self.high, other.high);
        quick_sum(
            p.high,
            p.low + (self.high * other.low + self.low * other.high),
        )
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let mut rest = self;
        let mut quotient = DoubleDouble::default();
        for _ in 0..3 {
            let digit = DoubleDouble::from(rest.high / other.high);
            quotient = quotient + digit;
            rest = rest - digit * other;
        }
        quotient
    }
}

impl DoubleDouble {
    /// Sine and cosine of an angle within a full turn of zero. The method sums the Taylor series of a 32nd of the
    /// angle and doubles the angle five times. It uses 1 - cos instead of the cosine, so that no digit is lost.
    fn sin_cos(self) -> (Self, Self) {
        let x = self.scaled(1.0 / 32.0);
        let square = x * x;
        let (mut sine, mut versine) = (self.zero(), self.zero());
        // The omitted terms are below 1e-33 of the first term: (2 pi/32)^22/22! is below 1e-33.
        for k in (1..=11).rev() {
            let k = f64::from(k);
            let next = |sum: Self, divisor: f64| (sum.one() - sum) * square / divisor.into();
            sine = next(sine, 2.0 * k * (2.0 * k + 1.0));
            versine = next(versine, (2.0 * k + 1.0) * (2.0 * k + 2.0));
        }
        sine = x - x * sine;
        versine = square.scaled(0.5) * (versine.one() - versine);
        for _ in 0..5 {
            // 1 - cos 2x = 2 (1 - cos x)(1 + cos x), sin 2x = 2 sin x cos x
            let cosine = versine.one() - versine;
            versine = (versine * (cosine.one() + cosine)).scaled(2.0);
            sine = (sine * cosine).scaled(2.0);
        }
        (sine, versine.one() - versine)
    }
}

impl Real for DoubleDouble {
    fn constant(self, value: f64) -> Self {
        value.into()
    }
    fn sqrt(self) -> Self {
        let root = DoubleDouble::from(self.high.sqrt());
        if root.high == 0.0 {
            return root;
        }
        root + (self - root * root) / (root + root)
    }
    /// asin x = atan2(x, sqrt((1 - x)(1 + x)))
    fn asin(self) -> Self {
        let cosine = ((self.one() - self) * (self.one() + self)).sqrt();
        self.atan2(cosine)
    }
    /// Computes the angle in double precision and adds a small correction. The tangent of the correction is a quotient: the
    /// vector's component normal to the approximate direction, divided by the component along this direction. The correction is
    /// so small that it equals its tangent.
    fn atan2(self, x: Self) -> Self {
        let angle = DoubleDouble::from(self.high.atan2(x.high));
        let (sine, cosine) = angle.sin_cos();
        let along = x * cosine + self * sine;
        if along.high == 0.0 {
            return angle;
        }
        angle + (self * cosine - x * sine) / along
    }
    fn sign(self) -> Self {
        self.constant(self.high.sign())
    }
}

impl Valued for DoubleDouble {
    type Plain = f64;
    fn plain_value(self) -> f64 {
        self.value()
    }
    fn of_plain(self, value: f64) -> Self {
        self.constant(value)
    }
    fn choose(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
}

impl Scalar for DoubleDouble {
    fn value(self) -> f64 {
        self.high + self.low
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest accepted relative error: one hundred times the rounding unit 2^-104.
    const ROUNDING: f64 = 5e-30;

    #[test]
    fn arcs_are_right_to_thirty_digits() {
        let one = DoubleDouble::from(1.0);
        // pi = 3.14159265358979323846264338327950288...
        let pi = one.atan2(one).scaled(4.0);
        assert_eq!(pi.high, std::f64::consts::PI);
        assert!((pi.low - 1.224_646_799_147_353_2e-16).abs() < ROUNDING);
        let sixth = one.scaled(0.5).asin() - pi / 6.0.into();
        assert!(sixth.value().abs() < ROUNDING, "{sixth:?}");
        for k in -31..=31 {
            let angle = DoubleDouble::from(0.1 * f64::from(k)) + DoubleDouble::from(1e-20);
            let (sine, cosine) = angle.sin_cos();
            let circle = sine * sine + cosine * cosine - one;
            let back = sine.atan2(cosine) - angle;
            assert!(circle.value().abs() < ROUNDING, "{circle:?}");
            assert!(back.value().abs() < ROUNDING, "{angle:?} {back:?}");
        }
    }
}
