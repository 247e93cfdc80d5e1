//! Scalar products of a vector that is fixed in the knuckle. From these products, the closed form computes the rotated
//! vector.

use crate::number::{Real, Vector3};

/// Scalar products of a knuckle vector x0 with m, u, t0, m x t0 and u x t0 (symbols as in module `closed_form`). They
/// determine the vector x into which a pose rotates x0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carried<T> {
    pub(super) by_m: T,
    pub(super) by_u: T,
    pub(super) by_t: T,
    pub(super) by_mt: T,
    pub(super) by_ut: T,
}

/// Makes the [`Carried`] vectors of one design.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carrier<T> {
    pub(super) m: Vector3<T>,
    pub(super) u: Vector3<T>,
    pub(super) tie: Vector3<T>,
    pub(super) foot_tie: Vector3<T>,
    pub(super) slide_tie: Vector3<T>,
}

impl<T: Real> Carrier<T> {
    /// Returns the products of a knuckle vector. The vector is given in the design position.
    #[inline(always)]
    pub(crate) fn carried(&self, x: Vector3<T>) -> Carried<T> {
        Carried {
            by_m: x.dot(self.m),
            by_u: x.dot(self.u),
            by_t: x.dot(self.tie),
            by_mt: x.dot(self.foot_tie),
            by_ut: x.dot(self.slide_tie),
        }
    }
}

impl<T: Real> Carried<T> {
    #[inline]
    pub(super) fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> Carried<U> {
        Carried {
            by_m: f(self.by_m),
            by_u: f(self.by_u),
            by_t: f(self.by_t),
            by_mt: f(self.by_mt),
            by_ut: f(self.by_ut),
        }
    }
}
