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
    /// Smallest margin of a design that satisfies the constraint.
    least: Option<f64>,
    /// Axis for the designs on the page.
    axis: AxisLayout,
    /// Logarithmic axis, if every value is positive.
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
        let at_design = Some(v.at_design);
        Column::of(
            &v.column,
            title,
            readable_unit(&unit),
            None,
            at_design,
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

/// Unit of a variable. For a car, the unit is at the end of the column name. Otherwise, all variables are lengths.
fn unit_of_variable(record: &SweepRecord, column: &str) -> String {
    let length = &record.length_unit;
    if !record.is_of_car() {
        return length.clone();
    }
    let known = [
        format!("N_per_{length}"),
        format!("N_{length}_per_rad"),
        "kg".to_owned(),
        length.clone(),
    ];
    let is_own = |unit: &String| without_unit(column, unit) != column;
    known.into_iter().find(is_own).unwrap_or_default()
}

/// Removes the unit from a column name: `camber_min_deg` -> `camber_min`.
fn without_unit<'a>(column: &'a str, unit: &str) -> &'a str {
    let name = column.strip_suffix(unit);
    name.and_then(|name| name.strip_suffix('_'))
        .unwrap_or(column)
}
