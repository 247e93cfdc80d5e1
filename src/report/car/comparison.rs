//! Results of several cars side by side.

use super::{CarResults, CarState};
use crate::car::{AxleParameter, Car};
use crate::car::{BodyParameter, CarQuantity, Moves, WheelResult};
use crate::model::{Axis, LengthUnit, PointId, Side};
use crate::number::Vector3;
use crate::report::figure::resolution;
use crate::report::files::csv_of_rows;
use crate::report::optional;
use crate::report::table::{Cell, Table};

/// A result of a load case, with a value for each car.
struct Row {
    case: String,
    quantity: CarQuantity,
    unit: String,
    values: Vec<Option<f64>>,
}

/// A parameter or a coordinate that differs between the cars.
struct Change {
    name: String,
    unit: String,
    values: Vec<Option<f64>>,
}

/// Results of several cars side by side.
pub struct CarComparison {
    labels: Vec<String>,
    rows: Vec<Row>,
    changes: Vec<Change>,
}

impl CarComparison {
    /// Compares cars, each with its label. The comparison has the load cases, results and units of the first car, and parameters in
    /// its axes. If a car does not have a case or a result, the cells are empty.
    ///
    /// # Errors
    /// No cars were given.
    pub fn of(cars: &[(String, CarResults<'_>)]) -> Result<Self, String> {
        let Some((_, first)) = cars.first() else {
            return Err("no cars were given".to_owned());
        };
        let length = first.study.car.length_unit;
        let mut rows = Vec::new();
        for case in &first.study.cases {
            for quantity in &first.study.quantities {
                let unit = quantity.info().unit;
                let value = |(_, of): &(String, CarResults<'_>)| {
                    let value = of.value(&case.name, *quantity)?;
                    Some(match of.study.car.length_unit {
                        own if own == length => value,
                        own => unit.reprinted(value, own, length),
                    })
                };
                let values: Vec<_> = cars.iter().map(value).collect();
                if values.iter().any(Option::is_some) {
                    rows.push(Row {
                        case: case.name.clone(),
                        quantity: *quantity,
                        unit: unit.suffix(length),
                        values,
                    });
                }
            }
        }
        let cars_alone: Vec<&Car> = cars.iter().map(|(_, of)| &of.study.car).collect();
        Ok(CarComparison {
            labels: cars.iter().map(|(label, _)| label.clone()).collect(),
            rows,
            changes: changes(&cars_alone),
        })
    }

    /// `comparison.csv`: one row for each result of each case, with differences from the first car.
    pub fn csv(&self) -> Vec<u8> {
        let others = &self.labels[1..];
        let mut header = ["case", "output", "unit"].map(str::to_owned).to_vec();
        header.extend(self.labels.iter().cloned());
        header.extend(others.iter().map(|label| format!("{label}_difference")));
        let rows = self.rows.iter().map(|row| {
            let mut cells = vec![row.case.clone(), row.quantity.name(), row.unit.clone()];
            cells.extend(row.values.iter().map(|value| optional(*value)));
            let first = row.values[0];
            let differences = row.values[1..].iter();
            cells.extend(
                differences.map(|own| optional(own.zip(first).map(|(own, first)| own - first))),
            );
            cells
        });
        csv_of_rows(std::iter::once(header).chain(rows))
    }

    /// Table of the results that differ between the cars by more than rounding errors, or that a car lacks: wheel loads, and
    /// results of the whole car. `comparison.csv` has all results.
    pub fn table(&self) -> Table {
        let is_key = |row: &&Row| {
            matches!(
                row.quantity,
                CarQuantity::Whole(_) | CarQuantity::Wheel(_, WheelResult::Load)
            )
        };
        let head = ["case", "output", "unit"].map(str::to_owned);
        let mut table = Table::with_columns(head.into_iter().chain(self.labels.iter().cloned()));
        let rows = self.rows.iter().filter(is_key);
        for row in rows.filter(|row| differ(&row.values, &row.unit)) {
            let name = row.quantity.name();
            let head = [row.case.as_str(), name.as_str(), row.unit.as_str()].map(Cell::from);
            let cells = row.values.iter();
            let cells = cells.map(|v| Cell::from(v.map(|v| Cell::figure(v, &row.unit))));
            table.push_row(head.into_iter().chain(cells));
        }
        table
    }

    /// Table of parameters, rates and coordinates that differ between the cars.
    pub fn changes_table(&self) -> Table {
        let head = ["changed", "unit"].map(str::to_owned);
        let mut table = Table::with_columns(head.into_iter().chain(self.labels.iter().cloned()));
        for change in &self.changes {
            let head = [change.name.as_str(), change.unit.as_str()].map(Cell::from);
            let cells = change.values.iter();
            let cells = cells.map(|v| Cell::from(v.map(|v| Cell::figure(v, &change.unit))));
            table.push_row(head.into_iter().chain(cells));
        }
        table
    }
}

impl CarResults<'_> {
    /// Printed value of a result in the case with this name. `None` if the car lacks the case, its equilibrium or the result.
    fn value(&self, case: &str, quantity: CarQuantity) -> Option<f64> {
        let number = self.study.cases.iter().position(|own| own.name == case)?;
        match &self.states[number] {
            CarState::Solved { solved, .. } if quantity.is_met_by(&self.study.car) => {
                quantity.printed(solved, &self.study.cases[number])
            }
            _ => None,
        }
    }
}

/// True if the values of a result differ between the cars by more than rounding errors in `unit`, or if some of them are missing.
fn differ(values: &[Option<f64>], unit: &str) -> bool {
    let mut known = values.iter().flatten();
    let Some(first) = known.next() else {
        return false;
    };
    let apart = known.any(|value| (value - first).abs() >= resolution(unit));
    apart || values.iter().any(Option::is_none)
}

/// Sign factor that converts a parameter of `car` from the axes of this car to the axes of the first car.
fn sign_in_first(moves: &Moves, first: &Car, car: &Car) -> f64 {
    let axis = match moves {
        Moves::Body(BodyParameter::CgX) => Axis::X,
        Moves::Body(BodyParameter::CgY) => Axis::Y,
        Moves::Body(BodyParameter::CgZ) => Axis::Z,
        _ => return 1.0,
    };
    // A car has the axes of the study of its front axle.
    let [to, from] = [first, car].map(|car| car.axles[0].left.frame.sign(axis));
    to * from
}

/// Converts a value of a car to the units of the first car.
fn in_first_units(moves: &Moves, first: &Car, car: &Car, value: f64) -> f64 {
    match moves {
        Moves::Body(BodyParameter::Mass) if car.mass_unit != first.mass_unit => {
            value * car.mass_unit.kilograms() / first.mass_unit.kilograms()
        }
        Moves::Body(
            BodyParameter::Mass | BodyParameter::BrakeShareFront | BodyParameter::DriveShareFront,
        ) => value,
        Moves::Rate { parameter, .. } => {
            let [from, to] = [car, first].map(|car| car.length_unit);
            let value = value * from.newtons() / to.newtons();
            match parameter {
                // The unit of these rates is force per length.
                AxleParameter::SpringRate
                | AxleParameter::HeaveSpringRate
                | AxleParameter::TyreRate => from.convert(value, to),
                // The unit of the other rates is force times length per angle.
                _ => to.convert(value, from),
            }
        }
        Moves::Hardpoints(_) | Moves::Body(_) | Moves::Wheelbase => {
            first.length_unit.convert(value, car.length_unit)
        }
    }
}

/// Largest relative difference of equal values in different units, which comes from rounding in the conversion.
const ROUNDING: f64 = 1e-12;

/// Returns true if a value differs from the value of the first car. Values in the same units must be equal bit for bit.
fn is_changed(first: Option<f64>, other: Option<f64>, in_same_units: bool) -> bool {
    match (first, other) {
        (Some(a), Some(b)) if !in_same_units => (a - b).abs() > ROUNDING * a.abs().max(b.abs()),
        _ => first != other,
    }
}

/// Position of a wheel's point in the kernel's frame of this wheel, in `unit`. The wheel is the index of its axle and its side.
/// `None` if the wheel has no point of this name.
fn place_of(
    car: &Car,
    (axle, side): (usize, Side),
    name: &str,
    unit: LengthUnit,
) -> Option<Vector3<f64>> {
    let wheel = car.axles[axle].suspension(side);
    let point = wheel.mechanism.point(name)?;
    let convert = |length: f64| unit.convert(length, wheel.length_unit);
    Some(Vector3::from(wheel.design[point.0].to_array().map(convert)))
}

/// Parameters, rates and coordinates of the first car that differ in another car, in the units and axes of the first car. The
/// points of right wheels are included if the right wheel of a car has hardpoints of its own.
fn changes(cars: &[&Car]) -> Vec<Change> {
    let mut changes = Vec::new();
    let units = |car: &Car| (car.length_unit, car.mass_unit);
    let in_same_units = |k: usize| units(cars[k]) == units(cars[0]);
    let mut push = |name: String, unit: String, values: Vec<Option<f64>>| {
        let mut others = values.iter().enumerate();
        if others.any(|(k, value)| is_changed(values[0], *value, in_same_units(k))) {
            changes.push(Change { name, unit, values });
        }
    };
    for moves in Moves::values() {
        let value = |car: &&Car| {
            let value = in_first_units(&moves, cars[0], car, moves.value(car)?);
            Some(value * sign_in_first(&moves, cars[0], car) + 0.0)
        };
        let values = cars.iter().map(value).collect();
        push(moves.label(cars[0]), moves.unit(cars[0]), values);
    }
    for axle in [0, 1] {
        for side in Side::ALL {
            if side == Side::Right && cars.iter().all(|car| car.axles[axle].own_right().is_none()) {
                continue;
            }
            let prefix = match side {
                Side::Left => "",
                Side::Right => "right_",
            };
            let mechanism = &cars[0].axles[axle].suspension(side).mechanism;
            for number in 0..mechanism.points.len() {
                let name = mechanism.name(PointId(number));
                for coordinate in Axis::ALL {
                    let values = cars.iter().map(|car| {
                        let place = place_of(car, (axle, side), name, cars[0].length_unit)?;
                        let frame = cars[0].axles[axle].frame(side);
                        Some(frame.sign(coordinate) * place[coordinate] + 0.0)
                    });
                    let (end, axis) = (crate::car::AXLE_NAMES[axle], coordinate.name());
                    let label = format!("{end}.{prefix}{name}.{axis}");
                    let unit = cars[0].length_unit.symbol().to_owned();
                    push(label, unit, values.collect());
                }
            }
        }
    }
    changes
}
