//! Equations of one wheel of a pair in six unknowns.

use super::super::pair::{Corrected, Linear as Motion, Wheel, WheelOnKnuckle};
use super::super::{Acceptance, LanePose};
use super::newton::{BranchGuard, NewtonSteps};
use super::{UNKNOWNS, moved};
use crate::mechanism::Twist;
use crate::number::{Matrix3, SimdReal, Vector3};

/// Equations of one wheel of a pair.
pub(in crate::solve::tracker) struct LinkageWheel<'w, 'd, B> {
    pub(super) steps: NewtonSteps<'w, 'd, B>,
    pub(super) on_knuckle: WheelOnKnuckle<B>,
    /// Displacement and rotation of the knuckle that were still missing to the required travel at the last linearisation.
    pub(super) rest: Twist<B>,
    /// Derivative of the pose with respect to travel, from the last linearisation.
    pub(super) by_travel: Twist<B>,
}

impl<B: SimdReal> LinkageWheel<'_, '_, B> {
    /// Wheel centre relative to the origin of the knuckle, and the spin axis.
    #[inline(always)]
    fn carried(&self, rotation: &Matrix3<B>) -> (Vector3<B>, Vector3<B>) {
        let WheelOnKnuckle { centre, axis } = &self.on_knuckle;
        (
            rotation.apply(centre.0.designed()),
            rotation.apply(axis.designed()),
        )
    }
}

impl<B: SimdReal> Wheel<B, UNKNOWNS> for LinkageWheel<'_, '_, B> {
    type Guard = BranchGuard<B>;

    #[inline(always)]
    fn slopes(&self) -> [[f64; UNKNOWNS]; 2] {
        [self.steps.method.by_travel, self.steps.method.by_rack]
    }

    #[inline(always)]
    fn linear(
        &mut self,
        unknowns: &[B; UNKNOWNS],
        rack: B,
        travel: B,
        settled: B::Mask,
    ) -> Motion<B> {
        let (at, rest) = self.steps.linearise(unknowns, [rack, travel], settled);
        let by_travel = self.steps.by_travel();
        let (lever, axis) = self.carried(&at.pose.rotation);
        (self.rest, self.by_travel) = (rest, by_travel);
        Motion {
            centre: at.pose.origin + lever,
            axis,
            rest: [rest.shift + rest.turn.cross(lever), rest.turn],
            rate: [
                by_travel.shift + by_travel.turn.cross(lever),
                by_travel.turn,
            ],
            is_near: self.steps.is_near(&rest),
        }
    }

    #[inline(always)]
    fn moved(&self, unknowns: &[B; UNKNOWNS], further: B) -> [B; UNKNOWNS] {
        let twist = Twist {
            shift: self.rest.shift.plus_scaled(self.by_travel.shift, further),
            turn: self.rest.turn.plus_scaled(self.by_travel.turn, further),
        };
        moved(*unknowns, &twist)
    }

    #[inline(always)]
    fn corrected(
        &mut self,
        unknowns: &[B; UNKNOWNS],
        rack: B,
        travel: B,
    ) -> Corrected<B, UNKNOWNS> {
        let (at, is_settled, unknowns) = self.steps.check_residual(unknowns, [rack, travel]);
        let (lever, axis) = self.carried(&at.pose.rotation);
        Corrected {
            is_settled,
            unknowns,
            centre: at.pose.origin + lever,
            axis,
        }
    }

    #[inline(always)]
    fn check(
        &self,
        unknowns: &[B; UNKNOWNS],
        before: &Option<BranchGuard<B>>,
        _: Option<B>,
        accepted: &mut Acceptance<B>,
    ) -> BranchGuard<B> {
        self.steps.guard(unknowns, before, accepted)
    }

    #[inline(always)]
    fn pose<'p>(&'p self, unknowns: &[B; UNKNOWNS], rack: B, travel: B) -> impl LanePose<B> + 'p {
        self.steps.pose(unknowns, [rack, travel])
    }
}
