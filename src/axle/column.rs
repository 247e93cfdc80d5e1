//! Columns of an axle's curves: names that say what a number is and in what unit.

use super::state::Motion;
use super::{Axle, AxlePlan, Quantity, Read, Void, WheelMotion};
use crate::curves::Loads;
use crate::model::{Axis, LengthUnit, Side};

/// A column of values.
#[derive(Clone, Debug, PartialEq)]
pub struct AxleColumn {
    /// Name with unit.
    pub name: String,
    /// Of what.
    pub of: Of,
    /// Along which motion it is the derivative, if it is one.
    pub by: Option<Motion>,
    /// Unit alone; empty for a plain number.
    pub unit: String,
    /// What a value in radians, length units and newtons is multiplied by to be printed.
    pub factor: f64,
}

/// Of what a column is.
#[derive(Clone, Debug, PartialEq)]
pub enum Of {
    /// A quantity.
    Quantity(Quantity),
    /// A force that carries a load on one wheel.
    Force {
        /// Its name without the unit.
        name: String,
        /// When it is positive.
        positive: &'static str,
    },
}

impl AxleColumn {
    /// The quantity, if it is of one.
    pub fn quantity(&self) -> Option<Quantity> {
        match &self.of {
            Of::Quantity(quantity) => Some(*quantity),
            Of::Force { .. } => None,
        }
    }

    /// What a position has of a quantity, in radians, length units and newtons, or why there is none; `None` of what is
    /// no quantity.
    pub fn evaluate(&self, read: &Read) -> Option<Result<f64, Void>> {
        let quantity = self.quantity()?;
        if read.is_stuck(quantity) {
            return Some(Err(Void::Toggle));
        }
        let value = quantity.value(&read.state);
        Some(value.map(|value| match self.by {
            None => value,
            Some(motion) => quantity.evaluate(&read.state.moving(motion))[1],
        }))
    }

    /// What it is of, without motion and unit.
    pub fn output(&self) -> String {
        match &self.of {
            Of::Quantity(quantity) => quantity.name(),
            Of::Force { name, .. } => name.clone(),
        }
    }

    /// When it is positive, in words; of a value alone, not of its derivatives.
    pub fn positive(&self) -> Option<&'static str> {
        match &self.of {
            _ if self.by.is_some() => None,
            Of::Quantity(quantity) => Some(quantity.positive()),
            Of::Force { positive, .. } => Some(positive),
        }
    }
}

impl AxlePlan {
    /// The motions along which derivatives are reported, with the name and unit of each.
    fn motions(&self, length: LengthUnit) -> Vec<(Motion, &'static str, String, f64)> {
        if !self.derivatives {
            return Vec::new();
        }
        let per_length = || format!("per_{}", length.symbol());
        let by_length = |motion, name| (motion, name, per_length(), 1.0);
        let roll = (
            Motion::Roll,
            "roll",
            "per_deg".to_owned(),
            1.0_f64.to_radians(),
        );
        let mut motions = match &self.course.wheels {
            WheelMotion::Heave(_) => vec![by_length(Motion::Heave, "heave")],
            WheelMotion::Roll { .. } => vec![roll, by_length(Motion::Heave, "heave")],
            WheelMotion::Travels { .. } => vec![
                by_length(Motion::TravelLeft, "travel_left"),
                by_length(Motion::TravelRight, "travel_right"),
            ],
        };
        if self.course.shows_rack {
            motions.push(by_length(Motion::Rack, "rack"));
        }
        motions
    }

    /// The columns: each value before its derivatives, forces last.
    pub fn columns(&self, axle: &Axle) -> Vec<AxleColumn> {
        let length = axle.left.length_unit;
        let rack_sign = axle.left.frame.sign(Axis::Y);
        let mut columns = Vec::new();
        for quantity in &self.quantities {
            let unit = quantity.unit();
            let (suffix, factor) = (unit.suffix(length), unit.printed_factor(length));
            let named = |stem: String, unit: &str| match unit.is_empty() {
                true => stem,
                false => format!("{stem}_{unit}"),
            };
            columns.push(AxleColumn {
                name: named(quantity.name(), &suffix),
                of: Of::Quantity(*quantity),
                by: None,
                unit: suffix.clone(),
                factor,
            });
            for (motion, by, per, by_factor) in self.motions(length) {
                let unit = match suffix.is_empty() {
                    true => per,
                    false => format!("{suffix}_{per}"),
                };
                let sign = if motion == Motion::Rack {
                    rack_sign
                } else {
                    1.0
                };
                columns.push(AxleColumn {
                    name: named(format!("{}_by_{by}", quantity.name()), &unit),
                    of: Of::Quantity(*quantity),
                    by: Some(motion),
                    unit,
                    factor: factor * by_factor * sign,
                });
            }
        }
        for side in [Side::Left, Side::Right] {
            columns.extend(self.carried(axle, side).columns().map(|force| AxleColumn {
                name: format!("{}_{}", side.name(), force.name),
                of: Of::Force {
                    name: format!("{}_{}", side.name(), force.output),
                    positive: force.positive.unwrap_or_default(),
                },
                by: None,
                unit: force.unit,
                factor: 1.0,
            }));
        }
        columns
    }

    /// The loads on one wheel, and what carries them.
    pub(super) fn carried<'a>(&'a self, axle: &'a Axle, side: Side) -> Loads<'a> {
        let mechanism = &axle.suspension(side).mechanism;
        Loads::of(mechanism, axle.frame(side), &self.loads[side as usize])
    }
}
