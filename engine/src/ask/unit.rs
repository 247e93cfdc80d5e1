//! Physical types of numbers, and their printed units.
//!
//! Inside the program angles are in radians, lengths in the study's unit, forces in newtons and torques in newtons
//! times the study's length unit.

use crate::model::LengthUnit;
use std::f64::consts::PI;

/// Physical type of a number. It determines the printed unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Unit {
    /// Angle, in degrees.
    Angle,
    /// Length, in the study's unit.
    Length,
    /// Angle per wheel travel, in degrees per length unit.
    AnglePerLength,
    /// Angle per angle, in degrees per degree.
    AnglePerAngle,
    /// Length per roll angle, in length units per degree.
    LengthPerAngle,
    /// Percent.
    Percent,
    /// Plain number.
    Ratio,
    /// Force, in newtons or pounds-force.
    Force,
    /// Force per length, in newtons or pounds-force per length unit.
    ForcePerLength,
    /// Torque. Printed in newton metres, or in pound-feet.
    Torque,
    /// Torque per angle, in newton metres or pound-feet per degree.
    TorquePerAngle,
    /// Frequency, in hertz.
    Frequency,
    /// Angle per force, in degrees per kilonewton.
    AnglePerForce,
    /// Length per force, in length units per kilonewton.
    LengthPerForce,
    /// Angle per torque, in degrees per 100 newton metres.
    AnglePerTorque,
    /// Force per length, in newtons per millimetre whatever the length unit.
    Stiffness,
    /// Angle per acceleration, in degrees per g.
    AnglePerG,
}

const DEGREES: f64 = 180.0 / PI;

impl Unit {
    /// Printed unit of numbers of this type, as in column names. Empty for a plain number.
    pub fn suffix(self, length: LengthUnit) -> String {
        let (force, (_, lever)) = (length.force_symbol(), length.lever());
        let length = length.symbol();
        match self {
            Unit::Angle => "deg".to_owned(),
            Unit::Length => length.to_owned(),
            Unit::AnglePerLength => format!("deg_per_{length}"),
            Unit::AnglePerAngle => "deg_per_deg".to_owned(),
            Unit::LengthPerAngle => format!("{length}_per_deg"),
            Unit::Percent => "percent".to_owned(),
            Unit::Ratio => String::new(),
            Unit::Force => force.to_owned(),
            Unit::ForcePerLength => format!("{force}_per_{length}"),
            Unit::Torque => format!("{force}_{lever}"),
            Unit::TorquePerAngle => format!("{force}_{lever}_per_deg"),
            Unit::Frequency => "Hz".to_owned(),
            Unit::AnglePerForce => "deg_per_kN".to_owned(),
            Unit::LengthPerForce => format!("{length}_per_kN"),
            Unit::AnglePerTorque => "deg_per_100_N_m".to_owned(),
            Unit::Stiffness => "N_per_mm".to_owned(),
            Unit::AnglePerG => "deg_per_g".to_owned(),
        }
    }

    /// Factor that converts a value inside the program to the printed value.
    pub fn printed_factor(self, length: LengthUnit) -> f64 {
        match self {
            Unit::Angle | Unit::AnglePerLength | Unit::AnglePerG => DEGREES,
            Unit::LengthPerAngle => 1.0 / DEGREES,
            Unit::Force | Unit::ForcePerLength => 1.0 / length.newtons(),
            Unit::Torque => 1.0 / (length.lever().0 * length.newtons()),
            Unit::TorquePerAngle => 1.0 / (length.lever().0 * length.newtons() * DEGREES),
            Unit::AnglePerForce => 1000.0 * DEGREES,
            Unit::LengthPerForce => 1000.0,
            Unit::AnglePerTorque => 100.0 * length.per_metre() * DEGREES,
            Unit::Stiffness => length.per_metre() / 1000.0,
            Unit::Length | Unit::AnglePerAngle | Unit::Percent | Unit::Ratio | Unit::Frequency => {
                1.0
            }
        }
    }

    /// Exponent of the length unit in values of this kind inside the program.
    fn power_of_length(self) -> i32 {
        match self {
            Unit::Length
            | Unit::LengthPerAngle
            | Unit::LengthPerForce
            | Unit::Torque
            | Unit::TorquePerAngle => 1,
            Unit::AnglePerLength
            | Unit::AnglePerTorque
            | Unit::ForcePerLength
            | Unit::Stiffness => -1,
            Unit::Angle
            | Unit::AnglePerAngle
            | Unit::Percent
            | Unit::Ratio
            | Unit::Force
            | Unit::Frequency
            | Unit::AnglePerForce
            | Unit::AnglePerG => 0,
        }
    }

    /// Converts a value printed for one study to the value printed for the same study in another unit of length.
    pub fn reprinted(self, printed: f64, from: LengthUnit, to: LengthUnit) -> f64 {
        let scale = to.convert(1.0, from).powi(self.power_of_length());
        match self {
            Unit::Length => to.convert(printed, from),
            _ => printed * (scale * self.printed_factor(to) / self.printed_factor(from)),
        }
    }

    /// Converts a printed value to the program's units.
    pub fn from_printed(self, printed: f64, length: LengthUnit) -> f64 {
        match self {
            Unit::Angle | Unit::AnglePerLength | Unit::AnglePerG => printed.to_radians(),
            _ => printed / self.printed_factor(length),
        }
    }
}

/// Name of a column: `name` with its unit, unless the unit is empty.
pub fn with_unit(name: impl Into<String>, unit: &str) -> String {
    let name = name.into();
    if unit.is_empty() {
        name
    } else {
        format!("{name}_{unit}")
    }
}

/// Converts an angle from radians to degrees. Returns a number with at most fourteen digits, if such a number gives
/// exactly this angle.
pub fn degrees(angle: f64) -> f64 {
    let exact = angle.to_degrees();
    let short: f64 = format!("{exact:.13e}").parse().unwrap_or(exact);
    if short.to_radians() == angle {
        short
    } else {
        exact
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pounds_are_printed_beside_inches() {
        let pounds = LengthUnit::InchPound;
        assert_eq!(Unit::Force.suffix(pounds), "lbf");
        assert_eq!(Unit::ForcePerLength.suffix(pounds), "lbf_per_in");
        assert_eq!(Unit::TorquePerAngle.suffix(pounds), "lbf_ft_per_deg");
        let force = Unit::Force.from_printed(1.0, pounds);
        assert!((force - 4.448_221_615_260_5).abs() < 1e-15, "{force}");
        // 1 lbf ft is 1.3558179483314004 N m.
        let torque = Unit::Torque.from_printed(1.0, pounds) * 0.0254;
        assert!((torque - 1.355_817_948_331_400_4).abs() < 1e-15, "{torque}");
    }

    #[test]
    fn printed_values_are_converted_between_units() {
        let (mm, m, pounds) = (
            LengthUnit::Millimetre,
            LengthUnit::Metre,
            LengthUnit::InchPound,
        );
        let cases = [
            (Unit::Length, mm, pounds, 25.4, 1.0),
            (Unit::AnglePerLength, mm, m, 0.02, 20.0),
            (Unit::LengthPerAngle, m, mm, 0.003, 3.0),
            (Unit::LengthPerForce, m, mm, 0.003, 3.0),
            (Unit::Force, mm, pounds, 4.448_221_615_260_5, 1.0),
            // 1 lbf/in is 0.175126835 N/mm, and 1 lbf ft is 1.3558179483314004 N m.
            (
                Unit::ForcePerLength,
                mm,
                pounds,
                0.175_126_835_246_476_38,
                1.0,
            ),
            (Unit::Torque, m, pounds, 1.355_817_948_331_400_4, 1.0),
            (
                Unit::TorquePerAngle,
                mm,
                pounds,
                1.355_817_948_331_400_4,
                1.0,
            ),
            // Stiffnesses, angles per torque, angles per force and percentages have the same printed unit in every study.
            (Unit::Stiffness, mm, m, 150.0, 150.0),
            (Unit::AnglePerTorque, mm, m, 0.4, 0.4),
            (Unit::AnglePerForce, mm, pounds, 0.4, 0.4),
            (Unit::Percent, mm, pounds, 55.0, 55.0),
        ];
        for (unit, from, to, before, after) in cases {
            let there = unit.reprinted(before, from, to);
            assert!((there - after).abs() < 4e-16 * after, "{unit:?} {there}");
            let back = unit.reprinted(there, to, from);
            assert!((back - before).abs() < 9e-16 * before, "{unit:?} {back}");
        }
    }

    #[test]
    fn degrees_and_newton_metres_are_printed() {
        let mm = LengthUnit::Millimetre;
        assert_eq!(Unit::Angle.from_printed(180.0, mm), PI);
        assert_eq!(Unit::Angle.printed_factor(mm) * PI, 180.0);
        assert_eq!(Unit::Length.from_printed(180.0, mm), 180.0);
        assert_eq!(Unit::Torque.from_printed(2.0, mm), 2000.0);
        assert_eq!(Unit::Torque.from_printed(2.0, LengthUnit::Metre), 2.0);
    }
}
