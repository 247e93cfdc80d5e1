//! Work-precision picture (computing time against accuracy) for print, with logarithmic axes. Each series has its own mark and grey
//! level.

use super::figure::power_of_ten;
use crate::bench::accuracy::{Accuracy, Family, Measurement};
use plotters::coord::Shift;
use plotters::coord::combinators::WithKeyPoints;
use plotters::prelude::*;
use std::ops::Range;

/// Width and height of one diagram, in pixels.
const PANEL: [u32; 2] = [560, 420];
/// Height of the caption, in pixels.
const CAPTION: u32 = 34;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Failed = Box<dyn std::error::Error>;

/// One of the four diagrams of the work-precision picture (computing time against accuracy).
struct Panel {
    title: &'static str,
    across: &'static str,
    up: &'static str,
    series: Vec<(String, Vec<(f64, f64)>)>,
    legend: SeriesLabelPosition,
}

/// SVG text of the work-precision picture.
pub(super) fn svg(accuracy: &Accuracy, caption: &str) -> String {
    let mut svg = String::new();
    draw(accuracy, caption, &mut svg).expect("a picture in memory can always be drawn");
    svg
}

fn draw(accuracy: &Accuracy, caption: &str, svg: &mut String) -> Result<(), Failed> {
    let size = (2 * PANEL[0], 2 * PANEL[1] + CAPTION);
    let root = SVGBackend::with_string(svg, size).into_drawing_area();
    root.fill(&WHITE)?;
    let (head, body) = root.split_vertically(CAPTION);
    let style = TextStyle::from(("sans-serif", 14).into_font()).color(&BLACK);
    head.draw_text(caption, &style, (16, 12))?;
    let panels = panels(accuracy);
    for (panel, area) in panels.iter().zip(body.split_evenly((2, 2))) {
        panel.draw(&area)?;
    }
    root.present()?;
    drop((head, body, root));
    Ok(())
}

fn panels(accuracy: &Accuracy) -> [Panel; 4] {
    let error = |m: &Measurement| (m.error, m.time.median);
    let step = |m: &Measurement| {
        let step = m.setting.rsplit(' ').next().and_then(|s| s.parse().ok());
        (step.unwrap_or(f64::NAN), m.error)
    };
    let of = |family: Family, place: &dyn Fn(&Measurement) -> (f64, f64)| {
        let mut series: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
        for m in accuracy.measurements.iter().filter(|m| m.family == family) {
            let point = place(m);
            // Both axes are logarithmic, so points with values of 0 or below are left out.
            if !(point.0 > 0.0 && point.1 > 0.0 && point.0.is_finite() && point.1.is_finite()) {
                continue;
            }
            match series.iter_mut().find(|(name, _)| *name == m.method) {
                Some((_, points)) => points.push(point),
                None => series.push((m.method.clone(), vec![point])),
            }
        }
        series
    };
    let mut derivatives = of(Family::Derivative, &step);
    let analytic = accuracy.measurements.iter();
    let analytic = analytic.filter(|m| m.family == Family::Derivative && m.method == "analytic");
    let steps = || {
        derivatives
            .iter()
            .flat_map(|(_, points)| points.iter().map(|p| p.0))
    };
    let ends = [
        steps().fold(f64::INFINITY, f64::min),
        steps().fold(0.0, f64::max),
    ];
    for m in analytic {
        let line = ends.map(|step| (step, m.error)).to_vec();
        derivatives.insert(0, ("analytic".to_owned(), line));
    }
    [
        Panel {
            title: "Poses, by formulation, arithmetic and tolerance",
            across: "largest error of camber [deg]",
            up: "time per pose [ns]",
            series: of(Family::Pose, &error),
            legend: SeriesLabelPosition::UpperRight,
        },
        Panel {
            title: "Poses, by start of Newton's method",
            across: "largest error of camber [deg]",
            up: "time per pose [ns]",
            series: of(Family::Start, &error),
            legend: SeriesLabelPosition::UpperRight,
        },
        Panel {
            title: "Curves interpolated between few exact poses",
            across: "largest error of camber [deg]",
            up: "time per point of the curve [ns]",
            series: of(Family::Curve, &error),
            legend: SeriesLabelPosition::UpperRight,
        },
        Panel {
            title: "Derivatives of four characteristics by every coordinate",
            across: "step of the difference quotient [size of the mechanism]",
            up: "largest error [fraction of the largest derivative]",
            series: derivatives,
            legend: SeriesLabelPosition::UpperMiddle,
        },
    ]
}

impl Panel {
    fn draw(&self, area: &Area<'_>) -> Result<(), Failed> {
        let points = || self.series.iter().flat_map(|(_, points)| points);
        let across = decades(points().map(|p| p.0), 0);
        // Additional powers of ten at the top of the vertical axis leave space for the legend.
        let room = 1 + i32::from(self.up.contains("error"));
        let up = decades(points().map(|p| p.1), room);
        let mut chart = ChartBuilder::on(area)
            .caption(self.title, ("sans-serif", 16).into_font())
            .margin(10)
            .margin_right(22)
            .x_label_area_size(48)
            .y_label_area_size(64)
            .build_cartesian_2d(ticked(across), ticked(up))?;
        chart
            .configure_mesh()
            .x_desc(self.across)
            .y_desc(self.up)
            .x_label_formatter(&label)
            .y_label_formatter(&label)
            .label_style(("sans-serif", 13))
            .axis_desc_style(("sans-serif", 14))
            .bold_line_style(RGBColor(205, 205, 205))
            .light_line_style(WHITE)
            .draw()?;
        for (number, (name, points)) in self.series.iter().enumerate() {
            let grey = grey(number);
            let line = points.iter().copied();
            match number % 2 {
                0 => chart.draw_series(LineSeries::new(line, grey.stroke_width(1)))?,
                _ => chart.draw_series(DashedLineSeries::new(line, 5, 3, grey.stroke_width(1)))?,
            };
            // Each kind of mark has its own Rust type, so a macro is used instead of a function.
            macro_rules! marked {
                ($mark:expr) => {
                    chart
                        .draw_series(points.iter().map(|p| $mark(*p)))?
                        .label(name)
                        .legend(move |(x, y)| $mark((x + 8, y)))
                };
            }
            let (filled, hollow) = (grey.filled(), grey.stroke_width(1));
            let heavy = grey.stroke_width(2);
            match number % MARKS {
                0 => marked!(|at| Circle::new(at, 4, filled)),
                1 => marked!(|at| Circle::new(at, 4, hollow)),
                2 => marked!(|at| TriangleMarker::new(at, 5, filled)),
                3 => marked!(|at| Cross::new(at, 4, heavy)),
                4 => marked!(|at| EmptyElement::at(at) + square(filled)),
                5 => marked!(|at| EmptyElement::at(at) + square(hollow)),
                _ => marked!(|at| TriangleMarker::new(at, 5, hollow)),
            };
        }
        chart
            .configure_series_labels()
            .position(self.legend.clone())
            .label_font(("sans-serif", 13))
            .background_style(WHITE.mix(0.85))
            .border_style(RGBColor(170, 170, 170))
            .draw()?;
        Ok(())
    }
}

/// Number of different marks (shapes of points).
const MARKS: usize = 7;

/// Grey level that distinguishes a series in addition to its mark.
fn grey(number: usize) -> RGBColor {
    let level = [0, 90, 0, 130, 60, 110, 30][number % MARKS];
    RGBColor(level, level, level)
}

fn square(style: ShapeStyle) -> Rectangle<(i32, i32)> {
    Rectangle::new([(-4, -4), (4, 4)], style)
}

/// Powers of ten that enclose these values, plus `more` powers of ten above.
fn decades(values: impl Iterator<Item = f64>, more: i32) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    if low > high {
        return 1.0..10.0;
    }
    let low = low.log10().floor() as i32;
    let high = (high.log10().ceil() as i32 + more).max(low + 1);
    10_f64.powi(low)..10_f64.powi(high)
}

/// Logarithmic axis with at most eight evenly spaced ticks. The crate `plotters` would place no ticks below 1e-14.
fn ticked(range: Range<f64>) -> WithKeyPoints<LogCoord<f64>> {
    let [low, high] = [range.start, range.end].map(|end| end.log10().round() as i32);
    let step = (high - low) / 8 + 1;
    let powers = (low..=high).filter(|power| power % step == 0);
    let ticks = powers.map(|power| 10_f64.powi(power)).collect();
    range.log_scale().with_key_points(ticks)
}

/// Label of a tick with this value.
fn label(value: &f64) -> String {
    power_of_ten(value.log10().round() as i32)
}
