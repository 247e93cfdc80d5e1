//! Equations of one wheel of a pair in one unknown.

use super::super::pair::{Corrected, Linear, Wheel, WheelOnKnuckle};
use super::super::{Acceptance, InKnuckle, LanePose};
use super::pose::ArmPose;
use super::{ArmDesign, BranchGuard, ByArm};
use crate::model::Drive;
use crate::number::{SimdReal, Vector3};
use crate::solve::closed_form::ArmState;

/// Equations of one wheel of a pair.
pub(in crate::solve::tracker) struct ArmWheel<'w, 'd, B> {
    pub(super) method: &'w ByArm,
    pub(super) design: &'w ArmDesign<'d, B>,
    pub(super) on_knuckle: WheelOnKnuckle<B>,
    pub(super) tolerance: f64,
    /// State of the closed form at the last linearisation or after the last correction.
    pub(super) state: ArmState<B>,
    /// Travel minus the required travel at the last linearisation.
    pub(super) missed: B,
    /// Derivative of the unknown (the half-angle tangent) with respect to travel, from the last linearisation.
    pub(super) by_travel: B,
}

impl<B: SimdReal> ArmWheel<'_, '_, B> {
    /// Wheel centre and spin axis in the state.
    #[inline(always)]
    fn carried(&self) -> (Vector3<B>, Vector3<B>) {
        let WheelOnKnuckle { centre, axis } = &self.on_knuckle;
        let (InKnuckle::Carried(centre), InKnuckle::Carried(axis)) = (&centre.0.0, &axis.0) else {
            unreachable!("the wheel has a closed form")
        };
        let from_joint = self.state.carry(centre);
        (self.state.ball_joint() + from_joint, self.state.carry(axis))
    }
}

impl<B: SimdReal> Wheel<B, 1> for ArmWheel<'_, '_, B> {
    type Guard = BranchGuard<B>;

    #[inline(always)]
    fn slopes(&self) -> [[f64; 1]; 2] {
        [[self.method.slope], [0.0]]
    }

    #[inline(always)]
    fn linear(&mut self, &[tangent]: &[B; 1], rack: B, travel: B, _: B::Mask) -> Linear<B> {
        let form = &self.design.form;
        self.state = form.at_half_tangent(tangent, rack);
        self.missed = form.travel(&self.state) - travel;
        let velocity = form.velocity(&self.state, tangent);
        let per_travel = tangent.one() / velocity.rise;
        let half = tangent.constant(0.5);
        // The derivative of tan(angle/2) with respect to the angle is (1 + tangent^2)/2.
        self.by_travel =
            velocity.arm_angle * half.plus_product(half, tangent * tangent) * per_travel;
        let (centre, axis) = self.carried();
        let turn = velocity.turn * per_travel;
        let lever = centre - self.state.ball_joint();
        let rate = velocity.ball_joint * per_travel + turn.cross(lever);
        Linear {
            centre,
            axis,
            rest: [-(rate * self.missed), -(turn * self.missed)],
            rate: [rate, turn],
            is_near: tangent.everywhere(),
        }
    }

    #[inline(always)]
    fn moved(&self, &[tangent]: &[B; 1], further: B) -> [B; 1] {
        [tangent.plus_product(self.by_travel, further - self.missed)]
    }

    #[inline(always)]
    fn corrected(&mut self, unknowns: &[B; 1], rack: B, travel: B) -> Corrected<B, 1> {
        let form = &self.design.form;
        self.state = form.at_half_tangent(unknowns[0], rack);
        let missed = form.travel(&self.state) - travel;
        let (centre, axis) = self.carried();
        Corrected {
            is_settled: missed.abs().less(missed.constant(self.tolerance)),
            unknowns: *unknowns,
            centre,
            axis,
        }
    }

    #[inline(always)]
    fn check(
        &self,
        &[tangent]: &[B; 1],
        before: &Option<BranchGuard<B>>,
        step: Option<B>,
        accepted: &mut Acceptance<B>,
    ) -> BranchGuard<B> {
        let inverse_step = step.map(
            #[inline(always)]
            |step| tangent.one() / step,
        );
        let at = (&self.state, tangent);
        (self.method).guard(
            self.design,
            Drive::Travel,
            at,
            before,
            inverse_step,
            accepted,
        )
    }

    #[inline(always)]
    fn pose<'p>(&'p self, &[tangent]: &[B; 1], _: B, _: B) -> impl LanePose<B> + 'p {
        ArmPose {
            roles: &self.method.roles,
            design: self.design,
            state: self.state,
            tangent,
            drive: Drive::Travel,
        }
    }
}
