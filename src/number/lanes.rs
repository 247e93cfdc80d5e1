//! SIMD registers as numbers.
//!
//! The instruction set is chosen when the program runs ([`Width`]): AVX-512 or AVX2 where the processor
//! has it, two registers at a time since one chain of dependent operations leaves it idle; plain numbers
//! elsewhere. Products and sums are not fused, so every width yields the same bits.
//!
//! What runs on [`Lanes`] must be inlined into the one function that is compiled for the instruction set:
//! `#[inline(always)]` throughout, and no closures that the compiler might leave as calls.

use super::{Bundle, Real, arc};
use pulp::{Simd, WithSimd};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// `K` registers.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<S: Simd, const K: usize> {
    simd: S,
    registers: [S::f64s; K],
}

/// A truth value for each lane of [`Lanes`].
#[derive(Clone, Copy, Debug)]
pub struct LaneMask<S: Simd, const K: usize> {
    simd: S,
    registers: [S::m64s; K],
}

impl<S: Simd, const K: usize> Lanes<S, K> {
    #[inline(always)]
    fn splat(simd: S, value: f64) -> Self {
        Lanes {
            simd,
            registers: [simd.splat_f64s(value); K],
        }
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $simd_method:ident) => {
        impl<S: Simd, const K: usize> $trait for Lanes<S, K> {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                let mut k = 0;
                while k < K {
                    self.registers[k] = self
                        .simd
                        .$simd_method(self.registers[k], other.registers[k]);
                    k += 1;
                }
                self
            }
        }
    };
}

operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);

impl<S: Simd, const K: usize> Neg for Lanes<S, K> {
    type Output = Self;
    #[inline(always)]
    fn neg(mut self) -> Self {
        let mut k = 0;
        while k < K {
            self.registers[k] = self.simd.neg_f64s(self.registers[k]);
            k += 1;
        }
        self
    }
}

impl<S: Simd, const K: usize> Real for Lanes<S, K> {
    const IN_REGISTERS: bool = true;

    #[inline(always)]
    fn lit(self, value: f64) -> Self {
        Lanes::splat(self.simd, value)
    }
    #[inline(always)]
    fn sqrt(mut self) -> Self {
        let mut k = 0;
        while k < K {
            self.registers[k] = self.simd.sqrt_f64s(self.registers[k]);
            k += 1;
        }
        self
    }
    #[inline(always)]
    fn asin(self) -> Self {
        arc::asin(self)
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        arc::atan2(self, x)
    }
    #[inline(always)]
    fn sign(self) -> Self {
        self.one().copysign(self)
    }
}

impl<S: Simd, const K: usize> Bundle for Lanes<S, K> {
    const LANES: usize = K * S::F64_LANES;
    type Mask = LaneMask<S, K>;

    #[inline(always)]
    fn load(mut self, from: &[f64]) -> Self {
        let (registers, _) = S::as_simd_f64s(from);
        let mut k = 0;
        while k < K {
            self.registers[k] = registers[k];
            k += 1;
        }
        self
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        let (registers, _) = S::as_mut_simd_f64s(to);
        let mut k = 0;
        while k < K {
            registers[k] = self.registers[k];
            k += 1;
        }
    }
    #[inline(always)]
    fn abs(mut self) -> Self {
        let mut k = 0;
        while k < K {
            self.registers[k] = self.simd.abs_f64s(self.registers[k]);
            k += 1;
        }
        self
    }
    #[inline(always)]
    fn copysign(mut self, other: Self) -> Self {
        let minus = self.simd.splat_f64s(-0.0);
        let mut k = 0;
        while k < K {
            let sign = self.simd.and_f64s(minus, other.registers[k]);
            let magnitude = self.simd.abs_f64s(self.registers[k]);
            self.registers[k] = self.simd.or_f64s(magnitude, sign);
            k += 1;
        }
        self
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self::Mask {
        let simd = self.simd;
        let mut registers = [simd.less_than_f64s(self.registers[0], other.registers[0]); K];
        let mut k = 1;
        while k < K {
            registers[k] = simd.less_than_f64s(self.registers[k], other.registers[k]);
            k += 1;
        }
        LaneMask { simd, registers }
    }
    #[inline(always)]
    fn select(mask: Self::Mask, mut yes: Self, no: Self) -> Self {
        let mut k = 0;
        while k < K {
            yes.registers[k] =
                yes.simd
                    .select_f64s(mask.registers[k], yes.registers[k], no.registers[k]);
            k += 1;
        }
        yes
    }
    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        let mut all = true;
        let mut k = 0;
        while k < K {
            let unset = mask.simd.not_m64s(mask.registers[k]);
            all &= mask.simd.first_true_m64s(unset) == S::F64_LANES;
            k += 1;
        }
        all
    }
    #[inline(always)]
    fn lane(mask: Self::Mask, lane: usize) -> bool {
        let simd = mask.simd;
        let (one, zero) = (simd.splat_f64s(1.0), simd.splat_f64s(0.0));
        let flags = simd.select_f64s(mask.registers[lane / S::F64_LANES], one, zero);
        let mut numbers = [0.0; 8];
        S::as_mut_simd_f64s(&mut numbers).0[0] = flags;
        numbers[lane % S::F64_LANES] == 1.0
    }
}

macro_rules! mask_operator {
    ($trait:ident, $method:ident, $simd_method:ident) => {
        impl<S: Simd, const K: usize> $trait for LaneMask<S, K> {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                let mut k = 0;
                while k < K {
                    self.registers[k] = self
                        .simd
                        .$simd_method(self.registers[k], other.registers[k]);
                    k += 1;
                }
                self
            }
        }
    };
}

mask_operator!(BitAnd, bitand, and_m64s);
mask_operator!(BitOr, bitor, or_m64s);

impl<S: Simd, const K: usize> Not for LaneMask<S, K> {
    type Output = Self;
    #[inline(always)]
    fn not(mut self) -> Self {
        let mut k = 0;
        while k < K {
            self.registers[k] = self.simd.not_m64s(self.registers[k]);
            k += 1;
        }
        self
    }
}

/// How many numbers are worked on at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Width {
    /// One number: every processor.
    Scalar,
    /// AVX2: registers of four.
    Avx2,
    /// AVX-512: registers of eight.
    Avx512,
}

impl Width {
    /// Every width, narrowest first.
    pub const ALL: [Width; 3] = [Width::Scalar, Width::Avx2, Width::Avx512];

    /// Name for tables.
    pub fn name(self) -> &'static str {
        match self {
            Width::Scalar => "scalar",
            Width::Avx2 => "avx2",
            Width::Avx512 => "avx512",
        }
    }

    /// Whether this processor has it.
    pub fn is_available(self) -> bool {
        match self {
            Width::Scalar => true,
            #[cfg(target_arch = "x86_64")]
            Width::Avx2 => pulp::x86::V3::try_new().is_some(),
            #[cfg(target_arch = "x86_64")]
            Width::Avx512 => pulp::x86::V4::try_new().is_some(),
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }

    /// The widest there is.
    pub fn widest() -> Width {
        Width::ALL
            .into_iter()
            .rfind(|w| w.is_available())
            .unwrap_or(Width::Scalar)
    }

    /// Runs a task in lanes of this width, or one by one where the processor does not have it.
    pub fn run<T: InLanes>(self, task: T) -> T::Output {
        #[cfg(target_arch = "x86_64")]
        match self {
            Width::Avx512 => {
                if let Some(simd) = pulp::x86::V4::try_new() {
                    return Simd::vectorize(simd, Task(task));
                }
            }
            Width::Avx2 => {
                if let Some(simd) = pulp::x86::V3::try_new() {
                    return Simd::vectorize(simd, Task(task));
                }
            }
            Width::Scalar => {}
        }
        task.run(0.0)
    }
}

/// Registers worked on together.
const REGISTERS: usize = 1;

/// Something to be done in lanes.
pub trait InLanes {
    /// What it yields.
    type Output;
    /// Does it; `like` says in which kind of lanes. To be marked `#[inline(always)]`.
    fn run<B: Bundle>(self, like: B) -> Self::Output;
}

struct Task<T>(T);

impl<T: InLanes> WithSimd for Task<T> {
    type Output = T::Output;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> T::Output {
        self.0.run(Lanes::<S, REGISTERS>::splat(simd, 0.0))
    }
}
