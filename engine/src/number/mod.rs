//! Number types of the formulas: plain `f64`, Taylor series ([`Jet`]), first derivatives with respect to a few inputs
//! ([`Dual`]), and SIMD registers ([`Lanes`]).
//!
//! The crate contains every formula once, generic over [`Real`]. The number type determines the result: a value, its
//! derivatives with respect to wheel travel, its gradient, or these results for many designs. Number types nest: a
//! `Dual<Jet<f64, 3>, 4>` contains the gradient of a value, together with the gradient's own first and second derivative
//! with respect to the drive.

mod arc;
mod decimal;
mod dual;
mod interval;
mod jet;
mod lanes;
mod matrix;
mod registers;
mod simd_real;
mod tape;
mod valued;
mod vector;
#[cfg(target_arch = "x86_64")]
mod x86;

pub(crate) use decimal::short_decimal;
pub use dual::Dual;
pub use interval::Interval;
pub use jet::Jet;
pub use lanes::{LaneMask, Lanes, SimdTask, Width};
pub(crate) use lanes::{run_one, run_short};
pub use matrix::Matrix3;
pub use simd_real::{MOST_LANES, SimdReal};
pub use tape::{Tape, Tracked};
pub(crate) use valued::larger;
pub use valued::{MaskOf, Valued};
pub use vector::Vector3;

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number, or a type with the same arithmetic.
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
    /// True if the number is stored in SIMD registers. All of its arithmetic must then be inlined into the function for
    /// these registers.
    const IN_REGISTERS: bool = false;
    /// True if the number is larger than a plain number. Types that consist of several such numbers use function calls for
    /// their arithmetic.
    const IS_LARGE: bool = size_of::<Self>() > 8;
    /// True for derivatives of large numbers ([`Real::IS_LARGE`]), such as derivatives of derivatives, and for recorded
    /// numbers. The arithmetic of their vectors consists of separate functions or small pieces ([`Outlined::IS_SMALL`]).
    const IS_NESTED: bool = false;
    /// True if one division and some products may replace two divisions. False for intervals, because a divisor that
    /// contains zero would also make the other quotient unbounded.
    const SHARES_DIVISIONS: bool = true;

    /// The constant `value`, with the type and size of `self` (all derivatives zero).
    fn constant(self, value: f64) -> Self;
    /// Square root. NaN for a negative number.
    fn sqrt(self) -> Self;
    /// Arc sine.
    fn asin(self) -> Self;
    /// Angle of the vector (`x`, `self`) from the x-axis, in [-pi, pi]. It is -pi for -0 above a negative `x`.
    fn atan2(self, x: Self) -> Self;
    /// The constant 1 or -1, with the sign of the value.
    fn sign(self) -> Self;

    /// Sum `self` + `a` `b`, rounded once in SIMD lanes.
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        self + a * b
    }
    /// Difference `self` - `a` `b`, rounded once in SIMD lanes.
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        self - a * b
    }

    /// Inverses 1/`self` and 1/`other`. If one number is zero, both results may be undefined.
    #[inline(always)]
    fn inverses(self, other: Self) -> [Self; 2] {
        if Self::SHARES_DIVISIONS {
            let inverse = self.one() / (self * other);
            [inverse * other, inverse * self]
        } else {
            [self.one() / self, self.one() / other]
        }
    }

    /// Runs a piece of work in a separate function, compiled for the instructions of this number type. A single function
    /// with everything inlined would take too long to compile.
    #[inline(always)]
    fn outlined<P: Outlined>(&self, piece: P) -> P::Output {
        piece.work_outlined()
    }

    /// Runs a piece of work like [`Real::outlined`], for the number type of a slice. (With an index instead of a slice, the
    /// compiler would add code that drops the piece if the index is out of range.)
    #[inline(always)]
    fn outlined_as<P: Outlined>(_: &[Self], piece: P) -> P::Output {
        piece.work_outlined()
    }

    /// Returns `self`. The argument must be equal to `self`. For intervals, returns the intersection of the two intervals,
    /// which is narrower.
    #[inline(always)]
    fn intersected_with(self, _: Self) -> Self {
        self
    }

    /// Zero, with the type and size of `self`.
    #[inline(always)]
    fn zero(self) -> Self {
        self.constant(0.0)
    }
    /// One, with the type and size of `self`.
    #[inline(always)]
    fn one(self) -> Self {
        self.constant(1.0)
    }
    /// `self` times itself.
    #[inline(always)]
    fn squared(self) -> Self {
        self * self
    }
    /// `self` times a plain constant.
    #[inline(always)]
    fn scaled(self, factor: f64) -> Self {
        self * self.constant(factor)
    }
}

/// A piece of work on numbers of one type.
pub trait Outlined: Sized {
    /// True if the piece is small enough to be inlined into its callers. Each codegen unit of the crate then compiles its
    /// own copy.
    const IS_SMALL: bool = false;
    /// Result of the piece of work.
    type Output;
    /// Does the work. Mark implementations `#[inline(always)]`.
    fn work(self) -> Self::Output;
    /// Runs the piece in a separate function, compiled for no particular instruction set. It is a method of the piece, so
    /// the compiler places it with the piece's module. A change in another module does not recompile it.
    #[inline(never)]
    fn work_outlined(self) -> Self::Output {
        self.work()
    }
    /// Runs a small piece, compiled for no particular instruction set. The compiler optimises it once, and then inlines the
    /// result.
    #[inline]
    fn work_small(self) -> Self::Output {
        self.work()
    }
}

/// Runs an operation on large numbers in a separate function. Inlined arithmetic of long series and of derivatives of
/// series would take minutes to compile. The function is compiled for no particular instruction set; numbers in registers
/// use [`Real::outlined`] instead. (With `outlined`, products of series were a quarter slower, because it copies their
/// operands once more.)
#[inline(never)]
pub(crate) fn call_outlined<A, R>(operands: A, operation: impl Fn(A) -> R) -> R {
    operation(operands)
}

/// Maps arrays of numbers with plain, inlined loops. The standard library's `map` and `from_fn` make six functions for each
/// use, and the compiler spent a twelfth of its time on them.
pub(crate) trait Each<T, const N: usize> {
    /// Returns the array with `f` applied to each entry.
    fn each<U: Copy>(&self, f: impl FnMut(T) -> U) -> [U; N];
}

impl<T: Copy, const N: usize> Each<T, N> for [T; N] {
    #[inline(always)]
    fn each<U: Copy>(&self, mut f: impl FnMut(T) -> U) -> [U; N] {
        let mut mapped = [f(self[0]); N];
        for k in 1..N {
            mapped[k] = f(self[k]);
        }
        mapped
    }
}

/// Returns the array of `entry(0)`, `entry(1)`, and so on.
#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "a plain loop is intended here")]
pub(crate) fn array_of<T: Copy, const N: usize>(mut entry: impl FnMut(usize) -> T) -> [T; N] {
    let mut array = [entry(0); N];
    for k in 1..N {
        array[k] = entry(k);
    }
    array
}

/// Compiles a block as a separate function with [`Real::outlined`], for a number of the type named first: `outlined!([T:
/// Real] like; a: Vector3<T> = left, b: &'p Vector3<T> = right => T { a.dot(*b) })`. References have the lifetime `'p`. The
/// length of a series may follow the types, as in `[T: Real; N]`. With `small` in front, the block becomes a small piece
/// ([`Outlined::IS_SMALL`]).
macro_rules! outlined {
    (small $($piece:tt)*) => { $crate::number::outlined!(@ true $($piece)*) };
    ([$($parameter:tt)*] $($piece:tt)*) => { $crate::number::outlined!(@ false [$($parameter)*] $($piece)*) };
    (@ $small:literal [$($parameter:ident: $bound:path),* $(; $length:ident)?] $like:expr;
        $($operand:ident: $kind:ty = $value:expr),* => $output:ty $body:block) => {{
        struct Piece<'p, $($parameter: $bound,)* $(const $length: usize)?>(
            $($kind,)*
            std::marker::PhantomData<(&'p (), $($parameter),*)>,
        );
        impl<'p, $($parameter: $bound,)* $(const $length: usize)?> $crate::number::Outlined
            for Piece<'p, $($parameter,)* $($length)?>
        {
            const IS_SMALL: bool = $small;
            type Output = $output;
            #[inline(always)]
            fn work(self) -> $output {
                let Piece($($operand,)* _) = self;
                $body
            }
        }
        $crate::number::Real::outlined(&$like, Piece($($value,)* std::marker::PhantomData))
    }};
}
pub(crate) use outlined;

/// A real number of one lane, possibly with derivatives. Formulas can compare its value.
pub trait Scalar: Valued<Plain = f64> {
    /// The value without its derivatives.
    fn value(self) -> f64;
}

/// A function whose formula depends on the values of its arguments.
pub trait LocalFunction<const N: usize, const K: usize> {
    /// Values of the function.
    fn at<T: Scalar>(&self, arguments: [T; N]) -> [T; K];
}

/// A number for formulas that contain a [`LocalFunction`]. In SIMD lanes, the function is evaluated lane by lane.
pub trait Local: Real {
    /// Values of a function.
    fn local<const N: usize, const K: usize>(
        arguments: [Self; N],
        function: &impl LocalFunction<N, K>,
    ) -> [Self; K];
}

impl<T: Scalar> Local for T {
    #[inline(always)]
    fn local<const N: usize, const K: usize>(
        arguments: [Self; N],
        function: &impl LocalFunction<N, K>,
    ) -> [Self; K] {
        function.at(arguments)
    }
}

impl Real for f64 {
    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        value
    }
    #[inline]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline]
    fn asin(self) -> Self {
        arc::asin(self)
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        arc::atan2(self, x)
    }
    #[inline]
    fn sign(self) -> Self {
        1.0_f64.copysign(self)
    }
}

impl Scalar for f64 {
    #[inline]
    fn value(self) -> f64 {
        self
    }
}
