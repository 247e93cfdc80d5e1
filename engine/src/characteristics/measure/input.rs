//! Vectors that the formulas of measures read in a pose.

use crate::derive::Seeds;
use crate::mechanism::Configuration;
use crate::model::PointId;
use crate::number::{Scalar, Vector3};

/// Direction of a joint's stud, fixed in the wheel carrier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stud {
    /// Direction from one point to another, in the design position.
    Between(PointId, PointId),
    /// Direction of the stud in the design position, as the study gives it.
    Along(Vector3<f64>),
}

impl Stud {
    #[inline]
    fn designed<T: Scalar>(self, at: &Configuration<T>) -> Vector3<T> {
        match self {
            Stud::Between(from, to) => at.designed(to) - at.designed(from),
            Stud::Along(direction) => at.pose.origin.constant(direction),
        }
    }

    #[inline]
    fn push_designed<T: Scalar>(self, gradient: Vector3<T>, seeds: &mut Seeds<'_, '_, T>) {
        if let Stud::Between(from, to) = self {
            seeds.hardpoint(to, gradient);
            seeds.hardpoint(from, -gradient);
        }
    }
}

/// A vector that a formula reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Input {
    /// Position of a point in the present pose.
    Now(PointId),
    /// Position of a point in the design position.
    Designed(PointId),
    /// Direction of the spin axis in the present pose.
    SpinAxis,
    /// Direction of a stud in the present pose.
    StudNow(Stud),
    /// Direction of a stud in the design position.
    StudDesigned(Stud),
}

impl Input {
    #[inline]
    pub(super) fn read<T: Scalar>(self, at: &Configuration<T>) -> Vector3<T> {
        match self {
            Input::Now(point) => at.point(point),
            Input::Designed(point) => at.designed(point),
            Input::SpinAxis => at.spin_axis(),
            Input::StudNow(stud) => at.pose.rotation.apply(stud.designed(at)),
            Input::StudDesigned(stud) => stud.designed(at),
        }
    }

    #[inline]
    pub(super) fn push<T: Scalar>(
        self,
        gradient: Vector3<T>,
        at: &Configuration<T>,
        seeds: &mut Seeds<'_, '_, T>,
    ) {
        match self {
            Input::Now(point) => seeds.point(point, gradient),
            Input::Designed(point) => seeds.hardpoint(point, gradient),
            Input::SpinAxis => seeds.spin_axis(gradient),
            Input::StudNow(stud) => {
                seeds.turn(self.read(at).cross(gradient));
                stud.push_designed(at.pose.rotation.apply_transposed(gradient), seeds);
            }
            Input::StudDesigned(stud) => stud.push_designed(gradient, seeds),
        }
    }
}
