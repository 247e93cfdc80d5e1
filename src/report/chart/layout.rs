//! Computes the positions of all elements of a chart, and writes the chart as SVG and as data.

mod drawing;
#[cfg(test)]
mod tests;

use super::labels::{end_labels, short_labels};
use super::{Chart, Line, Quantity, Scale, Wanted};
use crate::report::curve_table::CurveTable;
use crate::report::figure::power_of_ten;
use serde::Serialize;

/// Width and height of a chart.
pub(in crate::report) const SIZE: [f64; 2] = [420.0, 350.0];
/// Smallest distances of the plot from the left and the top edge of the chart.
const START: [f64; 2] = [68.0, 48.0];
/// Height of a line of remarks, from the second line on. The first line fits into the space above the plot.
const NOTE_LINE: f64 = 14.0;
/// Height of the space below the plot for the ticks and the title of the horizontal axis.
const BELOW: f64 = 44.0;
/// Height of the strip below the plot that shows deviations from targets, including the gap above it.
const STRIP: f64 = 44.0;
/// Width of a letter in labels of curves and ticks.
const LETTER: f64 = 7.0;
/// Width of a letter in remarks below the name of the chart.
const NOTE_LETTER: f64 = 6.5;

/// Layout of a chart. Positions are in picture units, with y downward.
#[derive(Clone, Debug, Serialize)]
pub(in crate::report) struct Layout {
    /// Name of the chart.
    pub key: String,
    /// Width and height of the chart.
    pub size: [f64; 2],
    /// Positions of the left, top, right and bottom edge of the plot.
    pub plot: [f64; 4],
    /// Positions of the top and bottom of the strip that shows deviations from targets. `None` without a strip.
    pub strip: Option<[f64; 2]>,
    /// Horizontal axis of the plot.
    pub x: AxisLayout,
    /// Vertical axis of the plot.
    pub y: AxisLayout,
    /// Curves in the plot.
    pub lines: Vec<LineLayout>,
    /// Labels at the ends of curves.
    pub labels: Vec<EndLabel>,
    /// Points of each target: value on the horizontal axis, lower limit and upper limit of the output.
    pub wanted: Vec<Vec<Limit>>,
    #[serde(skip)]
    chart: Chart,
    /// Lines of remarks below the name of the chart.
    #[serde(skip)]
    remarks: Vec<Vec<Remark>>,
    /// Words before the name of the chart.
    #[serde(skip)]
    before: String,
    #[serde(skip)]
    scales: [Scale; 2],
    #[serde(skip)]
    points: Vec<Vec<Option<[f64; 2]>>>,
    #[serde(skip)]
    fans: Vec<[Vec<Option<[f64; 2]>>; 2]>,
    #[serde(skip)]
    deviations: Vec<Deviations>,
}

/// Deviations of a curve from a target, as multiples of the target's tolerance.
#[derive(Clone, Debug)]
struct Deviations {
    /// Index of the curve in the chart.
    line: usize,
    /// Points of the deviation: value on the horizontal axis, and deviation.
    points: Vec<[f64; 2]>,
}

/// A remark below the name of a chart.
#[derive(Clone, Debug)]
struct Remark {
    class: &'static str,
    text: String,
    /// Position of the left end of the remark's text.
    at: f64,
}

/// Value on the horizontal axis, lower limit and upper limit of a target.
type Limit = (f64, Option<f64>, Option<f64>);

/// An axis with its ticks.
#[derive(Clone, Debug, Serialize)]
pub(in crate::report) struct AxisLayout {
    /// Column of the axis. For the same output of both wheels, the column of the first one.
    pub column: String,
    /// Readable name of the quantity.
    pub name: String,
    /// Readable unit of the quantity.
    pub unit: String,
    /// Value at the left or lower end of the axis.
    pub low: f64,
    /// Value at the right or upper end of the axis.
    pub high: f64,
    /// True for a logarithmic scale.
    pub is_log: bool,
    /// Power of ten that the labels of the ticks leave out.
    pub power: i32,
    /// Title of the axis: name, unit, and power of ten of the labels.
    pub title: String,
    /// Positions and labels of the ticks. A label times the power of ten is the value.
    pub ticks: Vec<(f64, String)>,
}

/// A curve for the page's script: rows of two columns of a table.
#[derive(Clone, Debug, Serialize)]
pub(in crate::report) struct LineLayout {
    /// Name of the curve in the list of values at the crosshair.
    pub told: String,
    /// CSS classes for colour and stroke of the curve.
    pub class: String,
    /// True for the main curve. Its value is the first in the list at the crosshair.
    pub is_main: bool,
    /// Index of the table with the curve's data.
    pub table: usize,
    /// Column of the horizontal axis.
    pub x: String,
    /// Column of the values.
    pub y: String,
    /// Rows of the table, in the order of the curve.
    pub rows: Vec<usize>,
}

/// A label at the end of a curve.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(in crate::report) struct EndLabel {
    /// Text of the label.
    pub text: String,
    /// CSS classes of the labelled curve.
    pub class: String,
    /// Position of the label: its left end, at half of its height.
    pub at: [f64; 2],
    /// Position of the end of the labelled curve.
    pub end: [f64; 2],
}

impl Chart {
    /// Lays out the chart with the values of these tables.
    pub(in crate::report) fn layout(self, tables: &[CurveTable]) -> Layout {
        let lines = self.lines.iter();
        let points: Vec<_> = lines.map(|line| self.points_of(line, tables)).collect();
        let fans: Vec<[Vec<_>; 2]> = (self.fans.iter())
            .map(|fan| fan.edges.each_ref().map(|edge| edge.points(tables)))
            .collect();
        let deviations = deviations(&self, &points);
        let all = || {
            let fans = fans.iter().flatten();
            points.iter().chain(fans).flatten().flatten().copied()
        };
        let edges: Vec<[f64; 2]> = self.wanted.iter().flat_map(Wanted::edges).collect();
        let own = || all().chain(edges.iter().copied());
        let zero = || self.from_zero.then_some(0.0).into_iter();
        let labels = short_labels(&self.lines);
        let longest = labels.iter().flatten().map(|l| l.chars().count()).max();
        let right = SIZE[0] - longest.map_or(16.0, |n| 14.0 + LETTER * n as f64);
        let has_strip = deviations.iter().any(|of| !of.points.is_empty());
        let bottom = SIZE[1] - BELOW - if has_strip { STRIP } else { 0.0 };
        let remarks = remarks(&self);
        let top = START[1] + NOTE_LINE * remarks.len().saturating_sub(1) as f64;
        let y_ticks = (bottom - top) / 34.0;
        let ends_y = [bottom, top];
        let values = own().map(|p| p[1]);
        let y = if self.y.is_log {
            Scale::logarithmic(values, ends_y)
        } else {
            Scale::showing(values.chain(zero()), y_ticks, ends_y)
        };
        // Long tick labels need space beside the title.
        let widest = y
            .ticks()
            .iter()
            .map(|(_, label)| label.chars().count())
            .max();
        let left = START[0] + LETTER * widest.unwrap_or(0).saturating_sub(5) as f64;
        let plot = [left, top, right, bottom];
        // The axis also covers positions without a value, so that a curve with few values does not fill the whole chart.
        let places = self
            .lines
            .iter()
            .flat_map(|line| line.source.places(tables));
        let places: Vec<f64> = places.filter(|x| !self.x.is_log || *x > 0.0).collect();
        let along = own()
            .map(|p| p[0])
            .chain(self.failed.iter().copied())
            .chain(places);
        let x_ticks = ((right - left) / 62.0).max(2.0);
        let ends_x = [left, right];
        let x = if self.x.is_log {
            Scale::logarithmic(along, ends_x)
        } else {
            Scale::within(along.chain(zero()), x_ticks, ends_x)
        };
        let labels = end_labels(&self.lines, labels, &points, &x, &y, plot);
        Layout {
            key: self.key.clone(),
            size: SIZE,
            plot,
            strip: has_strip.then_some([bottom + 10.0, bottom + STRIP]),
            x: AxisLayout::of(&self.x, &x),
            y: AxisLayout::of(&self.y, &y),
            lines: self.lines.iter().map(LineLayout::of).collect(),
            labels,
            wanted: self.wanted.iter().map(Wanted::limits).collect(),
            scales: [x, y],
            points,
            fans,
            deviations,
            remarks,
            before: String::new(),
            chart: self,
        }
    }

    /// Points of a curve. A logarithmic axis cannot show zero or negative values, so points with such values are `None`.
    fn points_of(&self, line: &Line, tables: &[CurveTable]) -> Vec<Option<[f64; 2]>> {
        let can_stand =
            |[x, y]: [f64; 2]| (!self.x.is_log || x > 0.0) && (!self.y.is_log || y > 0.0);
        let points = line.source.points(tables).into_iter();
        points
            .map(|point| point.filter(|p| can_stand(*p)))
            .collect()
    }
}

impl AxisLayout {
    /// Axis that shows these values. The positions of its ticks are fractions of the axis.
    pub(in crate::report) fn unit(quantity: &Quantity, values: impl Iterator<Item = f64>) -> Self {
        let ends = [0.0, 1.0];
        let scale = if quantity.is_log {
            Scale::logarithmic(values, ends)
        } else {
            Scale::showing(values, 6.0, ends)
        };
        AxisLayout::of(quantity, &scale)
    }

    fn of(quantity: &Quantity, scale: &Scale) -> Self {
        AxisLayout {
            column: quantity.column.clone(),
            name: quantity.name.clone(),
            unit: quantity.unit.clone(),
            low: scale.low,
            high: scale.high,
            is_log: scale.is_log,
            power: scale.power(),
            title: in_power(&quantity.title(), scale.power()),
            ticks: scale.ticks(),
        }
    }
}

impl LineLayout {
    fn of(line: &Line) -> Self {
        LineLayout {
            told: line.told.clone(),
            class: line.class.clone(),
            is_main: line.is_main,
            table: line.source.table,
            x: line.source.x.clone(),
            y: line.source.y.clone(),
            rows: line.source.rows.clone(),
        }
    }
}

/// Adds the power of ten of the ticks to an axis title: `camber gain [10⁻³ °/mm]`.
fn in_power(title: &str, power: i32) -> String {
    if power == 0 {
        return title.to_owned();
    }
    let factor = power_of_ten(power);
    match title.split_once('[') {
        Some((name, unit)) => format!("{name}[{factor} {unit}"),
        None => format!("{title} [{factor}]"),
    }
}

/// Deviations from targets for each curve that the strip shows. A curve is compared with the targets of its own column, at the
/// positions of each target.
fn deviations(chart: &Chart, points: &[Vec<Option<[f64; 2]>>]) -> Vec<Deviations> {
    let mut all = Vec::new();
    for (number, (line, points)) in chart.lines.iter().zip(points).enumerate() {
        if !line.in_strip {
            continue;
        }
        let wanted = chart.wanted.iter().filter_map(|wanted| match wanted {
            Wanted::Values {
                points: at,
                tolerance,
                column: Some(column),
            } if *tolerance > 0.0 && *column == line.source.y => Some((at, tolerance)),
            _ => None,
        });
        for (wanted, tolerance) in wanted {
            let of = wanted.iter().filter_map(|[place, value]| {
                let is = value_at(points, *place)?;
                Some([*place, (is - value) / tolerance])
            });
            all.push(Deviations {
                line: number,
                points: of.collect(),
            });
        }
    }
    all
}

/// Remarks below the name of a chart, in lines. The legends of the targets come first, each once. A remark that is longer than a
/// line continues on the next one.
fn remarks(chart: &Chart) -> Vec<Vec<Remark>> {
    const LEFT: f64 = 10.0;
    let mut own: Vec<(&'static str, String)> = Vec::new();
    for wanted in &chart.wanted {
        let legend = ("wanted", wanted.in_words(&chart.y.unit));
        if !own.contains(&legend) {
            own.push(legend);
        }
    }
    let missed = (!chart.missed.is_empty()).then(|| ("bad", "missed".to_owned()));
    let failed = (!chart.failed.is_empty()).then(|| ("bad", "not solved".to_owned()));
    let notes = chart.notes.iter().cloned();
    let mut lines: Vec<Vec<Remark>> = vec![Vec::new()];
    let mut at = LEFT;
    for (class, text) in own.into_iter().chain(missed).chain(failed).chain(notes) {
        let width = |text: &str| NOTE_LETTER * text.chars().count() as f64;
        if at > LEFT && at + width(&text) > SIZE[0] - 8.0 {
            lines.push(Vec::new());
            at = LEFT;
        }
        let mut rest = text.as_str();
        while !rest.is_empty() {
            let part = beginning(rest, ((SIZE[0] - 8.0 - at) / NOTE_LETTER) as usize);
            if let Some(line) = lines.last_mut() {
                let text = part.to_owned();
                line.push(Remark { class, text, at });
            }
            at += width(part) + 16.0;
            rest = rest[part.len()..].trim_start();
            if !rest.is_empty() {
                lines.push(Vec::new());
                at = LEFT;
            }
        }
    }
    lines
}

/// Beginning of a text: at most this many letters, in whole words if possible.
fn beginning(text: &str, most: usize) -> &str {
    match text.char_indices().nth(most.max(1)) {
        None => text,
        Some((end, _)) => match text[..end].rfind(' ') {
            Some(space) if space > 0 => &text[..space],
            _ => &text[..end],
        },
    }
}

/// Value of a curve at the position `place` on the horizontal axis, by linear interpolation between its points. `None` outside the
/// curve and in its gaps.
fn value_at(points: &[Option<[f64; 2]>], place: f64) -> Option<f64> {
    let known = || points.iter().flatten();
    if let Some([_, value]) = known().find(|[at, _]| *at == place) {
        return Some(*value);
    }
    points.windows(2).find_map(|pair| {
        let [Some(a), Some(b)] = [pair[0], pair[1]] else {
            return None;
        };
        let share = (place - a[0]) / (b[0] - a[0]);
        ((0.0..=1.0).contains(&share)).then(|| a[1] + share * (b[1] - a[1]))
    })
}

impl Layout {
    /// Adds words before the name of the chart. The title of the vertical axis does not change.
    pub(in crate::report) fn named(mut self, before: &str) -> Self {
        before.clone_into(&mut self.before);
        self
    }

    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.scales[0].place(x), self.scales[1].place(y)]
    }

    /// Description of the chart: title of the vertical axis over title of the horizontal axis.
    pub(in crate::report) fn description(&self) -> String {
        format!("{} over {}", self.chart.y.title(), self.chart.x.title())
    }
}
