//! Strips: pictures of one quantity on its own line and scale, with ranges, bands and values.

use super::escape::{html, prose};
use crate::report::chart::Scale;
use crate::report::chart::mark::{number, path};
use crate::report::{brief, to_digits, with_minus_signs};
use std::fmt::Write;

/// Width of the picture with strips. It equals the width of a chart.
const WIDTH: f64 = 420.0;
/// Space left and right of the scale.
const MARGIN: f64 = 34.0;
/// Height of a strip with its name, its line and the numbers below the line.
const HEIGHT: f64 = 58.0;
/// Vertical position of the line in a strip.
const LINE: f64 = 30.0;
/// Half of the height of a band and of the ticks at the ends of a range.
const HALF: f64 = 6.0;
/// Width of a digit. It is also the least distance between two numbers.
const DIGIT: f64 = 7.0;
/// Least distance between a number and the edge of the picture.
const EDGE: f64 = 8.0;

/// A quantity with a range, a band or values.
pub(super) struct Strip {
    /// Name of the quantity.
    pub title: String,
    /// Range of the quantity, drawn as a line with ends.
    pub range: Option<[f64; 2]>,
    /// Band (such as a target with its allowed error, or the study's motion), drawn behind the line. Its ends have numbers only if
    /// the strip also has a range. Otherwise the title contains the target value.
    pub band: Option<[f64; 2]>,
    /// Values of the quantity, drawn as dots: CSS class and value of each dot.
    pub dots: Vec<(&'static str, f64)>,
}

impl Strip {
    fn values(&self) -> impl Iterator<Item = f64> {
        let ends = self.range.into_iter().chain(self.band).flatten();
        ends.chain(self.dots.iter().map(|(_, value)| *value))
    }
}

/// Figure with strips below each other. Empty if there are no strips.
pub(super) fn strips(strips: &[Strip], about: &str) -> String {
    if strips.is_empty() {
        return String::new();
    }
    let height = HEIGHT * strips.len() as f64;
    let mut svg = format!(
        "<svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"{}\">\n",
        html(about)
    );
    for (row, strip) in strips.iter().enumerate() {
        draw(strip, HEIGHT * row as f64, &mut svg);
    }
    format!("<figure class=\"chart strips\">{svg}</svg></figure>\n")
}

fn draw(strip: &Strip, top: f64, svg: &mut String) {
    let scale = Scale::showing(strip.values(), 4.0, [MARGIN, WIDTH - MARGIN]);
    let at = |value: f64| scale.place(value);
    let (line, foot) = (top + LINE, top + LINE + 20.0);
    let text = |svg: &mut String, class: &str, x: f64, y: f64, anchor: &str, text: &str| {
        let _ = writeln!(
            svg,
            "<text class=\"{class}\" x=\"{}\" y=\"{}\" text-anchor=\"{anchor}\">{}</text>",
            number(x),
            number(y),
            prose(text)
        );
    };
    text(svg, "end", 8.0, top + 15.0, "start", &strip.title);
    let across = |svg: &mut String, class: &str, x: f64| {
        path(
            svg,
            class,
            [[x, line - HALF], [x, line + HALF]].into_iter(),
            false,
        );
    };
    let ends = [[at(scale.low), line], [at(scale.high), line]];
    path(svg, "grid", ends.into_iter(), false);
    if let Some([low, high]) = strip.band {
        let (low, high) = (at(low), at(high));
        let corners = [[low, -HALF], [high, -HALF], [high, HALF], [low, HALF]];
        let corners = corners.into_iter().map(|[x, y]| [x, line + y]);
        path(svg, "band wanted", corners, true);
        across(svg, "limit wanted", low);
        across(svg, "limit wanted", high);
    }
    if let Some(range) = strip.range {
        let places = range.map(|end| [at(end), line]);
        path(svg, "line main strong", places.into_iter(), false);
        for end in range {
            across(svg, "line main strong", at(end));
        }
    }
    for (class, value) in &strip.dots {
        path(
            svg,
            &format!("dot {class}"),
            [[at(*value), line]].into_iter(),
            false,
        );
    }
    // The numbers below the dots are placed first. Numbers at the ends of range and band follow, if there is enough space.
    let dots = strip.dots.iter().rev().map(|(_, value)| *value);
    let ends = strip.range.into_iter().chain(strip.range.and(strip.band));
    let mut taken: Vec<[f64; 2]> = Vec::new();
    for value in dots.chain(ends.flatten()) {
        let words = with_minus_signs(&brief(rounded(value, scale.high - scale.low)));
        let half = DIGIT * words.chars().count() as f64 / 2.0;
        let x = at(value).clamp(half + EDGE, WIDTH - half - EDGE);
        let place = [x - half - DIGIT / 2.0, x + half + DIGIT / 2.0];
        if taken
            .iter()
            .all(|other| place[1] <= other[0] || other[1] <= place[0])
        {
            text(svg, "axis-text", x, foot, "middle", &words);
            taken.push(place);
        }
    }
}

/// Rounds a number to four digits. A number that is only rounding error, compared with the span of its scale, becomes zero.
fn rounded(value: f64, span: f64) -> f64 {
    if value.abs() < 1e-9 * span {
        return 0.0;
    }
    to_digits(value, 4)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without a range, dots have numbers, and the ends of the band have no numbers. A rounding error is 0, and no number leaves
    /// the picture.
    #[test]
    fn numbers_are_those_of_the_dots() {
        let strip = Strip {
            title: "toe_deg, wanted -0.2".to_owned(),
            range: None,
            band: Some([-0.2351, -0.1649]),
            dots: vec![("former", -2.505e-14), ("main", -0.1704)],
        };
        let svg = strips(&[strip], "values");
        let numbers = svg.lines().filter(|line| line.contains("axis-text"));
        let numbers: Vec<&str> = numbers
            .map(|line| line.split(['>', '<']).nth(2).unwrap())
            .collect();
        assert_eq!(numbers, ["\u{2212}0.1704", "0"]);
        let long = Strip {
            title: String::new(),
            range: Some([-1234.0, 1e-4]),
            band: None,
            dots: vec![("main", 1.234e-4)],
        };
        for line in strips(&[long], "values").lines() {
            let Some((_, x)) = line.split_once("axis-text\" x=\"") else {
                continue;
            };
            let x: f64 = x.split('"').next().unwrap().parse().unwrap();
            let letters = line.split(['>', '<']).nth(2).unwrap().len() as f64;
            let half = 0.5 * DIGIT * letters;
            assert!(x - half >= 8.0 && x + half <= WIDTH - 8.0, "{line}");
        }
    }

    /// Ends of range and band, and dots, are at positions proportional to their values.
    #[test]
    fn values_are_drawn_to_scale() {
        let strip = Strip {
            title: "travel_mm".to_owned(),
            range: Some([-100.0, 300.0]),
            band: Some([-50.0, 50.0]),
            dots: vec![("former", 0.0)],
        };
        let svg = strips(&[strip], "ranges");
        let at = |class: &str| -> Vec<f64> {
            let marks = svg.lines().filter(|line| line.contains(class));
            let places = marks.map(|line| {
                let place = line.split("d=\"M").nth(1).unwrap();
                place.split(' ').next().unwrap().parse().unwrap()
            });
            places.collect()
        };
        let (line, band, dot) = (at("line main"), at("limit"), at("dot"));
        // The first mark is the line itself, which begins at the lower end. The marks of the lower and the upper end follow.
        assert_eq!(line[0], line[1]);
        let per_unit = (line[2] - line[1]) / 400.0;
        for (place, value) in [(band[0], -50.0), (band[1], 50.0), (dot[0], 0.0)] {
            let wanted = line[1] + (value + 100.0) * per_unit;
            assert!((place - wanted).abs() <= 0.1, "{value}: {place} {wanted}");
        }
        assert!(svg.contains(">300<") && svg.contains(">0<"));
        assert_eq!(strips(&[], "nothing"), "");
    }

    /// A value that is only rounding error is shown as 0, and negative numbers have a minus sign.
    #[test]
    fn numbers_can_be_read() {
        let strip = Strip {
            title: "toe_deg".to_owned(),
            range: None,
            band: Some([-0.152, -0.048]),
            dots: vec![("former", -1.977e-14), ("main", -0.152)],
        };
        let svg = strips(&[strip], "values");
        assert!(
            svg.contains(">0<") && svg.contains(">\u{2212}0.152<"),
            "{svg}"
        );
    }
}
