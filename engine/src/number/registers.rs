//! Operations of each instruction set, on a pair of registers at a time. One chain of dependent operations leaves a
//! processor idle most of the time; a second, independent chain fills the gaps.
//!
//! [`Single`] is one number at a time with the instructions of a set. It serves chains of dependent steps, which
//! registers full of the same number would only slow down.
//!
//! The code is written once for each set ([`super::x86`]), not generically. A product is then two instructions. A generic
//! function would be a stack of calls that costs the compiler more than all the arithmetic built on it.

use std::fmt::Debug;

/// Numbers side by side, and truth values of them.
pub trait Registers: Copy + Debug {
    /// Number of numbers.
    const LANES: usize;
    /// The numbers.
    type Numbers: Copy + Debug;
    /// A truth value of each.
    type Truths: Copy + Debug;

    /// Does a piece of work in a function of its own, compiled for the set.
    fn outlined<P: crate::number::Outlined>(self, piece: P) -> P::Output;
    /// The same number in every lane.
    fn splat(self, value: f64) -> Self::Numbers;
    /// a + b
    fn add(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    /// a - b
    fn sub(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    /// a b
    fn mul(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    /// a/b
    fn div(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    /// -a
    fn neg(self, a: Self::Numbers) -> Self::Numbers;
    /// c + a b, rounded once
    fn mul_add(self, a: Self::Numbers, b: Self::Numbers, c: Self::Numbers) -> Self::Numbers;
    /// c - a b, rounded once
    fn negate_mul_add(self, a: Self::Numbers, b: Self::Numbers, c: Self::Numbers) -> Self::Numbers;
    /// The square root.
    fn sqrt(self, a: Self::Numbers) -> Self::Numbers;
    /// |a|
    fn abs(self, a: Self::Numbers) -> Self::Numbers;
    /// |a| with the sign of b
    fn copysign(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    /// a < b; false for NaN
    fn less(self, a: Self::Numbers, b: Self::Numbers) -> Self::Truths;
    /// `yes` in lanes where `holds` is true, else `no`.
    fn select(self, holds: Self::Truths, yes: Self::Numbers, no: Self::Numbers) -> Self::Numbers;
    /// Logical and, lane by lane.
    fn and(self, a: Self::Truths, b: Self::Truths) -> Self::Truths;
    /// Logical or, lane by lane.
    fn or(self, a: Self::Truths, b: Self::Truths) -> Self::Truths;
    /// Logical not, lane by lane.
    fn not(self, a: Self::Truths) -> Self::Truths;
    /// Lane by lane, the first one lowest: a bit that is set where it holds.
    fn bits(self, a: Self::Truths) -> u32;
    /// The first numbers of a slice.
    fn load(self, from: &[f64]) -> Self::Numbers;
    /// To the beginning of a slice.
    fn store(self, a: Self::Numbers, to: &mut [f64]);
}

/// A set of instructions that work can be compiled for.
pub(super) trait Instructions: Copy + Debug {
    /// Does a piece of work in a function of its own, compiled for the set.
    fn compiled<P: crate::number::Outlined>(self, piece: P) -> P::Output;
}

/// The instructions that every processor has.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plain;

impl Instructions for Plain {
    #[inline(always)]
    fn compiled<P: crate::number::Outlined>(self, piece: P) -> P::Output {
        piece.work_outlined()
    }
}

/// One number at a time, with the instructions of a set.
#[derive(Clone, Copy, Debug)]
pub(super) struct Single<S>(pub(super) S);

/// Two registers, or their masks. Aligned so that no register in memory lies across two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Pair<R>(pub(super) R, pub(super) R);

impl<S: Instructions> Registers for Single<S> {
    const LANES: usize = 1;
    type Numbers = f64;
    type Truths = bool;
    #[inline(always)]
    fn outlined<P: crate::number::Outlined>(self, piece: P) -> P::Output {
        self.0.compiled(piece)
    }

    #[inline(always)]
    fn splat(self, value: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn add(self, a: f64, b: f64) -> f64 {
        a + b
    }
    #[inline(always)]
    fn sub(self, a: f64, b: f64) -> f64 {
        a - b
    }
    #[inline(always)]
    fn mul(self, a: f64, b: f64) -> f64 {
        a * b
    }
    #[inline(always)]
    fn div(self, a: f64, b: f64) -> f64 {
        a / b
    }
    #[inline(always)]
    fn neg(self, a: f64) -> f64 {
        -a
    }
    #[inline(always)]
    fn mul_add(self, a: f64, b: f64, c: f64) -> f64 {
        a.mul_add(b, c)
    }
    #[inline(always)]
    fn negate_mul_add(self, a: f64, b: f64, c: f64) -> f64 {
        (-a).mul_add(b, c)
    }
    #[inline(always)]
    fn sqrt(self, a: f64) -> f64 {
        a.sqrt()
    }
    #[inline(always)]
    fn abs(self, a: f64) -> f64 {
        a.abs()
    }
    #[inline(always)]
    fn copysign(self, a: f64, b: f64) -> f64 {
        a.copysign(b)
    }
    #[inline(always)]
    fn less(self, a: f64, b: f64) -> bool {
        a < b
    }
    #[inline(always)]
    fn select(self, holds: bool, yes: f64, no: f64) -> f64 {
        if holds { yes } else { no }
    }
    #[inline(always)]
    fn and(self, a: bool, b: bool) -> bool {
        a & b
    }
    #[inline(always)]
    fn or(self, a: bool, b: bool) -> bool {
        a | b
    }
    #[inline(always)]
    fn not(self, a: bool) -> bool {
        !a
    }
    #[inline(always)]
    fn bits(self, a: bool) -> u32 {
        u32::from(a)
    }
    #[inline(always)]
    fn load(self, from: &[f64]) -> f64 {
        from[0]
    }
    #[inline(always)]
    fn store(self, a: f64, to: &mut [f64]) {
        to[0] = a;
    }
}
