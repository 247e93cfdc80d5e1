//! One plot as SVG: curves over the motion, a target with its tolerance, and gaps where nothing was
//! solved.

use super::lettering::{Anchor, Lettering, Words};
use super::scale::Scale;
use std::fmt::Write;

/// Width and height of a panel.
pub const SIZE: [f64; 2] = [400.0, 470.0];
/// Left, top, right and bottom of the plot in it.
const PLOT: [f64; 4] = [64.0, 58.0, 384.0, 418.0];

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// The last design.
    Main,
    /// A design before it.
    Former,
}

/// A curve: motion and value, station by station; `None` is a gap.
#[derive(Clone, Debug)]
pub struct Line {
    /// Name in the legend; none for further curves of one name.
    pub name: Option<String>,
    /// How it is drawn.
    pub look: Look,
    /// Its points.
    pub points: Vec<Option<[f64; 2]>>,
}

/// A target: motion and value, and what may be missed.
#[derive(Clone, Debug)]
pub struct Band {
    /// Its points.
    pub points: Vec<[f64; 2]>,
    /// The tolerance.
    pub tolerance: f64,
}

/// One plot.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Label of the axis of values.
    pub value: String,
    /// Label of the axis of the motion.
    pub motion: String,
    /// Whether the motion is on the vertical axis.
    pub upright: bool,
    /// Curves, the most important one last.
    pub lines: Vec<Line>,
    /// Targets.
    pub bands: Vec<Band>,
    /// Motion values that were not solved.
    pub failed: Vec<f64>,
}

impl Panel {
    /// The panel as an SVG group, moved to the right by `shift`.
    pub fn svg(&self, shift: f64, lettering: &Lettering) -> String {
        let [left, top, right, bottom] = PLOT;
        let points = || self.lines.iter().flat_map(|l| l.points.iter().flatten());
        let wanted = || self.bands.iter().flat_map(|b| &b.points);
        let edges = self.bands.iter().flat_map(|b| {
            let both = |p: &[f64; 2]| [p[1] - b.tolerance, p[1] + b.tolerance];
            b.points.iter().flat_map(both)
        });
        let values = points().map(|p| p[1]).chain(edges);
        let motion = points().chain(wanted()).map(|p| p[0]);
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
        let mut svg = format!("<g transform=\"translate({} 0)\">\n", number(shift));
        self.axes(&mut svg, lettering, &x, &y);
        for band in &self.bands {
            band_svg(&mut svg, band, &place);
        }
        for line in &self.lines {
            let class = match line.look {
                Look::Main => "main",
                Look::Former => "former",
            };
            for piece in line.points.split(Option::is_none) {
                path(
                    &mut svg,
                    class,
                    piece.iter().flatten().map(|p| place(*p)),
                    false,
                );
            }
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
        let [across, up] = [(left + right) / 2.0, (top + bottom) / 2.0];
        let below = Words::new(below, [across, bottom + 40.0], Anchor::Middle).label();
        let beside = Words::new(beside, [16.0, up], Anchor::Middle).label();
        for words in [below, beside.upward()] {
            lettering.write(svg, &words);
            svg.push('\n');
        }
    }

    fn legend(&self, svg: &mut String, lettering: &Lettering) {
        let mut entries: Vec<(&str, &str)> = Vec::new();
        for line in &self.lines {
            if let Some(name) = &line.name {
                let class = match line.look {
                    Look::Main => "main",
                    Look::Former => "former",
                };
                entries.push((class, name));
            }
        }
        if !self.bands.is_empty() {
            entries.push(("target", "target ± tolerance"));
        }
        if !self.failed.is_empty() {
            entries.push(("failed", "not solved"));
        }
        let mut at = PLOT[0];
        for (class, name) in entries {
            let _ = write!(svg, "<path class=\"{class}\" d=\"M{at} 34h22\"/>");
            lettering.write(svg, &Words::new(name, [at + 28.0, 38.0], Anchor::Start));
            svg.push('\n');
            at += 44.0 + 7.0 * name.chars().count() as f64;
        }
    }
}

fn band_svg(svg: &mut String, band: &Band, place: &impl Fn([f64; 2]) -> [f64; 2]) {
    let side = |sign: f64| {
        let points = band.points.iter();
        points.map(move |[motion, value]| [*motion, value + sign * band.tolerance])
    };
    let outline = side(1.0).chain(side(-1.0).rev()).map(place);
    path(svg, "band", outline, true);
    match band.points.as_slice() {
        [only] => {
            let [x, y] = place(*only).map(number);
            let _ = writeln!(
                svg,
                "<circle class=\"spot\" cx=\"{x}\" cy=\"{y}\" r=\"3.5\"/>"
            );
        }
        points => path(svg, "target", points.iter().map(|p| place(*p)), false),
    }
}

/// A line through some points; a lone one becomes a dot.
fn path(svg: &mut String, class: &str, points: impl Iterator<Item = [f64; 2]>, closed: bool) {
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
pub fn number(length: f64) -> String {
    let text = format!("{:.1}", (length * 10.0).round() / 10.0 + 0.0);
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}
