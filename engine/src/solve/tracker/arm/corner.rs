//! Equations of a single wheel in one unknown.

use super::super::route::{Leg, RouteStep};
use super::super::track::{PlaceEquations, predicted, weighted};
use super::super::{Acceptance, Visit};
use super::pose::ArmPose;
use super::{ArmDesign, BranchGuard, ByArm, MOST_ROUNDS};
use crate::model::Drive;
use crate::number::SimdReal;
use crate::solve::closed_form::ArmState;

/// Equations of a single wheel, with the tangent of half the arm's angle as the unknown.
pub(in crate::solve::tracker) struct ArmCorner<'w, 'd, B, V> {
    pub(super) method: &'w ByArm,
    pub(super) design: &'w ArmDesign<'d, B>,
    pub(super) drive: Drive,
    pub(super) tolerance: B,
    pub(super) visitor: &'w mut V,
    /// Derivative of the half-angle tangent with respect to the drive, for the corrections.
    pub(super) slope: B,
    /// State of the closed form after the last correction.
    pub(super) state: ArmState<B>,
    /// Change of the half-angle tangent in the last correction.
    pub(super) step: B,
    /// Travel minus the required travel, before and after the last correction.
    pub(super) missed: [B; 2],
}

impl<B: SimdReal, V: Visit<B>> PlaceEquations<B, 1> for ArmCorner<'_, '_, B, V> {
    const MOST_ROUNDS: usize = MOST_ROUNDS;
    type Guard = BranchGuard<B>;

    #[inline(always)]
    fn predict(&mut self, place: &RouteStep, history: &[B]) -> [B; 1] {
        let like = history[0];
        // This reset allows the compiler to remove the values of the previous waypoint from registers.
        (self.step, self.missed) = (like.zero(), [like.zero(); 2]);
        if self.drive == Drive::ArmAngle {
            return [like.constant((0.5 * place.value).tan())];
        }
        self.slope = match &place.slope {
            Some(stencil) => weighted::<1, _, B>(stencil, history, 0),
            None => like.constant(self.method.slope),
        };
        predicted(place, history, [self.method.slope * place.along_slope])
    }

    /// Makes one correction in the first round, and two in later rounds. A mispredicted branch of the processor would take
    /// longer than the second correction. If the arm's angle is the drive, no equation has to be solved.
    #[inline(always)]
    fn correct(
        &mut self,
        place: &RouteStep,
        [tangent]: &mut [B; 1],
        settled: B::Mask,
        round: usize,
    ) -> B::Mask {
        let form = &self.design.form;
        let (target, rack) = (tangent.constant(place.value), tangent.constant(place.rack));
        if round > 1 {
            let [before, after] = self.missed;
            self.slope = B::select(settled, self.slope, self.step / (after - before));
            *tangent = B::select(settled, *tangent, *tangent - after * self.slope);
        }
        let zero = tangent.zero();
        self.missed = [zero; 2];
        if self.drive == Drive::Travel {
            self.missed[0] = form.travel(&form.at_half_tangent(*tangent, rack)) - target;
        }
        self.step = B::select(settled, zero, -(self.missed[0] * self.slope));
        *tangent = *tangent + self.step;
        self.state = form.at_half_tangent(*tangent, rack);
        if self.drive == Drive::Travel {
            self.missed[1] = form.travel(&self.state) - target;
        }
        self.missed[1].abs().less(self.tolerance)
    }

    #[inline(always)]
    fn check(
        &mut self,
        place: &RouteStep,
        &[tangent]: &[B; 1],
        before: &Option<BranchGuard<B>>,
        accepted: &mut Acceptance<B>,
    ) -> BranchGuard<B> {
        let inverse_step = match place.leg {
            Leg::Rack => None,
            _ => Some(tangent.constant(1.0 / place.step)),
        };
        let at = (&self.state, tangent);
        (self.method).guard(self.design, self.drive, at, before, inverse_step, accepted)
    }

    #[inline(always)]
    fn visit(
        &mut self,
        _: &RouteStep,
        station: usize,
        &[tangent]: &[B; 1],
        accepted: Acceptance<B>,
    ) {
        let pose = ArmPose {
            roles: &self.method.roles,
            design: self.design,
            state: self.state,
            tangent,
            drive: self.drive,
        };
        self.visitor.pose(station, &pose, accepted);
    }
}
