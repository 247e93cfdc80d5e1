//! Numbers of single precision. They show how many digits single precision loses.

use hardpoint_engine::number::{Real, Scalar, Valued};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number of single precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Single(f32);

impl From<f64> for Single {
    #[inline]
    fn from(value: f64) -> Self {
        Single(value as f32)
    }
}

impl Add for Single {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Single(self.0 + other.0)
    }
}

impl Sub for Single {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Single(self.0 - other.0)
    }
}

impl Mul for Single {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        Single(self.0 * other.0)
    }
}

impl Div for Single {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        Single(self.0 / other.0)
    }
}

impl Neg for Single {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Single(-self.0)
    }
}

impl Real for Single {
    #[inline]
    fn constant(self, value: f64) -> Self {
        value.into()
    }
    #[inline]
    fn sqrt(self) -> Self {
        Single(self.0.sqrt())
    }
    #[inline]
    fn asin(self) -> Self {
        Single(self.0.asin())
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        Single(self.0.atan2(x.0))
    }
    #[inline]
    fn sign(self) -> Self {
        Single(1.0_f32.copysign(self.0))
    }
}

impl Valued for Single {
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

impl Scalar for Single {
    #[inline]
    fn value(self) -> f64 {
        f64::from(self.0)
    }
}
