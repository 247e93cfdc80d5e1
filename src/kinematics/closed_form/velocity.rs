//! Velocities in a pose of the closed form, by the drive.
//!
//! With the arm turning at a rate of its own, the ball joint moves along its circle with r' and the upper
//! end with d' + r'. The knuckle vector v = m + s u is carried onto d, so
//!
//! ```text
//! d' = w x d + s' u        w = (d x (d' - s' u))/|d|^2 + k d
//! ```
//!
//! up to a turn k about the steering axis, which the tie rod fixes: with t its outer end and l = t - g,
//!
//! ```text
//! l.(w x t) + l.r' = 0     k = -(l.r' + l.((w - k d) x t))/(l.(d x t)),   l.(d x t) = ga |n|^2
//! ```
//!
//! *Strut.* The mount is fixed: d' = -r', and |d|^2 = |m|^2 + s^2 gives s' = d.d'/s.
//! *Upper arm.* s' = 0; its joint moves along its own circle, and |d| is constant: d.(d' of the joint) = d.r'.

use super::circle::Circle;
use super::upper::Upper;
use super::{Carried, ClosedForm, State};
use crate::number::{Real, Vector3};

/// Derivatives of a pose by the drive.
#[derive(Clone, Copy, Debug)]
pub(in crate::kinematics) struct Velocity<T> {
    /// Of the lower ball joint.
    pub ball_joint: Vector3<T>,
    /// Angular velocity of the knuckle.
    pub turn: Vector3<T>,
    /// Of the vector along the steering axis.
    pub steering_axis: Vector3<T>,
    /// Of the height of the wheel centre.
    pub rise: T,
}

impl<T: Real> Velocity<T> {
    /// The same at another rate of the drive.
    #[inline(always)]
    pub(in crate::kinematics) fn scaled(&self, factor: T) -> Self {
        Velocity {
            ball_joint: self.ball_joint * factor,
            turn: self.turn * factor,
            steering_axis: self.steering_axis * factor,
            rise: self.rise * factor,
        }
    }
}

impl<T: Real> ClosedForm<T> {
    /// The derivatives of a state by the arm angle, times 1 + tangent^2.
    #[inline(always)]
    pub(in crate::kinematics) fn velocity(&self, state: &State<T>, tangent: T) -> Velocity<T> {
        let ball_joint = self.ball_joint.velocity(tangent);
        let (d, g, n) = (state.d, state.g, state.n);
        let (steering_axis, along_line) = self.upper.velocity(state, &self.line, ball_joint);
        let held = d.cross(steering_axis - along_line) * (d.x.one() / state.dd);
        let tie_rod_outer = d * state.al + g * state.be + n * state.ga;
        let tie_rod = tie_rod_outer - g;
        let needed = tie_rod.dot(ball_joint + held.cross(tie_rod_outer));
        let turn = held - d * (needed / (state.ga * state.gram));
        let wheel_centre = state.carry(&self.wheel_centre);
        Velocity {
            ball_joint,
            turn,
            steering_axis,
            rise: ball_joint.z + turn.x * wheel_centre.y - turn.y * wheel_centre.x,
        }
    }
}

impl<T: Real> Circle<T> {
    /// Derivative of the joint's position by the arm angle, times 1 + tangent^2.
    #[inline(always)]
    fn velocity(&self, tangent: T) -> Vector3<T> {
        self.turned * (tangent.one() - tangent * tangent) - self.radius * (tangent + tangent)
    }
}

impl<T: Real> Upper<T> {
    /// d' and s' u.
    #[inline(always)]
    fn velocity(
        &self,
        state: &State<T>,
        line: &Carried<T>,
        ball_joint: Vector3<T>,
    ) -> (Vector3<T>, Vector3<T>) {
        let d = state.d;
        match self {
            Upper::Strut { .. } => {
                let along = -(d.dot(ball_joint) / state.slide);
                (-ball_joint, state.carry(line) * along)
            }
            Upper::Arm { circle, .. } => {
                let normal = circle.radius.cross(circle.turned);
                let from_centre = state.ball_joint + d - circle.centre;
                let along_circle = normal.cross(from_centre);
                let rate = d.dot(ball_joint) / d.dot(along_circle);
                (along_circle * rate - ball_joint, d.zero())
            }
        }
    }
}
