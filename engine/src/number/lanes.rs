//! SIMD registers as numbers.
//!
//! The program chooses the instruction set at run time ([`Width`]): AVX-512 or AVX2 if the processor has it.
//! Each operation works on two registers, because one chain of dependent operations leaves the processor idle.
//!
//! [`Real::plus_product`] and [`Real::minus_product`] round once. All other operations are IEEE operations. So results are
//! bit-identical for every width. (Without AVX2, they use the fused product and sum of the mathematical library, with the
//! same bits but more slowly. A plain `f64` is not a lane and rounds twice.)
//!
//! Code that runs on [`Lanes`] must be inlined into the one function that is compiled for the instruction set. Mark it
//! `#[inline(always)]`, and avoid closures that the compiler might not inline. [`Real::outlined`] makes a separate function
//! from a large piece of code.

use super::registers::{Plain, Registers, Single};
#[cfg(target_arch = "x86_64")]
use super::x86::{Avx2, Avx512};
use super::{Local, LocalFunction, MOST_LANES, Outlined, Real, SimdReal, arc, array_of};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Numbers in SIMD registers.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<S: Registers> {
    pub(super) simd: S,
    pub(super) registers: S::Numbers,
}

/// A truth value for each lane of [`Lanes`].
#[derive(Clone, Copy, Debug)]
pub struct LaneMask<S: Registers> {
    pub(super) simd: S,
    pub(super) registers: S::Truths,
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl<S: Registers> $trait for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                S::$method(self, other)
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl<S: Registers> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        S::neg(self)
    }
}

impl<S: Registers> Real for Lanes<S> {
    const IN_REGISTERS: bool = true;
    const IS_LARGE: bool = true;

    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        S::mul_add(a, b, self)
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        S::negate_mul_add(a, b, self)
    }
    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        self.simd.splat(value)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        S::sqrt(self)
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
    #[inline(always)]
    fn outlined<P: Outlined>(&self, piece: P) -> P::Output {
        self.simd.outlined(piece)
    }
    #[inline(always)]
    fn outlined_as<P: Outlined>(like: &[Self], piece: P) -> P::Output {
        like[0].simd.outlined(piece)
    }
}

impl<S: Registers> Local for Lanes<S> {
    #[inline(always)]
    fn local<const N: usize, const K: usize>(
        arguments: [Self; N],
        function: &impl LocalFunction<N, K>,
    ) -> [Self; K] {
        let mut lanes = [[0.0; MOST_LANES]; N];
        for k in 0..N {
            arguments[k].store(&mut lanes[k]);
        }
        let mut values = [[0.0; MOST_LANES]; K];
        for lane in 0..<Self as SimdReal>::LANES {
            let at: [f64; N] = array_of(|k| lanes[k][lane]);
            let found = function.at(at);
            for k in 0..K {
                values[k][lane] = found[k];
            }
        }
        array_of(|k| arguments[0].load(&values[k]))
    }
}

impl<S: Registers> SimdReal for Lanes<S> {
    const LANES: usize = <S as Registers>::LANES;
    type Mask = LaneMask<S>;

    #[inline(always)]
    fn load(self, from: &[f64]) -> Self {
        self.simd.load(from)
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        S::store(self, to);
    }
    #[inline(always)]
    fn abs(self) -> Self {
        S::abs(self)
    }
    #[inline(always)]
    fn copysign(self, other: Self) -> Self {
        S::copysign(self, other)
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self::Mask {
        S::less(self, other)
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        S::select(mask, yes, no)
    }
    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        S::bits(mask) == (1 << <Self as SimdReal>::LANES) - 1
    }
    #[inline(always)]
    fn lane(mask: Self::Mask, lane: usize) -> bool {
        S::bits(mask) & (1 << lane) != 0
    }
}

macro_rules! logic {
    ($trait:ident, $method:ident, $simd_method:ident $(, $other:ident)?) => {
        impl<S: Registers> $trait for LaneMask<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self $(, $other: Self)?) -> Self {
                S::$simd_method(self $(, $other)?)
            }
        }
    };
}

logic!(BitAnd, bitand, and, other);
logic!(BitOr, bitor, or, other);
logic!(Not, not, not);

/// Number of values that one operation processes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Width {
    /// One value, with instructions that every processor has. On x86-64 this width is not compiled: without AVX2, the
    /// program solves each design alone. This is faster, and saves a third of the code for lanes. With `--cfg
    /// hardpoint_portable`, x86-64 has this width, too. Tests then check that this width and the other widths give
    /// bit-identical results.
    Portable,
    /// AVX2: registers of four values.
    Avx2,
    /// AVX-512: registers of eight values.
    Avx512,
}

impl Width {
    /// Widths that this processor has, narrowest first.
    pub fn available() -> impl DoubleEndedIterator<Item = Width> {
        [Width::Portable, Width::Avx2, Width::Avx512]
            .into_iter()
            .filter(|width| width.is_available())
    }

    /// Name of the width, for tables.
    pub fn name(self) -> &'static str {
        match self {
            Width::Portable => "portable",
            Width::Avx2 => "avx2",
            Width::Avx512 => "avx512",
        }
    }

    /// Returns true if this processor has the instructions.
    pub fn is_available(self) -> bool {
        match self {
            Width::Portable => cfg!(any(not(target_arch = "x86_64"), hardpoint_portable)),
            #[cfg(target_arch = "x86_64")]
            Width::Avx2 => Avx2::detect().is_some(),
            #[cfg(target_arch = "x86_64")]
            Width::Avx512 => Avx512::detect().is_some(),
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }

    /// Widest available width. `None` if this processor solves each design alone.
    pub fn widest() -> Option<Width> {
        Width::available().next_back()
    }

    /// Number of values that one operation of this width processes.
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

    /// Runs a task in lanes of this width. A processor without AVX-512 runs a task of that width in AVX2 lanes.
    ///
    /// # Panics
    /// If the processor has neither instruction set, or if this width is not compiled.
    pub fn run<T: SimdTask>(self, task: T) -> T::Output {
        #[cfg(target_arch = "x86_64")]
        if self == Width::Avx512
            && let Some(simd) = Avx512::detect()
        {
            return simd.outlined(Task(task, simd));
        }
        self.run_in_avx2_lanes(task)
    }

    /// Runs a task in lanes of this width, but uses AVX2 instead of AVX-512 lanes. The results are bit-identical. Use it
    /// for tasks that take long to compile and gain little from wider registers. Such a task must use the number of lanes
    /// of its number type, not [`Width::lanes`].
    ///
    /// # Panics
    /// If this width is not [`Width::Portable`] and the processor lacks AVX2, or if this width is not compiled.
    pub(crate) fn run_in_avx2_lanes<T: SimdTask>(self, task: T) -> T::Output {
        #[cfg(any(not(target_arch = "x86_64"), hardpoint_portable))]
        if self == Width::Portable {
            return task.run(Single(Plain).splat(0.0));
        }
        if self != Width::Portable
            && let Ok(output) = Width::run_in_avx2(task)
        {
            return output;
        }
        panic!("the processor has no lanes of width {}", self.name());
    }

    /// Runs a task in AVX2 lanes. If the processor lacks these instructions, returns the task without running it. The
    /// compiler compiles the task only for this width. Use it for tasks that take long to compile.
    pub fn run_in_avx2<T: SimdTask>(task: T) -> Result<T::Output, T> {
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = Avx2::detect() {
            return Ok(simd.outlined(Task(task, simd)));
        }
        Err(task)
    }
}

/// Runs a short task in AVX2 lanes, or on one value at a time on other processors. Both give bit-identical results.
pub(crate) fn run_short<T: SimdTask>(task: T) -> T::Output {
    Width::run_in_avx2(task).unwrap_or_else(|task| task.run(Single(Plain).splat(0.0)))
}

/// Runs a task on one value at a time. A processor with fused products and sums uses them. In lanes, the task gives
/// bit-identical results. AVX-512 has no advantage for one value, so the task is not compiled for it.
pub(crate) fn run_one<T: SimdTask>(task: T) -> T::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = Avx2::detect() {
        return simd.outlined(Task(task, Single(simd)));
    }
    task.run(Single(Plain).splat(0.0))
}

/// A task that runs in lanes.
pub trait SimdTask {
    /// Result of the task.
    type Output;
    /// Runs the task. `like` is a sample of the number type. Mark the function `#[inline(always)]`.
    fn run<B: SimdReal>(self, like: B) -> Self::Output;
}

struct Task<T, R>(T, R);

impl<T: SimdTask, R: Registers> Outlined for Task<T, R> {
    type Output = T::Output;
    #[inline(always)]
    fn work(self) -> T::Output {
        self.0.run(self.1.splat(0.0))
    }
}
