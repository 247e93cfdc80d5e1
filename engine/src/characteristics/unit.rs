//! Units: what characteristics are printed in.

use super::Characteristic;
use crate::model::LengthUnit;

/// The kind of quantity, which decides the unit it is printed in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// An angle, printed in degrees.
    Angle,
    /// A length, in the study's unit.
    Length,
    /// Angle per wheel travel, in degrees per length unit.
    AnglePerLength,
    /// Percent.
    Percent,
    /// A plain number.
    Ratio,
}

impl Unit {
    /// The unit as column names write it; empty for a plain number.
    pub fn suffix(self, length: LengthUnit) -> String {
        match self {
            Unit::Angle => "deg".to_owned(),
            Unit::Length => length.symbol().to_owned(),
            Unit::AnglePerLength => format!("deg_per_{}", length.symbol()),
            Unit::Percent => "percent".to_owned(),
            Unit::Ratio => String::new(),
        }
    }

    /// What a value (radians, length units) is multiplied by to be printed.
    pub fn printed_factor(self) -> f64 {
        match self {
            Unit::Angle | Unit::AnglePerLength => 180.0 / std::f64::consts::PI,
            Unit::Length | Unit::Percent | Unit::Ratio => 1.0,
        }
    }

    /// The value (radians, length units) of a printed one.
    pub fn from_printed(self, printed: f64) -> f64 {
        match self {
            Unit::Angle | Unit::AnglePerLength => printed.to_radians(),
            Unit::Length | Unit::Percent | Unit::Ratio => printed,
        }
    }
}

impl Characteristic {
    /// The column name: the characteristic with its unit, like `camber_deg`.
    pub fn column(self, length: LengthUnit) -> String {
        let info = self.info();
        with_unit(info.name, &info.unit.suffix(length))
    }
}

/// The name of a column: `name` with its unit, unless that is empty.
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
    fn columns_carry_their_unit() {
        for (characteristic, column) in [
            (Characteristic::Camber, "camber_deg"),
            (Characteristic::ScrubRadius, "scrub_radius_mm"),
            (Characteristic::BumpSteer, "bump_steer_deg_per_mm"),
            (Characteristic::AntiDive, "anti_dive_percent"),
            (Characteristic::MotionRatio, "motion_ratio"),
        ] {
            assert_eq!(characteristic.column(LengthUnit::Millimetre), column);
        }
        assert_eq!(
            Characteristic::BumpSteer.column(LengthUnit::Metre),
            "bump_steer_deg_per_m"
        );
    }

    #[test]
    fn degrees_are_printed() {
        assert_eq!(Unit::Angle.from_printed(180.0), std::f64::consts::PI);
        assert_eq!(Unit::Angle.printed_factor() * std::f64::consts::PI, 180.0);
        assert_eq!(Unit::Length.from_printed(180.0), 180.0);
    }
}
