//! Pose of a mechanism with a closed form, for one design in each SIMD lane.

use super::super::{
    AdjointConstants, AdjointPose, InKnuckle, KnuckleVector, LaneAdjoint, LanePose, LaneRates,
};
use super::ArmDesign;
use crate::derive::Gradient;
use crate::mechanism::{Configuration, Twist, Wrench};
use crate::model::Drive;
use crate::number::{SimdReal, Vector3};
use crate::solve::closed_form::{Adjoint, ArmState, Roles};

/// Pose of a mechanism that has a closed form. It is stored as an [`ArmState`], the numbers of the closed form at one arm angle.
pub(crate) struct ArmPose<'f, B> {
    pub(super) roles: &'f Roles,
    pub(super) design: &'f ArmDesign<'f, B>,
    pub(super) state: ArmState<B>,
    pub(super) tangent: B,
    pub(super) drive: Drive,
}

impl<B: SimdReal> LanePose<B> for ArmPose<'_, B> {
    #[inline(always)]
    fn vector(&self, vector: &KnuckleVector<B>) -> Vector3<B> {
        match &vector.0 {
            InKnuckle::Carried(vector) => self.state.carry(vector),
            InKnuckle::Designed(_) => unreachable!("designs with a closed form have this vector"),
        }
    }

    #[inline(always)]
    fn origin(&self) -> Vector3<B> {
        self.state.ball_joint()
    }

    #[inline(always)]
    fn steering_axis(&self) -> (Vector3<B>, Vector3<B>, B::Mask) {
        let state = &self.state;
        let everywhere = self.tangent.everywhere();
        (state.ball_joint(), state.steering_axis(), everywhere)
    }

    #[inline(always)]
    fn rates(&self) -> LaneRates<B> {
        let velocity = self.design.form.velocity(&self.state, self.tangent);
        let one = self.tangent.one();
        let velocity = velocity.scaled(match self.drive {
            Drive::Travel => one / velocity.rise,
            Drive::ArmAngle => one / velocity.arm_angle,
        });
        LaneRates {
            origin: velocity.ball_joint,
            turn: velocity.turn,
            steering_axis: velocity.steering_axis,
        }
    }

    /// A rotation about the steering axis lifts the wheel. If travel is the drive, adding a motion along the travel cancels this
    /// lift. If the arm's angle is the drive, the arm does not move.
    #[inline(always)]
    fn by_rack(&self, rates: &LaneRates<B>) -> Twist<B> {
        let (turn, rise) = self.design.form.steered(&self.state);
        let back = match self.drive {
            Drive::Travel => -rise,
            Drive::ArmAngle => rise.zero(),
        };
        Twist {
            shift: rates.origin * back,
            turn: turn.plus_scaled(rates.turn, back),
        }
    }

    /// Returns true in every lane. If travel is the drive, the checks have limited the slope of the arm. If the arm's angle is
    /// the drive, no part rotates fast.
    #[inline(always)]
    fn velocity_is_reliable(&self, _: &LaneRates<B>) -> B::Mask {
        self.tangent.everywhere()
    }

    #[inline(always)]
    fn steering_axis_rates(&self, rates: &LaneRates<B>) -> (Vector3<B>, Vector3<B>) {
        (rates.origin, rates.steering_axis)
    }

    #[inline(always)]
    fn configuration(&self, rack: B) -> Configuration<'_, B> {
        Configuration {
            mechanism: self.design.mechanism,
            design: self.design.design,
            pose: self.design.form.pose_by_two(&self.state),
            rack,
            steering: None,
        }
    }
}

impl<B: SimdReal> AdjointPose<B> for ArmPose<'_, B> {
    #[inline(always)]
    fn adjoint<'p>(
        &'p self,
        members: &'p AdjointConstants<B>,
        at: &'p Configuration<'p, B>,
        rates: &LaneRates<B>,
    ) -> impl LaneAdjoint<B> + 'p {
        let AdjointConstants(Some(members)) = members else {
            unreachable!("designs with a closed form have these members")
        };
        let (roles, form) = (self.roles, &self.design.form);
        Adjoint::of(
            roles,
            members,
            form,
            &self.state,
            at,
            rates.origin,
            rates.turn,
        )
    }
}

impl<B: SimdReal> LaneAdjoint<B> for Adjoint<'_, B> {
    #[inline(always)]
    fn subtract(&self, wrench: &Wrench<B>, gradient: &mut (impl Gradient<B> + ?Sized)) {
        Adjoint::subtract(self, wrench, gradient);
    }
}
