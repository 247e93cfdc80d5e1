//! The operations of each instruction set, a pair of registers at a time: one chain of dependent operations leaves a
//! processor idle most of the time, two of them, independent of each other, fill the gaps.
//!
//! [`Single`] has one number at a time with the instructions of a set: for a chain of steps that wait for one another, which
//! registers full of the same number would only make slower.
//!
//! Written for each set and not over all of them: a product is then two instructions, where a function generic over the
//! set is a tower of them, which costs the compiler more than everything that is done with it.

use std::fmt::Debug;

/// Numbers side by side, and truth values of them.
pub trait Registers: Copy + Debug {
    /// How many numbers there are.
    const LANES: usize;
    /// The numbers.
    type Numbers: Copy + Debug;
    /// A truth value of each.
    type Truths: Copy + Debug;

    /// Does a piece of work in a function of its own, compiled for the set.
    fn apart<P: crate::number::Outlined>(self, piece: P) -> P::Output;
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
    /// Both hold.
    fn and(self, a: Self::Truths, b: Self::Truths) -> Self::Truths;
    /// One holds.
    fn or(self, a: Self::Truths, b: Self::Truths) -> Self::Truths;
    /// It does not hold.
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
        piece.apart()
    }
}

/// One number at a time, with the instructions of a set.
#[derive(Clone, Copy, Debug)]
pub(super) struct Single<S>(pub(super) S);

/// Two registers, or their masks. Aligned so that no register in memory lies across two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Pair<R>(R, R);

/// The operations of a set with registers of `$width` numbers, from what they are on one register.
#[cfg(target_arch = "x86_64")]
macro_rules! registers {
    ($set:ty, $with:ident, $register:ty, $mask:ty, $width:literal, {
        fn splat($splat_simd:ident, $value:ident) $splat:block
        fn bits($bits_simd:ident, $one_mask:ident) $bits:block
    $(
        fn $operation:ident($simd:ident, $($operand:ident: $kind:ident),*) -> $result:ident $body:block
    )*}) => {
        impl super::Instructions for $set {
            #[inline(always)]
            fn compiled<P: crate::number::Outlined>(self, piece: P) -> P::Output {
                crate::number::instruction_set::ForInstructionSet::$with(piece, self)
            }
        }

        impl Registers for $set {
            const LANES: usize = 2 * $width;
            type Numbers = Pair<$register>;
            type Truths = Pair<$mask>;

            #[inline(always)]
            fn apart<P: crate::number::Outlined>(self, piece: P) -> P::Output {
                super::Instructions::compiled(self, piece)
            }
            $(
                #[inline(always)]
                fn $operation(self, $($operand: Self::$kind),*) -> Self::$result {
                    let $simd = self;
                    Pair(
                        { $(let $operand = $operand.0;)* $body },
                        { $(let $operand = $operand.1;)* $body },
                    )
                }
            )*

            #[inline(always)]
            fn splat(self, value: f64) -> Self::Numbers {
                let ($splat_simd, $value) = (self, value);
                let register = $splat;
                Pair(register, register)
            }
            #[inline(always)]
            fn bits(self, a: Self::Truths) -> u32 {
                let $bits_simd = self;
                let low: u32 = { let $one_mask = a.0; $bits };
                let high: u32 = { let $one_mask = a.1; $bits };
                low | (high << $width)
            }
            #[inline(always)]
            fn load(self, from: &[f64]) -> Self::Numbers {
                let numbers = <Self as pulp::Simd>::as_simd_f64s(&from[..Self::LANES]).0;
                Pair(pulp::cast(numbers[0]), pulp::cast(numbers[1]))
            }
            #[inline(always)]
            fn store(self, a: Self::Numbers, to: &mut [f64]) {
                let numbers = <Self as pulp::Simd>::as_mut_simd_f64s(&mut to[..Self::LANES]).0;
                numbers[0] = pulp::cast(a.0);
                numbers[1] = pulp::cast(a.1);
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Pair, Registers};
    use pulp::x86::{V3, V4};
    use std::arch::x86_64::{__m256d, __m512d, __mmask8, _CMP_LT_OQ};

    registers!(V4, with_avx512, __m512d, __mmask8, 8, {
        fn splat(simd, value) { simd.avx512f._mm512_set1_pd(value) }
        fn bits(_simd, mask) { u32::from(mask) }
        fn add(simd, a: Numbers, b: Numbers) -> Numbers { simd.avx512f._mm512_add_pd(a, b) }
        fn sub(simd, a: Numbers, b: Numbers) -> Numbers { simd.avx512f._mm512_sub_pd(a, b) }
        fn mul(simd, a: Numbers, b: Numbers) -> Numbers { simd.avx512f._mm512_mul_pd(a, b) }
        fn div(simd, a: Numbers, b: Numbers) -> Numbers { simd.avx512f._mm512_div_pd(a, b) }
        fn neg(simd, a: Numbers) -> Numbers {
            let (bits, sign) = (simd.avx512f._mm512_castpd_si512(a), simd.avx512f._mm512_set1_epi64(i64::MIN));
            simd.avx512f._mm512_castsi512_pd(simd.avx512f._mm512_xor_si512(bits, sign))
        }
        fn mul_add(simd, a: Numbers, b: Numbers, c: Numbers) -> Numbers { simd.avx512f._mm512_fmadd_pd(a, b, c) }
        fn negate_mul_add(simd, a: Numbers, b: Numbers, c: Numbers) -> Numbers { simd.avx512f._mm512_fnmadd_pd(a, b, c) }
        fn sqrt(simd, a: Numbers) -> Numbers { simd.avx512f._mm512_sqrt_pd(a) }
        fn abs(simd, a: Numbers) -> Numbers { simd.avx512f._mm512_abs_pd(a) }
        fn copysign(simd, a: Numbers, b: Numbers) -> Numbers {
            let magnitude = simd.avx512f._mm512_castpd_si512(simd.avx512f._mm512_abs_pd(a));
            let sign = simd.avx512f._mm512_and_si512(
                simd.avx512f._mm512_castpd_si512(b),
                simd.avx512f._mm512_set1_epi64(i64::MIN),
            );
            simd.avx512f._mm512_castsi512_pd(simd.avx512f._mm512_or_si512(magnitude, sign))
        }
        fn less(simd, a: Numbers, b: Numbers) -> Truths { simd.avx512f._mm512_cmplt_pd_mask(a, b) }
        fn select(simd, holds: Truths, yes: Numbers, no: Numbers) -> Numbers {
            simd.avx512f._mm512_mask_blend_pd(holds, no, yes)
        }
        fn and(_simd, a: Truths, b: Truths) -> Truths { a & b }
        fn or(_simd, a: Truths, b: Truths) -> Truths { a | b }
        fn not(_simd, a: Truths) -> Truths { !a }
    });

    registers!(V3, with_avx2, __m256d, __m256d, 4, {
        fn splat(simd, value) { simd.avx._mm256_set1_pd(value) }
        fn bits(simd, mask) { simd.avx._mm256_movemask_pd(mask) as u32 }
        fn add(simd, a: Numbers, b: Numbers) -> Numbers { simd.avx._mm256_add_pd(a, b) }
        fn sub(simd, a: Numbers, b: Numbers) -> Numbers { simd.avx._mm256_sub_pd(a, b) }
        fn mul(simd, a: Numbers, b: Numbers) -> Numbers { simd.avx._mm256_mul_pd(a, b) }
        fn div(simd, a: Numbers, b: Numbers) -> Numbers { simd.avx._mm256_div_pd(a, b) }
        fn neg(simd, a: Numbers) -> Numbers { simd.avx._mm256_xor_pd(a, simd.avx._mm256_set1_pd(-0.0)) }
        fn mul_add(simd, a: Numbers, b: Numbers, c: Numbers) -> Numbers { simd.fma._mm256_fmadd_pd(a, b, c) }
        fn negate_mul_add(simd, a: Numbers, b: Numbers, c: Numbers) -> Numbers { simd.fma._mm256_fnmadd_pd(a, b, c) }
        fn sqrt(simd, a: Numbers) -> Numbers { simd.avx._mm256_sqrt_pd(a) }
        fn abs(simd, a: Numbers) -> Numbers { simd.avx._mm256_andnot_pd(simd.avx._mm256_set1_pd(-0.0), a) }
        fn copysign(simd, a: Numbers, b: Numbers) -> Numbers {
            let minus = simd.avx._mm256_set1_pd(-0.0);
            let sign = simd.avx._mm256_and_pd(minus, b);
            simd.avx._mm256_or_pd(simd.avx._mm256_andnot_pd(minus, a), sign)
        }
        fn less(simd, a: Numbers, b: Numbers) -> Truths { simd.avx._mm256_cmp_pd::<_CMP_LT_OQ>(a, b) }
        fn select(simd, holds: Truths, yes: Numbers, no: Numbers) -> Numbers {
            simd.avx._mm256_blendv_pd(no, yes, holds)
        }
        fn and(simd, a: Truths, b: Truths) -> Truths { simd.avx._mm256_and_pd(a, b) }
        fn or(simd, a: Truths, b: Truths) -> Truths { simd.avx._mm256_or_pd(a, b) }
        fn not(simd, a: Truths) -> Truths {
            let all = simd.avx._mm256_set1_pd(f64::from_bits(u64::MAX));
            simd.avx._mm256_xor_pd(a, all)
        }
    });
}

impl<S: Instructions> Registers for Single<S> {
    const LANES: usize = 1;
    type Numbers = f64;
    type Truths = bool;
    #[inline(always)]
    fn apart<P: crate::number::Outlined>(self, piece: P) -> P::Output {
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
