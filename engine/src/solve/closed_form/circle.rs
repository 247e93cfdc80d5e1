//! Circle of an arm's outer joint.

use crate::model::Arm;
use crate::number::Real;
use crate::number::Vector3;

/// Circle of an arm's outer joint: its centre, and the radius vector to the joint in the design position. `turned` is this radius
/// vector, rotated by a right angle in the direction that raises the joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Circle<T> {
    pub centre: Vector3<T>,
    pub radius: Vector3<T>,
    pub turned: Vector3<T>,
}

impl<T: Real> Circle<T> {
    #[inline(always)]
    pub(crate) fn of(arm: Arm, design: &[Vector3<T>]) -> Self {
        let [front, rear, outer] = [design[arm.front.0], design[arm.rear.0], design[arm.outer.0]];
        // A positive rotation about this axis raises the joint (as in `axis_ends` for plain numbers).
        let lift = (front - rear).cross(outer - rear).z;
        let axis = (front - rear).normalised() * lift.sign();
        let centre = rear + axis * (outer - rear).dot(axis);
        let radius = outer - centre;
        Circle {
            centre,
            radius,
            turned: axis.cross(radius),
        }
    }

    #[inline(always)]
    pub(crate) fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> Circle<U> {
        Circle {
            centre: self.centre.map(f),
            radius: self.radius.map(f),
            turned: self.turned.map(f),
        }
    }

    /// Position of the joint at an angle.
    #[inline(always)]
    pub(crate) fn at(&self, cosine: T, sine: T) -> Vector3<T> {
        self.centre
            .plus_scaled(self.radius, cosine)
            .plus_scaled(self.turned, sine)
    }
}

impl Circle<f64> {
    /// Angle of a point on the circle.
    pub(crate) fn angle(&self, point: Vector3<f64>) -> f64 {
        let from_centre = point - self.centre;
        let (cosine, sine) = (from_centre.dot(self.radius), from_centre.dot(self.turned));
        sine.atan2(cosine)
    }

    /// Tangent of half the angle of a point on the circle.
    pub(crate) fn half_tangent(&self, point: Vector3<f64>) -> f64 {
        let from_centre = point - self.centre;
        let squared = self.radius.norm_squared();
        let cosine = from_centre.dot(self.radius) / squared;
        let sine = from_centre.dot(self.turned) / squared;
        sine / (1.0 + cosine)
    }
}
