//! Columns of an axle's curves: names that say what a number is and in what unit.

use super::reading::WheelParts;
use super::state::Motion;
use super::{Axle, AxlePlan, Quantity, Read, Void, WheelMotion};
use crate::curves::Loads;
use crate::model::{Axis, LengthUnit, PointId, Side};

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
    /// A coordinate of a point of one wheel's suspension.
    Point {
        /// Which wheel.
        side: Side,
        /// Number of the point among those of the plan.
        number: usize,
        /// The point.
        id: PointId,
        /// The coordinate.
        axis: Axis,
        /// Its name without the unit.
        name: String,
        /// Whether it stands on a rocker.
        on_rocker: bool,
    },
    /// A component of the angular velocity of one wheel carrier.
    Turn(Side, Axis),
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
            _ => None,
        }
    }

    /// What a position has of it, in radians, length units and newtons, or why there is none; `None` of a force, which
    /// is not read of the position alone.
    pub fn evaluate(&self, read: &Read) -> Option<Result<f64, Void>> {
        match &self.of {
            Of::Quantity(quantity) => Some(self.quantity_in(*quantity, read)),
            Of::Point {
                side, on_rocker, ..
            } if *on_rocker && read.toggles[*side as usize].is_some() => Some(Err(Void::Toggle)),
            Of::Point {
                side, number, axis, ..
            } => {
                let place = &read.points[*side as usize][*number][*axis];
                let by = [[1, 0], [0, 1]].map(|powers| place.coefficient(powers));
                Some(Ok(match self.by {
                    None => place.coefficient([0, 0]),
                    Some(motion) => read.state.along(motion, *side, by),
                }))
            }
            Of::Turn(side, axis) => {
                let wheel = &read.state.readings[*side as usize];
                let by = [wheel.by_travel(), wheel.by_rack()].map(|[_, turn]| turn[*axis]);
                Some(Ok(read.state.along(self.by?, *side, by)))
            }
            Of::Force { .. } => None,
        }
    }

    fn quantity_in(&self, quantity: Quantity, read: &Read) -> Result<f64, Void> {
        if read.is_stuck(quantity) {
            return Err(Void::Toggle);
        }
        let value = quantity.value(&read.state)?;
        Ok(match self.by {
            None => value,
            Some(motion) => quantity.evaluate(&read.state.moving(motion))[1],
        })
    }

    /// What it is of, without motion and unit.
    pub fn output(&self) -> String {
        match &self.of {
            Of::Quantity(quantity) => quantity.name(),
            Of::Point { name, .. } | Of::Force { name, .. } => name.clone(),
            Of::Turn(side, axis) => format!("{}_knuckle_omega_{}", side.name(), axis.name()),
        }
    }

    /// When it is positive, in words; of a value alone, not of its derivatives.
    pub fn positive(&self) -> Option<&'static str> {
        match &self.of {
            _ if self.by.is_some() => None,
            Of::Quantity(quantity) => Some(quantity.positive()),
            Of::Force { positive, .. } => Some(positive),
            Of::Point { .. } | Of::Turn(..) => None,
        }
    }
}

/// Three components of the left wheel, three of the right one.
fn by_wheel() -> impl Iterator<Item = (Side, Axis)> {
    let sides = [Side::Left, Side::Right].into_iter();
    sides.flat_map(|side| Axis::ALL.map(|axis| (side, axis)))
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

    /// The columns: each value before its derivatives; quantities, points, wheel carriers, forces.
    pub fn columns(&self, axle: &Axle) -> Vec<AxleColumn> {
        let length = axle.left.length_unit;
        let motions = self.motions(length);
        let rack_sign = axle.left.frame.sign(Axis::Y);
        let mut columns = Vec::new();
        let named = |stem: String, unit: &str| match unit.is_empty() {
            true => stem,
            false => format!("{stem}_{unit}"),
        };
        let value = |of: Of, unit: String, factor: f64| {
            let mut column = AxleColumn {
                name: String::new(),
                of,
                by: None,
                unit,
                factor,
            };
            column.name = named(column.output(), &column.unit);
            column
        };
        let derivatives = |value: &AxleColumn| -> Vec<AxleColumn> {
            let by = |(motion, by, per, by_factor): &(Motion, &str, String, f64)| {
                let unit = match value.unit.is_empty() {
                    true => per.clone(),
                    false => format!("{}_{per}", value.unit),
                };
                let sign = match motion {
                    Motion::Rack => rack_sign,
                    _ => 1.0,
                };
                AxleColumn {
                    name: named(format!("{}_by_{by}", value.output()), &unit),
                    by: Some(*motion),
                    factor: value.factor * by_factor * sign,
                    unit,
                    of: value.of.clone(),
                }
            };
            motions.iter().map(by).collect()
        };
        for quantity in &self.quantities {
            let unit = quantity.unit();
            let (suffix, factor) = (unit.suffix(length), unit.printed_factor(length));
            let value = value(Of::Quantity(*quantity), suffix, factor);
            let derivatives = derivatives(&value);
            columns.push(value);
            columns.extend(derivatives);
        }
        for (number, id) in self.points.iter().enumerate() {
            for (side, axis) in by_wheel() {
                let mechanism = &axle.suspension(side).mechanism;
                let of = Of::Point {
                    side,
                    number,
                    id: *id,
                    axis,
                    name: format!("{}_{}_{}", side.name(), mechanism.name(*id), axis.name()),
                    on_rocker: mechanism.rockers_moving(*id).next().is_some(),
                };
                let sign = axle.frame(side).sign(axis);
                let value = value(of, length.symbol().to_owned(), sign);
                let derivatives = derivatives(&value);
                columns.push(value);
                columns.extend(derivatives);
            }
        }
        if self.knuckle {
            for (side, axis) in by_wheel() {
                let sign = axle.frame(side).turn_sign(axis);
                let turn = value(Of::Turn(side, axis), "rad".to_owned(), sign);
                columns.extend(derivatives(&turn));
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
