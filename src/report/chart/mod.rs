//! The chart component of `--plots` and of pages. It makes the layout, as SVG and as data for a page's script.
//!
//! A [`Chart`] has curves over one quantity, their targets, and stations without a value. [`Chart::layout`] chooses scales,
//! ticks, titles and positions of labels. A [`Layout`] is written as SVG, and as JSON with the scales and the rows of the curves.
//! The script of a page adds a crosshair and a zoom to this SVG. It draws no chart itself.
//!
//! The live page draws curves by its own script (`src/studio/page/curves.js`): during a drag, the script only moves existing
//! paths. A layout from this module would be a new SVG of every chart for each movement of the pointer. A browser needs too
//! long for that.

mod families;
mod glyphs;
mod labels;
mod layout;
pub(super) mod lettering;
pub(super) mod mark;
mod of_run;
mod scale;
mod style;
mod wanted;

pub(super) use families::{Family, families, moving_beside};
pub(super) use labels::{shortened, told_apart};
pub(super) use layout::{AxisLayout, Layout, SIZE};
pub(super) use lettering::Lettering;
pub(super) use of_run::{ChartGroup, Charted, chart_groups, charts_over, hue, in_words};
pub(super) use scale::Scale;
pub(super) use style::{page_style, picture_style};
pub(super) use wanted::Wanted;

use super::curve_table::CurveTable;

/// An axis of a chart.
#[derive(Clone, Debug, Default)]
pub(super) struct Quantity {
    /// Column of the values. For the same output of both wheels, the column of the first one.
    pub column: String,
    /// Readable name of the quantity.
    pub name: String,
    /// Readable unit of the quantity. Empty for a dimensionless number.
    pub unit: String,
    /// True for a logarithmic scale of the axis.
    pub is_log: bool,
}

impl Quantity {
    /// Makes a linear axis.
    pub(in crate::report) fn new(column: &str, name: &str, unit: &str) -> Self {
        Quantity {
            column: column.to_owned(),
            name: name.to_owned(),
            unit: unit.to_owned(),
            is_log: false,
        }
    }

    /// Makes the axis for a column of the motion: `travel_mm` -> wheel travel [mm].
    pub(in crate::report) fn of_column(column: &str) -> Self {
        let (name, unit) = column.rsplit_once('_').unwrap_or((column, ""));
        let name = match name {
            "travel" => "wheel travel".to_owned(),
            "roll" => "roll angle".to_owned(),
            name => name.replace('_', " "),
        };
        Quantity::new(column, &name, if unit == "deg" { "°" } else { unit })
    }

    /// Name with unit: `camber [°]`.
    pub(in crate::report) fn title(&self) -> String {
        match self.unit.as_str() {
            "" => self.name.clone(),
            unit => format!("{} [{unit}]", self.name),
        }
    }
}

/// Data of a curve: rows of two columns of a table.
#[derive(Clone, Debug, Default)]
pub(super) struct Source {
    /// Index of the table with the curve's data.
    pub table: usize,
    /// Column of the horizontal axis.
    pub x: String,
    /// Column of the values.
    pub y: String,
    /// Rows of the table, in the order of the curve.
    pub rows: Vec<usize>,
}

impl Source {
    /// Values on the horizontal axis, including rows without a value on the vertical axis.
    fn places(&self, tables: &[CurveTable]) -> Vec<f64> {
        let table = tables.get(self.table);
        let x = table.and_then(|table| table.column(&self.x));
        let x = x.unwrap_or_default();
        let rows = self.rows.iter().filter_map(|row| *x.get(*row)?);
        rows.collect()
    }

    /// Points of the curve. A row without a value is `None`. Empty if the table lacks one of the columns.
    fn points(&self, tables: &[CurveTable]) -> Vec<Option<[f64; 2]>> {
        let Some(table) = tables.get(self.table) else {
            return Vec::new();
        };
        let (Some(x), Some(y)) = (table.column(&self.x), table.column(&self.y)) else {
            return Vec::new();
        };
        let rows = self.rows.iter();
        rows.map(|row| Some([x[*row]?, y[*row]?])).collect()
    }
}

/// A curve of a chart.
#[derive(Clone, Debug)]
pub(super) struct Line {
    /// Label at the end of the curve. `None` if the curve needs no label.
    pub label: Option<String>,
    /// Name of the curve in the list of values at the crosshair.
    pub told: String,
    /// CSS classes for colour and stroke of the curve.
    pub class: String,
    /// True for a main curve. Its value comes first at the crosshair.
    pub is_main: bool,
    /// True if the strip below the plot shows the curve's deviations from targets.
    pub in_strip: bool,
    /// True if each point has a dot.
    pub has_dots: bool,
    /// Data of the curve.
    pub source: Source,
}

/// Area between two curves with the same rows.
#[derive(Clone, Debug)]
pub(super) struct Fan {
    /// CSS class for the colour of the area.
    pub class: &'static str,
    /// Lower and upper curve that bound the area.
    pub edges: [Source; 2],
}

/// A chart with its curves, targets and remarks.
#[derive(Clone, Debug, Default)]
pub(super) struct Chart {
    /// Name of the chart, and of its file.
    pub key: String,
    /// Quantity of the horizontal axis.
    pub x: Quantity,
    /// Quantity of the vertical axis.
    pub y: Quantity,
    /// Remarks below the name of the chart: CSS class and text of each remark.
    pub notes: Vec<(&'static str, String)>,
    /// Areas behind the curves.
    pub fans: Vec<Fan>,
    /// Curves, the most important one last.
    pub lines: Vec<Line>,
    /// Targets of the curves.
    pub wanted: Vec<Wanted>,
    /// Points at which the last design of a tuning misses a target by more than its tolerance.
    pub missed: Vec<[f64; 2]>,
    /// Positions on the horizontal axis at which a design has no pose.
    pub failed: Vec<f64>,
    /// True if both axes include 0.
    pub from_zero: bool,
}
