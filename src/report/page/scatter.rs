//! SVG pictures of scatter: the distribution of each value in its band (histogram and percentiles), and the effect of each
//! contributor.

use super::escape::html;
use crate::report::bands::BandRecord;
use crate::report::chart::{in_words, shortened};
use crate::report::figure::{brief, with_minus_signs};
use crate::report::tolerance_summary::{
    HistogramRecord, RankingRecord, ToleranceSummary, ValueRecord,
};
use std::fmt::Write;

/// Width of a picture.
const WIDTH: f64 = 760.0;
/// Width of the names on the left.
const NAMES: f64 = 250.0;
/// Width of the numbers (yield and capability) on the right.
const NUMBERS: f64 = 110.0;
/// Height of the row of a value.
const ROW: f64 = 64.0;
/// Height of a histogram.
const HISTOGRAM: f64 = 28.0;
/// Height of the band (allowed range) behind the histogram.
const BAND: f64 = 44.0;
/// Distance from the top of a row to the middle of the boxes that show percentiles.
const BOXES: f64 = 38.0;
/// Height of a contributor's row.
const BAR: f64 = 26.0;

/// Indices of the percentiles in [`ValueRecord::percentiles`].
const P1: usize = 1;
const P5: usize = 2;
const P50: usize = 3;
const P95: usize = 4;
const P99: usize = 5;

/// Picture of the distribution of every value with a band. `drive` is the column of the motion. Empty if no band has a value.
pub(super) fn distributions(summary: &ToleranceSummary, drive: &str) -> String {
    let bands = summary.bands.iter();
    let drawn: Vec<(&BandRecord, &ValueRecord)> = bands
        .filter_map(|band| Some((band, band.worst_value(&summary.values)?)))
        .collect();
    if drawn.is_empty() {
        return String::new();
    }
    let height = ROW * drawn.len() as f64;
    let mut svg = opening(height, "Distribution of each banded value with its band");
    for (number, (band, value)) in drawn.iter().enumerate() {
        let name = name_of(band, drive);
        row(&mut svg, ROW * number as f64, &name, band, value);
    }
    format!(
        "<h3>Distributions in the bands</h3><p class=\"note\">Bars: number of builds by value. Line: smallest to largest value of the builds. \
         Light box: 1 % to 99 %. Dark box: 5 % to 95 %. Stroke: median. Dot: nominal. Shaded: the band. Cp and Cpk: width of the band, and margin of the \
         mean to the nearer limit, in six and in three standard deviations of the builds. Where a band holds over the motion, the \
         position with the least margin is shown.</p><div class=\"scatter\" tabindex=\"0\" role=\"group\">{svg}</svg></div>"
    )
}

fn opening(height: f64, title: &str) -> String {
    format!("<svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"{title}\">")
}

/// Name of a band for its row: output, position and limits. The position on the motion of a wheel has its unit.
fn name_of(band: &BandRecord, drive: &str) -> String {
    match (band.at, &band.over, band.band.split_once(": ")) {
        (Some(at), None, Some((_, limits))) => {
            format!("{} at {}: {limits}", band.output, in_words(drive, at))
        }
        _ => band.band.clone(),
    }
}

/// Draws the distribution of a value in its band, with the name on the left, and yield and capability on the right.
fn row(svg: &mut String, top: f64, title: &str, band: &BandRecord, value: &ValueRecord) {
    let [least, most] = value.range;
    let limits = [band.low, band.high];
    let all = limits
        .into_iter()
        .chain([least, most, value.nominal])
        .flatten();
    let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    // A value without scatter may be equal to its limit. Then the scale still has a length.
    let shortest = 1e-9 * low.abs().max(high.abs()).max(1e-9);
    let room = 0.06 * (high - low).max(shortest);
    let (low, high) = (low - room, high + room);
    let (left, right) = (NAMES, WIDTH - NUMBERS);
    let x = |v: f64| left + (v - low) / (high - low) * (right - left);
    let (middle, name) = (top + BOXES, top + 24.0);
    let (from, to) = (band.low.map_or(left, x), band.high.map_or(right, x));
    let _ = write!(
        svg,
        "{}<rect class=\"band\" x=\"{from:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{BAND}\"/>",
        beside(title, name),
        to - from
    );
    for (limit, anchor) in [(band.low, "start"), (band.high, "end")] {
        if let Some(limit) = limit {
            let place = x(limit);
            let _ = write!(
                svg,
                "<path class=\"limit\" d=\"M{place:.1} {top:.1}v{BAND}\"/><text class=\"small\" x=\"{place:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{}</text>",
                top + BAND + 11.0,
                with_minus_signs(&brief(limit))
            );
        }
    }
    if let Some(histogram) = &value.histogram {
        bars(svg, top + 4.0 + HISTOGRAM, histogram, x);
    }
    spread(svg, middle, value, x);
    let _ = write!(
        svg,
        "<text x=\"{WIDTH}\" y=\"{:.1}\" text-anchor=\"end\">{:.2} % in band</text>",
        name,
        100.0 * band.kept
    );
    if let Some((mean, sigma)) = value.mean.zip(value.sigma) {
        let words = if value.scatters {
            capability([band.low, band.high], mean, sigma)
        } else {
            "does not scatter".to_owned()
        };
        let _ = write!(
            svg,
            "<text class=\"small\" x=\"{WIDTH}\" y=\"{:.1}\" text-anchor=\"end\">{words}</text>",
            name + 16.0
        );
    }
}

/// Draws range, percentiles, median and nominal value around the height `middle`.
fn spread(svg: &mut String, middle: f64, value: &ValueRecord, x: impl Fn(f64) -> f64) {
    if let [Some(least), Some(most)] = value.range {
        let _ = write!(
            svg,
            "<path class=\"whisker\" d=\"M{:.1} {middle}H{:.1}\"/>",
            x(least),
            x(most)
        );
    }
    for (from, to, class, half) in [(P1, P99, "light", 2.5), (P5, P95, "dark", 4.0)] {
        if let [Some(from), Some(to)] = [from, to].map(|p| value.percentiles[p]) {
            let _ = write!(
                svg,
                "<rect class=\"{class}\" x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\"/>",
                x(from),
                middle - half,
                (x(to) - x(from)).max(1.0),
                2.0 * half
            );
        }
    }
    if let Some(median) = value.percentiles[P50] {
        let _ = write!(
            svg,
            "<path class=\"median\" d=\"M{:.1} {:.1}v11\"/>",
            x(median),
            middle - 5.5
        );
    }
    if let Some(nominal) = value.nominal {
        let _ = write!(
            svg,
            "<circle class=\"nominal\" cx=\"{:.1}\" cy=\"{middle}\" r=\"3\"/>",
            x(nominal)
        );
    }
}

/// Largest number of letters of a name next to a picture.
const LETTERS: usize = 36;

/// Name beside a picture, at half of its height `y`. A longer name has two lines. If two lines are not enough, a tooltip has
/// the full name.
fn beside(name: &str, y: f64) -> String {
    const HALF_LINE: f64 = 6.5;
    let name = with_minus_signs(name);
    let line = |text: &str, y: f64| format!("<text x=\"0\" y=\"{y:.1}\">{text}</text>");
    if name.chars().count() <= LETTERS {
        return line(&html(&name), y);
    }
    let end = name
        .char_indices()
        .nth(LETTERS)
        .map_or(name.len(), |(end, _)| end);
    let at = name[..end].rfind([' ', '+']).map_or(end, |at| at + 1);
    let (first, rest) = name.split_at(at);
    let last = if rest.chars().count() <= LETTERS {
        html(rest)
    } else {
        format!(
            "{}<title>{}</title>",
            html(&shortened(rest, LETTERS)),
            html(&name)
        )
    };
    line(&html(first.trim_end()), y - HALF_LINE) + &line(&last, y + HALF_LINE)
}

/// Draws the bars of a histogram on the line `base`. The largest bar uses the full height.
fn bars(svg: &mut String, base: f64, histogram: &HistogramRecord, x: impl Fn(f64) -> f64) {
    let largest = histogram.counts.iter().copied().max().unwrap_or(0);
    let [low, high] = histogram.range;
    if largest == 0 || low == high {
        return;
    }
    let width = (high - low) / histogram.counts.len() as f64;
    let mut path = format!("M{:.1} {base:.1}", x(low));
    for (bin, count) in histogram.counts.iter().enumerate() {
        let top = base - HISTOGRAM * f64::from(*count) / f64::from(largest);
        let end = x(low + width * (bin as f64 + 1.0));
        let _ = write!(path, "V{top:.1}H{end:.1}");
    }
    let _ = write!(svg, "<path class=\"bars\" d=\"{path}V{base:.1}Z\"/>");
}

/// Capability of a value in its band: `Cp 1.33, Cpk 1.10`. Cp is the width of the band divided by six standard deviations. Cpk is
/// the distance from the mean to the nearer limit, divided by three standard deviations. A band with one limit has only Cpk.
fn capability([low, high]: [Option<f64>; 2], mean: f64, sigma: f64) -> String {
    let width = low.zip(high).map(|(low, high)| high - low);
    let cp = width.map(|width| format!("Cp {:.2}, ", width / (6.0 * sigma)));
    let margins = [low.map(|low| mean - low), high.map(|high| high - mean)];
    let nearer = margins.into_iter().flatten().reduce(f64::min);
    let cpk = nearer.map(|margin| format!("Cpk {:.2}", margin / (3.0 * sigma)));
    cp.unwrap_or_default() + &cpk.unwrap_or_default()
}

/// Picture of the predicted yield with half and with twice the tolerance of each contributor. Empty if the yield or the ranking is
/// missing.
pub(super) fn contributors(summary: &ToleranceSummary) -> String {
    let (Some(now), [_, ..]) = (summary.yield_of_all, &summary.ranking[..]) else {
        return String::new();
    };
    let ranking = &summary.ranking;
    let ends = ranking
        .iter()
        .flat_map(|r| [r.yield_halved, r.yield_doubled]);
    let low = ends.clone().fold(now, f64::min);
    let high = ends.fold(now, f64::max);
    let span = (high - low).max(1e-6);
    let (left, right) = (NAMES, WIDTH - 10.0);
    let x = |v: f64| left + 60.0 + (v - low) / span * (right - left - 120.0);
    let height = BAR * ranking.len() as f64 + 24.0;
    let mut svg = opening(
        height,
        "Predicted yield with half and with twice the tolerance of each contributor",
    );
    for (
        number,
        RankingRecord {
            contributor,
            yield_halved,
            yield_doubled,
            ..
        },
    ) in ranking.iter().enumerate()
    {
        let middle = BAR * number as f64 + 36.0;
        let _ = write!(svg, "{}", beside(contributor, middle + 4.0));
        let ends = [*yield_halved, *yield_doubled];
        for ((class, end), label) in ["better", "worse"]
            .into_iter()
            .zip(ends)
            .zip(end_labels(now, ends, &x))
        {
            let (a, b) = (x(now).min(x(end)), x(now).max(x(end)));
            let EndLabel {
                place,
                below,
                is_left,
            } = label;
            let anchor = if is_left { "end" } else { "start" };
            let _ = write!(
                svg,
                "<rect class=\"{class}\" x=\"{a:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"14\"/><text class=\"small\" x=\"{place:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{:.1} %</text>",
                middle - 7.0,
                b - a,
                middle + 4.0 + below,
                100.0 * end
            );
        }
    }
    let place = x(now);
    let _ = write!(
        svg,
        "<path class=\"median\" d=\"M{place:.1} 20V{height:.1}\"/><text class=\"small\" x=\"{place:.1}\" y=\"14\" text-anchor=\"middle\">now {:.2} %</text>",
        100.0 * now
    );
    format!(
        "<h3>Contributors</h3><p class=\"note\">Predicted share of builds in all bands with half (blue) and with twice (orange) the \
         tolerance of each contributor. Of two values above each other, the upper one is with half the tolerance.</p><div class=\"scatter\" tabindex=\"0\" role=\"group\">{svg}</svg></div>"
    )
}

/// Position of the label of a predicted yield at the end of a contributor's bar.
#[derive(Clone, Copy, Debug, PartialEq)]
struct EndLabel {
    place: f64,
    /// Distance from the middle of the row, downward.
    below: f64,
    /// True if the text is to the left of this position.
    is_left: bool,
}

/// Labels of the yields with half and with twice a tolerance. If both yields are on the same side of the present yield, one label
/// is above the other, beside the longer bar. Otherwise they would cover each other or the longer bar.
fn end_labels(now: f64, ends: [f64; 2], x: &impl Fn(f64) -> f64) -> [EndLabel; 2] {
    const GAP: f64 = 4.0;
    const HALF_LINE: f64 = 5.5;
    let sides = ends.map(|end| end < now);
    let beside = |end: f64, is_left: bool, below: f64| EndLabel {
        place: x(end) + if is_left { -GAP } else { GAP },
        below,
        is_left,
    };
    let [half, twice] = ends;
    if sides[0] != sides[1] {
        return [beside(half, sides[0], 0.0), beside(twice, sides[1], 0.0)];
    }
    let longer = if sides[0] {
        half.min(twice)
    } else {
        half.max(twice)
    };
    [-HALF_LINE, HALF_LINE].map(|below| beside(longer, sides[0], below))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A long name is split into two lines and keeps all of its letters. Its negative numbers have minus signs.
    #[test]
    fn a_long_name_has_two_lines() {
        let words = |svg: &str| -> Vec<String> {
            let parts = svg.split("</text>").filter_map(|part| part.split_once('>'));
            parts.map(|(_, text)| text.to_owned()).collect()
        };
        let name = "bump_steer_deg_per_mm: -0.018 to -0.004";
        let lines = words(&beside(name, 20.0));
        assert_eq!(
            lines,
            ["bump_steer_deg_per_mm: \u{2212}0.018 to", "\u{2212}0.004"]
        );
        let jig = "jig lower_arm_front+lower_arm_rear+upper_arm_front+upper_arm_rear";
        assert_eq!(words(&beside(jig, 20.0)).concat(), jig);
        assert_eq!(words(&beside("tie_rod length", 20.0)), ["tie_rod length"]);
    }

    /// If the two yields are on different sides of the present yield, each label is at its own bar. If they are on the same side,
    /// one label is above the other, outside both bars, at least a line of 10 px apart.
    #[test]
    fn labels_at_bars_do_not_overlap() {
        let x = |share: f64| 1000.0 * share;
        let [half, twice] = end_labels(0.8, [0.9, 0.7], &x);
        assert_eq!([half.is_left, twice.is_left], [false, true]);
        assert_eq!([half.below, twice.below], [0.0; 2]);
        for ends in [[0.835, 0.834], [0.834, 0.835], [0.6, 0.799]] {
            let [half, twice] = end_labels(0.8, ends, &x);
            assert_eq!(half.is_left, ends[0] < 0.8);
            assert!(twice.below - half.below > 10.0, "{half:?} {twice:?}");
            for label in [half, twice] {
                for end in ends {
                    let is_outside = if label.is_left {
                        label.place < x(end)
                    } else {
                        label.place > x(end)
                    };
                    assert!(is_outside, "{label:?} {end}");
                }
            }
        }
    }

    /// The band is eight standard deviations wide, and its middle is one standard deviation from the mean. So Cp is 8/6 and Cpk
    /// is 3/3.
    #[test]
    fn capability_counts_standard_deviations() {
        let of = |low, high| capability([low, high], 0.5, 0.5);
        assert_eq!(of(Some(-2.0), Some(2.0)), "Cp 1.33, Cpk 1.00");
        assert_eq!(of(None, Some(2.0)), "Cpk 1.00");
        assert_eq!(of(Some(-1.0), None), "Cpk 1.00");
        assert_eq!(of(None, None), "");
    }

    /// A value that does not scatter can be equal to the only limit of its band. Every position of its picture is a number.
    #[test]
    fn a_value_at_its_limit_has_a_picture() {
        let unknown = vec![None::<f64>; crate::tolerance::PERCENTILES.len()];
        let value = serde_json::json!({
            "output": "toe_deg", "builds": 8, "nominal": 1.5, "range": [1.5, 1.5], "percentiles": unknown,
            "shares": [], "scatters": false, "at_rest": false, "unit": "deg",
        });
        let value: ValueRecord = serde_json::from_value(value).unwrap();
        let band = serde_json::json!({ "band": "toe_deg: up to 1.5", "kept": 1.0, "kept_linear": 1.0, "high": 1.5 });
        let band: BandRecord = serde_json::from_value(band).unwrap();
        let mut svg = String::new();
        row(&mut svg, 0.0, "toe_deg", &band, &value);
        assert!(svg.contains("<circle") && !svg.contains("NaN"), "{svg}");
    }
}
