//! Numbers the formulas are written over: plain `f64`, Taylor series in the drive ([`Jet`]) and
//! first derivatives by a handful of inputs ([`Dual`]).
//!
//! Every formula of the crate is written once, generic over [`Real`]; what it yields (a value, its
//! derivatives by wheel travel, its gradient) is decided by the number it is run on. The numbers
//! nest: a `Dual<Jet<f64, 3>, 4>` carries the gradient of a value together with the gradient's own
//! first and second derivative by the drive.

mod double_double;
mod dual;
mod interval;
mod jet;
mod vector;

pub use double_double::DoubleDouble;
pub use dual::Dual;
pub use interval::Interval;
pub use jet::Jet;
pub use vector::{Matrix3, Vector3};

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number, or something that obeys the same rules.
///
/// Angles are in radians.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The constant `value`, in the shape of `self` (all derivatives zero).
    fn lit(self, value: f64) -> Self;
    /// Square root; NaN for a negative number.
    fn sqrt(self) -> Self;
    /// Arc sine.
    fn asin(self) -> Self;
    /// The angle of the vector (`x`, `self`) from the x-axis, in (-pi, pi].
    fn atan2(self, x: Self) -> Self;
    /// The value without its derivatives.
    fn value(self) -> f64;

    /// Zero, in the shape of `self`.
    #[inline]
    fn zero(self) -> Self {
        self.lit(0.0)
    }
    /// One, in the shape of `self`.
    #[inline]
    fn one(self) -> Self {
        self.lit(1.0)
    }
    /// `self` times itself.
    #[inline]
    fn squared(self) -> Self {
        self * self
    }
    /// `self` times a plain constant.
    #[inline]
    fn scaled(self, factor: f64) -> Self {
        self * self.lit(factor)
    }
}

impl Real for f64 {
    #[inline]
    fn lit(self, value: f64) -> Self {
        value
    }
    #[inline]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline]
    fn asin(self) -> Self {
        f64::asin(self)
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        f64::atan2(self, x)
    }
    #[inline]
    fn value(self) -> f64 {
        self
    }
}

/// Single precision, to see what it would cost in digits.
impl Real for f32 {
    #[inline]
    fn lit(self, value: f64) -> Self {
        value as f32
    }
    #[inline]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }
    #[inline]
    fn asin(self) -> Self {
        f32::asin(self)
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        f32::atan2(self, x)
    }
    #[inline]
    fn value(self) -> f64 {
        f64::from(self)
    }
}
