//! Computes the positions of all elements of a chart, and writes the chart as SVG and as data.

use super::labels::{end_labels, short_labels};
use super::lettering::{Anchor, Lettering, Words};
use super::mark::{number, path};
use super::{Chart, Line, Quantity, Scale, Wanted};
use crate::report::curve_table::CurveTable;
use crate::report::figure::power_of_ten;
use serde::Serialize;
use std::fmt::Write;

/// Width and height of a chart.
pub(in crate::report) const SIZE: [f64; 2] = [420.0, 350.0];
/// Left and top of the plot within the chart.
const START: [f64; 2] = [62.0, 48.0];
/// Height of the space below the plot for ticks and title.
const BELOW: f64 = 44.0;
/// Height of the strip of deviations, including the gap above it.
const STRIP: f64 = 44.0;
/// Largest deviation that the strip shows, in tolerances.
const MOST_DEVIATION: f64 = 2.0;
/// Widths of letters, for labels and for the title beside the plot.
const LETTER: f64 = 7.0;
const TITLE_LETTER: f64 = 7.0;

/// Layout of a chart. Positions are in picture units.
#[derive(Clone, Debug, Serialize)]
pub(in crate::report) struct Layout {
    /// Name of the chart.
    pub key: String,
    /// Width and height.
    pub size: [f64; 2],
    /// Left, top, right and bottom of the plot.
    pub plot: [f64; 4],
    /// Top and bottom of the strip of deviations.
    pub strip: Option<[f64; 2]>,
    /// Horizontal axis.
    pub x: AxisLayout,
    /// Vertical axis.
    pub y: AxisLayout,
    /// Curves.
    pub lines: Vec<LineLayout>,
    /// Labels at the ends of curves.
    pub labels: Vec<EndLabel>,
    /// Target values: position on the horizontal axis, lower limit and upper limit.
    pub wanted: Vec<Vec<Limit>>,
    #[serde(skip)]
    chart: Chart,
    #[serde(skip)]
    scales: [Scale; 2],
    #[serde(skip)]
    points: Vec<Vec<Option<[f64; 2]>>>,
    #[serde(skip)]
    fans: Vec<[Vec<Option<[f64; 2]>>; 2]>,
    #[serde(skip)]
    deviations: Vec<Vec<[f64; 2]>>,
}

/// Position on the horizontal axis, lower limit and upper limit of a target.
type Limit = (f64, Option<f64>, Option<f64>);

/// An axis with its ticks.
#[derive(Clone, Debug, Serialize)]
pub(in crate::report) struct AxisLayout {
    /// Column of the axis. Empty if the axis shows several columns.
    pub column: String,
    /// Readable name.
    pub name: String,
    /// Readable unit.
    pub unit: String,
    /// Value at the first end.
    pub low: f64,
    /// Value at the other end.
    pub high: f64,
    /// True for a logarithmic scale.
    pub is_log: bool,
    /// Positions and labels of the ticks.
    pub ticks: Vec<(f64, String)>,
}

/// A curve for the page's script: rows of two columns of a table.
#[derive(Clone, Debug, Serialize)]
pub(in crate::report) struct LineLayout {
    /// Name in the list of values at the crosshair.
    pub told: String,
    /// Classes for colour and stroke.
    pub class: String,
    /// True for the main curve. Its value comes first, and the chart shows its deviations.
    pub is_main: bool,
    /// Index of the table.
    pub table: usize,
    /// Column of the horizontal axis.
    pub x: String,
    /// Column of the values.
    pub y: String,
    /// Rows of the table.
    pub rows: Vec<usize>,
}

/// A label at the end of a curve.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(in crate::report) struct EndLabel {
    /// Text of the label.
    pub text: String,
    /// Classes of the labelled curve.
    pub class: String,
    /// Position of the label: left end, at half of its height.
    pub at: [f64; 2],
    /// End of the labelled curve.
    pub end: [f64; 2],
}

impl Chart {
    /// Lays out the chart with the values of these tables.
    pub(in crate::report) fn layout(self, tables: &[CurveTable]) -> Layout {
        // A logarithmic axis cannot show zero.
        let can_stand =
            |[x, y]: [f64; 2]| (!self.x.is_log || x > 0.0) && (!self.y.is_log || y > 0.0);
        let of_line = |line: &Line| -> Vec<Option<[f64; 2]>> {
            let points = line.source.points(tables).into_iter();
            points
                .map(|point| point.filter(|p| can_stand(*p)))
                .collect()
        };
        let points: Vec<_> = self.lines.iter().map(of_line).collect();
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
        let has_strip = deviations.iter().any(|of| !of.is_empty());
        let bottom = SIZE[1] - BELOW - if has_strip { STRIP } else { 0.0 };
        let y_ticks = (bottom - START[1]) / 34.0;
        let ends_y = [bottom, START[1]];
        let values = own().map(|p| p[1]);
        let y = match self.y.is_log {
            true => Scale::logarithmic(values, ends_y),
            false => Scale::showing(values.chain(zero()), y_ticks, ends_y),
        };
        // Long tick labels need space beside the title.
        let widest = y
            .ticks()
            .iter()
            .map(|(_, label)| label.chars().count())
            .max();
        let left = START[0] + LETTER * widest.unwrap_or(0).saturating_sub(5) as f64;
        let plot = [left, START[1], right, bottom];
        // Positions without a value also count, so that a curve with few values does not fill the whole chart.
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
        let x = match self.x.is_log {
            true => Scale::logarithmic(along, ends_x),
            false => Scale::within(along.chain(zero()), x_ticks, ends_x),
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
            chart: self,
        }
    }
}

impl AxisLayout {
    /// Axis of length 1 that shows these values.
    pub(in crate::report) fn unit(quantity: &Quantity, values: impl Iterator<Item = f64>) -> Self {
        let ends = [0.0, 1.0];
        let scale = match quantity.is_log {
            true => Scale::logarithmic(values, ends),
            false => Scale::showing(values, 6.0, ends),
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

/// Deviations of the main curve from each target, in tolerances, at the positions of the target.
fn deviations(chart: &Chart, points: &[Vec<Option<[f64; 2]>>]) -> Vec<Vec<[f64; 2]>> {
    let mut all = Vec::new();
    for (line, points) in chart.lines.iter().zip(points) {
        if !line.is_main {
            continue;
        }
        let wanted = chart.wanted.iter().filter_map(|wanted| match wanted {
            Wanted::Values {
                points: at,
                tolerance,
            } if *tolerance > 0.0 => Some((at, tolerance)),
            _ => None,
        });
        for (wanted, tolerance) in wanted {
            let of = wanted.iter().filter_map(|[place, value]| {
                let is = value_at(points, *place)?;
                Some([*place, (is - value) / tolerance])
            });
            all.push(of.collect());
        }
    }
    all
}

/// Value of a curve at a position, by linear interpolation between its points.
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
    /// Adds words before the name.
    pub(in crate::report) fn named(mut self, before: &str) -> Self {
        self.chart.y.name.insert_str(0, before);
        self
    }

    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.scales[0].place(x), self.scales[1].place(y)]
    }

    /// Describes the content of the chart in words.
    pub(in crate::report) fn description(&self) -> String {
        format!("{} over {}", self.y_title(), self.chart.x.title())
    }

    fn y_title(&self) -> String {
        self.chart.y.title()
    }

    /// Chart as an SVG group, moved by `shift` to the right and down.
    pub(in crate::report) fn group(&self, shift: [f64; 2], lettering: &Lettering) -> String {
        let [across, down] = shift.map(number);
        format!(
            "<g transform=\"translate({across} {down})\">\n{}</g>\n",
            self.content(lettering)
        )
    }

    /// Chart as an SVG element for a page.
    pub(in crate::report) fn element(&self) -> String {
        let [width, height] = self.size;
        format!(
            "<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{}\">\n{}</svg>",
            super::lettering::text(&self.description()).replace('"', "&quot;"),
            self.content(&Lettering::Text)
        )
    }

    fn content(&self, lettering: &Lettering) -> String {
        let mut svg = String::new();
        self.heading(&mut svg, lettering);
        svg += "<g class=\"axes\">\n";
        self.axes(&mut svg, lettering);
        svg += "</g>\n<g class=\"inner\">\n";
        for (fan, [low, high]) in self.chart.fans.iter().zip(&self.fans) {
            let pairs: Vec<_> = (low.iter().zip(high)).map(|(a, b)| (*a).zip(*b)).collect();
            for piece in pairs.split(Option::is_none) {
                let below = piece.iter().flatten().map(|(a, _)| *a);
                let above = piece.iter().flatten().rev().map(|(_, b)| *b);
                let outline = below.chain(above).map(|p| self.place(p));
                path(&mut svg, fan.class, outline, true);
            }
        }
        let place = |p: [f64; 2]| self.place(p);
        for wanted in &self.chart.wanted {
            wanted.draw(&mut svg, &place);
        }
        for missed in &self.chart.missed {
            path(&mut svg, "missed", [place(*missed)].into_iter(), false);
        }
        for (line, points) in self.chart.lines.iter().zip(&self.points) {
            let class = format!("line {}", line.class);
            for piece in points.split(Option::is_none) {
                let places = piece.iter().flatten().map(|p| place(*p));
                path(&mut svg, &class, places, false);
            }
            let class = format!("dot {}", line.class);
            for point in points.iter().flatten().filter(|_| line.has_dots) {
                path(&mut svg, &class, [place(*point)].into_iter(), false);
            }
        }
        svg += "</g>\n";
        self.gaps(&mut svg);
        self.strip(&mut svg, lettering);
        svg += "<g class=\"labels\">\n";
        for EndLabel {
            text,
            class,
            at,
            end,
        } in &self.labels
        {
            if (at[1] - end[1]).abs() > 5.0 || at[0] - end[0] > 14.0 {
                let ends = [[end[0] + 2.0, end[1]], [at[0] - 2.0, at[1]]];
                path(&mut svg, "leader", ends.into_iter(), false);
            }
            let class = format!("end {}", colour_of(class));
            let place = [at[0], at[1] + 4.0];
            lettering.write(
                &mut svg,
                &Words::new(text, place, Anchor::Start).class(&class),
            );
            svg.push('\n');
        }
        svg + "</g>\n"
    }

    /// Writes the name on its own line, with remarks below it.
    fn heading(&self, svg: &mut String, lettering: &Lettering) {
        let mut name = self.chart.y.name.chars();
        let name: String = name
            .next()
            .into_iter()
            .flat_map(char::to_uppercase)
            .chain(name)
            .collect();
        lettering.write(
            svg,
            &Words::new(&name, [10.0, 20.0], Anchor::Start)
                .label()
                .class("name"),
        );
        svg.push('\n');
        let mut at = 10.0;
        let own = self
            .chart
            .wanted
            .first()
            .map(|wanted| ("wanted", wanted.in_words(&self.chart.y.unit)));
        let missed = (!self.chart.missed.is_empty()).then(|| ("bad", "missed".to_owned()));
        let failed = (!self.chart.failed.is_empty()).then(|| ("bad", "not solved".to_owned()));
        let notes = self.chart.notes.iter().cloned();
        for (class, text) in own.into_iter().chain(missed).chain(failed).chain(notes) {
            let room = ((SIZE[0] - 8.0 - at) / LETTER) as usize;
            let text = match text.chars().count() > room {
                true if at > 10.0 => break,
                true => text
                    .chars()
                    .take(room.saturating_sub(1))
                    .chain(['…'])
                    .collect(),
                false => text,
            };
            let width = LETTER * text.chars().count() as f64;
            let class = format!("note {class}");
            lettering.write(
                svg,
                &Words::new(&text, [at, 37.0], Anchor::Start).class(&class),
            );
            svg.push('\n');
            at += width + 16.0;
        }
    }

    fn axes(&self, svg: &mut String, lettering: &Lettering) {
        let [left, top, right, bottom] = self.plot;
        let [x, y] = &self.scales;
        let foot = self.strip.map_or(bottom, |[_, end]| end);
        for (at, label) in &self.x.ticks {
            let line = number(*at);
            let _ = writeln!(svg, "<path class=\"grid\" d=\"M{line} {top}V{foot}\"/>");
            let place = [*at, foot + 16.0];
            lettering.write(
                svg,
                &Words::new(label, place, Anchor::Middle).class("axis-text"),
            );
            svg.push('\n');
        }
        for (at, label) in &self.y.ticks {
            let line = number(*at);
            let _ = writeln!(svg, "<path class=\"grid\" d=\"M{left} {line}H{right}\"/>");
            let place = [left - 7.0, at + 4.0];
            lettering.write(
                svg,
                &Words::new(label, place, Anchor::End).class("axis-text"),
            );
            svg.push('\n');
        }
        if !y.is_log && y.low < 0.0 && y.high > 0.0 {
            let line = number(y.place(0.0));
            let _ = writeln!(svg, "<path class=\"zero\" d=\"M{left} {line}H{right}\"/>");
        }
        let below = in_power(&self.chart.x.title(), x.power());
        let middle = [(left + right) / 2.0, foot + 35.0];
        lettering.write(
            svg,
            &Words::new(&below, middle, Anchor::Middle)
                .label()
                .class("axis-text"),
        );
        svg.push('\n');
        // A title that is longer than the plot is high is shortened, but keeps its unit.
        let mut beside = in_power(&self.y_title(), y.power());
        if beside.chars().count() as f64 * TITLE_LETTER > bottom - top + 30.0 {
            beside = match (beside.rfind('['), self.chart.y.unit.as_str()) {
                (Some(unit), _) => beside[unit..].to_owned(),
                (None, _) => String::new(),
            };
        }
        let up = [15.0, (top + bottom) / 2.0];
        lettering.write(
            svg,
            &Words::new(&beside, up, Anchor::Middle)
                .label()
                .class("axis-text")
                .upward(),
        );
        svg.push('\n');
    }

    /// Draws crosses at the positions without a value.
    fn gaps(&self, svg: &mut String) {
        for failed in &self.chart.failed {
            let [x, y] = [self.scales[0].place(*failed) - 3.0, self.plot[3] - 3.0].map(number);
            let _ = writeln!(svg, "<path class=\"failed\" d=\"M{x} {y}l6 6m0 -6l-6 6\"/>");
        }
    }

    /// Draws the strip of deviations. Allowed deviations are inside its band.
    fn strip(&self, svg: &mut String, lettering: &Lettering) {
        let Some([top, bottom]) = self.strip else {
            return;
        };
        let [left, _, right, _] = self.plot;
        let (middle, half) = ((top + bottom) / 2.0, (bottom - top) / 2.0);
        let y = |deviation: f64| {
            let shown = deviation.clamp(-MOST_DEVIATION, MOST_DEVIATION);
            middle - half * shown / MOST_DEVIATION
        };
        let corners = [
            [left, y(1.0)],
            [right, y(1.0)],
            [right, y(-1.0)],
            [left, y(-1.0)],
        ];
        svg.push_str("<g class=\"strip\">\n");
        path(svg, "band", corners.into_iter(), true);
        path(
            svg,
            "zero",
            [[left, middle], [right, middle]].into_iter(),
            false,
        );
        for (value, label) in [(1.0, "1"), (-1.0, "\u{2212}1")] {
            let place = [left - 7.0, y(value) + 4.0];
            lettering.write(
                svg,
                &Words::new(label, place, Anchor::End).class("axis-text"),
            );
            svg.push('\n');
        }
        lettering.write(
            svg,
            &Words::new("tol.", [15.0, middle], Anchor::Middle)
                .class("axis-text")
                .upward(),
        );
        svg.push('\n');
        for deviations in &self.deviations {
            let place = |[at, deviation]: [f64; 2]| [self.scales[0].place(at), y(deviation)];
            if deviations.len() > 1 {
                path(
                    svg,
                    "line main",
                    deviations.iter().map(|d| place(*d)),
                    false,
                );
            }
            for deviation in deviations {
                let outside = deviation[1].abs() > 1.0;
                if outside || deviations.len() == 1 {
                    let class = if outside { "dot bad" } else { "dot main" };
                    path(svg, class, [place(*deviation)].into_iter(), false);
                }
            }
        }
        svg.push_str("</g>\n");
    }
}

/// Class of a curve's colour, without its stroke.
fn colour_of(class: &str) -> String {
    let strokes = ["strong", "faint", "fine", "inner"];
    let kept: Vec<&str> = class.split(' ').filter(|c| !strokes.contains(c)).collect();
    kept.join(" ")
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

#[cfg(test)]
mod tests {
    use super::super::Source;
    use super::super::labels::LABEL;
    use super::*;

    /// Table of the line `a + b x` over -40 to 40.
    fn table(lines: &[[f64; 2]]) -> CurveTable {
        let places: Vec<f64> = (-4..=4).map(|k| 10.0 * f64::from(k)).collect();
        let column = |f: &dyn Fn(f64) -> f64| places.iter().map(|x| Some(f(*x))).collect();
        let mut columns: Vec<Vec<Option<f64>>> = vec![column(&|x| x)];
        columns.extend(lines.iter().map(|[a, b]| column(&|x| a + b * x)));
        let names = (0..lines.len()).map(|k| format!("y{k}"));
        CurveTable {
            header: ["x".to_owned()].into_iter().chain(names).collect(),
            columns,
            status: Vec::new(),
        }
    }

    fn line(number: usize, rows: std::ops::Range<usize>) -> Line {
        Line {
            label: Some(format!("line {number}")),
            told: String::new(),
            class: "main strong".to_owned(),
            is_main: true,
            has_dots: false,
            source: Source {
                table: 0,
                x: "x".to_owned(),
                y: format!("y{number}"),
                rows: rows.collect(),
            },
        }
    }

    fn chart(lines: Vec<Line>, wanted: Vec<Wanted>) -> Chart {
        Chart {
            key: "y".to_owned(),
            x: Quantity::of_column("travel_mm"),
            y: Quantity::new("y", "toe", "°"),
            lines,
            wanted,
            ..Chart::default()
        }
    }

    /// Labels of curves with nearly equal end values keep their order and their distance, and stay beside the plot.
    #[test]
    fn labels_at_the_ends_do_not_overlap() {
        let slopes: Vec<[f64; 2]> = (0..9).map(|k| [0.0, 1.0 + 1e-3 * f64::from(k)]).collect();
        let lines = (0..9).map(|k| line(k, 0..9)).collect();
        let layout = chart(lines, Vec::new()).layout(&[table(&slopes)]);
        assert_eq!(layout.labels.len(), 9);
        for pair in layout.labels.windows(2) {
            assert!(pair[1].at[1] - pair[0].at[1] >= LABEL - 1e-9, "{pair:?}");
            assert!(pair[1].end[1] >= pair[0].end[1]);
        }
        for label in &layout.labels {
            assert!(
                label.at[1] >= layout.plot[1] && label.at[1] <= layout.plot[3],
                "{label:?}"
            );
            let width = LETTER * label.text.chars().count() as f64;
            assert!(
                label.at[0] > layout.plot[2] && label.at[0] + width <= SIZE[0],
                "{label:?}"
            );
        }
    }

    /// For a line and a constant target, the deviation is the difference divided by the tolerance, also between the rows.
    #[test]
    fn deviations_are_in_tolerances() {
        let wanted = Wanted::Values {
            points: vec![[-40.0, 1.0], [5.0, 1.0], [40.0, 1.0]],
            tolerance: 0.25,
        };
        let layout = chart(vec![line(0, 0..9)], vec![wanted]).layout(&[table(&[[1.0, 0.01]])]);
        let expected = [[-40.0, -1.6], [5.0, 0.2], [40.0, 1.6]];
        for (found, expected) in layout.deviations[0].iter().zip(expected) {
            assert!(
                (found[0] - expected[0]).abs() + (found[1] - expected[1]).abs() < 1e-12,
                "{found:?}"
            );
        }
        let svg = layout.element();
        assert_eq!(svg.matches("class=\"dot bad\"").count(), 2);
        assert!(layout.strip.is_some());
        assert!(svg.contains("target ± 0.25 °"));
    }

    /// Ticks and curves use the same linear scale.
    #[test]
    fn ticks_and_curves_share_a_scale() {
        let layout = chart(vec![line(0, 0..9)], Vec::new()).layout(&[table(&[[0.0, 2.0]])]);
        let at = |axis: &AxisLayout, [from, to]: [f64; 2], value: f64| {
            from + (value - axis.low) / (axis.high - axis.low) * (to - from)
        };
        let [left, top, right, bottom] = layout.plot;
        for (place, label) in &layout.x.ticks {
            let value: f64 = label.replace('\u{2212}', "-").parse().unwrap();
            assert!(
                (place - at(&layout.x, [left, right], value)).abs() < 1e-9,
                "{label}"
            );
        }
        let end = layout.labels[0].end;
        assert!((end[0] - at(&layout.x, [left, right], 40.0)).abs() < 1e-9);
        assert!((end[1] - at(&layout.y, [bottom, top], 80.0)).abs() < 1e-9);
        let json = serde_json::to_value(&layout).unwrap();
        assert_eq!(json["lines"][0]["rows"].as_array().unwrap().len(), 9);
        assert_eq!(
            json["x"]["ticks"].as_array().unwrap().len(),
            layout.x.ticks.len()
        );
    }

    /// A gap in the data is a gap in the curve, and a cross marks its position.
    #[test]
    fn gaps_stay_gaps() {
        let mut table = table(&[[0.0, 1.0]]);
        table.columns[1][4] = None;
        let chart = Chart {
            failed: vec![0.0],
            ..chart(vec![line(0, 0..9)], Vec::new())
        };
        let svg = chart.layout(&[table]).element();
        assert_eq!(svg.matches("class=\"line main strong\"").count(), 2);
        assert_eq!(svg.matches("class=\"failed\"").count(), 1);
        assert!(svg.contains("not solved"));
    }
}
