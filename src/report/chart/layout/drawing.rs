//! Writes a layout as SVG.

use super::super::lettering::{Anchor, Lettering, Words, text};
use super::super::mark::{number, path};
use super::{Deviations, EndLabel, Layout, NOTE_LINE, Remark};
use std::fmt::Write;

/// Largest deviation from a target that the strip below the plot shows, as a multiple of the tolerance.
const MOST_DEVIATION: f64 = 2.0;
/// Vertical position of the baseline of the first line of remarks.
const FIRST_NOTE: f64 = 37.0;
/// Width of a letter in the title of the vertical axis, beside the plot.
const TITLE_LETTER: f64 = 7.0;

impl Layout {
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
            text(&self.description()).replace('"', "&quot;"),
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
            let class = format!("end {}", without_stroke(class));
            let place = [at[0], at[1] + 4.0];
            lettering.write(
                &mut svg,
                &Words::new(text, place, Anchor::Start).class(&class),
            );
            svg.push('\n');
        }
        svg + "</g>\n"
    }

    /// Writes the name of the chart on its own line, with the remarks below it.
    fn heading(&self, svg: &mut String, lettering: &Lettering) {
        let name = format!("{}{}", self.before, self.chart.y.name);
        let mut name = name.chars();
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
        for (row, line) in self.remarks.iter().enumerate() {
            let y = FIRST_NOTE + NOTE_LINE * row as f64;
            for Remark { class, text, at } in line {
                let class = format!("note {class}");
                let words = Words::new(text, [*at, y], Anchor::Start).class(&class);
                lettering.write(svg, &words);
                svg.push('\n');
            }
        }
    }

    fn axes(&self, svg: &mut String, lettering: &Lettering) {
        let [left, top, right, bottom] = self.plot;
        let y = &self.scales[1];
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
        let middle = [(left + right) / 2.0, foot + 35.0];
        lettering.write(
            svg,
            &Words::new(&self.x.title, middle, Anchor::Middle)
                .label()
                .class("axis-text"),
        );
        svg.push('\n');
        // A title such as "rise by vertical force" may be longer than the height of the plot. Then the words after "by" are
        // omitted, because the other axis names this load. If the title is still too long, only the unit stays.
        let fits =
            |title: &String| title.chars().count() as f64 * TITLE_LETTER <= bottom - top + 30.0;
        let beside = &self.y.title;
        let unit = beside.rfind('[').map_or("", |unit| &beside[unit..]);
        let short = beside
            .split_once(" by ")
            .map(|(name, _)| format!("{name} {unit}"));
        let forms = [Some(beside.clone()), short];
        let mut forms = forms.into_iter().flatten();
        let beside = forms.find(fits).unwrap_or_else(|| unit.to_owned());
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

    /// Draws crosses at the positions at which a design has no pose.
    fn gaps(&self, svg: &mut String) {
        for failed in &self.chart.failed {
            let [x, y] = [self.scales[0].place(*failed) - 3.0, self.plot[3] - 3.0].map(number);
            let _ = writeln!(svg, "<path class=\"failed\" d=\"M{x} {y}l6 6m0 -6l-6 6\"/>");
        }
    }

    /// Draws the strip that shows deviations from targets. Deviations within the tolerance are inside the shaded band.
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
        for Deviations { line, points } in &self.deviations {
            let line = &self.chart.lines[*line];
            let place = |[at, deviation]: [f64; 2]| [self.scales[0].place(at), y(deviation)];
            let class = without_stroke(&line.class);
            if points.len() > 1 {
                let places = points.iter().map(|d| place(*d));
                path(svg, &format!("line {class}"), places, false);
            }
            for deviation in points {
                let outside = deviation[1].abs() > 1.0;
                if outside || points.len() == 1 {
                    let missed = if outside && line.is_main { " bad" } else { "" };
                    let class = format!("dot {class}{missed}");
                    path(svg, &class, [place(*deviation)].into_iter(), false);
                }
            }
        }
        svg.push_str("</g>\n");
    }
}

/// Returns the CSS classes of a curve without the classes that style its line.
fn without_stroke(class: &str) -> String {
    let strokes = ["strong", "faint", "fine", "inner"];
    let kept: Vec<&str> = class.split(' ').filter(|c| !strokes.contains(c)).collect();
    kept.join(" ")
}
