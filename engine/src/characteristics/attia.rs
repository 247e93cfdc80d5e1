//! Kingpin and camber angles of Attia's paper, under separate names.
//!
//! H. A. Attia, *Numerical Kinematic Analysis of the Standard Macpherson Motor-Vehicle Suspension System*, KSME International
//! Journal 17 (2003), equations (16) and (17). These two angles allow a comparison with the paper. The usual engineering angles
//! are `kingpin_inclination` and `camber`.

use super::{Need, Slot, Unit, formulas};
use crate::number::{Real, Vector3};

formulas! {
    /// Front-view inclination of the line from point 5 (`lower_ball_joint`) to point 7 (`strut_upper`).
    AttiaKingpin {
        name: "attia_kingpin",
        unit: Unit::Angle,
        positive: "strut_upper outboard of lower_ball_joint",
        formula: "atan((y7 - y5)/(z7 - z5)), where 5 is lower_ball_joint and 7 is strut_upper",
        source: "Attia 2003, equation (16); a strut steers about 5-4, so the angle is not a kingpin inclination",
        reads: &[Slot::SteeringPoint, Slot::StrutUpper],
        needs: &[Need::SteeringAxis, Need::StrutUpper],
    } = |inputs| {
        let now = &inputs.now;
        attia_kingpin(now.steering_point, now.strut_upper)
    };

    /// Front-view inclination of the line from point 7 (`strut_upper`) to point 10 (`wheel_centre`), from the lateral
    /// direction.
    AttiaCamber {
        name: "attia_camber",
        unit: Unit::Angle,
        positive: "wheel_centre below strut_upper and outboard of it",
        formula: "atan(-(z7 - z10)/(y7 - y10)), where 7 is strut_upper and 10 is wheel_centre",
        source: "Attia 2003, equation (17); camber only where 7-10 is the spin axis of an unsteered wheel",
        reads: &[Slot::StrutUpper, Slot::Centre],
        needs: &[Need::StrutUpper],
    } = |inputs| attia_camber(inputs.now.strut_upper, inputs.now.centre);
}

/// Equation (16) of Attia's paper: inclination of the line 5-7 (`lower_ball_joint`, `strut_upper`) in the transverse plane.
/// Positive with point 7 outboard of point 5.
///
/// A MacPherson strut steers about the line 5-4, not 5-7, so this angle is not the kingpin inclination. For an ordinary car,
/// even the sign differs.
#[inline(always)]
pub fn attia_kingpin<T: Real>(lower_ball_joint: Vector3<T>, strut_upper: Vector3<T>) -> T {
    let line = strut_upper - lower_ball_joint;
    arc_tangent(line.y / line.z)
}

/// Equation (17) of Attia's paper: inclination of the line 7-10 (`strut_upper`, `wheel_centre`) in the transverse plane. Positive
/// with the wheel centre below point 7 and outboard of it.
///
/// The formula uses the line 7-10 in place of the spin axis, and projects this line. So the result equals camber only if 7-10
/// is the spin axis and the wheel is not steered.
#[inline(always)]
pub fn attia_camber<T: Real>(strut_upper: Vector3<T>, wheel_centre: Vector3<T>) -> T {
    let line = strut_upper - wheel_centre;
    arc_tangent(-line.z / line.y)
}

#[inline(always)]
fn arc_tangent<T: Real>(slope: T) -> T {
    slope.atan2(slope.one())
}
