//! The units in which quantities of an axle are printed.

use crate::model::LengthUnit;
use std::f64::consts::PI;

/// The kind of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A kind that wheel characteristics have.
    Corner(crate::characteristics::Unit),
    /// Angle per angle, in degrees per degree.
    AnglePerAngle,
    /// Length per roll angle.
    LengthPerAngle,
    /// Newtons.
    Force,
    /// Newtons per length unit.
    ForcePerLength,
    /// Newton metres, whatever the length unit.
    Torque,
    /// Newton metres per degree.
    TorquePerAngle,
    /// Hertz.
    Frequency,
}

const DEGREES: f64 = 180.0 / PI;

impl Unit {
    /// The unit as column names write it; empty for a plain number.
    pub fn suffix(self, length: LengthUnit) -> String {
        let length_name = length.symbol();
        match self {
            Unit::Corner(unit) => unit.suffix(length),
            Unit::AnglePerAngle => "deg_per_deg".to_owned(),
            Unit::LengthPerAngle => format!("{length_name}_per_deg"),
            Unit::Force => "N".to_owned(),
            Unit::ForcePerLength => format!("N_per_{length_name}"),
            Unit::Torque => "N_m".to_owned(),
            Unit::TorquePerAngle => "N_m_per_deg".to_owned(),
            Unit::Frequency => "Hz".to_owned(),
        }
    }

    /// What a value in radians, length units and newtons is multiplied by to be printed.
    pub fn printed_factor(self, length: LengthUnit) -> f64 {
        let metre = length.per_metre();
        match self {
            Unit::Corner(unit) => unit.printed_factor(),
            Unit::LengthPerAngle => 1.0 / DEGREES,
            Unit::Torque => 1.0 / metre,
            Unit::TorquePerAngle => 1.0 / (metre * DEGREES),
            Unit::AnglePerAngle | Unit::Force | Unit::ForcePerLength | Unit::Frequency => 1.0,
        }
    }

    /// The value (radians, length units, newtons) of a printed one.
    pub fn from_printed(self, printed: f64, length: LengthUnit) -> f64 {
        match self {
            Unit::Corner(unit) => unit.from_printed(printed),
            _ => printed / self.printed_factor(length),
        }
    }
}
