//! Columns of the designs on the page of a sweep.

use crate::report::chart::{AxisLayout, Quantity};
use crate::report::record::readable_unit;
use crate::report::sweep::SweepRun;
use crate::sweep::{Kind, SweepRecord};
use serde::Serialize;

/// A column of the table of designs.
#[derive(Serialize)]
pub(super) struct Column<'a> {
    column: &'a str,
    title: String,
    unit: String,
    kind: Option<Kind>,
    at_design: Option<f64>,
    /// Smallest margin of a design that satisfies the constraint. `None` for other columns.
    least: Option<f64>,
    /// Axis for the designs on the page.
    axis: AxisLayout,
    /// Logarithmic axis. `None` if a value is not positive.
    log_axis: Option<AxisLayout>,
}

/// Columns of the variables and outputs.
pub(super) fn columns(run: &SweepRun) -> Vec<Column<'_>> {
    let record = &run.record;
    let shown = |k: usize| {
        let column = run.shown.columns.get(k).into_iter().flatten();
        column.flatten().copied()
    };
    let variables = record.variables.iter().enumerate().map(|(k, v)| {
        let unit = unit_of_variable(record, &v.column);
        let title = without_unit(&v.column, &unit).to_owned();
        Column::of(
            &v.column,
            title,
            readable_unit(&unit),
            None,
            v.at_design,
            || shown(k),
        )
    });
    let outputs = record.outputs.iter().enumerate().map(|(k, o)| {
        let title = without_unit(&o.column, &o.unit).replace('_', " ");
        let unit = match o.kind {
            Kind::Rms | Kind::Misfit => "tolerances".to_owned(),
            _ => readable_unit(&o.unit),
        };
        let k = record.variables.len() + k;
        let own = Column::of(&o.column, title, unit, Some(o.kind), o.at_design, || {
            shown(k)
        });
        Column {
            least: o.least,
            ..own
        }
    });
    variables.chain(outputs).collect()
}

impl<'a> Column<'a> {
    fn of<Values: Iterator<Item = f64>>(
        column: &'a str,
        title: String,
        unit: String,
        kind: Option<Kind>,
        at_design: Option<f64>,
        shown: impl Fn() -> Values,
    ) -> Self {
        let values = || shown().chain(at_design);
        let mut quantity = Quantity::new(column, &title, &unit);
        let axis = AxisLayout::unit(&quantity, values());
        quantity.is_log = true;
        let is_positive = values().all(|v| v > 0.0);
        let log_axis = is_positive.then(|| AxisLayout::unit(&quantity, values()));
        Column {
            column,
            title,
            unit,
            kind,
            at_design,
            least: None,
            axis,
            log_axis,
        }
    }
}

/// Unit of a variable. For a car, the unit is at the end of the column name, and a share has no unit. Otherwise, all variables are
/// lengths.
fn unit_of_variable(record: &SweepRecord, column: &str) -> String {
    if record.is_of_car() {
        unit_at_end(column, &record.length_unit)
    } else {
        record.length_unit.clone()
    }
}

/// Unit at the end of the name of a car's variable. Empty if the name has no unit.
fn unit_at_end(column: &str, length: &str) -> String {
    let of_force = |force: &str| {
        [
            format!("{force}_per_{length}"),
            format!("{force}_{length}_per_rad"),
            format!("{force}_{length}"),
            force.to_owned(),
        ]
    };
    // A longer unit comes before a unit with the same end: `N_mm` before `mm`.
    let of_forces = ["N", "lbf"].into_iter().flat_map(of_force);
    let others = ["kg", "lb", length].map(str::to_owned);
    let mut known = of_forces.chain(others);
    let is_own = |unit: &String| without_unit(column, unit) != column;
    known.find(is_own).unwrap_or_default()
}

/// Removes the unit from a column name: `camber_min_deg` -> `camber_min`. A name without this unit stays.
fn without_unit<'a>(column: &'a str, unit: &str) -> &'a str {
    let name = column.strip_suffix(unit);
    name.and_then(|name| name.strip_suffix('_'))
        .unwrap_or(column)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The unit of a rate is not the length at its end.
    #[test]
    fn units_of_a_car_are_whole() {
        for (column, length, unit) in [
            ("front_spring_rate_N_per_mm", "mm", "N_per_mm"),
            ("front_spring_rate_lbf_per_in", "in", "lbf_per_in"),
            ("rear_bar_rate_N_mm_per_rad", "mm", "N_mm_per_rad"),
            ("front_heave_bar_torque_N_mm", "mm", "N_mm"),
            ("front_spring_force_lbf", "in", "lbf"),
            ("mass_lb", "in", "lb"),
            ("cg_z_mm", "mm", "mm"),
            ("brake_share_front", "mm", ""),
        ] {
            assert_eq!(unit_at_end(column, length), unit, "{column}");
        }
    }
}
