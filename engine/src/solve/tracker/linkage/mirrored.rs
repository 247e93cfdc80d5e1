//! Pose of an axle whose wheels share one mechanism, as seen from the right wheel.
//!
//! Let M be the reflection in the middle plane. Let a body have the rotation R and the angular velocity w. In the right
//! wheel's frame its rotation is M R M, and its angular velocity is -M w. Points and velocities are multiplied by M. In
//! the right wheel's frame, the difference of travels has the opposite sign, and the mean travel is the same.

use super::super::{KnuckleVector, LanePose, LaneRates};
use super::LinkageDesign;
use super::one_body::rocker_of;
use super::pose::{LinkagePose, from_configuration};
use crate::mechanism::{Configuration, Pose, Twist};
use crate::model::{RockerId, mirrored};
use crate::number::{Matrix3, Real, SimdReal, Vector3};

/// Mirror image of an angular velocity.
#[inline(always)]
fn mirrored_turn<T: Real>(turn: Vector3<T>) -> Vector3<T> {
    Vector3::new(-turn.x, turn.y, -turn.z)
}

/// A pose as seen from the right wheel.
pub(crate) struct MirroredPose<'p, 'd, B> {
    left: &'p LinkagePose<'p, 'd, B>,
    /// Rocker of the left wheel's mechanism that is the knuckle of the right wheel. `None` if the same knuckle carries both
    /// wheels.
    body: Option<RockerId>,
    at: Configuration<'d, B>,
}

impl<'p, 'd, B: SimdReal> MirroredPose<'p, 'd, B> {
    /// Mirrors a pose of the left wheel for this design of the right wheel.
    #[inline(always)]
    pub(super) fn of(left: &'p LinkagePose<'p, 'd, B>, right: &LinkageDesign<'d, B>) -> Self {
        let mechanism = left.at.mechanism;
        let own = right.mechanism.origin;
        let origin = (mechanism.rigid_axle.as_ref()).map_or(own, |rigid| rigid.partner(own));
        let body = rocker_of(mechanism, origin);
        let place = left.at.body_place(body);
        let [x, y, z] = place.rotation.columns;
        let pose = Pose {
            origin: mirrored(place.point(mirrored(right.design[own.0]))),
            rotation: Matrix3 {
                columns: [mirrored(x), -mirrored(y), mirrored(z)],
            },
        };
        MirroredPose {
            left,
            body,
            at: Configuration {
                mechanism: right.mechanism,
                design: right.design,
                pose,
                rack: left.at.rack,
                steering: None,
            },
        }
    }

    /// Converts a motion of the left wheel's knuckle into the motion of the right wheel's knuckle, in the right wheel's frame.
    #[inline(always)]
    fn mirrored_motion(&self, motion: &Twist<B>) -> Twist<B> {
        let body = self.left.at.moving_body(self.body, motion);
        Twist {
            shift: mirrored(body.velocity(mirrored(self.at.pose.origin))),
            turn: mirrored_turn(body.motion.turn),
        }
    }
}

impl<B: SimdReal> LanePose<B> for MirroredPose<'_, '_, B> {
    from_configuration!(B);

    #[inline(always)]
    fn steering_axis(&self) -> (Vector3<B>, Vector3<B>, B::Mask) {
        unreachable!("the axle has no instantaneous steering axis")
    }

    #[inline(always)]
    fn rates(&self) -> LaneRates<B> {
        LaneRates::of(-self.mirrored_motion(&self.left.rates().twist()))
    }

    #[inline(always)]
    fn by_rack(&self, rates: &LaneRates<B>) -> Twist<B> {
        self.mirrored_motion(&self.left.by_rack(rates))
    }

    #[inline(always)]
    fn velocity_is_reliable(&self, rates: &LaneRates<B>) -> B::Mask {
        self.left.velocity_is_reliable(rates)
    }

    #[inline(always)]
    fn steering_axis_rates(&self, _: &LaneRates<B>) -> (Vector3<B>, Vector3<B>) {
        unreachable!("the axle has no instantaneous steering axis")
    }
}
