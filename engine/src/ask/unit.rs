//! Kinds of numbers, and the units in which they are printed.
//!
//! Inside the program angles are in radians, lengths in the study's unit, forces in newtons and torques in newtons
//! times the study's length unit.

use crate::model::LengthUnit;
use std::f64::consts::PI;

/// Kind of a number. It decides the printed unit.
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
    /// Force, in newtons.
    Force,
    /// Force per length, in newtons per length unit.
    ForcePerLength,
    /// Torque, in newton metres for every length unit.
    Torque,
    /// Torque per angle, in newton metres per degree for every length unit.
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
}

const DEGREES: f64 = 180.0 / PI;

impl Unit {
    /// The unit in column names; empty for a plain number.
    pub fn suffix(self, length: LengthUnit) -> String {
        let length = length.symbol();
        match self {
            Unit::Angle => "deg".to_owned(),
            Unit::Length => length.to_owned(),
            Unit::AnglePerLength => format!("deg_per_{length}"),
            Unit::AnglePerAngle => "deg_per_deg".to_owned(),
            Unit::LengthPerAngle => format!("{length}_per_deg"),
            Unit::Percent => "percent".to_owned(),
            Unit::Ratio => String::new(),
            Unit::Force => "N".to_owned(),
            Unit::ForcePerLength => format!("N_per_{length}"),
            Unit::Torque => "N_m".to_owned(),
            Unit::TorquePerAngle => "N_m_per_deg".to_owned(),
            Unit::Frequency => "Hz".to_owned(),
            Unit::AnglePerForce => "deg_per_kN".to_owned(),
            Unit::LengthPerForce => format!("{length}_per_kN"),
            Unit::AnglePerTorque => "deg_per_100_N_m".to_owned(),
            Unit::Stiffness => "N_per_mm".to_owned(),
        }
    }

    /// Factor from a value inside the program to the printed value.
    pub fn printed_factor(self, length: LengthUnit) -> f64 {
        match self {
            Unit::Angle | Unit::AnglePerLength => DEGREES,
            Unit::LengthPerAngle => 1.0 / DEGREES,
            Unit::Torque => 1.0 / length.per_metre(),
            Unit::TorquePerAngle => 1.0 / (length.per_metre() * DEGREES),
            Unit::AnglePerForce => 1000.0 * DEGREES,
            Unit::LengthPerForce => 1000.0,
            Unit::AnglePerTorque => 100.0 * length.per_metre() * DEGREES,
            Unit::Stiffness => length.per_metre() / 1000.0,
            Unit::Length
            | Unit::AnglePerAngle
            | Unit::Percent
            | Unit::Ratio
            | Unit::Force
            | Unit::ForcePerLength
            | Unit::Frequency => 1.0,
        }
    }

    /// The value inside the program of a printed one.
    pub fn from_printed(self, printed: f64, length: LengthUnit) -> f64 {
        match self {
            Unit::Angle | Unit::AnglePerLength => printed.to_radians(),
            _ => printed / self.printed_factor(length),
        }
    }
}

/// Name of a column: `name` with its unit, unless the unit is empty.
pub fn with_unit(name: impl Into<String>, unit: &str) -> String {
    let name = name.into();
    match unit.is_empty() {
        true => name,
        false => format!("{name}_{unit}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
