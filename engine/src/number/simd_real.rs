//! Independent numbers side by side, as in SIMD registers.

use super::{Local, Valued};
use std::ops::{BitAnd, BitOr, Not};

/// Largest number of lanes. No processor has more.
pub const MOST_LANES: usize = 16;

/// One or more independent numbers that undergo the same operations at the same time.
///
/// Every basic operation is the IEEE operation, lane by lane. So a lane's result is bit-identical for any neighbours and any
/// number of lanes in [`super::Lanes`]. A plain `f64` is also such a number, but rounds [`super::Real::plus_product`] twice.
/// Code that depends on the values must use [`SimdReal::select`].
pub trait SimdReal: Local + Valued<Plain = Self> {
    /// Count of numbers in the bundle.
    const LANES: usize;
    /// A truth value for each lane.
    type Mask: Copy
        + std::fmt::Debug
        + BitAnd<Output = Self::Mask>
        + BitOr<Output = Self::Mask>
        + Not<Output = Self::Mask>;

    /// Loads the first [`SimdReal::LANES`] numbers of a slice, with the type of `self`.
    fn load(self, from: &[f64]) -> Self;
    /// Writes the lanes to the beginning of a slice.
    fn store(self, to: &mut [f64]);
    /// The number in one lane.
    #[inline(always)]
    fn in_lane(self, lane: usize) -> f64 {
        let mut lanes = [0.0; MOST_LANES];
        self.store(&mut lanes);
        lanes[lane]
    }
    /// Absolute value.
    fn abs(self) -> Self;
    /// The magnitude of `self` with the sign of `other`.
    fn copysign(self, other: Self) -> Self;
    /// Lanes in which `self` is less than `other`; false for NaN.
    fn less(self, other: Self) -> Self::Mask;
    /// Mask that is set in every lane.
    #[inline(always)]
    fn everywhere(self) -> Self::Mask {
        self.zero().less(self.one())
    }
    /// Selects `yes` where the mask is set, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Returns true if the mask is set in every lane.
    fn all(mask: Self::Mask) -> bool;
    /// Returns true if the mask is set in at least one lane.
    #[inline(always)]
    fn any(mask: Self::Mask) -> bool {
        !Self::all(!mask)
    }
    /// Returns true if the mask is set in this lane.
    fn lane(mask: Self::Mask, lane: usize) -> bool;
    /// Returns the number, or NaN if it is not finite.
    #[inline(always)]
    fn finite(self) -> Self {
        let is_finite = self.abs().less(self.constant(f64::INFINITY));
        Self::select(is_finite, self, self.constant(f64::NAN))
    }
}

impl SimdReal for f64 {
    const LANES: usize = 1;
    type Mask = bool;

    #[inline(always)]
    fn load(self, from: &[f64]) -> Self {
        from[0]
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[0] = self;
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn copysign(self, other: Self) -> Self {
        f64::copysign(self, other)
    }
    #[inline(always)]
    fn less(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn all(mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn lane(mask: bool, _: usize) -> bool {
        mask
    }
}
