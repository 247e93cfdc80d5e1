//! AVX2 and AVX-512 of x86 processors: functions compiled for these sets, and registers of numbers. Only this file contains
//! code that some processors cannot run, and only this file contains `unsafe`.
//!
//! Each set has a token ([`Avx512`], [`Avx2`]). Only `detect` makes tokens, after it has checked the processor. So code
//! that has a token runs on a processor with these instructions. Every `unsafe` in this file relies on this argument,
//! because pieces of work and operations on registers require the token. Loads and stores use pointers into slices whose
//! length has been checked.
//!
//! Each piece is compiled as a method of its own type, in the module of that type. So a changed formula recompiles only the
//! lanes of that formula. The compiler inlines operations on registers into the piece; most operations become one
//! instruction per register.

#![allow(
    unsafe_code,
    reason = "the code uses these instructions only if a CPU-feature token shows that the processor has them"
)]

use super::Outlined;
use super::lanes::{LaneMask, Lanes};
use super::registers::{Instructions, Pair, Registers};
use std::arch::x86_64::*;

/// Defines an instruction set: its token, and the compilation of pieces of work for it.
macro_rules! instruction_set {
    ($(#[$about:meta])* $set:ident, $compiled:ident: $($feature:tt),+) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug)]
        pub(super) struct $set(());

        impl $set {
            /// Returns the token if this processor has the instructions.
            #[inline]
            pub(super) fn detect() -> Option<Self> {
                ($(is_x86_feature_detected!($feature))&&+).then_some($set(()))
            }
        }

        /// Compilation of a function for the instruction set. Every [`Outlined`] function has it.
        trait $compiled: Outlined {
            /// Runs the piece in a separate function.
            ///
            /// # Safety
            /// The processor has the instructions.
            unsafe fn own(self) -> Self::Output;
            /// Runs the piece; the compiler decides whether to inline it.
            ///
            /// # Safety
            /// The processor has the instructions.
            unsafe fn small(self) -> Self::Output;
        }

        impl<P: Outlined> $compiled for P {
            #[target_feature($(enable = $feature),+)]
            unsafe fn own(self) -> P::Output {
                self.work()
            }
            #[inline]
            #[target_feature($(enable = $feature),+)]
            unsafe fn small(self) -> P::Output {
                self.work()
            }
        }

        impl Instructions for $set {
            #[inline(always)]
            fn compiled<P: Outlined>(self, piece: P) -> P::Output {
                // SAFETY: the token guarantees that the processor has the instructions.
                unsafe {
                    match P::IS_SMALL {
                        true => $compiled::small(piece),
                        false => $compiled::own(piece),
                    }
                }
            }
        }
    };
}

instruction_set!(
    /// AVX-512 as of Skylake-X.
    Avx512, CompiledForAvx512:
    "avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl", "fma", "bmi1", "bmi2", "lzcnt", "popcnt"
);
instruction_set!(
    /// AVX2 with fused products and sums.
    Avx2, CompiledForAvx2: "avx2", "fma", "bmi1", "bmi2", "lzcnt", "popcnt"
);

/// Defines a set's operations on pairs of registers of `$width` numbers from its operations on one register. Each operation
/// is a function compiled for the set. The compiler optimises it once and then inlines it. (When operations were inlined
/// first and optimised at each use, they took an eighth of the compiler time of the engine.)
macro_rules! registers {
    ($set:ident, $features:literal, $width:literal, $register:ty, $mask:ty, $load:ident, $store:ident, {
        fn splat($value:ident) $splat:block
        fn bits($one_mask:ident) $bits:block
    $(
        fn $operation:ident($first:ident: $first_kind:ident $(, $operand:ident: $kind:ident)*) -> $result:ident $body:block
    )*}) => {
        // SAFETY of every call: the token guarantees that the processor has the instructions.
        impl Registers for $set {
            const LANES: usize = 2 * $width;
            type Numbers = Pair<$register>;
            type Truths = Pair<$mask>;

            #[inline(always)]
            fn outlined<P: Outlined>(self, piece: P) -> P::Output {
                self.compiled(piece)
            }
            $(
                #[inline(always)]
                fn $operation($first: $first_kind<$set> $(, $operand: $kind<$set>)*) -> $result<$set> {
                    #[inline]
                    #[target_feature(enable = $features)]
                    fn compiled($first: $first_kind<$set> $(, $operand: $kind<$set>)*) -> $result<$set> {
                        $result {
                            simd: $first.simd,
                            registers: Pair(
                                { let $first = $first.registers.0; $(let $operand = $operand.registers.0;)* $body },
                                { let $first = $first.registers.1; $(let $operand = $operand.registers.1;)* $body },
                            ),
                        }
                    }
                    unsafe { compiled($first $(, $operand)*) }
                }
            )*

            #[inline(always)]
            fn splat(self, $value: f64) -> Lanes<$set> {
                #[inline]
                #[target_feature(enable = $features)]
                fn compiled(simd: $set, $value: f64) -> Lanes<$set> {
                    let register = $splat;
                    Lanes { simd, registers: Pair(register, register) }
                }
                unsafe { compiled(self, $value) }
            }
            #[inline(always)]
            fn bits(a: LaneMask<$set>) -> u32 {
                #[inline]
                #[target_feature(enable = $features)]
                fn compiled(a: LaneMask<$set>) -> u32 {
                    let low: u32 = { let $one_mask = a.registers.0; $bits };
                    let high: u32 = { let $one_mask = a.registers.1; $bits };
                    low | (high << $width)
                }
                unsafe { compiled(a) }
            }
            #[inline(always)]
            fn load(self, from: &[f64]) -> Lanes<$set> {
                let from = from[..Self::LANES].as_ptr();
                // SAFETY: the slice has at least two registers of numbers.
                let registers = unsafe { Pair($load(from), $load(from.add($width))) };
                Lanes { simd: self, registers }
            }
            #[inline(always)]
            fn store(a: Lanes<$set>, to: &mut [f64]) {
                let to = to[..Self::LANES].as_mut_ptr();
                // SAFETY: the slice has space for two registers of numbers.
                unsafe {
                    $store(to, a.registers.0);
                    $store(to.add($width), a.registers.1);
                }
            }
        }
    };
}

registers!(Avx512, "avx512f,avx512dq", 8, __m512d, __mmask8, _mm512_loadu_pd, _mm512_storeu_pd, {
    fn splat(value) { _mm512_set1_pd(value) }
    fn bits(mask) { u32::from(mask) }
    fn add(a: Lanes, b: Lanes) -> Lanes { _mm512_add_pd(a, b) }
    fn sub(a: Lanes, b: Lanes) -> Lanes { _mm512_sub_pd(a, b) }
    fn mul(a: Lanes, b: Lanes) -> Lanes { _mm512_mul_pd(a, b) }
    fn div(a: Lanes, b: Lanes) -> Lanes { _mm512_div_pd(a, b) }
    fn neg(a: Lanes) -> Lanes { _mm512_xor_pd(a, _mm512_set1_pd(-0.0)) }
    fn mul_add(a: Lanes, b: Lanes, c: Lanes) -> Lanes { _mm512_fmadd_pd(a, b, c) }
    fn negate_mul_add(a: Lanes, b: Lanes, c: Lanes) -> Lanes { _mm512_fnmadd_pd(a, b, c) }
    fn sqrt(a: Lanes) -> Lanes { _mm512_sqrt_pd(a) }
    fn abs(a: Lanes) -> Lanes { _mm512_andnot_pd(_mm512_set1_pd(-0.0), a) }
    fn copysign(a: Lanes, b: Lanes) -> Lanes {
        let minus = _mm512_set1_pd(-0.0);
        _mm512_or_pd(_mm512_andnot_pd(minus, a), _mm512_and_pd(minus, b))
    }
    fn less(a: Lanes, b: Lanes) -> LaneMask { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b) }
    fn select(holds: LaneMask, yes: Lanes, no: Lanes) -> Lanes { _mm512_mask_blend_pd(holds, no, yes) }
    fn and(a: LaneMask, b: LaneMask) -> LaneMask { a & b }
    fn or(a: LaneMask, b: LaneMask) -> LaneMask { a | b }
    fn not(a: LaneMask) -> LaneMask { !a }
});

registers!(Avx2, "avx2,fma", 4, __m256d, __m256d, _mm256_loadu_pd, _mm256_storeu_pd, {
    fn splat(value) { _mm256_set1_pd(value) }
    fn bits(mask) { _mm256_movemask_pd(mask) as u32 }
    fn add(a: Lanes, b: Lanes) -> Lanes { _mm256_add_pd(a, b) }
    fn sub(a: Lanes, b: Lanes) -> Lanes { _mm256_sub_pd(a, b) }
    fn mul(a: Lanes, b: Lanes) -> Lanes { _mm256_mul_pd(a, b) }
    fn div(a: Lanes, b: Lanes) -> Lanes { _mm256_div_pd(a, b) }
    fn neg(a: Lanes) -> Lanes { _mm256_xor_pd(a, _mm256_set1_pd(-0.0)) }
    fn mul_add(a: Lanes, b: Lanes, c: Lanes) -> Lanes { _mm256_fmadd_pd(a, b, c) }
    fn negate_mul_add(a: Lanes, b: Lanes, c: Lanes) -> Lanes { _mm256_fnmadd_pd(a, b, c) }
    fn sqrt(a: Lanes) -> Lanes { _mm256_sqrt_pd(a) }
    fn abs(a: Lanes) -> Lanes { _mm256_andnot_pd(_mm256_set1_pd(-0.0), a) }
    fn copysign(a: Lanes, b: Lanes) -> Lanes {
        let minus = _mm256_set1_pd(-0.0);
        _mm256_or_pd(_mm256_andnot_pd(minus, a), _mm256_and_pd(minus, b))
    }
    fn less(a: Lanes, b: Lanes) -> LaneMask { _mm256_cmp_pd::<_CMP_LT_OQ>(a, b) }
    fn select(holds: LaneMask, yes: Lanes, no: Lanes) -> Lanes { _mm256_blendv_pd(no, yes, holds) }
    fn and(a: LaneMask, b: LaneMask) -> LaneMask { _mm256_and_pd(a, b) }
    fn or(a: LaneMask, b: LaneMask) -> LaneMask { _mm256_or_pd(a, b) }
    fn not(a: LaneMask) -> LaneMask { _mm256_xor_pd(a, _mm256_set1_pd(f64::from_bits(u64::MAX))) }
});
