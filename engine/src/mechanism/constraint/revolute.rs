//! A hinge: the knuckle rotates about the line through two chassis points.
//!
//! The point p of the knuckle that coincides with a chassis point c in the design position must not move away from c along
//! the direction n. With l = p - o the lever of p about the knuckle's origin o:
//!
//! ```text
//! F  = n.(p - c)                                                   (1)
//! dF = n.dp - n.dc                                                 (2)
//! f  = n,   m = l x n                                              (3)
//! ```
//!
//! For the first point of the axis, n is x, y and z. For the second point, n is each of two directions normal to the axis.
//! These directions rotate with the axis. But p = c in every pose of a design, so their rotation adds no term to equation
//! (2).
//!
//! Rates along the motion (v, w), from l' = w x l and n fixed in the body:
//!
//! ```text
//! f' = 0,   m' = (w x l) x n                                       (4)
//! ```
//!
//! A ball joint at the body has the three equations of one point, with n along x, y and z.
//!
//! The position of p in the knuckle is a dimension of the knuckle. A built arm keeps the positions of its bushings in the arm,
//! wherever the points of the body are.

use super::normals;
use crate::mechanism::pose::Sink;
use crate::mechanism::{Configuration, Twist, Wrench};
use crate::model::PointId;
use crate::number::{Each, Real};
use crate::number::{Matrix3, Vector3};

/// One of a hinge's five equations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pinned<T> {
    pub point: PointId,
    /// Direction n in which the point p must not move away from c.
    pub direction: Vector3<T>,
    /// Vector from the origin of the undisplaced knuckle to p.
    lever: Vector3<T>,
}

impl<T: Real> Pinned<T> {
    /// Makes all five equations. `body` holds the points of the body, `knuckle` the positions of all points on the undisplaced
    /// knuckle. For a design, both are the points of the design. `origin` is the knuckle's origin.
    #[inline(always)]
    pub(crate) fn all(
        first: PointId,
        second: PointId,
        body: &[Vector3<T>],
        knuckle: &[Vector3<T>],
        origin: PointId,
    ) -> [Self; 5] {
        let axis = (body[second.0] - body[first.0]).normalised();
        let [x, y, z] = Matrix3::identity(axis.x).columns;
        // The z component of the nominal axis gives the sign. So two builds have nearly equal normals, even if the axis of
        // one build rises and the axis of the other build falls.
        let sign = (knuckle[second.0] - knuckle[first.0]).z.sign();
        let [across, other] = normals(axis, sign);
        let at_first = knuckle[first.0] - knuckle[origin.0];
        let at_second = knuckle[second.0] - knuckle[origin.0];
        [
            Pinned::new(first, x, at_first),
            Pinned::new(first, y, at_first),
            Pinned::new(first, z, at_first),
            Pinned::new(second, across, at_second),
            Pinned::new(second, other, at_second),
        ]
    }

    /// Makes the three equations of a ball joint. `knuckle` holds the positions of all points on the undisplaced knuckle.
    #[inline(always)]
    pub(crate) fn point(point: PointId, knuckle: &[Vector3<T>], origin: PointId) -> [Self; 3] {
        let lever = knuckle[point.0] - knuckle[origin.0];
        Matrix3::identity(lever.x)
            .columns
            .each(|direction| Pinned::new(point, direction, lever))
    }

    #[inline(always)]
    fn new(point: PointId, direction: Vector3<T>, lever: Vector3<T>) -> Self {
        Pinned {
            point,
            direction,
            lever,
        }
    }

    /// Residual of the constraint, as a length: F in equation (1) of this file.
    #[inline(always)]
    pub(crate) fn residual(&self, at: &Configuration<T>) -> T {
        let carried = at.pose.origin + at.pose.rotation.apply(self.lever);
        self.direction.dot(carried - at.designed(self.point))
    }

    /// Adds the derivatives of the residual, equation (2) of this file, times `weight` to the sink.
    #[inline(always)]
    pub(crate) fn differential(&self, at: &Configuration<T>, weight: T, sink: &mut impl Sink<T>) {
        let along = self.direction * weight;
        let in_knuckle = at.pose.rotation.apply_transposed(along);
        let lever = at.pose.rotation.apply(self.lever);
        sink.wrench(along, lever.cross(along));
        sink.hardpoint(self.point, in_knuckle - along);
        sink.hardpoint(at.mechanism.origin, -in_knuckle);
    }

    /// Rates of the constraint's force and moment along a motion of the knuckle, equation (4) of this file.
    #[inline(always)]
    pub(crate) fn wrench_rate(&self, at: &Configuration<T>, along: &Twist<T>) -> Wrench<T> {
        let lever = at.pose.rotation.apply(self.lever);
        Wrench {
            force: lever.zero(),
            moment: along.turn.cross(lever).cross(self.direction),
            rack: lever.x.zero(),
        }
    }
}
