//! Pose of a mechanism, and the positions of all points in it.

use super::arm::{self, arm_point, arm_point_gradient};
use crate::model::{Arm, Body, Mechanism, PointId, RockerId};
use crate::number::{Matrix3, Outlined, Real, Vector3, outlined};
use std::ops::Neg;

/// Position and rotation of the knuckle, relative to the design position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<T> {
    /// Position of the knuckle's origin (a hardpoint, see [`Mechanism::origin`]).
    pub origin: Vector3<T>,
    /// Rotation from the design position.
    pub rotation: Matrix3<T>,
}

impl<T: Real> Pose<T> {
    /// Converts the pose to another number type.
    #[inline]
    pub fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> Pose<U> {
        Pose {
            origin: self.origin.map(f),
            rotation: self.rotation.map(f),
        }
    }

    /// Pose moved by a twist. `shift` displaces the origin. `rodrigues`, tan(angle/2) times the axis, rotates the
    /// knuckle about the origin.
    #[inline(always)]
    pub fn moved(&self, shift: Vector3<T>, rodrigues: Vector3<T>) -> Self {
        Pose {
            origin: self.origin + shift,
            rotation: self.rotation.turned(rodrigues),
        }
    }
}

/// A design in one pose.
#[derive(Clone, Copy)]
pub struct Configuration<'a, T> {
    /// Structure of the suspension.
    pub mechanism: &'a Mechanism,
    /// Design position of every point.
    pub design: &'a [Vector3<T>],
    /// Pose of the knuckle.
    pub pose: Pose<T>,
    /// Displacement of the rack, towards the kernel's +y. For a rigid axle, the travel that a constraint holds.
    pub rack: T,
    /// Velocity of the knuckle per unit of rack displacement, with the drive fixed. `Some` only if the mechanism has an
    /// instantaneous steering axis and a requested quantity needs this axis.
    pub steering: Option<Twist<T>>,
}

/// A velocity of the knuckle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twist<T> {
    /// Velocity of the knuckle's origin.
    pub shift: Vector3<T>,
    /// Angular velocity of the knuckle.
    pub turn: Vector3<T>,
}

impl<T: Real> Neg for Twist<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Twist {
            shift: -self.shift,
            turn: -self.turn,
        }
    }
}

impl<T> Twist<T> {
    /// Makes a twist from six components: first the velocity, then the angular velocity.
    #[inline(always)]
    pub(crate) fn from_array([x, y, z, a, b, c]: [T; 6]) -> Self {
        Twist {
            shift: Vector3::new(x, y, z),
            turn: Vector3::new(a, b, c),
        }
    }

    /// Six components of the twist: first the velocity, then the angular velocity.
    pub(crate) fn into_array(self) -> [T; 6] {
        let (v, w) = (self.shift, self.turn);
        [v.x, v.y, v.z, w.x, w.y, w.z]
    }
}

/// Collects the derivatives of a quantity with respect to the pose and to the hardpoints.
///
/// A derivative with respect to the pose is a wrench on the knuckle. The force is the derivative with respect to the position
/// of the knuckle's origin. The moment is the derivative with respect to the knuckle's rotation.
pub(crate) trait Sink<T> {
    /// Adds a wrench at the knuckle's origin.
    fn wrench(&mut self, force: Vector3<T>, moment: Vector3<T>);
    /// Adds a derivative with respect to a hardpoint at fixed pose.
    fn hardpoint(&mut self, id: PointId, gradient: Vector3<T>);
    /// Adds the quantity's derivative with respect to the displacement of the rack at fixed pose. A sink that does not need this
    /// derivative ignores it.
    #[inline]
    fn rack(&mut self, _gradient: T) {}
}

impl<T, S: Sink<T> + ?Sized> Sink<T> for &mut S {
    #[inline(always)]
    fn wrench(&mut self, force: Vector3<T>, moment: Vector3<T>) {
        S::wrench(self, force, moment);
    }
    #[inline(always)]
    fn hardpoint(&mut self, id: PointId, gradient: Vector3<T>) {
        S::hardpoint(self, id, gradient);
    }
    #[inline(always)]
    fn rack(&mut self, gradient: T) {
        S::rack(self, gradient);
    }
}

/// A wrench on the knuckle at its origin: a row of the Jacobian, or the derivative of an output with respect to the
/// pose. It includes the force along the rack, which is the derivative with respect to the rack's displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench<T> {
    /// Derivative with respect to the position of the knuckle's origin.
    pub force: Vector3<T>,
    /// Derivative with respect to the rotation of the knuckle.
    pub moment: Vector3<T>,
    /// Derivative with respect to the displacement of the rack.
    pub rack: T,
}

impl<T: Real> Wrench<T> {
    #[inline(always)]
    pub(crate) fn zero(like: T) -> Self {
        let zero = Vector3::new(like, like, like).zero();
        Wrench {
            force: zero,
            moment: zero,
            rack: zero.x,
        }
    }

    pub(crate) fn to_row(self) -> [T; 6] {
        let (f, m) = (self.force, self.moment);
        [f.x, f.y, f.z, m.x, m.y, m.z]
    }
}

impl<T: Real> Sink<T> for Wrench<T> {
    #[inline(always)]
    fn wrench(&mut self, force: Vector3<T>, moment: Vector3<T>) {
        self.force = self.force + force;
        self.moment = self.moment + moment;
    }
    #[inline(always)]
    fn hardpoint(&mut self, _: PointId, _: Vector3<T>) {}
    #[inline(always)]
    fn rack(&mut self, gradient: T) {
        self.rack = self.rack + gradient;
    }
}

impl<'a, T: Real> Configuration<'a, T> {
    /// Configuration of a design in a pose, without the velocity of steering (`steering` is `None`).
    #[inline(always)]
    pub fn new(mechanism: &'a Mechanism, design: &'a [Vector3<T>], pose: Pose<T>, rack: T) -> Self {
        Configuration {
            mechanism,
            design,
            pose,
            rack,
            steering: None,
        }
    }

    /// Design position of a point.
    #[inline(always)]
    pub fn designed(&self, id: PointId) -> Vector3<T> {
        self.design[id.0]
    }

    /// Vector from the knuckle's origin to a knuckle point, in the design position.
    #[inline(always)]
    pub fn designed_lever(&self, id: PointId) -> Vector3<T> {
        self.designed(id) - self.designed(self.mechanism.origin)
    }

    /// Present position of a point.
    #[inline(always)]
    pub fn point(&self, id: PointId) -> Vector3<T> {
        outlined!(
            [T: Real] self.rack; at: &'p Configuration<'p, T> = self, id: PointId = id => Vector3<T> { at.point_inline(id) }
        )
    }

    /// Present position of a point that is not on a rocker. This function is inlined, unlike [`Configuration::point`].
    #[inline(always)]
    pub(crate) fn place(&self, id: PointId) -> Vector3<T> {
        match self.mechanism.body(id) {
            Body::Chassis | Body::Rack | Body::Opposite(_) | Body::SteeringGear(_) => {
                self.grounded(id)
            }
            Body::StrutRod(top) => {
                let top = self.designed(top);
                top + self.pose.rotation.apply(self.designed(id) - top)
            }
            Body::Arm(arm) => self.on_arm(self.mechanism.arms[arm.0], id),
            Body::Knuckle | Body::Rocker(_) => self.carried(id),
        }
    }

    #[inline(always)]
    fn point_inline(&self, id: PointId) -> Vector3<T> {
        match self.mechanism.body(id) {
            Body::Rocker(rocker) => self.rocker_point(rocker, self.designed(id)),
            _ => self.place(id),
        }
    }

    /// Present position of a point of the chassis, the rack or the steering gear, or of a mount that moves opposite
    /// to a knuckle point.
    #[inline(always)]
    pub(crate) fn grounded(&self, id: PointId) -> Vector3<T> {
        let p = self.designed(id);
        match self.mechanism.body(id) {
            Body::Rack => Vector3::new(p.x, p.y + self.rack, p.z),
            Body::SteeringGear(place) => self.designed(place),
            Body::Opposite(other) => {
                // This is a function call instead of inlined code, because few points have the body `Opposite`.
                let moved = self.point(other).y - self.designed(other).y;
                Vector3::new(p.x, p.y - moved, p.z)
            }
            _ => p,
        }
    }

    /// Adds the derivative of `gradient . grounded(id)` to the sink.
    #[inline(always)]
    pub(crate) fn push_grounded(&self, id: PointId, gradient: Vector3<T>, sink: &mut impl Sink<T>) {
        let body = self.mechanism.body(id);
        if let Body::SteeringGear(place) = body {
            return sink.hardpoint(place, gradient);
        }
        sink.hardpoint(id, gradient);
        match body {
            Body::Rack => sink.rack(gradient.y),
            Body::Opposite(other) => {
                let zero = gradient.x.zero();
                let opposite = Vector3::new(zero, -gradient.y, zero);
                self.push_point(other, opposite, sink);
                sink.hardpoint(other, -opposite);
            }
            _ => {}
        }
    }

    /// The knuckle that carries the wheel, if this knuckle is a rocker of a steered axle. `None` if the mechanism's own
    /// knuckle carries the wheel.
    #[inline(always)]
    pub(crate) fn steered_knuckle(&self) -> Option<RockerId> {
        match self.mechanism.body(self.mechanism.wheel_centre) {
            Body::Rocker(knuckle) => Some(knuckle),
            _ => None,
        }
    }

    /// Rotation of the body that carries the wheel, from the design position.
    #[inline(always)]
    pub fn carrier_rotation(&self) -> Matrix3<T> {
        match self.steered_knuckle() {
            None => self.pose.rotation,
            Some(knuckle) => self.rocker_rotation(knuckle),
        }
    }

    /// Adds the derivative with respect to a rotation of the body that carries the wheel to the sink. `moment` is about the
    /// vehicle's axes.
    #[inline(always)]
    pub(crate) fn push_carrier_turn(&self, moment: Vector3<T>, sink: &mut impl Sink<T>) {
        match self.steered_knuckle() {
            None => sink.wrench(moment.zero(), moment),
            Some(knuckle) => self.push_rocker_turn(knuckle, moment, sink),
        }
    }

    /// Present position of the point of the knuckle that coincides with this point in the design position.
    #[inline(always)]
    pub(crate) fn carried(&self, id: PointId) -> Vector3<T> {
        if id == self.mechanism.origin {
            return self.pose.origin;
        }
        self.pose.origin + self.pose.rotation.apply(self.designed_lever(id))
    }

    /// Adds the derivative of `gradient . carried(id)` to the sink.
    #[inline(always)]
    pub(crate) fn push_carried(&self, id: PointId, gradient: Vector3<T>, sink: &mut impl Sink<T>) {
        if id == self.mechanism.origin {
            return sink.wrench(gradient, gradient.zero());
        }
        let in_knuckle = self.pose.rotation.apply_transposed(gradient);
        let lever = self.pose.rotation.apply(self.designed_lever(id));
        sink.wrench(gradient, lever.cross(gradient));
        sink.hardpoint(id, in_knuckle);
        sink.hardpoint(self.mechanism.origin, -in_knuckle);
    }

    /// Adds the derivative of `gradient . point(id)` to the sink.
    #[inline(always)]
    pub(crate) fn push_point(&self, id: PointId, gradient: Vector3<T>, sink: &mut impl Sink<T>) {
        if T::IN_REGISTERS {
            self.rack.outlined(PushingPoint {
                at: self,
                id,
                gradient,
                sink,
            })
        } else {
            self.push_point_outlined(id, gradient, sink)
        }
    }

    /// Implements [`Configuration::push_point`] as a separate function with a dynamic sink, so that it is compiled only once
    /// for each number type.
    #[inline(never)]
    fn push_point_outlined(&self, id: PointId, gradient: Vector3<T>, mut sink: &mut dyn Sink<T>) {
        self.push_point_inline(id, gradient, &mut sink);
    }

    #[inline(always)]
    fn push_point_inline(&self, id: PointId, gradient: Vector3<T>, sink: &mut impl Sink<T>) {
        match self.mechanism.body(id) {
            Body::Chassis | Body::Rack | Body::Opposite(_) | Body::SteeringGear(_) => {
                self.push_grounded(id, gradient, sink)
            }
            Body::Knuckle => self.push_carried(id, gradient, sink),
            Body::StrutRod(top) => {
                let in_knuckle = self.pose.rotation.apply_transposed(gradient);
                let lever = self.point(id) - self.designed(top);
                sink.wrench(gradient.zero(), lever.cross(gradient));
                sink.hardpoint(id, in_knuckle);
                sink.hardpoint(top, gradient - in_knuckle);
            }
            Body::Arm(arm) => self.push_arm_point(self.mechanism.arms[arm.0], id, gradient, sink),
            Body::Rocker(rocker) => {
                let by_point = self.push_rocker_point(rocker, self.designed(id), gradient, sink);
                sink.hardpoint(id, by_point);
            }
        }
    }

    /// Frame of unit vectors on an arm: its axis, the direction from the axis to the outer joint, and the normal of both.
    #[inline(always)]
    pub(crate) fn arm_frame(&self, arm: Arm) -> [Vector3<T>; 3] {
        let front = self.designed(arm.front);
        let axis = (self.designed(arm.rear) - front).normalised();
        let lever = (self.carried(arm.outer) - front).across(axis).normalised();
        [axis, lever, axis.cross(lever)]
    }

    /// Present position of a point of an arm. This is a separate function, because it is rarely used and large.
    #[inline(always)]
    fn on_arm(&self, arm: Arm, id: PointId) -> Vector3<T> {
        outlined!([T: Real] self.rack; inputs: arm::Inputs<T> = self.arm_inputs(arm, id) => Vector3<T> { arm_point(inputs) })
    }

    /// Adds the derivative of `gradient . on_arm(arm, id)` to the sink.
    #[inline(always)]
    fn push_arm_point(&self, arm: Arm, id: PointId, gradient: Vector3<T>, sink: &mut impl Sink<T>) {
        let by_outer = self.push_arm_hardpoints(arm, id, gradient, sink);
        self.push_carried(arm.outer, by_outer, sink);
    }

    /// Adds the derivatives of `gradient . on_arm(arm, id)` with respect to hardpoints to the sink. Here the present position
    /// of the arm's outer joint is fixed. Returns the derivative with respect to this position. A separate function,
    /// because it is rarely used and large.
    #[inline(always)]
    pub(crate) fn push_arm_hardpoints(
        &self,
        arm: Arm,
        id: PointId,
        gradient: Vector3<T>,
        sink: &mut impl Sink<T>,
    ) -> Vector3<T> {
        let by = outlined!(
            [T: Real] self.rack;
            inputs: arm::Inputs<T> = self.arm_inputs(arm, id), gradient: Vector3<T> = gradient
                => arm::Inputs<T> { arm_point_gradient(inputs, gradient) }
        );
        for (k, hardpoint) in [arm.front, arm.rear, arm.outer, id].iter().enumerate() {
            sink.hardpoint(*hardpoint, by[k]);
        }
        by[4]
    }

    /// Position and velocity of a point that is not on a rocker, from the velocity of the knuckle with the rack fixed. This
    /// version is for SIMD lanes.
    #[inline(always)]
    pub(crate) fn moving_below_rockers(&self, id: PointId, motion: &Twist<T>) -> [Vector3<T>; 2] {
        match self.mechanism.body(id) {
            Body::Knuckle => self.moving_carried(id, motion),
            Body::StrutRod(top) => {
                let lever = self
                    .pose
                    .rotation
                    .apply(self.designed(id) - self.designed(top));
                [self.designed(top) + lever, motion.turn.cross(lever)]
            }
            Body::Arm(arm) => {
                let arm = self.mechanism.arms[arm.0];
                outlined!(
                    [T: Real] self.rack;
                    at: &'p Configuration<'p, T> = self, arm: Arm = arm, id: PointId = id, motion: &'p Twist<T> = motion
                        => [Vector3<T>; 2] { at.moving_on_arm(arm, id, motion) }
                )
            }
            Body::Opposite(other) => {
                let [_, rate] = self.moving_carried(other, motion);
                let zero = rate.x.zero();
                [self.grounded(id), Vector3::new(zero, -rate.y, zero)]
            }
            Body::Chassis | Body::Rack | Body::SteeringGear(_) | Body::Rocker(_) => {
                let now = self.grounded(id);
                [now, now.zero()]
            }
        }
    }

    #[inline(always)]
    fn moving_on_arm(&self, arm: Arm, id: PointId, motion: &Twist<T>) -> [Vector3<T>; 2] {
        let now = arm_point(self.arm_inputs(arm, id));
        let front = self.designed(arm.front);
        let axis = self.designed(arm.rear) - front;
        let [outer, outer_rate] = self.moving_carried(arm.outer, motion);
        // The arm's angular velocity is w times the axis, and w axis x (outer - front) is the joint's velocity.
        let across = axis.cross(outer - front);
        let turn = across.dot(outer_rate) / across.norm_squared();
        [now, axis.cross(now - front) * turn]
    }

    #[inline(always)]
    fn moving_carried(&self, id: PointId, motion: &Twist<T>) -> [Vector3<T>; 2] {
        let now = self.carried(id);
        let rate = motion.shift + motion.turn.cross(now - self.pose.origin);
        [now, rate]
    }

    /// Inputs of [`arm_point`].
    #[inline(always)]
    fn arm_inputs(&self, arm: Arm, id: PointId) -> arm::Inputs<T> {
        [
            self.designed(arm.front),
            self.designed(arm.rear),
            self.designed(arm.outer),
            self.designed(id),
            self.carried(arm.outer),
        ]
    }
}

struct PushingPoint<'c, 'd, 's, T, S> {
    at: &'c Configuration<'d, T>,
    id: PointId,
    gradient: Vector3<T>,
    sink: &'s mut S,
}

impl<T: Real, S: Sink<T>> Outlined for PushingPoint<'_, '_, '_, T, S> {
    type Output = ();
    #[inline(always)]
    fn work(self) {
        self.at.push_point_inline(self.id, self.gradient, self.sink);
    }
}
