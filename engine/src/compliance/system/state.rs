//! Unknowns of a system of equations, and a step of these unknowns.

use super::super::algebra::Placed;
use super::super::limb::{LimbState, LimbStep};
use super::{MOST_JOINTS, MOST_LIMBS};
use crate::number::{Each, MaskOf, Valued};

/// Values of all unknowns.
#[derive(Clone, Copy, Debug)]
pub(in crate::compliance) struct State<T> {
    pub(in crate::compliance) carrier: Placed<T>,
    pub(in crate::compliance) limbs: [LimbState<T>; MOST_LIMBS],
    pub(in crate::compliance) joints: [T; MOST_JOINTS],
    /// Vertical force at the contact point that keeps the wheel at its height.
    pub(in crate::compliance) vertical: T,
}

impl<T: Valued> State<T> {
    #[inline(always)]
    pub(in crate::compliance) fn design(like: T) -> Self {
        State {
            carrier: Placed::design(like),
            limbs: [LimbState::design(like); MOST_LIMBS],
            joints: [like.zero(); MOST_JOINTS],
            vertical: like.zero(),
        }
    }

    #[inline(always)]
    pub(in crate::compliance) fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> State<U> {
        State {
            carrier: self.carrier.map(f),
            limbs: self.limbs.each_ref().each(|limb| limb.map(f)),
            joints: self.joints.each(f),
            vertical: f(self.vertical),
        }
    }
}

impl<T: Valued> State<T> {
    /// For each SIMD lane, selects `yes` if the lane is in the mask, else `no`.
    #[inline(always)]
    pub(in crate::compliance) fn choose(mask: MaskOf<T>, yes: &Self, no: &Self) -> Self {
        let mut chosen = *no;
        let one = |yes: T, no: T| T::choose(mask, yes, no);
        chosen.carrier = placed(mask, &yes.carrier, &no.carrier);
        for k in 0..MOST_LIMBS {
            let (yes, no) = (&yes.limbs[k], &no.limbs[k]);
            chosen.limbs[k] = LimbState {
                placed: placed(mask, &yes.placed, &no.placed),
                pivot: [
                    one(yes.pivot[0], no.pivot[0]),
                    one(yes.pivot[1], no.pivot[1]),
                ],
                slide: one(yes.slide, no.slide),
            };
        }
        for k in 0..MOST_JOINTS {
            chosen.joints[k] = one(yes.joints[k], no.joints[k]);
        }
        chosen.vertical = one(yes.vertical, no.vertical);
        chosen
    }
}

/// Selects a position for each SIMD lane.
#[inline(always)]
fn placed<T: Valued>(mask: MaskOf<T>, yes: &Placed<T>, no: &Placed<T>) -> Placed<T> {
    let number = |yes, no| T::choose(mask, yes, no);
    Placed {
        shift: yes.shift.zip(no.shift, number),
        turn: yes.turn.zip(no.turn, number),
    }
}

/// Change of all unknowns in a step, or their derivatives.
#[derive(Clone, Copy, Debug)]
pub(in crate::compliance) struct Step<T> {
    pub(in crate::compliance) carrier: [T; 6],
    pub(in crate::compliance) limbs: [LimbStep<T>; MOST_LIMBS],
    pub(in crate::compliance) joints: [T; MOST_JOINTS],
    pub(in crate::compliance) vertical: T,
}

impl<T: Valued> Step<T> {
    #[inline(always)]
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
