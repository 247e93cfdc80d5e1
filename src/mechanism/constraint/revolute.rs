//! A hinge: the knuckle turns about the line through two chassis points.
//!
//! The point p of the knuckle that was at a chassis point c in the design position must not leave it
//! along the direction n:
//!
//! ```text
//! F  = n.(p - c)
//! dF = n.dp - n.dc
//! ```
//!
//! n is x, y and z for the first point of the axis; of the second, only the two directions normal to
//! the axis are left to hold. These turn with the axis, but as p = c in every pose that adds nothing.

use super::normals;
use crate::mechanism::pose::Sink;
use crate::mechanism::{Configuration, Twist, Wrench};
use crate::model::PointId;
use crate::number::Real;
use crate::number::{Matrix3, Vector3};

/// One of a hinge's five equations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pinned<T> {
    pub point: PointId,
    /// n
    pub direction: Vector3<T>,
}

impl<T: Real> Pinned<T> {
    #[inline(always)]
    pub(crate) fn all(first: PointId, second: PointId, design: &[Vector3<T>]) -> [Self; 5] {
        let axis = (design[second.0] - design[first.0]).normalised();
        let [x, y, z] = Matrix3::identity(axis.x).columns;
        let [across, other] = normals(axis);
        let pinned = |point, direction| Pinned { point, direction };
        [
            pinned(first, x),
            pinned(first, y),
            pinned(first, z),
            pinned(second, across),
            pinned(second, other),
        ]
    }

    #[inline(always)]
    pub(crate) fn residual(&self, at: &Configuration<T>) -> T {
        self.direction
            .dot(at.carried(self.point) - at.designed(self.point))
    }

    #[inline(always)]
    pub(crate) fn differential(&self, at: &Configuration<T>, weight: T, sink: &mut impl Sink<T>) {
        let along = self.direction * weight;
        at.push_carried(self.point, along, sink);
        sink.hardpoint(self.point, -along);
    }

    #[inline(always)]
    pub(crate) fn wrench_rate(&self, at: &Configuration<T>, along: &Twist<T>) -> Wrench<T> {
        let lever = at.pose.rotation.apply(at.designed_lever(self.point));
        Wrench {
            force: lever.zero(),
            moment: along.turn.cross(lever).cross(self.direction),
            rack: lever.x.zero(),
        }
    }
}
