//! Columns of the results. The name of a column contains its meaning and its unit.

use crate::ask::{Info, with_unit};
use crate::characteristics::{Characteristic, Quantity};
use crate::model::{Axis, LengthUnit};
use crate::plan::{Output, Plan};
use crate::study::Drive;

/// A column of the results.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name with unit, for example `camber_d1_deg_per_mm`.
    pub name: String,
    /// Name of the quantity without order and unit.
    pub output: String,
    /// Unit, for example `deg_per_mm`. Empty for a plain number.
    pub unit: String,
    /// Meaning of a positive value, in words. `None` for derivatives, coordinates of points and measures of one wheel.
    pub positive: Option<&'static str>,
    /// Order of the derivative; 0 for a value.
    pub order: usize,
    /// Coordinate of the axle with respect to which the column is a derivative, for example `left travel`. `None` for
    /// values, and for derivatives with respect to the drive coordinate or time.
    pub by: Option<&'static str>,
    /// Index of the output in the plan. `None` for other columns, for example a force under a load.
    pub(crate) of: Option<usize>,
    /// Factor from a value in radians and length units to the printed value.
    pub(crate) factor: f64,
}

impl Column {
    /// Columns of a plan, output by output. Each value comes before its derivatives.
    pub fn all(plan: &Plan, length: LengthUnit) -> Vec<Column> {
        let mut columns = Vec::new();
        for (of, output) in plan.outputs.iter().enumerate() {
            for order in 0..=output.highest {
                columns.push(Column::new(of, output, order, plan, length));
            }
        }
        columns
    }

    /// Makes the column of a characteristic.
    pub(crate) fn of_characteristic(of: Characteristic, length: LengthUnit) -> Column {
        let Info {
            name,
            unit,
            positive,
            ..
        } = of.info();
        let factor = unit.printed_factor(length);
        Column::of_value((*name).to_owned(), unit.suffix(length), positive, factor)
    }

    /// Makes the column of a value that is not an output of a plan for one wheel.
    pub(crate) fn of_value(
        output: String,
        unit: String,
        positive: &'static str,
        factor: f64,
    ) -> Column {
        Column {
            name: with_unit(&output, &unit),
            output,
            unit,
            positive: Some(positive),
            order: 0,
            by: None,
            of: None,
            factor,
        }
    }

    /// Factor from a value in radians and length units to the printed value.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// Unit of this column's derivative with respect to a hardpoint coordinate.
    pub fn unit_per(&self, length: LengthUnit) -> String {
        per(&self.unit, length.symbol(), 1)
    }

    fn new(of: usize, output: &Output, order: usize, plan: &Plan, length: LengthUnit) -> Column {
        // An angular velocity is already a first derivative.
        let rate_order = match output.quantity() {
            Some(Quantity::AngularVelocity(_)) => 1,
            _ => 0,
        };
        let (by, factor) = match (&plan.time, plan.drive) {
            (Some(_), _) => ("s", 1.0),
            (None, Drive::Travel) => (length.symbol(), 1.0),
            (None, Drive::ArmAngle | Drive::PaperTheta) => ("deg", 1.0_f64.to_radians()),
        };
        let unit = per(&output.unit, by, order + rate_order);
        let by_time = plan.time.is_some();
        let stem = match (output.quantity(), order) {
            (Some(Quantity::AngularVelocity(axis)), 0) => format!("knuckle_omega_{}", axis.name()),
            (Some(Quantity::AngularVelocity(axis)), _) => format!("knuckle_alpha_{}", axis.name()),
            (Some(Quantity::Coordinate(_, axis)), 1 | 2) if by_time => {
                velocity_name(&output.name, axis, order)
            }
            (_, 0) => output.name.clone(),
            _ => format!("{}_d{order}", output.name),
        };
        Column {
            name: with_unit(stem, &unit),
            output: output.name.clone(),
            unit,
            positive: match (output.quantity(), order) {
                (Some(Quantity::Characteristic(c)), 0) => Some(c.info().positive),
                _ => None,
            },
            order,
            by: None,
            of: Some(of),
            factor: output.factor * factor.powi((order + rate_order) as i32),
        }
    }
}

/// Converts the name `wheel_centre_x` to `wheel_centre_vx` (velocity) or `wheel_centre_ax` (acceleration).
pub(crate) fn velocity_name(coordinate: &str, axis: Axis, order: usize) -> String {
    let point = coordinate.strip_suffix(axis.name()).unwrap_or(coordinate);
    let letter = if order == 1 { 'v' } else { 'a' };
    format!("{point}{letter}{}", axis.name())
}

/// Name of the unit `unit` divided by the `power`-th power of `by`. Examples: `deg`, `mm`, 2 gives `deg_per_mm2`;
/// `deg_per_mm2`, `mm`, 1 gives `deg_per_mm3`.
pub(crate) fn per(unit: &str, by: &str, power: usize) -> String {
    if power == 0 {
        return unit.to_owned();
    }
    let whole = format!("_{unit}");
    let below = format!("_per_{by}");
    // A unit that is already divided by `by` gets a larger exponent.
    let divided = whole.rsplit_once(&below).and_then(|(above, exponent)| {
        let exponent = match exponent {
            "" => 1,
            digits => digits.parse::<usize>().ok()?,
        };
        Some((above.trim_start_matches('_'), power + exponent))
    });
    let (above, power) = divided.unwrap_or((unit, power));
    let exponent = if power == 1 {
        String::new()
    } else {
        power.to_string()
    };
    let separator = if above.is_empty() { "" } else { "_" };
    format!("{above}{separator}per_{by}{exponent}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_divide() {
        assert_eq!(per("deg", "mm", 0), "deg");
        assert_eq!(per("deg", "mm", 2), "deg_per_mm2");
        assert_eq!(per("deg_per_mm", "mm", 1), "deg_per_mm2");
        assert_eq!(per("deg_per_mm", "s", 1), "deg_per_mm_per_s");
        assert_eq!(per("", "mm", 1), "per_mm");
        for length in ["mm", "in", "m"] {
            let second = format!("deg_per_{length}2");
            assert_eq!(per(&second, length, 1), format!("deg_per_{length}3"));
            assert_eq!(
                per(&format!("per_{length}"), length, 1),
                format!("per_{length}2")
            );
        }
        assert_eq!(per("deg_per_mm", "m", 1), "deg_per_mm_per_m");
        assert_eq!(
            velocity_name("wheel_centre_x", Axis::X, 1),
            "wheel_centre_vx"
        );
    }
}
