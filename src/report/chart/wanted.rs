//! Target of a curve: values with a tolerance, or limits.

use super::mark::path;
use crate::report::figure::brief;

/// A target in a chart.
#[derive(Clone, Debug)]
pub(in crate::report) enum Wanted {
    /// Target values of an output, with a common tolerance.
    Values {
        /// Points: value of the motion's coordinate, and target value.
        points: Vec<[f64; 2]>,
        /// Tolerance of the values.
        tolerance: f64,
        /// Column of the curves to which the strip compares the target. `None` if the chart has no curve at the poses of the
        /// target.
        column: Option<String>,
    },
    /// Limits without their tolerance: value of the motion's coordinate, minimum and maximum. `None` without a limit.
    Limits(Vec<(f64, Option<f64>, Option<f64>)>),
}

impl Wanted {
    /// Legend of the target: `target ± 0.1 °`, or the mark of a range.
    pub(super) fn in_words(&self, unit: &str) -> String {
        match self {
            Wanted::Values { tolerance, .. } => format!("target ± {} {unit}", brief(*tolerance))
                .trim_end()
                .to_owned(),
            Wanted::Limits(limits) if limits.len() > 1 => "shaded: wanted range".to_owned(),
            Wanted::Limits(_) => "marks: wanted range".to_owned(),
        }
    }

    /// Points: value of the motion's coordinate, lower limit and upper limit. The limits of target values include the tolerance.
    /// Limits of a range do not.
    pub(super) fn limits(&self) -> Vec<(f64, Option<f64>, Option<f64>)> {
        match self {
            Wanted::Values {
                points, tolerance, ..
            } => {
                let around = |[at, value]: &[f64; 2]| {
                    (*at, Some(value - tolerance), Some(value + tolerance))
                };
                points.iter().map(around).collect()
            }
            Wanted::Limits(limits) => limits.clone(),
        }
    }

    /// Corner points of the target's outline: value of the motion's coordinate, and value of the limit.
    pub(super) fn edges(&self) -> Vec<[f64; 2]> {
        match self {
            Wanted::Values {
                points, tolerance, ..
            } => {
                let both = |[motion, value]: &[f64; 2]| {
                    [-tolerance, *tolerance].map(|by| [*motion, value + by])
                };
                points.iter().flat_map(both).collect()
            }
            Wanted::Limits(limits) => [least(limits), most(limits)].concat(),
        }
    }

    /// Draws the target. `place` converts a point to a position on the picture.
    pub(super) fn draw(&self, svg: &mut String, place: &impl Fn([f64; 2]) -> [f64; 2]) {
        match self {
            Wanted::Values {
                points, tolerance, ..
            } => match points.as_slice() {
                [only] => bar(svg, *only, *tolerance, place),
                points => band(svg, points, *tolerance, place),
            },
            Wanted::Limits(limits) => {
                let both = |limit: &&(f64, Option<f64>, Option<f64>)| {
                    limit.1.is_some() && limit.2.is_some()
                };
                let closed: Vec<_> = limits.iter().filter(both).copied().collect();
                if closed.len() > 1 {
                    let back = most(&closed).into_iter().rev();
                    let outline = least(&closed).into_iter().chain(back).map(place);
                    path(svg, "band", outline, true);
                }
                for edge in [least(limits), most(limits)] {
                    match edge.as_slice() {
                        [only] => tick(svg, "limit", *only, place),
                        edge => path(svg, "limit", edge.iter().map(|p| place(*p)), false),
                    }
                }
            }
        }
    }
}

fn least(limits: &[(f64, Option<f64>, Option<f64>)]) -> Vec<[f64; 2]> {
    let edge = limits
        .iter()
        .filter_map(|(motion, low, _)| Some([*motion, (*low)?]));
    edge.collect()
}

fn most(limits: &[(f64, Option<f64>, Option<f64>)]) -> Vec<[f64; 2]> {
    let edge = limits
        .iter()
        .filter_map(|(motion, _, high)| Some([*motion, (*high)?]));
    edge.collect()
}

/// Draws target values as a line over the motion, with the band of their tolerance.
fn band(
    svg: &mut String,
    points: &[[f64; 2]],
    tolerance: f64,
    place: &impl Fn([f64; 2]) -> [f64; 2],
) {
    let side = |sign: f64| {
        let points = points.iter();
        points.map(move |[motion, value]| [*motion, value + sign * tolerance])
    };
    let outline = side(1.0).chain(side(-1.0).rev()).map(place);
    path(svg, "band", outline, true);
    path(svg, "target", points.iter().map(|p| place(*p)), false);
}

/// Draws a target value at one position: a spot, with a bar for its tolerance.
fn bar(
    svg: &mut String,
    [motion, value]: [f64; 2],
    tolerance: f64,
    place: &impl Fn([f64; 2]) -> [f64; 2],
) {
    let [low, high] = [-tolerance, tolerance].map(|by| [motion, value + by]);
    path(svg, "bar", [low, high].map(place).into_iter(), false);
    for end in [low, high] {
        tick(svg, "bar", end, place);
    }
    path(svg, "spot", [place([motion, value])].into_iter(), false);
}

/// Draws a short line at a value.
fn tick(
    svg: &mut String,
    class: &str,
    [motion, value]: [f64; 2],
    place: &impl Fn([f64; 2]) -> [f64; 2],
) {
    let [x, y] = place([motion, value]);
    let ends = [-5.0, 5.0].map(|by| [x + by, y]);
    path(svg, class, ends.into_iter(), false);
}
