//! Unknowns of a system, and a step in them.

use super::super::algebra::Placed;
use super::super::limb::{LimbState, LimbStep};
use super::{MOST_JOINTS, MOST_LIMBS};
use crate::number::{Each, Scalar};

/// State of all unknowns.
#[derive(Clone, Copy, Debug)]
pub(in crate::compliance) struct State<T> {
    pub(in crate::compliance) carrier: Placed<T>,
    pub(in crate::compliance) limbs: [LimbState<T>; MOST_LIMBS],
    pub(in crate::compliance) joints: [T; MOST_JOINTS],
    /// Vertical force at the contact point that holds the height.
    pub(in crate::compliance) vertical: T,
}

impl<T: Scalar> State<T> {
    #[inline]
    pub(in crate::compliance) fn design(like: T) -> Self {
        State {
            carrier: Placed::design(like),
            limbs: [LimbState::design(like); MOST_LIMBS],
            joints: [like.zero(); MOST_JOINTS],
            vertical: like.zero(),
        }
    }

    #[inline]
    pub(in crate::compliance) fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> State<U> {
        State {
            carrier: self.carrier.map(f),
            limbs: self.limbs.each_ref().each(|limb| limb.map(f)),
            joints: self.joints.each(f),
            vertical: f(self.vertical),
        }
    }
}

/// Change of all unknowns, or their rate.
#[derive(Clone, Copy, Debug)]
pub(in crate::compliance) struct Step<T> {
    pub(in crate::compliance) carrier: [T; 6],
    pub(in crate::compliance) limbs: [LimbStep<T>; MOST_LIMBS],
    pub(in crate::compliance) joints: [T; MOST_JOINTS],
    pub(in crate::compliance) vertical: T,
}

impl<T: Scalar> Step<T> {
    #[inline]
    pub(in crate::compliance) fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> Step<U> {
        Step {
            carrier: self.carrier.each(f),
            limbs: self.limbs.each_ref().each(|limb| LimbStep {
                inner: limb.inner.each(f),
                slide: f(limb.slide),
            }),
            joints: self.joints.each(f),
            vertical: f(self.vertical),
        }
    }
}
