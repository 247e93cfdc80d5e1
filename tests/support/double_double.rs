//! Numbers of twice the precision: an unevaluated sum of two doubles, about 32 digits.
//!
//! T. J. Dekker, A floating-point technique for extending the available precision, Numer. Math. 18,
//! 1971; square root by one Newton step from the double's.

use hardpoint::number::{Real, Scalar};
use std::ops::{Add, Div, Mul, Neg, Sub};

#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct DoubleDouble {
    pub high: f64,
    pub low: f64,
}

/// a + b exactly, |a| >= |b|.
fn quick_sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    DoubleDouble {
        high,
        low: b - (high - a),
    }
}

/// a + b exactly.
fn sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    let part = high - a;
    DoubleDouble {
        high,
        low: (a - (high - part)) + (b - part),
    }
}

/// a b exactly.
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

impl Real for DoubleDouble {
    fn lit(self, value: f64) -> Self {
        value.into()
    }
    fn sqrt(self) -> Self {
        let root = DoubleDouble::from(self.high.sqrt());
        root + (self - root * root) / (root + root)
    }
    fn asin(self) -> Self {
        unimplemented!("not needed")
    }
    fn atan2(self, _: Self) -> Self {
        unimplemented!("not needed")
    }
    fn sign(self) -> Self {
        self.lit(self.high.sign())
    }
}

impl Scalar for DoubleDouble {
    fn value(self) -> f64 {
        self.high + self.low
    }
}
