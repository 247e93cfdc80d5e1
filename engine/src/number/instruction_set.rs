//! Work compiled for an instruction set: the one place where a function is called that not every processor can run.
//!
//! A piece of work becomes a function with the features of [`pulp::x86::V4`] or [`pulp::x86::V3`], and is called with such a
//! token in hand. Tokens come from `try_new` alone, which asks the processor: where there is one, the instructions are
//! there. That is the whole argument for `unsafe` here, and nothing else is unsafe.
//!
//! `Simd::vectorize` of pulp does the same by functions that each part of the crate compiles for itself. These are methods of the
//! piece, compiled once, with what stands around it: a changed formula compiles the lanes of that formula and no others.

#![allow(
    unsafe_code,
    reason = "functions compiled for instructions are called where a token proves that the processor has them"
)]

use super::Outlined;
use pulp::x86::{V3, V4};

/// A piece of work that is compiled for every instruction set; all pieces are.
pub(super) trait ForInstructionSet: Outlined {
    /// Does the work with AVX-512.
    fn with_avx512(self, proof: V4) -> Self::Output;
    /// Does the work with AVX2.
    fn with_avx2(self, proof: V3) -> Self::Output;
    /// Does the work with AVX-512 in a function of its own.
    ///
    /// # Safety
    /// The processor has the features of [`V4`].
    unsafe fn avx512(self) -> Self::Output;
    /// Does the work with AVX-512, inlined or not as the compiler decides.
    ///
    /// # Safety
    /// The processor has the features of [`V4`].
    unsafe fn small_avx512(self) -> Self::Output;
    /// Does the work with AVX2 in a function of its own.
    ///
    /// # Safety
    /// The processor has the features of [`V3`].
    unsafe fn avx2(self) -> Self::Output;
    /// Does the work with AVX2, inlined or not as the compiler decides.
    ///
    /// # Safety
    /// The processor has the features of [`V3`].
    unsafe fn small_avx2(self) -> Self::Output;
}

/// The three methods of one instruction set.
macro_rules! compiled {
    ($with:ident, $token:ty, $own:ident, $small:ident, $features:literal) => {
        #[inline(always)]
        fn $with(self, _proof: $token) -> P::Output {
            // SAFETY: the token proves that the processor has the features.
            unsafe {
                match P::IS_SMALL {
                    true => self.$small(),
                    false => self.$own(),
                }
            }
        }
        #[target_feature(enable = $features)]
        unsafe fn $own(self) -> P::Output {
            self.work()
        }
        #[inline]
        #[target_feature(enable = $features)]
        unsafe fn $small(self) -> P::Output {
            self.work()
        }
    };
}

impl<P: Outlined> ForInstructionSet for P {
    compiled!(
        with_avx512,
        V4,
        avx512,
        small_avx512,
        "sse,sse2,fxsr,sse3,ssse3,sse4.1,sse4.2,popcnt,avx,avx2,bmi1,bmi2,fma,lzcnt,avx512f,avx512bw,avx512cd,avx512dq,avx512vl"
    );
    compiled!(
        with_avx2,
        V3,
        avx2,
        small_avx2,
        "sse,sse2,fxsr,sse3,ssse3,sse4.1,sse4.2,popcnt,avx,avx2,bmi1,bmi2,fma,lzcnt"
    );
}
