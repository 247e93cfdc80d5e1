//! Target of a curve: values with a tolerance, or limits.

use super::panel::{number, path};
use std::fmt::Write;

/// A target.
#[derive(Clone, Debug)]
pub(super) enum DrawnTarget {
    /// Motion and value, and what may be missed.
    Values {
        /// The points.
        points: Vec<[f64; 2]>,
        /// The tolerance.
        tolerance: f64,
    },
    /// Motion, the least and the most value there; none where there is no limit.
    Limits(Vec<(f64, Option<f64>, Option<f64>)>),
}

impl DrawnTarget {
    /// The two kinds: what their lines look like, and what the legend calls them.
    pub(super) const KINDS: [(&str, &str); 2] =
        [("target", "target ± tolerance"), ("limit", "wanted")];

    /// Style of its line.
    pub(super) fn class(&self) -> &'static str {
        match self {
            DrawnTarget::Values { .. } => "target",
            DrawnTarget::Limits(_) => "limit",
        }
    }

    /// Motion and value of its outline.
    pub(super) fn edges(&self) -> Vec<[f64; 2]> {
        match self {
            DrawnTarget::Values { points, tolerance } => {
                let both = |[motion, value]: &[f64; 2]| {
                    [-tolerance, *tolerance].map(|by| [*motion, value + by])
                };
                points.iter().flat_map(both).collect()
            }
            DrawnTarget::Limits(limits) => [least(limits), most(limits)].concat(),
        }
    }

    pub(super) fn draw(&self, svg: &mut String, place: &impl Fn([f64; 2]) -> [f64; 2]) {
        match self {
            DrawnTarget::Values { points, tolerance } => match points.as_slice() {
                [only] => bar(svg, *only, *tolerance, place),
                points => band(svg, points, *tolerance, place),
            },
            DrawnTarget::Limits(limits) => {
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

/// Values over the motion between their tolerances.
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

/// A value at one place: a spot, with a bar over its tolerance.
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
    let [x, y] = place([motion, value]).map(number);
    let _ = writeln!(
        svg,
        "<circle class=\"spot\" cx=\"{x}\" cy=\"{y}\" r=\"3.5\"/>"
    );
}

/// A short line across the axis of values.
fn tick(
    svg: &mut String,
    class: &str,
    [motion, value]: [f64; 2],
    place: &impl Fn([f64; 2]) -> [f64; 2],
) {
    let at = place([motion, value]);
    // Which axis the values are on shows by where another one would be.
    let is_upright = place([motion, value + 1.0])[0] != at[0];
    let across = if is_upright { [0.0, 5.0] } else { [5.0, 0.0] };
    let ends = [-1.0, 1.0].map(|sign| [at[0] + sign * across[0], at[1] + sign * across[1]]);
    path(svg, class, ends.into_iter(), false);
}
