//! Designs with a closed form: one unknown, the tangent of half the angle of the lower arm.

mod corner;
#[cfg(test)]
mod guards;
mod pose;
mod wheel;

use super::pair::WheelOnKnuckle;
use super::{Acceptance, Rejection, Visit, within_half};
use crate::model::{Drive, Mechanism, SteeringAxis};
use crate::number::Jet;
use crate::number::SimdReal;
use crate::number::Vector3;
use crate::solve::closed_form::Members;
use crate::solve::closed_form::Roles;
use crate::solve::closed_form::{ArmState, Carrier, ClosedForm};
pub(super) use corner::ArmCorner;
pub(crate) use pose::ArmPose;
pub(super) use wheel::ArmWheel;

/// Equations of a mechanism with a closed form.
#[derive(Clone, Debug)]
pub(crate) struct ByArm {
    roles: Roles,
    /// Derivative of tan(angle/2) of the arm with respect to the drive, in the base design, near which the tracked designs
    /// lie.
    slope: f64,
    /// Largest accepted absolute value of the derivative of tan(angle/2) with respect to the drive.
    steepest: f64,
}

/// Constants of the designs, one design in each SIMD lane.
#[derive(Clone, Copy)]
pub(crate) struct ArmDesign<'d, B> {
    mechanism: &'d Mechanism,
    design: &'d [Vector3<B>],
    form: ClosedForm<B>,
    pub(crate) carrier: Carrier<B>,
}

impl<B: SimdReal> ArmDesign<'_, B> {
    /// Slope of the half tangent, tan(angle/2) of the arm, with respect to the travel.
    #[inline(always)]
    fn slope(&self, state: &ArmState<B>, tangent: B) -> B {
        let velocity = self.form.velocity(state, tangent);
        let half = tangent.constant(0.5);
        // The derivative of tan(angle/2) with respect to the angle is (1 + tangent^2)/2.
        velocity.arm_angle * half.plus_product(half, tangent * tangent) / velocity.rise
    }
}

/// Largest slope of the half tangent, tan(angle/2), with respect to the travel, in 1/size. An arm as long as the size has a slope
/// of one half. A larger slope means that a fold is near. Rounding errors of the pose grow with the slope. Rounding errors of rates
/// grow with the cube of the slope.
pub(crate) const STEEPEST: f64 = 3.0;
/// Largest rotation of the arm from the design position, as the tangent of half the angle.
pub(crate) const FARTHEST: f64 = 0.7;
/// Largest rotation of the arm in one step, as a change of the tangent of half the angle.
const LONGEST: f64 = 0.1;
/// Largest number of rounds of corrections in which the design of a SIMD lane must converge.
const MOST_ROUNDS: usize = 4;

impl ByArm {
    /// Prepares to solve designs of a mechanism with these roles in its closed form. `None` if designs near `base`
    /// cannot be tracked.
    pub(crate) fn of(
        roles: Roles,
        base: &[Vector3<f64>],
        drive: Drive,
        size: f64,
    ) -> Option<ByArm> {
        let (slope, steepest) = match drive {
            Drive::Travel => {
                let form = ClosedForm::new(&roles, base).map(Jet::<f64, 2>::constant);
                let state = form.at_half_tangent(Jet::variable(0.0), Jet::constant(0.0));
                (1.0 / form.travel(&state)[1], STEEPEST / size)
            }
            Drive::ArmAngle => (0.5, f64::INFINITY),
        };
        slope.is_finite().then_some(ByArm {
            roles,
            slope,
            steepest,
        })
    }

    /// Steering axis, which runs through the two joints.
    pub(crate) fn steering_axis(&self) -> SteeringAxis {
        let (lower, upper) = (self.roles.ball_joint(), self.roles.upper_end());
        SteeringAxis::Through { lower, upper }
    }

    #[inline(always)]
    pub(crate) fn design<'d, B: SimdReal>(
        &self,
        mechanism: &'d Mechanism,
        design: &'d [Vector3<B>],
    ) -> ArmDesign<'d, B> {
        let (form, carrier) = ClosedForm::with_carrier(&self.roles, design);
        ArmDesign {
            mechanism,
            design,
            form,
            carrier,
        }
    }

    /// Members of a design that carry forces.
    #[inline(always)]
    pub(crate) fn members<B: SimdReal>(&self, design: &ArmDesign<'_, B>) -> Members<B> {
        Members::of(&self.roles, &design.form, design.design)
    }

    /// Passes the poses to a visitor. `tangent` is the tangent of half the arm's angle in each pose.
    #[inline(always)]
    pub(crate) fn visit_stations_in_lanes<B: SimdReal>(
        &self,
        design: &ArmDesign<'_, B>,
        drive: Drive,
        tangent: B,
        rack: B,
        visit: impl FnOnce(&ArmPose<'_, B>),
    ) {
        let state = design.form.at_half_tangent(tangent, rack);
        visit(&ArmPose {
            roles: &self.roles,
            design,
            state,
            tangent,
            drive,
        });
    }

    /// Equations of a single wheel, for a design that this tracker has made.
    #[inline(always)]
    pub(super) fn corner<'w, 'd, B: SimdReal, V: Visit<B>>(
        &'w self,
        design: &'w ArmDesign<'d, B>,
        drive: Drive,
        tolerance: f64,
        visitor: &'w mut V,
    ) -> ArmCorner<'w, 'd, B, V> {
        let zero = design.form.like().zero();
        ArmCorner {
            method: self,
            design,
            drive,
            tolerance: zero.constant(tolerance),
            visitor,
            slope: zero,
            state: design.form.at_half_tangent(zero, zero),
            step: zero,
            missed: [zero; 2],
        }
    }

    /// Accepts lanes in which the closed form is well conditioned and the arm is on its solution branch. `inverse_step` is
    /// 1 divided by the change of the drive since the previous check. The caller passes `inverse_step` only on the legs of
    /// the route (up and down from the design position) that contain the stations. Returns the values for the next check.
    #[inline(always)]
    fn guard<B: SimdReal>(
        &self,
        design: &ArmDesign<'_, B>,
        drive: Drive,
        (state, tangent): (&ArmState<B>, B),
        before: &Option<BranchGuard<B>>,
        inverse_step: Option<B>,
        accepted: &mut Acceptance<B>,
    ) -> BranchGuard<B> {
        BranchGuard::check(state, tangent, accepted);
        if let (Some(before), Some(inverse_step)) = (before, inverse_step) {
            let guard = before.next(state, tangent, inverse_step);
            guard.check_slope(before, self.steepest, accepted);
            guard.check_step(before, accepted);
            return guard;
        }
        let rate = match drive {
            Drive::Travel => design.slope(state, tangent),
            Drive::ArmAngle => tangent.constant(self.slope),
        };
        let guard = BranchGuard::start(state, tangent, rate);
        guard.check_slope(&guard, self.steepest, accepted);
        if let Some(before) = before {
            guard.check_step(before, accepted);
        }
        guard
    }
}

/// Half tangent, slope and margin at a waypoint (a station or a point between stations). The checks compare them with their
/// values at the next waypoint.
#[derive(Clone, Copy)]
pub(super) struct BranchGuard<B> {
    tangent: B,
    /// Slope of the half tangent, tan(angle/2) of the arm, with respect to the drive over the last step.
    rate: B,
    /// Product of the three squares ([`ArmState::squares`]) and of the margin of the upper end. It vanishes with each
    /// divisor or radicand of the closed form.
    margin: B,
}

impl<B: SimdReal> BranchGuard<B> {
    /// Values for the checks at a waypoint at zero drive. `rate` is the slope of the half tangent in this design. Near a fold,
    /// `rate` differs much from the slope of the base design.
    #[inline(always)]
    fn start(state: &ArmState<B>, tangent: B, rate: B) -> Self {
        let [a, b, c] = state.squares();
        BranchGuard {
            tangent,
            rate,
            margin: (a.0 * (b.0 * c.0)) * state.upper_margin(),
        }
    }

    /// Values for the checks at the next waypoint on this leg of the route. The slope is the change of the half tangent divided by
    /// the step.
    #[inline(always)]
    fn next(&self, state: &ArmState<B>, tangent: B, inverse_step: B) -> Self {
        BranchGuard::start(state, tangent, (tangent - self.tangent) * inverse_step)
    }

    /// Accepts lanes in which the closed form is well conditioned. Rejects NaN.
    #[inline(always)]
    fn check(state: &ArmState<B>, tangent: B, accepted: &mut Acceptance<B>) {
        accepted.require(state.is_well_conditioned(), Rejection::IllConditioned);
        let is_near = tangent.abs().less(tangent.constant(FARTHEST));
        accepted.require(is_near, Rejection::TurnedFar);
    }

    /// Accepts lanes in which the slope of the arm, extrapolated to the next waypoint, is not too large.
    #[inline(always)]
    fn check_slope(&self, before: &Self, steepest: f64, accepted: &mut Acceptance<B>) {
        let ahead = self.rate + (self.rate - before.rate);
        let is_flat = ahead.abs().less(ahead.constant(steepest));
        accepted.require(is_flat, Rejection::FoldNear);
    }

    /// Accepts lanes in which the slope of the half tangent and the margin have changed little since the previous waypoint.
    /// Then neither could have vanished in between. Also limits the rotation of the arm in this step.
    #[inline(always)]
    fn check_step(&self, before: &Self, accepted: &mut Acceptance<B>) {
        let is_steady =
            within_half(self.rate, before.rate) & within_half(self.margin, before.margin);
        accepted.require(is_steady, Rejection::ChangedTooMuch);
        let step = (self.tangent - before.tangent).abs();
        let is_short = step.less(self.tangent.constant(LONGEST));
        accepted.require(is_short, Rejection::TurnedFar);
    }
}

impl ByArm {
    /// Equations of one wheel of a pair, for a design that this tracker has made.
    #[inline(always)]
    pub(super) fn wheel<'w, 'd, B: SimdReal>(
        &'w self,
        design: &'w ArmDesign<'d, B>,
        on_knuckle: WheelOnKnuckle<B>,
        tolerance: f64,
    ) -> ArmWheel<'w, 'd, B> {
        let zero = design.form.like().zero();
        ArmWheel {
            method: self,
            design,
            on_knuckle,
            tolerance,
            state: design.form.at_half_tangent(zero, zero),
            missed: zero,
            by_travel: zero,
        }
    }
}
