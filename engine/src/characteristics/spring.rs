//! Spring, rocker and anti-roll bar.
//!
//! l is the length of the spring or strut, s the vector from its lower to its upper end, W the wheel centre. Primes are
//! derivatives with respect to the drive coordinate.

use super::{Need, Slot, Unit, formulas};

const INSTALLATION: &str = "installation ratio in W. F. Milliken, D. L. Milliken, Race Car Vehicle Dynamics, SAE 1995, ch. 16";

formulas! {
    /// Spring compression per wheel travel.
    MotionRatio {
        name: "motion_ratio",
        unit: Unit::Ratio,
        positive: "spring shortens in jounce",
        formula: "-l'/W_z', where l is the length of spring or strut: spring travel per wheel travel (not its inverse)",
        source: INSTALLATION,
        reads: &[Slot::SpringLengthRate, Slot::CentreRate],
        needs: &[Need::Spring],
    } = |inputs| -(inputs.rate.spring_length / inputs.rate.centre.z);

    /// Distance between the spring's ends.
    SpringLength {
        name: "spring_length",
        unit: Unit::Length,
        positive: "always",
        formula: "l, the distance of the ends of spring or strut",
        source: "the distance of two hardpoints; of a strut from strut_lower to strut_top",
        reads: &[Slot::SpringLength],
        needs: &[Need::Spring],
    } = |inputs| inputs.now.spring_length;

    /// Angle of the spring from the vertical. It has no derivatives if the spring is vertical.
    SpringInclination {
        name: "spring_inclination",
        unit: Unit::Angle,
        positive: "always: 0 deg upright, 90 deg level, 180 deg with the upper end below",
        formula: "atan2(hypot(s_x, s_y), s_z), where s points from the lower to the upper end of spring or strut",
        source: "the angle of a line with the vertical",
        reads: &[Slot::Spring],
        needs: &[Need::Spring],
    } = |inputs| {
        let s = inputs.now.spring;
        (s.x * s.x + s.y * s.y).sqrt().atan2(s.z)
    };

    /// Angle of the spring's rocker from its design position.
    RockerAngle {
        name: "rocker_angle",
        unit: Unit::Angle,
        positive: "pushrod pushes, or pullrod pulls, the rocker from its design position",
        formula: "turn of the rocker about its axis from its design position",
        source: "closed form of the loop of rod and rocker",
        reads: &[Slot::RockerAngle],
        needs: &[Need::Rocker],
    } = |inputs| inputs.now.rocker_angle;

    /// Angle of the anti-roll bar's lever from its design position.
    AntiRollBarAngle {
        name: "anti_roll_bar_angle",
        unit: Unit::Angle,
        positive: "drop link pushes the lever from its design position; negative where it pulls, as in jounce with the lever below drop_link_outer",
        formula: "b, the turn of the anti-roll bar's lever about the bar's axis from its design position",
        source: "closed form of the loop of drop link and lever",
        reads: &[Slot::BarAngle],
        needs: &[Need::AntiRollBar],
    } = |inputs| inputs.now.bar_angle;

    /// Rotation of the anti-roll bar's lever per wheel travel.
    AntiRollBarMotionRatio {
        name: "anti_roll_bar_motion_ratio",
        unit: Unit::AnglePerLength,
        positive: "drop link pushes the lever in jounce; negative where it pulls",
        formula: "b'/W_z', where b is the angle of the anti-roll bar: lever angle per wheel travel",
        source: INSTALLATION,
        reads: &[Slot::BarAngleRate, Slot::CentreRate],
        needs: &[Need::AntiRollBar],
    } = |inputs| inputs.rate.bar_angle / inputs.rate.centre.z;
}
