//! Numbers the formulas are written over: plain `f64`, Taylor series in the drive ([`Jet`]), first
//! derivatives by a handful of inputs ([`Dual`]), SIMD registers ([`Lanes`]).
//!
//! Every formula of the crate is written once, generic over [`Real`]; what it yields (a value, its
//! derivatives by wheel travel, its gradient, the same for many designs) is decided by the number it is
//! run on. The numbers
//! nest: a `Dual<Jet<f64, 3>, 4>` carries the gradient of a value together with the gradient's own
//! first and second derivative by the drive.

mod arc;
mod bundle;
mod dual;
mod interval;
mod jet;
mod lanes;
mod registers;
mod tape;
mod vector;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use bundle::{MOST_LANES, SimdReal};
pub use dual::Dual;
pub use interval::Interval;
pub use jet::Jet;
pub use lanes::{LaneMask, Lanes, SimdTask, Width};
pub use tape::{Tape, Tracked};
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
    /// Whether the number lives in SIMD registers: then everything done with it must be inlined into the
    /// function that is compiled for them.
    const IN_REGISTERS: bool = false;
    /// Whether it is more than a plain number: what is made of several of it does its arithmetic in calls.
    const IS_LARGE: bool = size_of::<Self>() > 8;
    /// Whether it is made of derivatives of derivatives, whose arithmetic is calls (see `called`).
    const IS_NESTED: bool = false;
    /// Whether two divisions may be one and some products: not of intervals, where one that contains zero would
    /// take the other with it.
    const SHARES_DIVISIONS: bool = true;

    /// The constant `value`, in the shape of `self` (all derivatives zero).
    fn lit(self, value: f64) -> Self;
    /// Square root; NaN for a negative number.
    fn sqrt(self) -> Self;
    /// Arc sine.
    fn asin(self) -> Self;
    /// The angle of the vector (`x`, `self`) from the x-axis, in (-pi, pi].
    fn atan2(self, x: Self) -> Self;
    /// The constant 1 or -1, whichever has the sign of the value.
    fn sign(self) -> Self;

    /// `self` + `a` `b`; rounded once in SIMD lanes.
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        self + a * b
    }
    /// `self` - `a` `b`; rounded once in SIMD lanes.
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        self - a * b
    }

    /// 1/`self` and 1/`other`.
    #[inline(always)]
    fn inverses(self, other: Self) -> [Self; 2] {
        if Self::SHARES_DIVISIONS {
            let inverse = self.one() / (self * other);
            [inverse * other, inverse * self]
        } else {
            [self.one() / self, self.one() / other]
        }
    }

    /// Does a piece of work in a function of its own, compiled for the instructions that the number is made for:
    /// what is inlined into one function all takes the compiler long.
    #[inline(always)]
    fn outlined<P: Outlined>(self, piece: P) -> P::Output {
        piece.work_outlined()
    }

    /// The same number, given that it also equals the argument: an interval is narrowed to the intersection of both,
    /// any other number stays as it is.
    #[inline(always)]
    fn also(self, _: Self) -> Self {
        self
    }

    /// Zero, in the shape of `self`.
    #[inline(always)]
    fn zero(self) -> Self {
        self.lit(0.0)
    }
    /// One, in the shape of `self`.
    #[inline(always)]
    fn one(self) -> Self {
        self.lit(1.0)
    }
    /// `self` times itself.
    #[inline(always)]
    fn squared(self) -> Self {
        self * self
    }
    /// `self` times a plain constant.
    #[inline(always)]
    fn scaled(self, factor: f64) -> Self {
        self * self.lit(factor)
    }
}

/// A piece of work on numbers of one kind.
pub trait Outlined: Sized {
    /// Whether it is so small that numbers in registers may have it where it is called: each part of the crate then compiles
    /// it for itself.
    const IS_SMALL: bool = false;
    /// What it yields.
    type Output;
    /// Does it. To be marked `#[inline(always)]`.
    fn work(self) -> Self::Output;
    /// Does it in a function of its own, compiled for no instruction set: as a method of the piece, with what stands around
    /// the piece, so that a change elsewhere does not compile it again.
    #[inline(never)]
    fn work_outlined(self) -> Self::Output {
        self.work()
    }
}

/// Does an operation on large numbers in a function of its own: inlined everywhere, the arithmetic of long
/// series and of derivatives of series would make the crate take minutes to compile. It is compiled for no instruction
/// set: numbers in registers have [`Real::outlined`]. Products of series by that took a quarter longer: their operands are
/// copied once more.
#[inline(never)]
pub(crate) fn called<A, R>(operands: A, operation: impl Fn(A) -> R) -> R {
    operation(operands)
}

/// As `array.map(f)`, in place: the standard library's is no small function, and a call wherever it is not compiled
/// together with its caller.
#[inline(always)]
pub(crate) fn each<T: Copy, U: Copy, const N: usize>(array: &[T; N], f: impl Fn(T) -> U) -> [U; N] {
    let mut mapped = [f(array[0]); N];
    for k in 1..N {
        mapped[k] = f(array[k]);
    }
    mapped
}

/// A block in a function of its own by [`Real::outlined`], for a number of the type named first:
/// `outlined!([T: Real] like; a: Vector3<T> = left, b: &'p Vector3<T> = right => T { a.dot(*b) })`. References live
/// for `'p`; the length of a series may follow the types, as in `[T: Real; N]`. Begun with `small`, it is a small piece.
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
        $crate::number::Real::outlined($like, Piece($($value,)* std::marker::PhantomData))
    }};
}
pub(crate) use outlined;

/// One real number, perhaps with derivatives, whose value can be compared.
pub trait Scalar: Real {
    /// The value without its derivatives.
    fn value(self) -> f64;
}

impl Real for f64 {
    #[inline(always)]
    fn lit(self, value: f64) -> Self {
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
