//! Operations of each instruction set on a pair of registers. With one chain of dependent operations, a processor is idle
//! most of the time. A second, independent chain fills the gaps.
//!
//! [`Single`] works on one number at a time with the instructions of a set. Chains of dependent steps use it, because
//! registers filled with copies of one number would be slower.
//!
//! The code is written separately for each set ([`super::x86`]), not generically. A product then takes two instructions,
//! one for each register. A generic function would consist of nested calls. Compiling these calls would take longer than
//! compiling all the arithmetic that uses them.

use super::lanes::{LaneMask, Lanes};
use std::fmt::Debug;

/// An instruction set: registers for one bundle of numbers, and operations on them. Operations take whole bundles, not
/// their registers. So the call does not copy a bundle, and the compiler need not remove such copies.
pub trait Registers: Copy + Debug {
    /// Count of numbers in a bundle.
    const LANES: usize;
    /// Registers of a bundle.
    type Numbers: Copy + Debug;
    /// Registers with a truth value for each number.
    type Truths: Copy + Debug;

    /// Does a piece of work in a separate function, compiled for the instruction set.
    fn outlined<P: crate::number::Outlined>(self, piece: P) -> P::Output;
    /// Copies a number to every lane.
    fn splat(self, value: f64) -> Lanes<Self>;
    /// a + b
    fn add(a: Lanes<Self>, b: Lanes<Self>) -> Lanes<Self>;
    /// a - b
    fn sub(a: Lanes<Self>, b: Lanes<Self>) -> Lanes<Self>;
    /// a b
    fn mul(a: Lanes<Self>, b: Lanes<Self>) -> Lanes<Self>;
    /// a/b
    fn div(a: Lanes<Self>, b: Lanes<Self>) -> Lanes<Self>;
    /// -a
    fn neg(a: Lanes<Self>) -> Lanes<Self>;
    /// c + a b, rounded once
    fn mul_add(a: Lanes<Self>, b: Lanes<Self>, c: Lanes<Self>) -> Lanes<Self>;
    /// c - a b, rounded once
    fn negate_mul_add(a: Lanes<Self>, b: Lanes<Self>, c: Lanes<Self>) -> Lanes<Self>;
    /// The square root.
    fn sqrt(a: Lanes<Self>) -> Lanes<Self>;
    /// |a|
    fn abs(a: Lanes<Self>) -> Lanes<Self>;
    /// |a| with the sign of b
    fn copysign(a: Lanes<Self>, b: Lanes<Self>) -> Lanes<Self>;
    /// a < b; false for NaN
    fn less(a: Lanes<Self>, b: Lanes<Self>) -> LaneMask<Self>;
    /// Returns `yes` in lanes in which `holds` is true, else `no`.
    fn select(holds: LaneMask<Self>, yes: Lanes<Self>, no: Lanes<Self>) -> Lanes<Self>;
    /// Logical and, lane by lane.
    fn and(a: LaneMask<Self>, b: LaneMask<Self>) -> LaneMask<Self>;
    /// Logical or, lane by lane.
    fn or(a: LaneMask<Self>, b: LaneMask<Self>) -> LaneMask<Self>;
    /// Logical not, lane by lane.
    fn not(a: LaneMask<Self>) -> LaneMask<Self>;
    /// Bits of the truth values, one per lane. The first lane is the lowest bit; true is 1.
    fn bits(a: LaneMask<Self>) -> u32;
    /// Loads the first numbers of a slice.
    fn load(self, from: &[f64]) -> Lanes<Self>;
    /// Writes the numbers to the beginning of a slice.
    fn store(a: Lanes<Self>, to: &mut [f64]);
}

/// An instruction set for which pieces of work can be compiled.
pub(super) trait Instructions: Copy + Debug {
    /// Does a piece of work in a separate function, compiled for the instruction set.
    fn compiled<P: crate::number::Outlined>(self, piece: P) -> P::Output;
}

/// Instructions that every processor has.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plain;

impl Instructions for Plain {
    #[inline(always)]
    fn compiled<P: crate::number::Outlined>(self, piece: P) -> P::Output {
        if P::IS_SMALL {
            piece.work_small()
        } else {
            piece.work_outlined()
        }
    }
}

/// One number at a time, with the instructions of an instruction set.
#[derive(Clone, Copy, Debug)]
pub(super) struct Single<S>(pub(super) S);

/// Two registers, or their masks. The alignment keeps each register in memory within one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Pair<R>(pub(super) R, pub(super) R);

/// Defines operations on one number at a time.
macro_rules! on_one_number {
    ($(fn $operation:ident($first:ident: $first_kind:ident $(, $operand:ident: $kind:ident)*) -> $result:ident {
        $value:expr
    })*) => {
        $(
            #[inline(always)]
            fn $operation($first: $first_kind<Self> $(, $operand: $kind<Self>)*) -> $result<Self> {
                let simd = $first.simd;
                let $first = $first.registers;
                $(let $operand = $operand.registers;)*
                $result { simd, registers: $value }
            }
        )*
    };
}

impl<S: Instructions> Registers for Single<S> {
    const LANES: usize = 1;
    type Numbers = f64;
    type Truths = bool;
    #[inline(always)]
    fn outlined<P: crate::number::Outlined>(self, piece: P) -> P::Output {
        self.0.compiled(piece)
    }
    #[inline(always)]
    fn splat(self, value: f64) -> Lanes<Self> {
        Lanes {
            simd: self,
            registers: value,
        }
    }
    on_one_number! {
        fn add(a: Lanes, b: Lanes) -> Lanes { a + b }
        fn sub(a: Lanes, b: Lanes) -> Lanes { a - b }
        fn mul(a: Lanes, b: Lanes) -> Lanes { a * b }
        fn div(a: Lanes, b: Lanes) -> Lanes { a / b }
        fn neg(a: Lanes) -> Lanes { -a }
        fn mul_add(a: Lanes, b: Lanes, c: Lanes) -> Lanes { a.mul_add(b, c) }
        fn negate_mul_add(a: Lanes, b: Lanes, c: Lanes) -> Lanes { (-a).mul_add(b, c) }
        fn sqrt(a: Lanes) -> Lanes { a.sqrt() }
        fn abs(a: Lanes) -> Lanes { a.abs() }
        fn copysign(a: Lanes, b: Lanes) -> Lanes { a.copysign(b) }
        fn less(a: Lanes, b: Lanes) -> LaneMask { a < b }
        fn select(holds: LaneMask, yes: Lanes, no: Lanes) -> Lanes { if holds { yes } else { no } }
        fn and(a: LaneMask, b: LaneMask) -> LaneMask { a & b }
        fn or(a: LaneMask, b: LaneMask) -> LaneMask { a | b }
        fn not(a: LaneMask) -> LaneMask { !a }
    }
    #[inline(always)]
    fn bits(a: LaneMask<Self>) -> u32 {
        u32::from(a.registers)
    }
    #[inline(always)]
    fn load(self, from: &[f64]) -> Lanes<Self> {
        self.splat(from[0])
    }
    #[inline(always)]
    fn store(a: Lanes<Self>, to: &mut [f64]) {
        to[0] = a.registers;
    }
}
