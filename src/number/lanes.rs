//! SIMD registers as numbers.
//!
//! The instruction set is chosen when the program runs ([`Width`]): AVX-512 or AVX2 where the processor
//! has it, two registers at a time since one chain of dependent operations leaves it idle; plain numbers
//! elsewhere. [`Real::plus_product`] and [`Real::minus_product`] are rounded once, everything else is the
//! IEEE operation, so every width yields the same bits. (Where plain numbers must do, the mathematical
//! library's product and sum makes up for a processor's: the same bits, slowly.)
//!
//! What runs on [`Lanes`] must be inlined into the one function that is compiled for the instruction set:
//! `#[inline(always)]` throughout, and no closures that the compiler might leave as calls.

use super::{Outlined, Real, SimdReal, Unrolled2, arc};
use pulp::{Simd, WithSimd};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// A SIMD register.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<S: Simd> {
    simd: S,
    register: S::f64s,
}

/// A truth value for each lane of [`Lanes`].
#[derive(Clone, Copy, Debug)]
pub struct LaneMask<S: Simd> {
    simd: S,
    register: S::m64s,
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    fn splat(simd: S, value: f64) -> Self {
        Lanes {
            simd,
            register: simd.splat_f64s(value),
        }
    }

    #[inline(always)]
    fn with(self, register: S::f64s) -> Self {
        Lanes {
            simd: self.simd,
            register,
        }
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $simd_method:ident) => {
        impl<S: Simd> $trait for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(self.simd.$simd_method(self.register, other.register))
            }
        }
    };
}

operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.with(self.simd.neg_f64s(self.register))
    }
}

impl<S: Simd> Real for Lanes<S> {
    const IN_REGISTERS: bool = true;

    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        let (a, b) = (a.register, b.register);
        self.with(self.simd.mul_add_f64s(a, b, self.register))
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        let (a, b) = (a.register, b.register);
        self.with(self.simd.negate_mul_add_f64s(a, b, self.register))
    }
    #[inline(always)]
    fn lit(self, value: f64) -> Self {
        Lanes::splat(self.simd, value)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.with(self.simd.sqrt_f64s(self.register))
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

impl<S: Simd> SimdReal for Lanes<S> {
    const LANES: usize = S::F64_LANES;
    type Mask = LaneMask<S>;

    #[inline(always)]
    fn load(self, from: &[f64]) -> Self {
        self.with(S::as_simd_f64s(from).0[0])
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        S::as_mut_simd_f64s(to).0[0] = self.register;
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.with(self.simd.abs_f64s(self.register))
    }
    #[inline(always)]
    fn copysign(self, other: Self) -> Self {
        let minus = self.simd.splat_f64s(-0.0);
        let sign = self.simd.and_f64s(minus, other.register);
        let magnitude = self.simd.abs_f64s(self.register);
        self.with(self.simd.or_f64s(magnitude, sign))
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self::Mask {
        LaneMask {
            simd: self.simd,
            register: self.simd.less_than_f64s(self.register, other.register),
        }
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        yes.with(
            yes.simd
                .select_f64s(mask.register, yes.register, no.register),
        )
    }
    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        let unset = mask.simd.not_m64s(mask.register);
        mask.simd.first_true_m64s(unset) == S::F64_LANES
    }
    #[inline(always)]
    fn outlined<P: Outlined>(self, piece: P) -> P::Output {
        self.simd.vectorize(InOwnFunction(piece))
    }
    #[inline(always)]
    fn lane(mask: Self::Mask, lane: usize) -> bool {
        let simd = mask.simd;
        let (one, zero) = (simd.splat_f64s(1.0), simd.splat_f64s(0.0));
        let flags = simd.select_f64s(mask.register, one, zero);
        let mut numbers = [0.0; 8];
        S::as_mut_simd_f64s(&mut numbers).0[0] = flags;
        numbers[lane] == 1.0
    }
}

impl<S: Simd> BitAnd for LaneMask<S> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        LaneMask {
            simd: self.simd,
            register: self.simd.and_m64s(self.register, other.register),
        }
    }
}

impl<S: Simd> BitOr for LaneMask<S> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        LaneMask {
            simd: self.simd,
            register: self.simd.or_m64s(self.register, other.register),
        }
    }
}

impl<S: Simd> Not for LaneMask<S> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        LaneMask {
            simd: self.simd,
            register: self.simd.not_m64s(self.register),
        }
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

    /// Numbers that tasks of this width work on at a time.
    pub fn lanes(self) -> usize {
        struct Count;
        impl SimdTask for Count {
            type Output = usize;
            #[inline(always)]
            fn run<B: SimdReal>(self, _: B) -> usize {
                B::LANES
            }
        }
        self.run(Count)
    }

    /// Runs a task in lanes of this width, or one by one where the processor does not have it.
    pub fn run<T: SimdTask>(self, task: T) -> T::Output {
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
        task.run(Lanes::splat(pulp::Scalar, 0.0))
    }
}

/// Something to be done in lanes.
pub trait SimdTask {
    /// What it yields.
    type Output;
    /// Does it; `like` says in which kind of lanes. To be marked `#[inline(always)]`.
    fn run<B: SimdReal>(self, like: B) -> Self::Output;
}

struct InOwnFunction<P>(P);

impl<P: Outlined> WithSimd for InOwnFunction<P> {
    type Output = P::Output;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> P::Output {
        self.0.work()
    }
}

struct Task<T>(T);

impl<T: SimdTask> WithSimd for Task<T> {
    type Output = T::Output;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> T::Output {
        let zero = Lanes::splat(simd, 0.0);
        self.0.run(Unrolled2(zero, zero))
    }
}
