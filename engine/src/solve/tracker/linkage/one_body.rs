//! Equations of an axle whose wheels share one mechanism: a solid axle or a twist beam.
//!
//! The unknowns are the pose of the mechanism as seen from the left wheel, and half the difference of the travels, s. Both
//! wheels are on bodies of this mechanism, so their contact points follow from the same pose. With a fixed mean travel z,
//! the drive of the closure equations is s. Equations (1) and (2) of [`pair`](super::super::pair) become
//!
//! ```text
//! f(s) = h_l(z, s) - h_r(z, s) = 0,    f_s = h_l,s - h_r,s
//! ```
//!
//! As seen from the right wheel, the pose is its mirror image (see `mirrored.rs`). So no further equations have to be solved for
//! that wheel.
//!
//! A steering gear shifts the zero positions of both travels in the equations, by equations (4) and (5) of
//! `model/steered_axle.rs`. In the lead of a route, which begins in the design pose, this shift grows in proportion to the
//! completed fraction of the lead.

use super::super::pair::{AxleTracker, LEAST_RISE, MOST_ROUNDS, PairDrive, VisitPair};
use super::super::route::RouteStep;
use super::super::track::{PlaceEquations, kept, predicted};
use super::super::{Acceptance, Rejection};
use super::mirrored::MirroredPose;
use super::newton::{BranchGuard, NewtonSteps};
use super::{LinkageDesign, UNKNOWNS, moved};
use crate::mechanism::{BodyPlace, Configuration, Ground, MovingBody, Twist};
use crate::model::{Body, Mechanism, PointId, RockerId, mirrored};
use crate::number::{SimdReal, Vector3};

/// Unknowns of the pose, and half the difference of the travels.
pub(in crate::solve::tracker) const ALL: usize = UNKNOWNS + 1;

/// Largest number of further corrections with the same linearised equations. Each correction multiplies the remaining error by
/// about the error of the prediction. It takes a third of the time of a new linearisation.
const CHORDS: usize = 3;

/// Equations of an axle whose wheels share one mechanism.
pub(in crate::solve::tracker) struct OneBody<'w, 'd, B: SimdReal, V> {
    tracker: &'w AxleTracker<'w>,
    steps: NewtonSteps<'w, 'd, B>,
    right: &'w LinkageDesign<'d, B>,
    /// Left and right wheel in the left wheel's frame.
    wheels: [WheelOnBody<B>; 2],
    /// Mean travel and half the difference of travels that count as zero in the closure equations.
    rest: [B; 2],
    /// Largest permitted difference between the heights of the two contact points.
    level: B,
    visitor: &'w mut V,
    /// Ground at this waypoint, in the left wheel's frame.
    ground: Ground<B>,
    /// Lanes in which Newton's first correction of this waypoint's prediction was within its limit.
    is_near: B::Mask,
    /// Lanes in which both contact points rise fast enough with their wheels.
    rises: B::Mask,
}

/// A wheel of the axle in the design position, in the left wheel's frame.
#[derive(Clone, Copy)]
struct WheelOnBody<B> {
    /// Rocker that carries the wheel; `None` if the knuckle does.
    body: Option<RockerId>,
    centre: Vector3<B>,
    /// Unit vector along the spin axis.
    axis: Vector3<B>,
}

/// Rocker that carries a point; `None` for another body.
pub(super) fn rocker_of(mechanism: &Mechanism, id: PointId) -> Option<RockerId> {
    match mechanism.body(id) {
        Body::Rocker(rocker) => Some(rocker),
        _ => None,
    }
}

impl<B: SimdReal> WheelOnBody<B> {
    /// Wheel centre and spin axis, with their body in this position.
    #[inline(always)]
    fn placed(&self, place: &BodyPlace<B>) -> [Vector3<B>; 2] {
        [place.point(self.centre), place.rotation.apply(self.axis)]
    }
}

impl<'w, 'd, B: SimdReal, V> OneBody<'w, 'd, B, V> {
    /// Equations of designs of a tracker. `axes` are the spin axes of both wheels in the design position, each in the
    /// frame of its wheel.
    #[inline(always)]
    pub(in crate::solve::tracker) fn new(
        tracker: &'w AxleTracker<'w>,
        steps: NewtonSteps<'w, 'd, B>,
        right: &'w LinkageDesign<'d, B>,
        [left_axis, right_axis]: [Vector3<B>; 2],
        rest: [B; 2],
        level: B,
        visitor: &'w mut V,
    ) -> Self {
        let LinkageDesign {
            mechanism, design, ..
        } = *steps.linkage();
        let far = (mechanism.rigid_axle.as_ref()).map_or(mechanism.wheel_centre, |r| r.far_centre);
        let wheel = |id: PointId, axis: Vector3<B>| WheelOnBody {
            body: rocker_of(mechanism, id),
            centre: design[id.0],
            axis,
        };
        let wheels = [
            wheel(mechanism.wheel_centre, left_axis),
            wheel(far, mirrored(right_axis)),
        ];
        OneBody {
            tracker,
            right,
            wheels,
            rest,
            level,
            visitor,
            ground: Ground::level(level),
            is_near: level.everywhere(),
            rises: level.everywhere(),
            steps,
        }
    }

    /// Mean travel at a waypoint.
    #[inline(always)]
    fn mean(&self, place: &RouteStep) -> f64 {
        match self.tracker.drive {
            PairDrive::Heave => place.value,
            PairDrive::Roll { .. } => place.rack,
        }
    }

    /// Input values of the closure equations at a waypoint: first the fixed mean travel, then the value of the drive. `half` is
    /// half the difference of the travels.
    #[inline(always)]
    fn motion(&self, place: &RouteStep, half: B) -> [B; 2] {
        let [mean, difference] = self.rest;
        let lead = half.constant(place.lead);
        [
            half.constant(self.mean(place)).minus_product(mean, lead),
            half.minus_product(difference, lead),
        ]
    }

    /// Both wheels in a configuration, in the left wheel's frame.
    #[inline(always)]
    fn contacts(&self, at: &Configuration<'d, B>, radius: f64) -> [Contact<B>; 2] {
        let [left, right] = &self.wheels;
        let (ground, opposite) = (self.ground, self.ground.mirrored());
        let [left_centre, left_axis] = left.placed(&at.body_place(left.body));
        let [right_centre, right_axis] = right.placed(&at.body_place(right.body));
        [
            Contact {
                centre: left_centre,
                lever: ground.contact_lever(left_axis, radius),
            },
            Contact {
                centre: right_centre,
                lever: mirrored(opposite.contact_lever(mirrored(right_axis), radius)),
            },
        ]
    }

    /// Height of the left contact point above the right one.
    #[inline(always)]
    fn apart(&self, [left, right]: &[Contact<B>; 2]) -> B {
        let normal = self.ground.normal();
        normal.dot(left.centre + left.lever) - normal.dot(right.centre + right.lever)
    }

    /// Velocities of both contact points along the normal of the ground, in a motion of the knuckle.
    #[inline(always)]
    fn rises_in(
        &self,
        at: &Configuration<'d, B>,
        [left, right]: &[Contact<B>; 2],
        motion: &Twist<B>,
    ) -> [B; 2] {
        let normal = self.ground.normal();
        let [on_left, on_right] = &self.wheels;
        [
            normal.dot(left.velocity(&at.moving_body(on_left.body, motion))),
            normal.dot(right.velocity(&at.moving_body(on_right.body, motion))),
        ]
    }
}

/// A wheel on the ground, in the left wheel's frame.
#[derive(Clone, Copy)]
struct Contact<B> {
    centre: Vector3<B>,
    /// Vector from the wheel centre to the contact point.
    lever: Vector3<B>,
}

impl<B: SimdReal> Contact<B> {
    /// Velocity of the contact point, if the wheel does not rotate on its body.
    #[inline(always)]
    fn velocity(&self, body: &MovingBody<B>) -> Vector3<B> {
        body.velocity(self.centre + self.lever)
    }
}

/// Equations of a waypoint on one ground, linearised about a prediction.
struct OnGround<'d, B> {
    at: Configuration<'d, B>,
    contacts: [Contact<B>; 2],
    /// Derivative of the pose with respect to half the difference of the travels.
    by_travel: Twist<B>,
    /// Inverse of the derivative of the left contact point's height above the right one. The derivative is with respect to
    /// half the difference of the travels.
    inverse: B,
}

impl<B: SimdReal, V> OneBody<'_, '_, B, V> {
    /// Change of half the difference of the travels that brings both contact points to the same height. Their heights differ by
    /// `apart`, and the pose also changes by `twist`.
    #[inline(always)]
    fn levelling(&self, on: &OnGround<'_, B>, apart: B, twist: &Twist<B>) -> B {
        let [left, right] = self.rises_in(&on.at, &on.contacts, twist);
        -((apart + (left - right)) * on.inverse)
    }
}

/// Returns the six unknowns of the pose, and half the difference of the travels.
#[inline(always)]
fn parted<B: Copy>(&[a, b, c, d, e, f, half]: &[B; ALL]) -> ([B; UNKNOWNS], B) {
    ([a, b, c, d, e, f], half)
}

/// Inverse of [`parted`].
#[inline(always)]
fn joined<B: Copy>([a, b, c, d, e, f]: [B; UNKNOWNS], half: B) -> [B; ALL] {
    [a, b, c, d, e, f, half]
}

impl<B: SimdReal, V: VisitPair<B>> PlaceEquations<B, ALL> for OneBody<'_, '_, B, V> {
    const MOST_ROUNDS: usize = MOST_ROUNDS;
    const LEAVES_REJECTED: bool = true;
    type Guard = BranchGuard<B>;

    #[inline(always)]
    fn predict(&mut self, place: &RouteStep, history: &[B]) -> [B; ALL] {
        self.ground = self.tracker.ground(place, history[0]);
        let unknowns = predicted(place, history, [0.0; ALL]);
        let (along_mean, along_half) = match self.tracker.drive {
            PairDrive::Heave => (place.along_slope, 0.0),
            PairDrive::Roll { half_track, .. } => {
                (place.along_rack, -half_track * place.along_slope)
            }
        };
        if [along_mean, along_half, place.along_lead] == [0.0; 3] {
            return unknowns;
        }
        // The first steps use the slopes of the lane's own design at the previous waypoint. The last linearisation at
        // that waypoint is not used, because it depends on the number of corrections that neighbouring lanes needed.
        let (pose, half) = parted(&unknowns);
        let everywhere = half.everywhere();
        (self.steps).linearise(&pose, self.motion(place, half), everywhere);
        let [mean, difference] = self.rest;
        let lead = half.constant(place.along_lead);
        let by_mean = half.constant(along_mean).minus_product(mean, lead);
        let by_half = half.constant(along_half);
        let along = (self.steps).along(by_mean, by_half.minus_product(difference, lead));
        joined(moved(pose, &along), half + by_half)
    }

    #[inline(always)]
    fn correct(
        &mut self,
        place: &RouteStep,
        unknowns: &mut [B; ALL],
        settled: B::Mask,
        round: usize,
    ) -> B::Mask {
        let (mut pose, mut half) = parted(unknowns);
        let (at, rest) = (self.steps).linearise(&pose, self.motion(place, half), settled);
        if round == 1 {
            self.is_near = self.steps.is_near(&rest);
        }
        let on_ground = match self.tracker.radius() {
            None => None,
            Some(radius) => {
                let by_travel = self.steps.by_travel();
                let contacts = self.contacts(&at, radius);
                let [left, right] = self.rises_in(&at, &contacts, &by_travel);
                // In the difference of travels, the right wheel has the opposite sign.
                let least = half.constant(LEAST_RISE);
                let upward = least.less(left) & least.less(-right);
                self.rises = match round {
                    1 => upward,
                    _ => (self.rises & settled) | (upward & !settled),
                };
                Some(OnGround {
                    at,
                    contacts,
                    by_travel,
                    inverse: half.one() / (left - right),
                })
            }
        };
        let (mut twist, mut step) = (rest, half.zero());
        if let Some(on) = &on_ground {
            step = self.levelling(on, self.apart(&on.contacts), &twist);
        }
        let mut settled = settled;
        let mut chord = 0;
        loop {
            // A lane that has converged does not change.
            if let Some(on) = &on_ground {
                twist = Twist {
                    shift: twist.shift.plus_scaled(on.by_travel.shift, step),
                    turn: twist.turn.plus_scaled(on.by_travel.turn, step),
                };
                half = B::select(settled, half, half + step);
            }
            pose = kept(settled, pose, moved(pose, &twist));
            let motion = self.motion(place, half);
            let (at, mut is_settled, remaining) = self.steps.remaining(&pose, motion);
            twist = remaining;
            if let (Some(on), Some(radius)) = (&on_ground, self.tracker.radius()) {
                let apart = self.apart(&self.contacts(&at, radius));
                is_settled = is_settled & apart.abs().less(self.level);
                step = self.levelling(on, apart, &twist);
            }
            // Rates are accurate only with the last correction.
            let last = is_settled & !settled;
            pose = kept(last, moved(pose, &twist), pose);
            settled = settled | is_settled;
            if chord == CHORDS || B::all(settled) {
                break;
            }
            chord += 1;
        }
        *unknowns = joined(pose, half);
        settled
    }

    #[inline(always)]
    fn check(
        &mut self,
        _: &RouteStep,
        unknowns: &[B; ALL],
        before: &Option<Self::Guard>,
        accepted: &mut Acceptance<B>,
    ) -> Self::Guard {
        accepted.require(self.is_near, Rejection::ChangedTooMuch);
        accepted.require(self.rises, Rejection::FoldNear);
        let (pose, _) = parted(unknowns);
        self.steps.guard(&pose, before, accepted)
    }

    #[inline(always)]
    fn visit(
        &mut self,
        place: &RouteStep,
        station: usize,
        unknowns: &[B; ALL],
        accepted: Acceptance<B>,
    ) {
        let (pose, half) = parted(unknowns);
        let mean = half.constant(self.mean(place));
        let travels = [mean + half, mean - half];
        let stand = self.tracker.stand(place, self.ground, travels);
        let left = self.steps.pose(&pose, self.motion(place, half));
        let right = MirroredPose::of(&left, self.right);
        self.visitor.pair(station, &left, &right, stand, accepted);
    }
}
