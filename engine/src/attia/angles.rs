//! The paper's kingpin and camber angles.
//!
//! They are what the paper defines, not what an engineer means by these words; the catalogue's
//! `kingpin_inclination` and `camber` are that. Both are for a left wheel and in radians.

use crate::number::Real;
use crate::number::Vector3;

/// Equation (16): inclination of the line 5-7 (`lower_ball_joint`, `strut_upper`) in the transverse
/// plane, positive with 7 outboard of 5.
///
/// A MacPherson strut is steered about the line 5-4, not 5-7, so this is not the kingpin inclination:
/// for an ordinary car even its sign differs.
#[inline(always)]
pub fn attia_kingpin<T: Real>(lower_ball_joint: Vector3<T>, strut_upper: Vector3<T>) -> T {
    let line = strut_upper - lower_ball_joint;
    arc_tangent(line.y / line.z)
}

/// Equation (17): inclination of the line 7-10 (`strut_upper`, `wheel_centre`) in the transverse plane,
/// positive with the wheel centre above 7 and outboard of it.
///
/// It takes 7-10 for the spin axis, which no strut obliges it to be, and it projects: it is camber only
/// where the line 7-10 is the spin axis and the wheel is not steered.
#[inline(always)]
pub fn attia_camber<T: Real>(strut_upper: Vector3<T>, wheel_centre: Vector3<T>) -> T {
    let line = strut_upper - wheel_centre;
    arc_tangent(-line.z / line.y)
}

#[inline(always)]
fn arc_tangent<T: Real>(slope: T) -> T {
    slope.atan2(slope.one())
}
