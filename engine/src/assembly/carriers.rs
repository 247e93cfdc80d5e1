//! Points in a build that are not on the knuckle: points of arms, rockers, struts and axles.
//!
//! A rocker of an independent wheel does not locate the knuckle, so its angle is computed after the knuckle's pose.
//! Rockers of a solid axle (Watt linkage, steered knuckles) locate the axle. The closure equations of such an axle use
//! positions of the rockers in which every rod has its built length. [`Assembler::turned`] computes these positions,
//! with the axle in its nominal pose. From these positions, the same equations as for designs give the angles of the
//! rockers in any pose of the axle.
//!
//! The mechanism of a twist beam belongs to one wheel, the near wheel. The half of the opposite wheel is the far half,
//! and it is such a rocker. Its axis is the hinge at the shear centre, which connects both halves. In a build the mounts
//! are points of the body. In the design, a point of the near arm ([`TwistBeam::eye`]) coincides with the mount of this
//! arm. The rubber lets both arms move sideways, by equal and opposite displacements relative to the mounts. Let Y_n and
//! Y_f be the sideways positions of the near and the far mount. Let y_n and y_f be the sideways positions of the arms at
//! these mounts:
//!
//! ```text
//! y_n - Y_n = -(y_f - Y_f),   so y_n + y_f = Y_n + Y_f                                         (1)
//! ```
//!
//! A sideways deviation of the near mount thus acts like the same deviation of the far mount ([`Parts::change`]).

use super::assembler::Assembler;
use super::assembly_error::AssemblyError;
use super::parts::Parts;
use crate::mechanism::{Pose, Turn, has_leverage};
use crate::model::{
    Body, Constraint, Point, PointId, Rocker, RockerId, SPINDLE_INNER, SpinAxis, Suspension,
    TwistBeam, mirrored,
};
use crate::number::{Each, Matrix3, Real, Vector3};
use std::borrow::Cow;

impl Assembler {
    /// Returns the parts of a solid axle with its rockers rotated. In the returned positions, every rod has its built
    /// length while the axle is in its nominal pose. The parts of a twist beam also get new lengths (`turn_far_half`).
    /// Parts of other suspensions are returned unchanged.
    pub(super) fn turned<'p, T: Real>(&self, parts: &'p Parts<T>) -> Cow<'p, Parts<T>> {
        let mut turned = Cow::Borrowed(parts);
        if self.suspension().mechanism.rigid_axle.is_some() {
            self.turn_rockers(turned.to_mut());
        }
        turned
    }

    /// Rotates the rockers of these parts. Unlike [`Assembler::turned`], the function changes the parts and makes no copy.
    #[inline(always)]
    pub(super) fn turn_rockers<T: Real>(&self, parts: &mut Parts<T>) {
        let mechanism = &self.suspension().mechanism;
        let Some(rigid) = &mechanism.rigid_axle else {
            return;
        };
        if let Some(beam) = &rigid.twist_beam {
            return self.turn_far_half(beam, parts);
        }
        if let Some(steering) = &rigid.steering {
            parts.points[steering.place.0] = parts.points[steering.end.0];
        }
        for (number, rocker) in mechanism.rockers.iter().enumerate() {
            let length = parts.lengths[mechanism.constraints.len() + number];
            let outer = parts.points[rocker.outer.0];
            let built = BuiltRocker::of(rocker, parts, length, outer);
            for (i, point) in parts.points.iter_mut().enumerate() {
                if mechanism.body(PointId(i)) == Body::Rocker(RockerId(number)) {
                    *point = built.place(*point);
                }
            }
        }
    }

    /// Rotates the far half (the half of the opposite wheel) about the hinge of a twist beam. The near half is in its
    /// nominal pose. Then the mount of the far half is as near to its position on the body as the hinge allows. The far
    /// half keeps its shape, so the distances between this mount and the points of the hinge stay the same.
    #[inline(always)]
    fn turn_far_half<T: Real>(&self, beam: &TwistBeam, parts: &mut Parts<T>) {
        let mechanism = &self.suspension().mechanism;
        let mount = parts.drawn[beam.far_mount.0];
        for (number, constraint) in mechanism.constraints.iter().enumerate() {
            if let Constraint::Link { outer, .. } = constraint {
                parts.lengths[number] = (parts.points[outer.0] - mount).norm();
            }
        }
        let ends = [beam.shear_centre, beam.hinge, beam.rod_end, beam.far_mount];
        let [first, second, inner, now] = ends.each(|id| parts.points[id.0]);
        let turn = Turn::of([first, second, inner, mount, now]);
        for (i, point) in parts.points.iter_mut().enumerate() {
            if let Body::Rocker(_) = mechanism.body(PointId(i)) {
                *point = turn.moved(*point);
            }
        }
    }

    /// Returns an error that names a rod of a solid axle if this rod is too short or too long. `parts` must come from
    /// [`Assembler::turned`].
    pub(super) fn check_turned(&self, parts: &Parts<f64>) -> Result<(), AssemblyError> {
        let mechanism = &self.suspension().mechanism;
        if mechanism.rigid_axle.is_none() {
            return Ok(());
        }
        let is_known = |rocker: &&Rocker| parts.points[rocker.inner.0].norm().is_finite();
        match mechanism.rockers.iter().find(|rocker| !is_known(rocker)) {
            None => Ok(()),
            Some(rocker) => Err(AssemblyError::Rod(rocker.rod)),
        }
    }

    /// Writes the built design: positions of all points of parts that are assembled in a pose of the carrier. For a solid
    /// axle, `parts` must come from [`Assembler::turned`].
    #[inline(always)]
    pub(crate) fn place<T: Real>(&self, parts: &Parts<T>, pose: &Pose<T>, into: &mut [Vector3<T>]) {
        let mechanism = &self.suspension().mechanism;
        let drawn = |id: PointId| parts.drawn[id.0];
        let at = self.configuration(parts, pose);
        for (i, (place, &point)) in into.iter_mut().zip(&parts.points).enumerate() {
            let id = PointId(i);
            *place = match mechanism.body(id) {
                Body::Chassis | Body::Rack | Body::SteeringGear(_) => point,
                Body::Opposite(_) => at.grounded(id),
                Body::Rocker(_) if mechanism.rigid_axle.is_some() => at.point(id),
                Body::Rocker(_) => point,
                Body::Knuckle => at.carried(id),
                Body::StrutRod(top) => {
                    parts.points[top.0] + pose.rotation.apply(point - drawn(top))
                }
                Body::Arm(number) => {
                    let arm = mechanism.arms[number.0];
                    let from = ArmFrame::of(drawn(arm.front), drawn(arm.rear), drawn(arm.outer));
                    let [front, rear] = [parts.points[arm.front.0], parts.points[arm.rear.0]];
                    let to = ArmFrame::of(front, rear, at.carried(arm.outer));
                    to.place(from.read(point))
                }
            };
        }
        if let Some(rigid) = &mechanism.rigid_axle {
            if let Some(steering) = &rigid.steering {
                steering.displace(into[0].x.zero(), into);
            }
            // The rubber at the mount of a twist beam moves sideways with the arm.
            if let Some((beam, eye)) = rigid.twist_beam.and_then(|beam| Some((beam, beam.eye?))) {
                into[beam.mount.0] = into[eye.0];
            }
            return;
        }
        for (number, rocker) in mechanism.rockers.iter().enumerate() {
            let length = parts.lengths[mechanism.constraints.len() + number];
            let built = BuiltRocker::of(rocker, parts, length, into[rocker.outer.0]);
            for (i, (place, &point)) in into.iter_mut().zip(&parts.points).enumerate() {
                if mechanism.body(PointId(i)) == Body::Rocker(RockerId(number)) {
                    *place = built.place(point);
                }
            }
        }
    }

    /// Returns an error that names a rod if this rod is too short or too long, or at a toggle.
    pub(super) fn check_rods(&self, built: &[Vector3<f64>]) -> Result<(), AssemblyError> {
        for rocker in &self.suspension().mechanism.rockers {
            let inner = built[rocker.inner.0];
            if !(inner.x + inner.y + inner.z).is_finite() || !has_leverage(rocker, built) {
                return Err(AssemblyError::Rod(rocker.rod));
            }
        }
        Ok(())
    }
}

/// A rocker of a build, at the angle that the length of its rod requires.
struct BuiltRocker<T> {
    first: Vector3<T>,
    drawn_first: Vector3<T>,
    tilt: Tilt<T>,
    turn: Turn<T>,
}

impl<T: Real> BuiltRocker<T> {
    /// Makes a rocker whose rod has this length. `outer_now` is the other end of the rod.
    #[inline(always)]
    fn of(rocker: &Rocker, parts: &Parts<T>, length: T, outer_now: Vector3<T>) -> Self {
        let drawn = |id: PointId| parts.drawn[id.0];
        let (first, second) = (parts.points[rocker.first.0], parts.points[rocker.second.0]);
        let drawn_first = drawn(rocker.first);
        let tilt = Tilt::between(drawn(rocker.second) - drawn_first, second - first);
        let inner = first + tilt.apply(parts.points[rocker.inner.0] - drawn_first);
        let along = tilt.apply((drawn(rocker.outer) - drawn(rocker.inner)).normalised());
        let outer = inner + along * length;
        // The built length of the rod determines the rotation of the rocker.
        let turn = Turn::of([first, second, inner, outer, outer_now]);
        BuiltRocker {
            first,
            drawn_first,
            tilt,
            turn,
        }
    }

    /// Returns the position of a point of the rocker after the rotation. `point` is its position in the undisplaced part.
    #[inline(always)]
    fn place(&self, point: Vector3<T>) -> Vector3<T> {
        self.turn
            .moved(self.first + self.tilt.apply(point - self.drawn_first))
    }
}

/// Frame of an arm. The origin is the outer joint. The axes are the direction of the arm's axis and the direction from
/// this axis to the joint.
struct ArmFrame<T> {
    origin: Vector3<T>,
    axes: Matrix3<T>,
}

impl<T: Real> ArmFrame<T> {
    #[inline(always)]
    fn of(front: Vector3<T>, rear: Vector3<T>, outer: Vector3<T>) -> Self {
        let axis = (rear - front).normalised();
        let from_front = outer - front;
        let radial = (from_front - axis * axis.dot(from_front)).normalised();
        ArmFrame {
            origin: outer,
            axes: Matrix3 {
                columns: [axis, radial, axis.cross(radial)],
            },
        }
    }

    /// Returns the coordinates of a point in the frame of the arm.
    #[inline(always)]
    fn read(&self, point: Vector3<T>) -> Vector3<T> {
        self.axes.apply_transposed(point - self.origin)
    }

    /// Returns the point with these coordinates in the frame of the arm.
    #[inline(always)]
    fn place(&self, coordinates: Vector3<T>) -> Vector3<T> {
        self.origin + self.axes.apply(coordinates)
    }
}

/// Smallest rotation that turns one direction (unit vector a) into another one (unit vector b). With k = a x b and c =
/// a.b, a vector v becomes v + k x v + k x (k x v)/(1 + c).
struct Tilt<T> {
    across: Vector3<T>,
    factor: T,
}

impl<T: Real> Tilt<T> {
    #[inline(always)]
    fn between(from: Vector3<T>, to: Vector3<T>) -> Self {
        let (from, to) = (from.normalised(), to.normalised());
        let cosine = from.dot(to);
        Tilt {
            across: from.cross(to),
            factor: cosine.one() / (cosine.one() + cosine),
        }
    }

    #[inline(always)]
    fn apply(&self, v: Vector3<T>) -> Vector3<T> {
        let once = self.across.cross(v);
        v + once + self.across.cross(once) * self.factor
    }
}

/// Returns the suspension with an additional point of the carrier on the spin axis, if the study gives this axis by
/// angles. In a built carrier the point keeps its position relative to the wheel centre. The distance between this
/// point and the wheel centre has no effect. A solid axle gets such a point at each wheel.
pub(super) fn with_spindle(suspension: &Suspension) -> Suspension {
    let mut suspension = suspension.clone();
    if let SpinAxis::Along(direction) = suspension.mechanism.spin_axis {
        let size = suspension.size();
        let length = suspension.wheel_radius.unwrap_or(0.25 * size);
        // The length is the wheel's radius, or a quarter of the size without a radius. With an extreme radius the point
        // would be too close to the wheel centre, or so far that rounding rotates the axis.
        let length = length.clamp(0.01 * size, 100.0 * size);
        let inward = direction * -length;
        let near_centre = suspension.mechanism.wheel_centre;
        let rigid = suspension.mechanism.rigid_axle.as_ref();
        let far_centre = rigid.map(|rigid| rigid.far_centre);
        let mut add = |centre: PointId, name: String, inward: Vector3<f64>| {
            let body = suspension.mechanism.body(centre);
            let place = suspension.design[centre.0] + inward;
            suspension.design.push(place);
            suspension.mechanism.points.push(Point { name, body });
            PointId(suspension.design.len() - 1)
        };
        let near = add(near_centre, SPINDLE_INNER.to_owned(), inward);
        let far = far_centre
            .map(|centre| add(centre, format!("right_{SPINDLE_INNER}"), mirrored(inward)));
        let mechanism = &mut suspension.mechanism;
        mechanism.parallel_axes = vec![[near_centre, near]];
        if let (Some(rigid), Some(far)) = (&mut mechanism.rigid_axle, far) {
            rigid.pairs.push([near, far]);
            mechanism.parallel_axes.push([rigid.far_centre, far]);
        }
        mechanism.spin_axis = SpinAxis::From(near);
    }
    suspension
}

/// Returns the suspension of a twist beam with an additional point: the point of a trailing arm that coincides with the
/// arm's mount. The mount is then a point of the body only. A deviation of the shear centre also moves the second point
/// of the hinge. Other suspensions are returned unchanged.
pub(super) fn with_eye(mut suspension: Suspension) -> Suspension {
    let mechanism = &mut suspension.mechanism;
    let beam = mechanism
        .rigid_axle
        .as_mut()
        .and_then(|rigid| rigid.twist_beam.as_mut());
    let Some(beam) = beam.filter(|beam| beam.eye.is_none()) else {
        return suspension;
    };
    let eye = PointId(suspension.design.len());
    beam.eye = Some(eye);
    let (mount, far_mount) = (beam.mount, beam.far_mount);
    let hinge = [beam.shear_centre, beam.hinge];
    mechanism.points[far_mount.0].body = Body::Opposite(eye);
    mechanism.points.push(Point {
        name: "mount_eye".to_owned(),
        body: Body::Knuckle,
    });
    mechanism.parallel_axes.push(hinge);
    suspension.design.push(suspension.design[mount.0]);
    suspension
}
