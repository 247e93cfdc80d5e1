//! A telescopic strut: its mount stays on a line fixed in the knuckle.
//!
//! Let n be one of two normals of the line, fixed in the undisplaced knuckle. R is the knuckle's rotation, o its origin, and
//! g = top - o, with g0 in the design position:
//!
//! ```text
//! F  = R n . g - n . g0                                                               (1)
//! dF = R n . (d top - do) + (R n x g) . d(rotation) - n . (d top0 - do0) - c n . du   (2)
//! c  = R u . g - u . g0                                                               (3)
//! f  = -R n,   m = R n x g                                                            (4)
//! ```
//!
//! u is the direction of the line. Its normal rotates with it: dn = -u (n.du). c is the distance by which the knuckle has
//! slid along the line.
//!
//! Rates along the motion (v, w), from (R n)' = w x R n and g' = -v, since the mount is fixed in the body:
//!
//! ```text
//! f' = -(w x R n),   m' = (w x R n) x g - R n x v                                     (5)
//! ```
//!
//! n . g0 and u are dimensions of the knuckle. A built strut keeps the values of its own knuckle, wherever the mount is in the
//! body.

use super::normals;
use crate::mechanism::pose::Sink;
use crate::mechanism::{Configuration, Twist, Wrench};
use crate::model::PointId;
use crate::number::Real;
use crate::number::Vector3;

/// One of a strut's two equations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StrutLine<T> {
    pub top: PointId,
    lower: PointId,
    upper: Option<PointId>,
    /// Normal n of the line, in the undisplaced knuckle.
    pub normal: Vector3<T>,
    /// Product n . g0, with g0 from the knuckle's origin to the mount in the design position.
    offset: T,
    /// Direction u of the line, in the undisplaced knuckle.
    along: Vector3<T>,
    /// Inverse of the design distance between the two points that give the direction of the line.
    inverse_base: T,
}

impl<T: Real> StrutLine<T> {
    /// Makes both equations. `knuckle` holds the positions of all points on the undisplaced knuckle (for a design, the points
    /// of the design). `origin` is the knuckle's origin.
    #[inline(always)]
    pub(crate) fn both(
        top: PointId,
        lower: PointId,
        upper: Option<PointId>,
        knuckle: &[Vector3<T>],
        origin: PointId,
    ) -> [Self; 2] {
        let base = knuckle[upper.unwrap_or(top).0] - knuckle[lower.0];
        let lever = knuckle[top.0] - knuckle[origin.0];
        let inverse_base = base.x.one() / base.norm();
        let along = base * inverse_base;
        let [first, second] = normals(along, along.z.sign());
        let across_first = StrutLine {
            top,
            lower,
            upper,
            normal: first,
            offset: first.dot(lever),
            along,
            inverse_base,
        };
        let across_second = StrutLine {
            normal: second,
            offset: second.dot(lever),
            ..across_first
        };
        [across_first, across_second]
    }

    /// Residual of the constraint, as a length: F in equation (1) of this file.
    #[inline(always)]
    pub(crate) fn residual(&self, at: &Configuration<T>) -> T {
        let gap = at.grounded(self.top) - at.pose.origin;
        at.pose.rotation.apply(self.normal).dot(gap) - self.offset
    }

    /// Adds the derivatives of the residual, equation (2) with the distance c of equation (3), times `weight` to the sink.
    #[inline(always)]
    pub(crate) fn differential(&self, at: &Configuration<T>, weight: T, sink: &mut impl Sink<T>) {
        let StrutLine { top, normal, .. } = *self;
        let gap = at.point(top) - at.pose.origin;
        let turned = at.pose.rotation.apply(normal) * weight;
        sink.wrench(-turned, turned.cross(gap));
        at.push_point(top, turned, sink);
        sink.hardpoint(top, -(normal * weight));
        sink.hardpoint(at.mechanism.origin, normal * weight);
        let slid =
            at.pose.rotation.apply(self.along).dot(gap) - self.along.dot(at.designed_lever(top));
        let by_direction = normal * (-(slid * weight) * self.inverse_base);
        sink.hardpoint(self.upper.unwrap_or(top), by_direction);
        sink.hardpoint(self.lower, -by_direction);
    }

    /// Rates of the constraint's force and moment along a motion of the knuckle, equation (5) of this file.
    #[inline(always)]
    pub(crate) fn wrench_rate(&self, at: &Configuration<T>, along: &Twist<T>) -> Wrench<T> {
        let gap = at.grounded(self.top) - at.pose.origin;
        let turned = at.pose.rotation.apply(self.normal);
        let turned_rate = along.turn.cross(turned);
        Wrench {
            force: -turned_rate,
            moment: turned_rate.cross(gap) - turned.cross(along.shift),
            rack: gap.x.zero(),
        }
    }
}
