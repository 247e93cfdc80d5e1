//! Velocities in a pose of the closed form.
//!
//! All velocities share one factor, which depends on the variable of the derivatives. The program divides by this
//! factor last. As the arm rotates, the ball joint moves along its circle with r' and the upper end moves with d' + r'.
//! The image of the knuckle vector v = m + s u is d, so
//!
//! ```text
//! d' = w x d + s' u        w = (d x (d' - s' u))/|d|^2 + k d
//! ```
//!
//! where k is a rotation about the steering axis. The tie rod determines it. With t its outer end and l = t - g,
//!
//! ```text
//! l.(w x t) + l.r' = 0     k = -(l.r' + l.((w - k d) x t))/(l.(d x t)),   l.(d x t) = ga |n|^2
//! ```
//!
//! The part of d' that rotates d is normal to d. It is -r' plus the free motion of the upper end, along a vector f:
//!
//! ```text
//! d' - s' u = f (d.r')/(d.f) - r'
//! ```
//!
//! *Strut.* The mount is fixed, d' = -r', and the knuckle slides along its line: f = u, d.u = s. *Upper arm.* s' = 0, and
//! the joint moves along its own circle: f is the tangent there.

use super::circle::Circle;
use super::upper::Upper;
use super::{ArmState, Carried, ClosedForm};
use crate::number::Real;
use crate::number::Vector3;

/// Rates of a pose, all multiplied by the same unknown factor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Velocity<T> {
    /// Velocity of the lower ball joint.
    pub ball_joint: Vector3<T>,
    /// Angular velocity of the knuckle.
    pub turn: Vector3<T>,
    /// Rate of the vector along the steering axis.
    pub steering_axis: Vector3<T>,
    /// Vertical velocity of the wheel centre.
    pub rise: T,
    /// Angular rate of the arm.
    pub arm_angle: T,
}

impl<T: Real> Velocity<T> {
    /// Multiplies all rates by a factor.
    #[inline(always)]
    pub(crate) fn scaled(&self, factor: T) -> Self {
        Velocity {
            ball_joint: self.ball_joint * factor,
            turn: self.turn * factor,
            steering_axis: self.steering_axis * factor,
            rise: self.rise * factor,
            arm_angle: self.arm_angle * factor,
        }
    }
}

impl<T: Real> ClosedForm<T> {
    /// Rates of a state. `tangent` is the tangent of half the arm's angle in this state.
    #[inline(always)]
    pub(crate) fn velocity(&self, state: &ArmState<T>, tangent: T) -> Velocity<T> {
        let (d, g) = (state.d, state.g);
        let (free, lever) = self.upper.free(state, &self.line);
        let tie_rod_lever = state.ga * state.gram;
        let joint = self.ball_joint.velocity(tangent);

        // To avoid divisions, these vectors are multiplied by three factors. The factors are the lever of the upper end,
        // then also d.d, and finally the lever of the tie rod.
        let across = free * d.dot(joint) - joint * lever;
        let twofold = state.dd * lever;
        let joint_twofold = joint * twofold;
        let held = d.cross(across);
        let tie_rod_outer = state.tie_rod_outer();
        let needed = (tie_rod_outer - g).dot(joint_twofold + held.cross(tie_rod_outer));
        let turn = (held * tie_rod_lever).plus_scaled(d, -needed);
        let ball_joint = joint_twofold * tie_rod_lever;
        let wheel_centre = state.carry(&self.wheel_centre);
        let one = tangent.one();
        Velocity {
            ball_joint,
            turn,
            steering_axis: match self.upper {
                Upper::Strut { .. } => -ball_joint,
                Upper::Arm { .. } => across * (state.dd * tie_rod_lever),
            },
            rise: ball_joint
                .z
                .plus_product(turn.x, wheel_centre.y)
                .minus_product(turn.y, wheel_centre.x),
            arm_angle: twofold * tie_rod_lever * one.plus_product(tangent, tangent),
        }
    }

    /// Angular velocity of the knuckle and vertical velocity of the wheel centre per unit of rack displacement, with the
    /// arm fixed. The knuckle rotates by k about d, with l.(k d x t) = l.y. Here y is the direction of the rack.
    #[inline(always)]
    pub(crate) fn steered(&self, state: &ArmState<T>) -> (Vector3<T>, T) {
        let rod = state.tie_rod_outer() - state.g;
        let turn = state.d * (rod.y / (state.ga * state.gram));
        let wheel_centre = state.carry(&self.wheel_centre);
        let rise = (turn.x * wheel_centre.y).minus_product(turn.y, wheel_centre.x);
        (turn, rise)
    }
}

impl<T: Real> Circle<T> {
    /// Derivative of the joint's position with respect to the arm angle, times 1 + tangent^2.
    #[inline(always)]
    fn velocity(&self, tangent: T) -> Vector3<T> {
        self.turned * (tangent.one() - tangent * tangent) - self.radius * (tangent + tangent)
    }
}

impl<T: Real> Upper<T> {
    /// Vector f along which the upper end can move freely, and the product d.f.
    #[inline(always)]
    pub(crate) fn free(&self, state: &ArmState<T>, line: &Carried<T>) -> (Vector3<T>, T) {
        match self {
            Upper::Strut { .. } => (state.carry(line), state.slide),
            Upper::Arm { circle, .. } => {
                let normal = circle.radius.cross(circle.turned);
                let from_centre = state.ball_joint + state.d - circle.centre;
                let along_circle = normal.cross(from_centre);
                (along_circle, state.d.dot(along_circle))
            }
        }
    }
}
