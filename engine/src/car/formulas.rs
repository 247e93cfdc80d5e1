//! Formulas of results. There are two jacking coefficients. The coefficient j is for side forces in the lateral
//! direction of the car on the ground. The coefficient J is for side forces in the direction of the tyre's lateral
//! forces.

pub(super) mod axle;
pub(super) mod car;
pub(super) mod wheel;

use crate::number::Scalar;
use std::f64::consts::PI;

/// Converts the square of an angular frequency to a frequency in hertz.
fn frequency<T: Scalar>(squared: T) -> T {
    squared.sqrt().scaled(0.5 / PI)
}
