//! Why a path turns back at a fold.
//!
//! It is read off the motion that is left there. Per unit speed of the arm's outer joint, the wheel centre
//! rises by three terms: with the outer joint, by the knuckle's swing about it as the joint above guides
//! it, and by steering about the steering axis, which the tie rod imposes. At a fold of the travel they
//! cancel; the cause is the term whose change along the path brings that about. Where the drive is the
//! arm or the rack, it is the part of the motion that is left when the drive stands still.

use super::continuation::{Curve, CurvePoint, Moving};
use crate::derive::rates::angular_velocity;
use crate::mechanism::LimitCause;
use crate::model::{ClosedForm, Drive, SteeringAxis};
use crate::number::Jet;

impl Curve<'_> {
    /// Why the path turns back at a fold.
    pub(crate) fn cause(&self, fold: &CurvePoint) -> LimitCause {
        let mechanism = self.mechanism;
        let pose = fold.series;
        let at = self.design_series.at(mechanism, pose, Jet::constant(0.0));
        let joint = pose.origin.map(Jet::differentiated);
        let turning = angular_velocity(&pose);
        let Some(SteeringAxis::Through { lower, upper }) = mechanism.steering_axis else {
            return LimitCause::DeadCentre;
        };
        let axis = (at.point(upper) - at.point(lower)).normalised();
        let steer = axis * axis.dot(turning);
        let swing = turning - steer;
        let lever = pose
            .rotation
            .apply(at.designed_lever(mechanism.wheel_centre));
        let by_steer = steer.cross(lever).z;
        let by_swing = swing.cross(lever).z;
        let speed = joint.norm();
        let travels = self.moving == Moving::Drive && self.held.drive == Drive::Travel;
        let [arm, swing, steer] = if travels && speed[0] > 0.0 {
            [joint.z, by_swing, by_steer].map(|term| (term / speed)[1].abs())
        } else {
            // A drive that stands still leaves the arm no part in it, unless it is the rack.
            [
                speed[0],
                swing.norm_squared()[0].sqrt() * self.size,
                steer.norm_squared()[0].sqrt() * self.size,
            ]
        };
        // Written so that terms that grow beyond all bounds, as at toggle itself, win.
        if steer.is_nan() || steer >= arm.max(swing) {
            LimitCause::TieRodToggle
        } else if swing > arm {
            match mechanism.closed_form {
                Some(ClosedForm::Strut) => LimitCause::StrutSquare,
                _ => LimitCause::UpperArmStraight,
            }
        } else {
            LimitCause::ArmVertical
        }
    }
}
