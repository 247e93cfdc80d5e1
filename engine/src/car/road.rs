//! Ground under a car, equation (1) of [`super`].

use crate::number::{Scalar, Vector3};

/// Directions of the ground in the body's axes.
#[derive(Clone, Copy, Debug)]
pub struct Road<T> {
    /// Upward normal.
    pub up: Vector3<T>,
    /// Forward direction along the ground.
    pub forward: Vector3<T>,
    /// Direction to the left along the ground.
    pub left: Vector3<T>,
}

/// Sine and cosine of an angle. Derivatives are exact up to the second order.
fn sin_cos<T: Scalar>(angle: T) -> [T; 2] {
    let (sine, cosine) = angle.value().sin_cos();
    let change = angle - angle.constant(angle.value());
    let near_one = angle.one() - change.squared().scaled(0.5);
    [
        near_one.scaled(sine) + change.scaled(cosine),
        near_one.scaled(cosine) - change.scaled(sine),
    ]
}

impl<T: Copy> Road<T> {
    /// Converts all numbers to another kind.
    pub(super) fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> Road<U> {
        Road {
            up: self.up.map(f),
            forward: self.forward.map(f),
            left: self.left.map(f),
        }
    }
}

impl<T: Scalar> Road<T> {
    /// Computes the ground under a body with this roll and pitch (1).
    pub fn under(roll: T, pitch: T) -> Self {
        let [sine, cosine] = sin_cos(roll);
        let [dip, level] = sin_cos(pitch);
        Road {
            up: Vector3::new(-dip, level * sine, level * cosine),
            forward: Vector3::new(level, dip * sine, dip * cosine),
            left: Vector3::new(roll.zero(), cosine, -sine),
        }
    }
}
