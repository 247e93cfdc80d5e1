//! Constraint that holds an arm at a given angle.
//!
//! a0 and a are the vectors from the axis to the outer joint, in the design position and in the present pose. e is the unit
//! axis, and r the radius of the outer joint about it:
//!
//! ```text
//! r^2 sin = e.(a0 x a),   r^2 cos = a.a0 - (a.e)(a0.e)                                (1)
//! F = (cos(wanted) r^2 sin - sin(wanted) r^2 cos)/r = r sin(angle - wanted)           (2)
//! ```
//!
//! A positive angle raises the outer joint, whatever the order of the axis points in the study.
//!
//! With c = cos(wanted)/r and s = sin(wanted)/r, both constant because they only scale the row, the derivatives are
//!
//! ```text
//! by a:   c (e x a0) - s (a0 - e (a0.e))                                              (3)
//! by a0:  c (a x e) - s (a - e (a.e))                                                 (4)
//! by e:   c (a0 x a) + s (a (a0.e) + a0 (a.e)), its part normal to e                  (5)
//! ```
//!
//! a and a0 start from the rear point of the axis. A move of the front point rotates e, so its derivative is (5) divided by
//! the length of the axis.

use crate::mechanism::Configuration;
use crate::mechanism::DEGENERATE;
use crate::mechanism::pose::Sink;
use crate::model::{Arm, PointId};
use crate::number::Real;
use crate::number::Vector3;

/// Required angle of the mechanism's first arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ArmAngle<T> {
    pub sine: T,
    pub cosine: T,
}

/// The two points of an arm's axis, in the order for which a positive rotation raises the outer joint.
#[inline]
pub(crate) fn axis_ends(arm: Arm, design: &[Vector3<f64>]) -> (PointId, PointId) {
    if sense(arm, design) > 0.0 {
        (arm.rear, arm.front)
    } else {
        (arm.front, arm.rear)
    }
}

/// Sign of the rotation: 1 if a positive rotation about the axis from rear to front raises the outer joint, else -1.
#[inline]
fn sense<T: Real>(arm: Arm, design: &[Vector3<T>]) -> T {
    way(arm, design).z.sign()
}

/// Direction in which the outer joint moves when the arm rotates about the axis from rear to front.
#[inline]
fn way<T: Real>(arm: Arm, design: &[Vector3<T>]) -> Vector3<T> {
    let rear = design[arm.rear.0];
    (design[arm.front.0] - rear).cross(design[arm.outer.0] - rear)
}

/// Returns true if the arm raises its outer joint in one direction of rotation and lowers it in the other. At dead centre
/// the joint first moves horizontally, so rounding would decide which direction is positive.
pub fn raises_its_joint(arm: Arm, design: &[Vector3<f64>]) -> bool {
    let way = way(arm, design);
    way.z.abs() > DEGENERATE * way.norm()
}

impl<T: Real> ArmAngle<T> {
    /// Residual of the constraint, as a length: F in equation (2) of this file.
    #[inline]
    pub(crate) fn residual(&self, at: &Configuration<T>) -> T {
        let arm = Turned::of(at);
        (self.cosine * arm.sine() - self.sine * arm.cosine()) * arm.inverse_radius
    }

    /// Adds `weight` times the derivatives of the residual, equations (3) to (5) of this file, to the sink.
    #[inline(always)]
    pub(crate) fn differential(&self, at: &Configuration<T>, weight: T, sink: &mut impl Sink<T>) {
        let arm = Turned::of(at);
        let (e, from, to) = (arm.axis, arm.designed, arm.now);
        let weight = weight * arm.inverse_radius;
        let (c, s) = (self.cosine * weight, self.sine * weight);
        let along = (e.dot(from), e.dot(to));
        let by_now = e.cross(from) * c - (from - e * along.0) * s;
        let by_designed = to.cross(e) * c - (to - e * along.1) * s;
        let by_axis = from.cross(to) * c + (to * along.0 + from * along.1) * s;
        let by_base = (by_axis - e * e.dot(by_axis)) * arm.inverse_base;
        let Arm { front, rear, outer } = at.mechanism.arms[0];
        at.push_point(outer, by_now, sink);
        sink.hardpoint(outer, by_designed);
        sink.hardpoint(rear, -(by_now + by_designed + by_base));
        sink.hardpoint(front, by_base);
    }
}

/// The first arm, in the design position and in the present pose, relative to its axis.
struct Turned<T> {
    /// Unit vector e of the arm's axis.
    axis: Vector3<T>,
    /// Vector a0 from the rear point of the axis to the outer joint, in the design position.
    designed: Vector3<T>,
    /// Vector a from the rear point of the axis to the outer joint, in the present pose.
    now: Vector3<T>,
    /// Inverse distance of the two points of the axis. Negative if the axis runs from front to rear.
    inverse_base: T,
    /// Inverse radius 1/r. Treated as constant, because it only scales the row.
    inverse_radius: T,
}

impl<T: Real> Turned<T> {
    #[inline]
    fn of(at: &Configuration<T>) -> Self {
        let arm = at.mechanism.arms[0];
        let rear = at.designed(arm.rear);
        let base = at.designed(arm.front) - rear;
        let inverse_base = sense(arm, at.design) / base.norm();
        let axis = base * inverse_base;
        let designed = at.designed(arm.outer) - rear;
        let radius = (designed - axis * axis.dot(designed)).norm();
        Turned {
            axis,
            designed,
            now: at.point(arm.outer) - rear,
            inverse_base,
            inverse_radius: radius.one() / radius,
        }
    }

    /// Product r^2 sin of equation (1).
    #[inline]
    fn sine(&self) -> T {
        self.axis.dot(self.designed.cross(self.now))
    }

    /// Product r^2 cos of equation (1).
    #[inline]
    fn cosine(&self) -> T {
        self.now.dot(self.designed) - self.now.dot(self.axis) * self.designed.dot(self.axis)
    }
}
