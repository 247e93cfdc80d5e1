//! Frames that carry points of built arms and rockers.

use crate::number::{Matrix3, Real, Vector3};

/// Frame of an arm: its outer joint, the direction of its axis, and the direction from the axis to the joint.
pub(super) struct ArmFrame<T> {
    origin: Vector3<T>,
    axes: Matrix3<T>,
}

impl<T: Real> ArmFrame<T> {
    #[inline(always)]
    pub(super) fn of(front: Vector3<T>, rear: Vector3<T>, outer: Vector3<T>) -> Self {
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

    /// Coordinates of a point in the frame.
    #[inline(always)]
    pub(super) fn read(&self, point: Vector3<T>) -> Vector3<T> {
        self.axes.apply_transposed(point - self.origin)
    }

    /// Point with these coordinates.
    #[inline(always)]
    pub(super) fn place(&self, coordinates: Vector3<T>) -> Vector3<T> {
        self.origin + self.axes.apply(coordinates)
    }
}

/// Smallest rotation from one direction to another. With k = a x b and c = a.b of the unit vectors it is v + k x v + k x (k
/// x v)/(1 + c).
pub(super) struct Tilt<T> {
    across: Vector3<T>,
    factor: T,
}

impl<T: Real> Tilt<T> {
    #[inline(always)]
    pub(super) fn between(from: Vector3<T>, to: Vector3<T>) -> Self {
        let (from, to) = (from.normalised(), to.normalised());
        let cosine = from.dot(to);
        Tilt {
            across: from.cross(to),
            factor: cosine.one() / (cosine.one() + cosine),
        }
    }

    #[inline(always)]
    pub(super) fn apply(&self, v: Vector3<T>) -> Vector3<T> {
        let once = self.across.cross(v);
        v + once + self.across.cross(once) * self.factor
    }
}
