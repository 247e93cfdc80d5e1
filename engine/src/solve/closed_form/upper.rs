//! Upper end of the steering axis: a strut's mount or an upper arm's ball joint.
//!
//! The lower ball joint r determines the vector d to the upper end, and the knuckle vector v = m + s u, whose image is d.
//!
//! *Strut.* u is the direction of the strut line in the knuckle. m is the vector from the ball joint to the foot of its
//! perpendicular on the line. The mount p is fixed: d = p - r, and |m + s u| = |d| gives the strut length s = sqrt(d.d -
//! m.m). No formula divides by |m|, so a ball joint on the strut axis is an ordinary case. At s = 0 the mount is at the
//! foot.
//!
//! *Upper arm.* v = m is the design value of d. The upper joint moves on a circle, c + a cos + b sin with
//! |a| = |b|, and keeps its distance from r. With q = c - r:
//!
//! ```text
//! A cos + B sin = C,   A = q.a, B = q.b, C = (m.m - q.q - a.a)/2
//! cos = (A C - B w)/H, sin = (B C + A w)/H,   H = A^2 + B^2, w^2 = H - C^2
//! ```
//!
//! w is B cos - A sin up to its sign. It is the lever by which the upper arm holds the knuckle. At w = 0, arm and steering
//! axis are in line, seen along the axis of the arm. The design, with cos = 1 and sin = 0, has w = -B.

use super::circle::Circle;
use super::roles::{Roles, UpperRoles};
use crate::number::Real;
use crate::number::Vector3;

/// Constants of the upper end in one design.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Upper<T> {
    Strut {
        top: Vector3<T>,
        /// Vector m from the ball joint to the foot on the strut line.
        foot: Vector3<T>,
        /// Unit vector u along the strut line.
        line: Vector3<T>,
        /// Product m.m: squared distance of the ball joint from the strut line.
        foot_squared: T,
        /// Inverse length 1/|d0|, with d0 the vector from ball joint to mount in the design position.
        scale: T,
    },
    Arm {
        circle: Circle<T>,
        /// Number (m.m - a.a)/2, with the distance |m| of the ball joints and the radius |a| of the upper joint's circle.
        half_difference: T,
        /// Sign of w, the lever by which the upper arm holds the knuckle.
        side: T,
        /// Scale 1/(|m| |a|), with the same lengths.
        scale: T,
    },
}

impl<T: Real> Upper<T> {
    /// Makes the constants of a design. Also returns the vector d from the ball joint to the upper end in the design
    /// position.
    #[inline(always)]
    pub(crate) fn new(roles: &Roles, design: &[Vector3<T>]) -> (Self, Vector3<T>) {
        let ball_joint = design[roles.lower_arm.outer.0];
        match roles.upper {
            UpperRoles::Strut { top, lower, upper } => {
                let to_top = design[top.0] - ball_joint;
                let line = (design[upper.unwrap_or(top).0] - design[lower.0]).normalised();
                let along = line.dot(to_top);
                let upward = along.sign();
                let (line, along) = (line * upward, along * upward);
                let foot = to_top - line * along;
                let strut = Upper::Strut {
                    top: design[top.0],
                    foot,
                    line,
                    foot_squared: foot.norm_squared(),
                    scale: along.one() / to_top.norm(),
                };
                (strut, to_top)
            }
            UpperRoles::Arm(arm) => {
                let circle = Circle::of(arm, design);
                let to_joint = design[arm.outer.0] - ball_joint;
                let (mm, aa) = (to_joint.norm_squared(), circle.radius.norm_squared());
                let lever = (circle.centre - ball_joint).dot(circle.turned);
                let arm = Upper::Arm {
                    circle,
                    half_difference: (mm - aa).scaled(0.5),
                    side: -lever.sign(),
                    scale: mm.one() / (mm * aa).sqrt(),
                };
                (arm, to_joint)
            }
        }
    }

    /// Vectors m and u, which give the knuckle vector v = m + s u to the upper end.
    #[inline(always)]
    pub(crate) fn knuckle_vector(&self, designed: Vector3<T>) -> (Vector3<T>, Vector3<T>) {
        match *self {
            Upper::Strut { foot, line, .. } => (foot, line),
            Upper::Arm { .. } => (designed, designed.zero()),
        }
    }

    /// Returns the vector d to the upper end, the strut length s and the margin of the upper end. At margin zero the upper end
    /// is at its limit. Beyond this limit, the margin is NaN, and also the strut length or the arm's d. `square`, if given, is
    /// a more accurate value of [`Upper::square`] than the joint's position gives.
    #[inline(always)]
    pub(crate) fn at(&self, ball_joint: Vector3<T>, square: Option<T>) -> (Vector3<T>, T, T) {
        let known = |own: T| square.map_or(own, |square| own.intersected_with(square));
        match self {
            Upper::Strut {
                top,
                foot_squared,
                scale,
                ..
            } => {
                let d = *top - ball_joint;
                let length = known(d.norm_squared() - *foot_squared).sqrt();
                (d, length, length * *scale)
            }
            Upper::Arm {
                circle,
                half_difference,
                side,
                scale,
            } => {
                let q = circle.centre - ball_joint;
                let (a, b) = (q.dot(circle.radius), q.dot(circle.turned));
                let c = *half_difference - q.norm_squared().scaled(0.5);
                let h = (a * a).plus_product(b, b);
                let lever = known(h.minus_product(c, c)).sqrt();
                let (w, inverse) = (*side * lever, h.one() / h);
                let cosine = (a * c).minus_product(b, w) * inverse;
                let sine = (b * c).plus_product(a, w) * inverse;
                let d = q
                    .plus_scaled(circle.radius, cosine)
                    .plus_scaled(circle.turned, sine);
                (d, c.zero(), lever * *scale)
            }
        }
    }

    /// Product d.d. For an upper arm, d.d also equals the constant a.a + 2 (m.m - a.a)/2. Interval numbers are
    /// intersected with this constant, which makes the interval narrower.
    #[inline(always)]
    pub(crate) fn length_squared(&self, d: Vector3<T>) -> T {
        match self {
            Upper::Strut { .. } => d.norm_squared(),
            Upper::Arm {
                circle,
                half_difference,
                ..
            } => d
                .norm_squared()
                .intersected_with(circle.radius.norm_squared() + half_difference.scaled(2.0)),
        }
    }

    /// Lever by which the upper end prevents the knuckle from rotating about the lower end: s for a strut, |d| w/(|m| |a|)
    /// for an arm.
    #[inline]
    pub(crate) fn lever(&self, state: &crate::solve::closed_form::ArmState<T>) -> T {
        match self {
            Upper::Strut { .. } => state.slide,
            Upper::Arm { .. } => state.upper_margin * state.dd.sqrt(),
        }
    }

    /// Number under the square root in the position of the upper end: the square of the strut's length, or of the arm's lever.
    pub(crate) fn square(&self, ball_joint: Vector3<T>) -> T {
        match self {
            Upper::Strut {
                top, foot_squared, ..
            } => (*top - ball_joint).norm_squared() - *foot_squared,
            Upper::Arm {
                circle,
                half_difference,
                ..
            } => {
                let q = circle.centre - ball_joint;
                let (a, b) = (q.dot(circle.radius), q.dot(circle.turned));
                let c = *half_difference - q.norm_squared().scaled(0.5);
                a * a + b * b - c * c
            }
        }
    }

    #[inline]
    pub(crate) fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> Upper<U> {
        match self {
            Upper::Strut {
                top,
                foot,
                line,
                foot_squared,
                scale,
            } => Upper::Strut {
                top: top.map(f),
                foot: foot.map(f),
                line: line.map(f),
                foot_squared: f(*foot_squared),
                scale: f(*scale),
            },
            Upper::Arm {
                circle,
                half_difference,
                side,
                scale,
            } => Upper::Arm {
                circle: circle.map(f),
                half_difference: f(*half_difference),
                side: f(*side),
                scale: f(*scale),
            },
        }
    }
}
