//! Designs with a closed form: one unknown, the tangent of half the angle of the lower arm.

#[cfg(test)]
mod guards;

use super::pair::{Corrected, Linear, Wheel, WheelOnKnuckle};
use super::route::{Leg, RouteStep};
use super::track::{PlaceEquations, predicted, weighted};
use super::{
    Acceptance, AdjointConstants, InKnuckle, KnuckleVector, LaneAdjoint, LanePose, LaneRates,
    Rejection, Visit, within_half,
};
use crate::derive::Gradient;
use crate::mechanism::{Configuration, Twist, Wrench};
use crate::model::{Drive, Mechanism, SteeringAxis};
use crate::number::Jet;
use crate::number::SimdReal;
use crate::number::Vector3;
use crate::solve::closed_form::Roles;
use crate::solve::closed_form::{Adjoint, Members};
use crate::solve::closed_form::{ArmState, Carrier, ClosedForm};

/// Equations of a mechanism with a closed form.
#[derive(Clone, Debug)]
pub(crate) struct ByArm {
    roles: Roles,
    /// Slope of the half tangent by the drive, in the base design.
    slope: f64,
    /// Largest slope that is accepted.
    steepest: f64,
}

/// The constants of a design in each lane.
#[derive(Clone, Copy)]
pub(crate) struct ArmDesign<'d, B> {
    mechanism: &'d Mechanism,
    design: &'d [Vector3<B>],
    form: ClosedForm<B>,
    pub(crate) carrier: Carrier<B>,
}

impl<B: SimdReal> ArmDesign<'_, B> {
    /// Slope of the half tangent by the travel.
    #[inline(always)]
    fn slope(&self, state: &ArmState<B>, tangent: B) -> B {
        let velocity = self.form.velocity(state, tangent);
        let half = tangent.constant(0.5);
        // The derivative of tan(angle/2) by the angle is (1 + tangent^2)/2.
        velocity.arm_angle * half.plus_product(half, tangent * tangent) / velocity.rise
    }
}

/// A pose as a state of the closed form.
pub(crate) struct ArmPose<'f, B> {
    roles: &'f Roles,
    design: &'f ArmDesign<'f, B>,
    state: ArmState<B>,
    tangent: B,
    drive: Drive,
}

impl<B: SimdReal> LanePose<B> for ArmPose<'_, B> {
    #[inline(always)]
    fn vector(&self, vector: &KnuckleVector<B>) -> Vector3<B> {
        match &vector.0 {
            InKnuckle::Carried(vector) => self.state.carry(vector),
            InKnuckle::Designed(_) => unreachable!("a vector of a design with a closed form"),
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

    /// A rotation about the steering axis lifts the wheel. A motion along the travel cancels this lift.
    #[inline(always)]
    fn by_rack(&self, rates: &LaneRates<B>) -> Twist<B> {
        let (turn, rise) = self.design.form.steered(&self.state);
        let back = -rise;
        Twist {
            shift: rates.origin * back,
            turn: turn.plus_scaled(rates.turn, back),
        }
    }

    /// True in every lane. If travel is the drive, the guards have checked the slope of the arm. If the arm's angle is the
    /// drive, nothing rotates fast.
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

    #[inline(always)]
    fn adjoint<'p>(
        &'p self,
        members: &'p AdjointConstants<B>,
        at: &'p Configuration<'p, B>,
        rates: &LaneRates<B>,
    ) -> impl LaneAdjoint<B> + 'p {
        let AdjointConstants(Some(members)) = members else {
            unreachable!("the members of a design with a closed form")
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

/// Largest slope of the half tangent by travel, in 1/size. An arm as long as the size has a slope of one half. A larger
/// slope means that a fold is near. Rounding errors of the pose grow with the slope, those of rates with its cube.
pub(crate) const STEEPEST: f64 = 3.0;
/// Largest rotation of the arm, as the tangent of half the angle.
pub(crate) const FARTHEST: f64 = 0.7;
/// Largest rotation of the arm in one step, as a change of that tangent.
const LONGEST: f64 = 0.1;
/// Largest number of correction pairs for a lane to settle.
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

    /// Passes the poses at these half tangents to a visitor.
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

    /// Equations of a single wheel, for a design of this tracker.
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

    /// Accepts lanes in which the closed form is well conditioned and the arm is on its branch. `inverse_step` is the
    /// inverse of the change of the drive since the previous guard. It is given only on the legs of stations.
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

/// Equations of a single wheel.
pub(super) struct ArmCorner<'w, 'd, B, V> {
    method: &'w ByArm,
    design: &'w ArmDesign<'d, B>,
    drive: Drive,
    tolerance: B,
    visitor: &'w mut V,
    /// Derivative of the half tangent by the drive, which the corrections use.
    slope: B,
    /// Result of the last correction: new state, step taken, and travel error before and after it.
    state: ArmState<B>,
    step: B,
    missed: [B; 2],
}

impl<B: SimdReal, V: Visit<B>> PlaceEquations<B, 1> for ArmCorner<'_, '_, B, V> {
    const MOST_ROUNDS: usize = MOST_ROUNDS;
    type Guard = BranchGuard<B>;

    #[inline(always)]
    fn predict(&mut self, place: &RouteStep, history: &[B]) -> [B; 1] {
        let like = history[0];
        // The values of the previous place need not stay in registers.
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

    /// Makes two corrections at a time. One is always needed, and an unpredictable branch would cost more than the second.
    /// If the arm's angle is the drive, there is nothing to solve.
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

/// Numbers whose change along the path is guarded.
#[derive(Clone, Copy)]
pub(super) struct BranchGuard<B> {
    tangent: B,
    /// Slope of the half tangent by the drive over the last step.
    rate: B,
    /// Product of all numbers by which the closed form divides or whose root it takes.
    margin: B,
}

impl<B: SimdReal> BranchGuard<B> {
    /// Guard of a place at zero drive. `rate` is the design's own slope. Near a fold it differs much from that of the base
    /// design.
    #[inline(always)]
    fn start(state: &ArmState<B>, tangent: B, rate: B) -> Self {
        let [a, b, c] = state.squares();
        BranchGuard {
            tangent,
            rate,
            margin: (a.0 * (b.0 * c.0)) * state.upper_margin(),
        }
    }

    /// Guard of the next place on the leg. Its slope is the change of the tangent divided by the step.
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

    /// Accepts lanes in which the slope of the arm, extrapolated to the next place, is not too large.
    #[inline(always)]
    fn check_slope(&self, before: &Self, steepest: f64, accepted: &mut Acceptance<B>) {
        let ahead = self.rate + (self.rate - before.rate);
        let is_flat = ahead.abs().less(ahead.constant(steepest));
        accepted.require(is_flat, Rejection::FoldNear);
    }

    /// Accepts lanes in which slope and margin have changed so little since the previous place that neither could have
    /// vanished in between.
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

/// Equations of one wheel of a pair.
pub(super) struct ArmWheel<'w, 'd, B> {
    method: &'w ByArm,
    design: &'w ArmDesign<'d, B>,
    on_knuckle: WheelOnKnuckle<B>,
    tolerance: f64,
    /// State of the last linearisation or correction.
    state: ArmState<B>,
    /// Results of the last linearisation: the remaining error of travel, and the derivative of the unknown (the half-angle
    /// tangent) by travel.
    missed: B,
    by_travel: B,
}

impl ByArm {
    /// Equations of one wheel of a pair, for a design of this tracker.
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

impl<B: SimdReal> ArmWheel<'_, '_, B> {
    /// Wheel centre and spin axis in the state.
    #[inline(always)]
    fn carried(&self) -> (Vector3<B>, Vector3<B>) {
        let WheelOnKnuckle { centre, axis } = &self.on_knuckle;
        let (InKnuckle::Carried(centre), InKnuckle::Carried(axis)) = (&centre.0.0, &axis.0) else {
            unreachable!("a wheel of a design with a closed form")
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
        // The derivative of tan(angle/2) by the angle is (1 + tangent^2)/2.
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
