//! Vectors over any [`Real`].
//!
//! nalgebra's vectors require scalar operations that derivative numbers and SIMD lanes do not have. So the kernel has its
//! own vectors. The public interface uses plain `[f64; 3]`.

use super::{Jet, Real, call_outlined, outlined};
use std::ops::{Add, Mul, Neg, Sub};

/// A vector of three numbers.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Vector3<T> {
    /// Forward component.
    pub x: T,
    /// Leftward component.
    pub y: T,
    /// Upward component.
    pub z: T,
}

impl<T> Vector3<T> {
    /// The vector (x, y, z).
    #[inline(always)]
    pub const fn new(x: T, y: T, z: T) -> Self {
        Vector3 { x, y, z }
    }
}

/// Types that implement `Copy` need no destructor. Without the bound `T: Copy`, most of the compiled code of a function
/// would be destructor calls for the case that a call unwinds.
impl<T: Copy> Vector3<T> {
    /// Applies `f` to each component.
    #[inline(always)]
    pub fn map<U: Copy>(self, f: impl Fn(T) -> U + Copy) -> Vector3<U> {
        Vector3::new(f(self.x), f(self.y), f(self.z))
    }

    /// Combines each component with the same component of another vector.
    #[inline(always)]
    pub(crate) fn zip<U: Copy, V: Copy>(
        self,
        other: Vector3<U>,
        f: impl Fn(T, U) -> V + Copy,
    ) -> Vector3<V> {
        Vector3::new(f(self.x, other.x), f(self.y, other.y), f(self.z, other.z))
    }

    /// The components as an array.
    #[inline(always)]
    pub fn to_array(self) -> [T; 3] {
        [self.x, self.y, self.z]
    }
}

impl<T> From<[T; 3]> for Vector3<T> {
    #[inline(always)]
    fn from([x, y, z]: [T; 3]) -> Self {
        Vector3 { x, y, z }
    }
}

impl<T: Real> Vector3<T> {
    /// True if sums are function calls. True for nested numbers outside SIMD registers; in registers, a sum is shorter than a
    /// call.
    const ADDS_IN_CALLS: bool = T::IS_NESTED && !T::IN_REGISTERS;
    /// True if products are small pieces ([`super::Outlined::IS_SMALL`]). True for nested numbers and for numbers in
    /// registers. The compiler then optimises each operation once instead of at each use.
    pub(super) const IN_PIECES: bool = T::IS_NESTED || T::IN_REGISTERS;
    /// True for derivative numbers outside registers. Their operations are functions that the compiler optimises once and
    /// then inlines where inlining is faster.
    pub(super) const IN_FUNCTIONS: bool = T::IS_LARGE && !T::IN_REGISTERS;
}

/// Arithmetic without function calls. Code in SIMD registers must be inlined, and the compiler does not inline closures
/// reliably. So code in SIMD registers uses these inlined functions. Nested derivative numbers call them through separate
/// functions.
impl<T: Real> Vector3<T> {
    #[inline(always)]
    pub(super) fn dot_inline(self, other: Self) -> T {
        (self.x * other.x)
            .plus_product(self.y, other.y)
            .plus_product(self.z, other.z)
    }

    #[inline(always)]
    pub(super) fn cross_inline(self, other: Self) -> Self {
        Vector3::new(
            (self.y * other.z).minus_product(self.z, other.y),
            (self.z * other.x).minus_product(self.x, other.z),
            (self.x * other.y).minus_product(self.y, other.x),
        )
    }

    #[inline(always)]
    pub(super) fn plus_scaled_inline(self, other: Self, factor: T) -> Self {
        Vector3::new(
            self.x.plus_product(other.x, factor),
            self.y.plus_product(other.y, factor),
            self.z.plus_product(other.z, factor),
        )
    }

    #[inline(always)]
    pub(super) fn normalised_inline(self) -> Self {
        self * (self.x.one() / self.norm())
    }

    #[inline(always)]
    pub(super) fn plus_inline(self, other: Self) -> Self {
        Vector3::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }

    #[inline(always)]
    pub(super) fn minus_inline(self, other: Self) -> Self {
        Vector3::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }

    #[inline(always)]
    pub(super) fn times_inline(self, factor: T) -> Self {
        Vector3::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

/// Operations for derivative numbers outside registers.
impl<T: Real> Vector3<T> {
    /// Product with a constant factor.
    #[inline(always)]
    pub fn scaled(self, factor: f64) -> Self {
        self.map(|c| c.scaled(factor))
    }

    #[inline]
    fn dot_called(self, other: Self) -> T {
        self.dot_inline(other)
    }

    #[inline]
    fn cross_called(self, other: Self) -> Self {
        self.cross_inline(other)
    }

    #[inline]
    fn plus_scaled_called(self, other: Self, factor: T) -> Self {
        self.plus_scaled_inline(other, factor)
    }

    #[inline]
    fn normalised_called(self) -> Self {
        self.normalised_inline()
    }

    #[inline]
    fn plus_called(self, other: Self) -> Self {
        self.plus_inline(other)
    }

    #[inline]
    fn minus_called(self, other: Self) -> Self {
        self.minus_inline(other)
    }

    #[inline]
    fn times_called(self, factor: T) -> Self {
        self.times_inline(factor)
    }
}

impl<T: Real> Vector3<T> {
    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> T {
        if Self::IN_PIECES {
            outlined!(
                small [T: Real] self.x; a: Vector3<T> = self, b: Vector3<T> = other => T { a.dot_inline(b) }
            )
        } else if Self::IN_FUNCTIONS {
            self.dot_called(other)
        } else {
            self.dot_inline(other)
        }
    }

    /// Vector product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        if Self::IN_PIECES {
            outlined!(
                small [T: Real] self.x; a: Vector3<T> = self, b: Vector3<T> = other => Vector3<T> { a.cross_inline(b) }
            )
        } else if Self::IN_FUNCTIONS {
            self.cross_called(other)
        } else {
            self.cross_inline(other)
        }
    }

    /// Sum of this vector and a multiple of another.
    #[inline(always)]
    pub fn plus_scaled(self, other: Self, factor: T) -> Self {
        if Self::IN_PIECES {
            outlined!(
                small [T: Real] self.x;
                a: Vector3<T> = self, b: Vector3<T> = other, f: T = factor => Vector3<T> { a.plus_scaled_inline(b, f) }
            )
        } else if Self::IN_FUNCTIONS {
            self.plus_scaled_called(other, factor)
        } else {
            self.plus_scaled_inline(other, factor)
        }
    }

    /// Taylor series of a vector: `self` is the value and `rate` is the first derivative.
    #[inline(always)]
    pub fn with_rate(self, rate: Self) -> Vector3<Jet<T, 2>> {
        Vector3::new(
            Jet([self.x, rate.x]),
            Jet([self.y, rate.y]),
            Jet([self.z, rate.z]),
        )
    }

    /// Component of the vector perpendicular to a unit vector.
    #[inline(always)]
    pub fn across(self, axis: Self) -> Self {
        self - axis * axis.dot(self)
    }

    /// Squared length.
    #[inline(always)]
    pub fn norm_squared(self) -> T {
        self.dot(self)
    }

    /// Length.
    #[inline(always)]
    pub fn norm(self) -> T {
        self.norm_squared().sqrt()
    }

    /// Unit vector in this direction.
    #[inline(always)]
    pub fn normalised(self) -> Self {
        if Self::IN_PIECES {
            outlined!(small [T: Real] self.x; a: Vector3<T> = self => Vector3<T> { a.normalised_inline() })
        } else if Self::IN_FUNCTIONS {
            self.normalised_called()
        } else {
            self.normalised_inline()
        }
    }

    /// A constant vector, with the number type of this vector.
    #[inline(always)]
    pub fn constant(self, value: Vector3<f64>) -> Self {
        Vector3::new(
            self.x.constant(value.x),
            self.x.constant(value.y),
            self.x.constant(value.z),
        )
    }

    /// Zero vector.
    #[inline(always)]
    pub fn zero(self) -> Self {
        let zero = self.x.zero();
        Vector3::new(zero, zero, zero)
    }
}

impl<T: Real> Add for Vector3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        match Self::ADDS_IN_CALLS {
            true => call_outlined((self, other), |(a, b)| a.plus_inline(b)),
            false if T::IN_REGISTERS => outlined!(
                small [T: Real] self.x; a: Vector3<T> = self, b: Vector3<T> = other => Vector3<T> { a.plus_inline(b) }
            ),
            false if Self::IN_FUNCTIONS => self.plus_called(other),
            false => self.plus_inline(other),
        }
    }
}

impl<T: Real> Sub for Vector3<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        match Self::ADDS_IN_CALLS {
            true => call_outlined((self, other), |(a, b)| a.minus_inline(b)),
            false if T::IN_REGISTERS => outlined!(
                small [T: Real] self.x; a: Vector3<T> = self, b: Vector3<T> = other => Vector3<T> { a.minus_inline(b) }
            ),
            false if Self::IN_FUNCTIONS => self.minus_called(other),
            false => self.minus_inline(other),
        }
    }
}

impl<T: Real> Neg for Vector3<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Vector3::new(-self.x, -self.y, -self.z)
    }
}

impl<T: Real> Mul<T> for Vector3<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        if Self::IN_PIECES {
            outlined!(
                small [T: Real] self.x; v: Vector3<T> = self, f: T = factor => Vector3<T> { v.times_inline(f) }
            )
        } else if Self::IN_FUNCTIONS {
            self.times_called(factor)
        } else {
            self.times_inline(factor)
        }
    }
}
