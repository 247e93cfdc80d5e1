//! A link between an arm and the knuckle, or a second joint between them.
//!
//! The arm rotates about the line through its front point f along the unit vector e. Let o be its outer joint, and let r be
//! the component of o - f normal to e. A point of the arm is at
//!
//! ```text
//! P = f + a e + b r + c e x r                                               (1)
//! ```
//!
//! a, b and c are dimensions of the arm, so P is linear in the pose. With u_n the component of a vector u normal to e,
//!
//! ```text
//! dP = M do + ..,   M u = b u_n + c e x u,   M^T g = b g_n - c e x g        (2)
//! ```
//!
//! For a link, d runs from P to the outer end, and d0 is d in the design position. For a joint, p is the point of the
//! knuckle that coincides with P. n is one of two directions normal to the line from o to p in the design position:
//!
//! ```text
//! F = (d.d - d0.d0)/(2 |d0|),   g = d/|d0|          (link)                  (3)
//! F = n.(p - P),                g = n               (joint)                 (4)
//! ```
//!
//! For a unit multiplier, the force g acts at the outer end p, and h = -M^T g acts at o. With the levers l of p and k of o about
//! the knuckle's origin,
//!
//! ```text
//! dF = g.dp - g.dP + ..,   f = g + h,   m = l x g + k x h                   (5)
//! ```
//!
//! The two legs of the arm leave o only the rotation about the axis. With the two equations of a joint, the knuckle can
//! only rotate about the line from o to p in addition. For a design, equation (1) gives the same position as module `arm`.
//! Module `arm` gives the derivatives with respect to hardpoints.
//!
//! Rates along the motion (v, w). M is constant, since e is fixed in the body:
//!
//! ```text
//! l' = w x l,   k' = w x k,   d' = v + l' - M (v + k'),   h' = -M^T g'
//! f' = g' + h',   m' = l' x g + l x g' + k' x h + k x h'                    (6)
//! ```
//!
//! with g' = d'/|d0| for a link and g' = 0 for a joint.
//!
//! In a built arm, a, b and c follow from the lengths of the two built legs, and from the coordinates of the point in the
//! frame of the nominal arm. This frame has its origin at the outer joint. Its directions are along the axis, and from the
//! axis to the joint (7).

use super::link::{RodLength, push_hardpoints};
use super::normals;
use crate::mechanism::pose::Sink;
use crate::mechanism::{Configuration, Twist, Wrench};
use crate::model::{Arm, ArmId, Constraint, Mechanism, PointId};
use crate::number::{Real, Vector3, outlined};

/// Equation of a link or of a joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ArmEnd<T> {
    arm: ArmId,
    /// Point of the arm. For a joint, also the point of the knuckle.
    pub inner: PointId,
    pub outer: PointId,
    /// Dimensions a, b and c of the arm in equation (1).
    place: [T; 3],
    kind: Kind<T>,
}

#[derive(Clone, Copy, Debug)]
enum Kind<T> {
    /// Length |d0| of the link in the design position.
    Link(RodLength<T>),
    /// Direction n in which the joint holds the knuckle, normal to the line of both joints.
    Joint(Vector3<T>),
}

/// Dimensions of built parts: points of the body, positions of all points on the undisplaced knuckle, nominal positions of
/// all points, and a length for each constraint.
#[derive(Clone, Copy)]
pub(crate) struct PartDimensions<'a, T> {
    pub body: &'a [Vector3<T>],
    pub knuckle: &'a [Vector3<T>],
    pub drawn: &'a [Vector3<T>],
    pub lengths: &'a [T],
}

/// Unit vector of the arm's axis, and the vector from the axis to the outer joint, normal to the axis.
#[inline(always)]
fn frame<T: Real>(arm: Arm, design: &[Vector3<T>]) -> [Vector3<T>; 2] {
    let front = design[arm.front.0];
    let axis = (design[arm.rear.0] - front).normalised();
    [axis, (design[arm.outer.0] - front).across(axis)]
}

/// Dimensions a, b and c of an arm in equation (1), for a point of a design.
#[inline(always)]
pub(super) fn designed<T: Real>(
    mechanism: &Mechanism,
    arm: ArmId,
    point: PointId,
    design: &[Vector3<T>],
) -> [T; 3] {
    let arm = mechanism.arms[arm.0];
    let [axis, radius] = frame(arm, design);
    let from_front = design[point.0] - design[arm.front.0];
    let inverse = axis.x.one() / radius.norm_squared();
    [
        axis.dot(from_front),
        from_front.dot(radius) * inverse,
        from_front.dot(axis.cross(radius)) * inverse,
    ]
}

/// Dimensions a, b and c of a built arm, as in paragraph (7) of this file. `point` is the position of the point in the
/// nominal arm: the position of a built link's end, and the nominal position of a joint.
#[inline(always)]
pub(super) fn built<T: Real>(
    mechanism: &Mechanism,
    arm: ArmId,
    point: Vector3<T>,
    parts: PartDimensions<T>,
) -> [T; 3] {
    let arm = mechanism.arms[arm.0];
    let [axis, radius] = frame(arm, parts.drawn);
    let from_joint = point - parts.drawn[arm.outer.0];
    let along = radius.normalised();
    let leg = |inner: PointId| {
        let is_leg = |c: &Constraint| c.link() == Some((inner, arm.outer));
        let number = mechanism.constraints.iter().position(is_leg);
        parts.lengths[number.unwrap_or(0)].squared()
    };
    let (front, rear) = (leg(arm.front), leg(arm.rear));
    let base = (parts.body[arm.rear.0] - parts.body[arm.front.0]).norm();
    let reach = (front - rear + base.squared()) / (base + base);
    let inverse = axis.x.one() / (front - reach.squared()).sqrt();
    [
        reach + axis.dot(from_joint),
        axis.x.one() + from_joint.dot(along) * inverse,
        from_joint.dot(axis.cross(along)) * inverse,
    ]
}

/// Returns one of two directions n normal to the line from the arm's outer joint to its second joint `at` with the knuckle.
/// `number` selects the direction: 0 or 1.
#[inline(always)]
fn across<T: Real>(arm: Arm, at: PointId, points: &[Vector3<T>], number: usize) -> Vector3<T> {
    let line = (points[at.0] - points[arm.outer.0]).normalised();
    let [first, second] = normals(line, line.z.sign());
    match number {
        0 => first,
        _ => second,
    }
}

impl<T: Real> ArmEnd<T> {
    /// Makes the equation of a link, whose inner end has the dimensions `place`.
    #[inline(always)]
    pub(crate) fn link(
        arm: ArmId,
        [inner, outer]: [PointId; 2],
        place: [T; 3],
        length: RodLength<T>,
    ) -> Self {
        ArmEnd {
            arm,
            inner,
            outer,
            place,
            kind: Kind::Link(length),
        }
    }

    /// Makes one of the two equations of a joint with the dimensions `place`. `points` are the points of the design, or the
    /// nominal positions of built points.
    #[inline(always)]
    pub(crate) fn joint(
        mechanism: &Mechanism,
        arm: ArmId,
        at: PointId,
        number: usize,
        place: [T; 3],
        points: &[Vector3<T>],
    ) -> Self {
        ArmEnd {
            arm,
            inner: at,
            outer: at,
            place,
            kind: Kind::Joint(across(mechanism.arms[arm.0], at, points, number)),
        }
    }

    /// Outer joint of the arm.
    #[inline(always)]
    pub(crate) fn joint_of_arm(&self, at: &Configuration<T>) -> PointId {
        at.mechanism.arms[self.arm.0].outer
    }

    /// Position P of the point on the arm, equation (1). A separate function, because it is rarely used.
    #[inline(always)]
    fn on_arm(&self, at: &Configuration<T>) -> Vector3<T> {
        outlined!(
            [T: Real] at.rack; row: &'p ArmEnd<T> = self, at: &'p Configuration<'p, T> = at => Vector3<T> {
                row.on_arm_inline(at)
            }
        )
    }

    #[inline(always)]
    fn on_arm_inline(&self, at: &Configuration<T>) -> Vector3<T> {
        let arm = at.mechanism.arms[self.arm.0];
        let front = at.designed(arm.front);
        let axis = (at.designed(arm.rear) - front).normalised();
        let radius = (at.carried(arm.outer) - front).across(axis);
        let [a, b, c] = self.place;
        front + axis * a + radius * b + axis.cross(radius) * c
    }

    /// Force g at the outer end: equation (3) for a link, (4) for a joint.
    #[inline(always)]
    fn push(&self, at: &Configuration<T>) -> Vector3<T> {
        match self.kind {
            Kind::Link(length) => (at.carried(self.outer) - self.on_arm(at)) * length.scale,
            Kind::Joint(normal) => normal,
        }
    }

    /// Displacement M u of the point of the arm if the arm's outer joint moves by u, equation (2).
    #[inline(always)]
    fn moved(&self, axis: Vector3<T>, u: Vector3<T>) -> Vector3<T> {
        let [_, b, c] = self.place;
        u.across(axis) * b + axis.cross(u) * c
    }

    /// Force h at the arm's outer joint that is equivalent to a force -g at the point of the arm: -M^T g.
    #[inline(always)]
    fn passed(&self, axis: Vector3<T>, g: Vector3<T>) -> Vector3<T> {
        let [_, b, c] = self.place;
        axis.cross(g) * c - g.across(axis) * b
    }

    /// Forces g and h on the knuckle, at the outer end and at the arm's outer joint, for a unit multiplier.
    #[inline(always)]
    pub(crate) fn forces(&self, at: &Configuration<T>) -> [Vector3<T>; 2] {
        let [axis, _] = frame(at.mechanism.arms[self.arm.0], at.design);
        let push = self.push(at);
        [push, self.passed(axis, push)]
    }

    /// Residual of the constraint, as a length: F in equation (3) for a link, in (4) for a joint.
    #[inline(always)]
    pub(crate) fn residual(&self, at: &Configuration<T>) -> T {
        let d = at.carried(self.outer) - self.on_arm(at);
        match self.kind {
            Kind::Link(length) => length.residual(d),
            Kind::Joint(normal) => normal.dot(d),
        }
    }

    /// Adds the derivatives of the residual, equation (5), times `weight` to the sink. The derivatives with respect to hardpoints
    /// are valid only for the equation of a design, not for built parts.
    #[inline(always)]
    pub(crate) fn differential(&self, at: &Configuration<T>, weight: T, sink: &mut impl Sink<T>) {
        let push = self.push(at) * weight;
        at.push_carried(self.outer, push, sink);
        let arm = at.mechanism.arms[self.arm.0];
        at.push_arm_hardpoints(arm, self.inner, -push, sink);
        let [axis, _] = frame(arm, at.design);
        at.push_carried(arm.outer, self.passed(axis, push), sink);
        if let Kind::Link(length) = self.kind {
            push_hardpoints([self.inner, self.outer], at, length.scale * weight, sink);
        }
    }

    /// Rates of the constraint's force and moment along a motion of the knuckle, equation (6) of this file.
    #[inline(always)]
    pub(crate) fn wrench_rate(&self, at: &Configuration<T>, along: &Twist<T>) -> Wrench<T> {
        outlined!(
            [T: Real] at.rack;
            row: &'p ArmEnd<T> = self, at: &'p Configuration<'p, T> = at, along: &'p Twist<T> = along
                => Wrench<T> { row.wrench_rate_inline(at, along) }
        )
    }

    #[inline(always)]
    fn wrench_rate_inline(&self, at: &Configuration<T>, along: &Twist<T>) -> Wrench<T> {
        let arm = at.mechanism.arms[self.arm.0];
        let [axis, _] = frame(arm, at.design);
        let lever = |id| at.pose.rotation.apply(at.designed_lever(id));
        let (l, k) = (lever(self.outer), lever(arm.outer));
        let (l_rate, k_rate) = (along.turn.cross(l), along.turn.cross(k));
        let push = self.push(at);
        let push_rate = match self.kind {
            Kind::Link(length) => {
                let end = self.moved(axis, along.shift + k_rate);
                (along.shift + l_rate - end) * length.scale
            }
            Kind::Joint(normal) => normal.zero(),
        };
        let (passed, passed_rate) = (self.passed(axis, push), self.passed(axis, push_rate));
        Wrench {
            force: push_rate + passed_rate,
            moment: l_rate.cross(push)
                + l.cross(push_rate)
                + k_rate.cross(passed)
                + k.cross(passed_rate),
            rack: at.rack.zero(),
        }
    }
}
