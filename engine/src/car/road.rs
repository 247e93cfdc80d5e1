//! Ground under a car: equation (1) of [`super`].

use crate::number::{Local, LocalFunction, Scalar, Vector3};

/// Directions of the ground in the body's axes.
#[derive(Clone, Copy, Debug)]
pub struct Road<T> {
    /// Upward normal of the ground.
    pub up: Vector3<T>,
    /// Forward direction along the ground.
    pub forward: Vector3<T>,
    /// Direction to the left along the ground.
    pub left: Vector3<T>,
}

/// Sine and cosine of an angle. Derivatives are exact up to the third order.
struct SinCos;

impl LocalFunction<1, 2> for SinCos {
    #[inline(always)]
    fn at<T: Scalar>(&self, [angle]: [T; 1]) -> [T; 2] {
        let (sine, cosine) = angle.value().sin_cos();
        let change = angle - angle.constant(angle.value());
        let square = change.squared();
        let near_one = angle.one() - square.scaled(0.5);
        let small = change - change * square.scaled(1.0 / 6.0);
        [
            near_one.scaled(sine) + small.scaled(cosine),
            near_one.scaled(cosine) - small.scaled(sine),
        ]
    }
}

impl<T: Copy> Road<T> {
    /// Converts all numbers to another number type.
    pub(super) fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> Road<U> {
        Road {
            up: self.up.map(f),
            forward: self.forward.map(f),
            left: self.left.map(f),
        }
    }
}

impl<T: Local> Road<T> {
    /// Computes the directions of the ground under a body with this roll and pitch, by equation (1) of [`super`].
    #[inline(always)]
    pub fn under(roll: T, pitch: T) -> Self {
        let [sine, cosine] = T::local([roll], &SinCos);
        let [dip, level] = T::local([pitch], &SinCos);
        Road {
            up: Vector3::new(-dip, level * sine, level * cosine),
            forward: Vector3::new(level, dip * sine, dip * cosine),
            left: Vector3::new(roll.zero(), cosine, -sine),
        }
    }
}
