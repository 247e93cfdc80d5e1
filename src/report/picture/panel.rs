//! One plot as SVG: curves over the motion, what was wanted of them, and gaps where nothing was solved.

use super::drawn_target::DrawnTarget;
use super::lettering::{Anchor, Lettering, Words};
use super::scale::Scale;
use crate::report::figure::power_of_ten;
use std::fmt::Write;

/// Width and height of a panel.
pub(super) const SIZE: [f64; 2] = [400.0, 470.0];
/// Left, top, right and bottom of the plot in it.
const PLOT: [f64; 4] = [64.0, 58.0, 384.0, 418.0];

/// Number of colours that are told apart at once.
const HUES: usize = 7;
/// Number of shades of a scale.
const SHADES: usize = 9;
/// Height of a row of the legend.
const ROW: f64 = 15.0;
/// Number of rows of the legend for which there is room above the plot.
const ROWS: usize = 2;

/// A colour of one line among several.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Hue {
    /// One of few that are told apart at once.
    Apart(usize),
    /// A shade of a scale from one end to the other, of many.
    Shade(usize),
}

impl Hue {
    /// The colour of a line, by its number among so many.
    pub(super) fn of(number: usize, lines: usize) -> Self {
        match lines {
            0..=HUES => Hue::Apart(number),
            _ => Hue::Shade((number * (SHADES - 1) + (lines - 1) / 2) / (lines - 1)),
        }
    }
}

/// Style of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Look {
    /// Whether it is of the last design.
    pub main: bool,
    /// Colour of its family, where there are several.
    pub hue: Option<Hue>,
    /// Whether it is of the inner of two pairs of designs about the last one.
    pub is_inner: bool,
}

impl Look {
    fn class(self) -> String {
        let design = match (self.main, self.is_inner) {
            (true, _) => "main",
            (false, false) => "former",
            (false, true) => "former inner",
        };
        let hue = self.hue.map(|hue| match hue {
            Hue::Apart(number) => format!(" rack{number}"),
            Hue::Shade(number) => format!(" shade{number}"),
        });
        design.to_owned() + &hue.unwrap_or_default()
    }
}

/// A curve: motion and value, station by station; `None` is a gap.
#[derive(Clone, Debug)]
pub(super) struct Line {
    /// Name in the legend; none for further curves of one name.
    pub name: Option<String>,
    /// Style of the curve.
    pub look: Look,
    /// Its points.
    pub points: Vec<Option<[f64; 2]>>,
}

/// One plot.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    /// Label of the axis of values.
    pub value: String,
    /// Label of the axis of the motion.
    pub motion: String,
    /// Whether the motion is on the vertical axis.
    pub upright: bool,
    /// Curves, the most important one last.
    pub lines: Vec<Line>,
    /// Targets.
    pub wanted: Vec<DrawnTarget>,
    /// Places of the last design that miss a target by more than its tolerance.
    pub missed: Vec<[f64; 2]>,
    /// Motion values that were not solved.
    pub failed: Vec<f64>,
}

impl Panel {
    /// Whether some line has a look that few pictures need: a shade of a scale, or that of an inner pair.
    pub(super) fn has_rare_looks(&self) -> bool {
        let mut looks = self.lines.iter().map(|line| line.look);
        looks.any(|look| look.is_inner || matches!(look.hue, Some(Hue::Shade(_))))
    }

    /// Height that the legend needs beyond the room above the plot.
    pub(super) fn legend_beyond(&self) -> f64 {
        ROW * self.legend_rows().len().saturating_sub(ROWS) as f64
    }

    /// The panel as an SVG group, moved to the right and down by `shift`.
    pub(super) fn svg(&self, shift: [f64; 2], lettering: &Lettering) -> String {
        let [left, top, right, bottom] = PLOT;
        let points = || self.lines.iter().flat_map(|l| l.points.iter().flatten());
        let wanted: Vec<[f64; 2]> = self.wanted.iter().flat_map(DrawnTarget::edges).collect();
        let values = points().chain(&wanted).map(|p| p[1]);
        let motion = points().chain(&wanted).map(|p| p[0]);
        let motion = motion.chain(self.failed.iter().copied());
        let (x, y) = match self.upright {
            true => (
                Scale::showing(values, 5.0, [left, right]),
                Scale::showing(motion, 8.0, [bottom, top]),
            ),
            false => (
                Scale::showing(motion, 5.0, [left, right]),
                Scale::showing(values, 8.0, [bottom, top]),
            ),
        };
        let place = |[motion, value]: [f64; 2]| match self.upright {
            true => [x.place(value), y.place(motion)],
            false => [x.place(motion), y.place(value)],
        };
        let [across, down] = shift.map(number);
        let mut svg = format!("<g transform=\"translate({across} {down})\">\n");
        self.axes(&mut svg, lettering, &x, &y);
        for wanted in &self.wanted {
            wanted.draw(&mut svg, &place);
        }
        for line in &self.lines {
            for piece in line.points.split(Option::is_none) {
                path(
                    &mut svg,
                    &line.look.class(),
                    piece.iter().flatten().map(|p| place(*p)),
                    false,
                );
            }
        }
        for missed in &self.missed {
            let [x, y] = place(*missed).map(number);
            let _ = writeln!(
                svg,
                "<circle class=\"missed\" cx=\"{x}\" cy=\"{y}\" r=\"4\"/>"
            );
        }
        for motion in &self.failed {
            let (x, y) = match self.upright {
                true => (left, y.place(*motion)),
                false => (x.place(*motion), bottom),
            };
            let _ = writeln!(
                svg,
                "<path class=\"failed\" d=\"M{} {}l6 6m0 -6l-6 6\"/>",
                number(x - 3.0),
                number(y - 3.0)
            );
        }
        self.legend(&mut svg, lettering);
        svg + "</g>\n"
    }

    fn axes(&self, svg: &mut String, lettering: &Lettering, x: &Scale, y: &Scale) {
        let [left, top, right, bottom] = PLOT;
        for (at, label) in x.ticks() {
            let line = number(at);
            let _ = writeln!(svg, "<path class=\"grid\" d=\"M{line} {top}V{bottom}\"/>");
            let place = [at, bottom + 18.0];
            lettering.write(svg, &Words::new(&label, place, Anchor::Middle));
            svg.push('\n');
        }
        for (at, label) in y.ticks() {
            let line = number(at);
            let _ = writeln!(svg, "<path class=\"grid\" d=\"M{left} {line}H{right}\"/>");
            let place = [left - 8.0, at + 4.0];
            lettering.write(svg, &Words::new(&label, place, Anchor::End));
            svg.push('\n');
        }
        let (below, beside) = match self.upright {
            true => (&self.value, &self.motion),
            false => (&self.motion, &self.value),
        };
        let (below, beside) = (&in_power(below, x.power()), &in_power(beside, y.power()));
        let [across, up] = [(left + right) / 2.0, (top + bottom) / 2.0];
        let below = Words::new(below, [across, bottom + 40.0], Anchor::Middle).label();
        let beside = Words::new(beside, [16.0, up], Anchor::Middle).label();
        for words in [below, beside.upward()] {
            lettering.write(svg, &words);
            svg.push('\n');
        }
    }

    /// Entries of the legend in rows: place, class and name.
    fn legend_rows(&self) -> Vec<Vec<(f64, String, &str)>> {
        let mut entries: Vec<(String, &str)> = Vec::new();
        for line in &self.lines {
            if let Some(name) = &line.name {
                entries.push((line.look.class(), name));
            }
        }
        for (class, name) in DrawnTarget::KINDS {
            if self.wanted.iter().any(|wanted| wanted.class() == class) {
                entries.push((class.to_owned(), name));
            }
        }
        if !self.missed.is_empty() {
            entries.push(("missed".to_owned(), "missed"));
        }
        if !self.failed.is_empty() {
            entries.push(("failed".to_owned(), "not solved"));
        }
        let [left, _, right, _] = PLOT;
        let mut rows: Vec<Vec<(f64, String, &str)>> = vec![Vec::new()];
        let mut at = left;
        for (class, name) in entries {
            let width = 44.0 + 7.0 * name.chars().count() as f64;
            if at + width > right + 16.0 && at > left {
                rows.push(Vec::new());
                at = left;
            }
            let row = rows.last_mut().expect("there is one");
            row.push((at, class, name));
            at += width;
        }
        rows
    }

    /// Names of the curves, in as many rows as that takes, upward from the plot.
    fn legend(&self, svg: &mut String, lettering: &Lettering) {
        let rows = self.legend_rows();
        let first = PLOT[1] - 24.0 - ROW * (rows.len() - 1) as f64;
        for (number, row) in rows.into_iter().enumerate() {
            let y = first + ROW * number as f64;
            for (at, class, name) in row {
                let _ = match class.as_str() {
                    "missed" => {
                        let x = at + 11.0;
                        write!(
                            svg,
                            "<circle class=\"{class}\" cx=\"{x}\" cy=\"{y}\" r=\"4\"/>"
                        )
                    }
                    _ => write!(svg, "<path class=\"{class}\" d=\"M{at} {y}h22\"/>"),
                };
                let place = [at + 28.0, y + 4.0];
                lettering.write(svg, &Words::new(name, place, Anchor::Start));
                svg.push('\n');
            }
        }
    }
}

/// The title of an axis whose ticks are in a power of ten: `camber gain [10⁻³ °/mm]`.
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

/// A line through some points; a lone one becomes a dot.
pub(super) fn path(
    svg: &mut String,
    class: &str,
    points: impl Iterator<Item = [f64; 2]>,
    closed: bool,
) {
    let places: Vec<String> = points
        .map(|[x, y]| format!("{} {}", number(x), number(y)))
        .collect();
    let end = match (places.len(), closed) {
        (0, _) => return,
        (1, _) => "h0.1",
        (_, true) => "Z",
        (_, false) => "",
    };
    let _ = writeln!(
        svg,
        "<path class=\"{class}\" d=\"M{}{end}\"/>",
        places.join("L")
    );
}

/// A length on the picture: tenths are more than enough, and hide the last digits of the platform.
pub(super) fn number(length: f64) -> String {
    let text = format!("{:.1}", (length * 10.0).round() / 10.0 + 0.0);
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}
