//! Columns of the designs on the page of a sweep.

use crate::report::chart::{AxisLayout, Quantity};
use crate::report::record::readable_unit;
use crate::report::split_unit;
use crate::report::sweep::SweepRun;
use crate::sweep::Kind;
use serde::Serialize;

/// A column of the table of designs.
#[derive(Serialize)]
pub(super) struct Column<'a> {
    column: &'a str,
    title: String,
    unit: String,
    kind: Option<Kind>,
    at_design: Option<f64>,
    /// Smallest margin of the constraint with which a design satisfies it. `None` for a column that is not a constraint.
    least: Option<f64>,
    /// Axis that shows the values of the designs on the page.
    axis: AxisLayout,
    /// Logarithmic axis for these values. `None` if one of them is not positive.
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
        let (title, unit) = split_unit(&v.column);
        let (title, unit) = (title.to_owned(), readable_unit(unit));
        Column::of(&v.column, title, unit, None, v.at_design, || shown(k))
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

/// Removes the unit from a column name: `camber_min_deg` -> `camber_min`. A name without this unit stays.
fn without_unit<'a>(column: &'a str, unit: &str) -> &'a str {
    let name = column.strip_suffix(unit);
    name.and_then(|name| name.strip_suffix('_'))
        .unwrap_or(column)
}
