//! Charts of a car's page: load transfer by part, and the g-g map.

use super::shown;
use crate::report::car::{CarMap, CarStateRecord};
use std::fmt::Write;

/// Names of the parts of a load transfer.
const PARTS: [&str; 4] = ["elastic", "geometric", "longitudinal", "unsprung"];
/// Width of a chart. On a phone, one unit is one pixel.
const WIDTH: f64 = 350.0;

/// Legend for the colours of the parts of a load transfer.
pub(super) fn key() -> String {
    let entry =
        |(number, name): (usize, &&str)| format!("<li><i class=\"part-{number}\"></i>{name}</li>");
    let entries: String = PARTS.iter().enumerate().map(entry).collect();
    format!("<ul class=\"key\">{entries}</ul>")
}

/// Scale shared by all charts of load transfer.
pub(super) struct Scale {
    /// Ends of the scale: smallest sum of the negative parts of a load transfer, and largest sum of the positive parts.
    ends: [f64; 2],
}

/// Sum of the negative parts and sum of the positive parts of an axle's load transfer.
fn sums(parts: &[f64; 4]) -> [f64; 2] {
    let below = parts.iter().filter(|part| **part < 0.0).sum();
    let above = parts.iter().filter(|part| **part > 0.0).sum();
    [below, above]
}

/// Scale that fits the load transfers of all these states.
pub(super) fn transfer_scale<'r>(states: impl Iterator<Item = &'r CarStateRecord>) -> Scale {
    let mut ends = [0.0_f64; 2];
    for parts in states.flat_map(|state| &state.transfer) {
        let [below, above] = sums(parts);
        ends = [ends[0].min(below), ends[1].max(above)];
    }
    if ends[1] - ends[0] <= 0.0 {
        ends[1] = 1.0;
    }
    Scale { ends }
}

/// Bars for the load transfer of the front and the rear axle, each with its parts and its total. Negative parts extend to the left
/// of zero.
pub(super) fn transfer(state: &CarStateRecord, scale: &Scale, unit: &str) -> String {
    let (from, to) = (40.0, WIDTH - 62.0);
    let [low, high] = scale.ends;
    let x = |force: f64| from + (force - low) / (high - low) * (to - from);
    let mut svg = format!(
        "<svg viewBox=\"0 0 {WIDTH} 92\" role=\"img\" aria-label=\"load transfer by part\">"
    );
    for (axle, parts) in state.transfer.iter().enumerate() {
        let y = 10.0 + 40.0 * axle as f64;
        let name = crate::car::AXLE_NAMES[axle];
        let _ = write!(svg, "<text x=\"0\" y=\"{}\">{name}</text>", y + 18.0);
        let mut ends = [0.0; 2];
        for (number, part) in parts.iter().enumerate() {
            let side = usize::from(*part > 0.0);
            let (a, b) = (x(ends[side]), x(ends[side] + part));
            ends[side] += part;
            let _ = write!(
                svg,
                "<rect class=\"part-{number}\" x=\"{:.1}\" y=\"{y}\" width=\"{:.1}\" height=\"26\"><title>{}: {} {unit}</title></rect>",
                a.min(b),
                (b - a).abs(),
                PARTS[number],
                shown(*part, unit)
            );
        }
        let total: f64 = parts.iter().sum();
        let _ = write!(
            svg,
            "<text class=\"end\" x=\"{WIDTH}\" y=\"{}\">{} {unit}</text>",
            y + 18.0,
            shown(total, unit)
        );
    }
    let zero = x(0.0);
    let _ = write!(svg, "<path class=\"zero\" d=\"M{zero:.1} 4V82\"/></svg>");
    svg
}

/// Picture of a g-g map. Values of ay grow to the right, and values of ax grow upward, if the study lists them in rising order. A
/// stronger colour is a larger friction demand.
pub(super) fn map(map: &CarMap) -> String {
    let (columns, rows) = (map.ay.len(), map.ax.len());
    let (left, top, size) = (46.0, 18.0, WIDTH - 54.0);
    let width = size / columns as f64;
    let height = (0.8 * size / rows as f64).min(40.0);
    let bottom = top + height * rows as f64;
    let most = map
        .friction
        .iter()
        .flatten()
        .fold(0.0_f64, |most, f| most.max(*f));
    let mut svg = format!(
        "<svg viewBox=\"0 0 {WIDTH} {:.0}\" role=\"img\" aria-label=\"g-g map\">",
        bottom + 44.0
    );
    let shows_numbers = width >= 34.0 && height >= 18.0;
    for row in 0..rows {
        // The row with the first ax is at the bottom.
        let y = bottom - height * (row + 1) as f64;
        for column in 0..columns {
            let x = left + width * column as f64;
            let number = row * columns + column;
            let (middle, centre) = (x + 0.5 * width, y + 0.5 * height);
            let Some(friction) = map.friction[number] else {
                let _ = write!(
                    svg,
                    "<path class=\"none\" d=\"M{:.1} {:.1}l6 6m0 -6l-6 6\"/>",
                    middle - 3.0,
                    centre - 3.0
                );
                continue;
            };
            let opacity = 0.06 + 0.64 * friction / most.max(1e-9);
            let _ = write!(
                svg,
                "<rect class=\"cell\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" opacity=\"{opacity:.3}\"><title>ax {} g, ay {} g: {}</title></rect>",
                shown(map.ax[row], "g"),
                shown(map.ay[column], "g"),
                shown(friction, "")
            );
            if shows_numbers {
                let _ = write!(
                    svg,
                    "<text class=\"middle\" x=\"{middle:.1}\" y=\"{:.1}\">{friction:.2}</text>",
                    centre + 4.0
                );
            }
            if map.lifted[number] > 0 {
                let _ = write!(
                    svg,
                    "<circle class=\"dot\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"2.5\"/>",
                    x + width - 5.0,
                    y + 5.0
                );
            }
        }
    }
    axes(&mut svg, map, [left, bottom, width, height]);
    svg + "</svg>"
}

/// Writes the values of ax and ay beside the cells of the g-g map. If there are many values, only some are written.
fn axes(svg: &mut String, map: &CarMap, [left, bottom, width, height]: [f64; 4]) {
    let every = |count: usize, size: f64, least: f64| {
        ((least / size).ceil() as usize).clamp(1, count.max(1))
    };
    for column in (0..map.ay.len()).step_by(every(map.ay.len(), width, 40.0)) {
        let _ = write!(
            svg,
            "<text class=\"small middle\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            left + width * (column as f64 + 0.5),
            bottom + 15.0,
            shown(map.ay[column], "g")
        );
    }
    for row in (0..map.ax.len()).step_by(every(map.ax.len(), height, 16.0)) {
        let _ = write!(
            svg,
            "<text class=\"small end\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            left - 6.0,
            bottom - height * (row as f64 + 0.5) + 4.0,
            shown(map.ax[row], "g")
        );
    }
    let _ = write!(
        svg,
        "<text class=\"small middle\" x=\"{:.1}\" y=\"{:.1}\">ay [g], to the left</text><text class=\"small\" x=\"0\" y=\"11\">ax [g]</text>",
        left + 0.5 * width * map.ay.len() as f64,
        bottom + 32.0,
    );
}
