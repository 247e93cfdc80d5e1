//! Whether hardpoints make a suspension: distinct points, arms that turn, believable size, right side.

use super::error::Problems;
use super::file;
use super::value::Text;
use crate::mechanism::has_leverage;
use crate::model::{Body, PointId, Suspension};
use std::ops::Range as Span;

/// Points closer than this share of the mechanism's size coincide.
const COINCIDENT: f64 = 1e-9;

/// Sizes of a suspension that are believed, in metres: from a small model car to a haul truck. The
/// wrong unit is a factor of a thousand.
const PLAUSIBLE_SIZE: [f64; 2] = [0.005, 50.0];

/// Passes a suspension without a mistake; a mistake found first keeps those that follow from it quiet.
pub fn check(
    section: &file::Suspension,
    suspension: &Suspension,
    problems: &mut Problems,
) -> Option<()> {
    let geometry = Geometry {
        section,
        suspension,
    };
    geometry.distinct_points(problems)?;
    geometry.arms_turn(problems)?;
    geometry.rockers_turn(problems)?;
    geometry.plausible_size(problems)?;
    geometry.right_side(problems)
}

struct Geometry<'a> {
    section: &'a file::Suspension,
    suspension: &'a Suspension,
}

impl Geometry<'_> {
    fn name(&self, id: PointId) -> &str {
        self.suspension.mechanism.name(id)
    }

    /// Where the file names a hardpoint.
    fn place(&self, id: PointId) -> Span<usize> {
        let hardpoints = &self.section.hardpoints;
        let text = hardpoints
            .get_ref()
            .keys()
            .find(|text| text.get_ref() == self.name(id));
        text.map_or(hardpoints.span(), Text::span)
    }

    fn distinct_points(&self, problems: &mut Problems) -> Option<()> {
        let Suspension {
            mechanism, design, ..
        } = self.suspension;
        let least = COINCIDENT * self.suspension.size();
        let mut sound = Some(());
        for (first, second, reason) in mechanism.topology.all_distinct() {
            let (Some(a), Some(b)) = (mechanism.point(first), mechanism.point(second)) else {
                continue;
            };
            if (design[a.0] - design[b.0]).norm() <= least {
                sound = None;
                let message = format!("{second} coincides with {first}: {reason}");
                let error = problems.add(self.place(b), message);
                error.related(self.place(a), "the same place");
            }
        }
        sound
    }

    fn arms_turn(&self, problems: &mut Problems) -> Option<()> {
        let Suspension {
            mechanism, design, ..
        } = self.suspension;
        let mut sound = Some(());
        for arm in &mechanism.arms {
            let axis = (design[arm.front.0] - design[arm.rear.0]).normalised();
            let leg = design[arm.outer.0] - design[arm.rear.0];
            if axis.cross(leg).norm() <= COINCIDENT * self.suspension.size() {
                sound = None;
                let [outer, front, rear] = [arm.outer, arm.front, arm.rear].map(|p| self.name(p));
                let message = format!(
                    "{outer} is in line with {front} and {rear}: the arm could not move it"
                );
                problems.add(self.place(arm.outer), message);
            }
        }
        sound
    }

    fn rockers_turn(&self, problems: &mut Problems) -> Option<()> {
        let Suspension {
            mechanism, design, ..
        } = self.suspension;
        let mut sound = Some(());
        for rocker in &mechanism.rockers {
            let [inner, outer, first, second] =
                [rocker.inner, rocker.outer, rocker.first, rocker.second].map(|p| self.name(p));
            let axis = (design[rocker.second.0] - design[rocker.first.0]).normalised();
            let lever = axis.cross(design[rocker.inner.0] - design[rocker.first.0]);
            let turned = rocker.rod.turns();
            let message = if lever.norm() <= COINCIDENT * self.suspension.size() {
                format!("{inner} is in line with {first} and {second}: it could not turn {turned}")
            } else if !has_leverage(rocker, design) {
                format!(
                    "the {} is at toggle in the design position: {outer}, {inner} and the axis from \
                     {first} to {second} lie in one plane, so it cannot turn {turned}",
                    rocker.rod
                )
            } else {
                continue;
            };
            sound = None;
            problems.add(self.place(rocker.inner), message);
        }
        sound
    }

    fn plausible_size(&self, problems: &mut Problems) -> Option<()> {
        let size = self.suspension.size();
        let unit = self.suspension.length_unit;
        let metres = size / unit.per_metre();
        let [smallest, largest] = PLAUSIBLE_SIZE;
        if (smallest..=largest).contains(&metres) {
            return Some(());
        }
        let written = self.section.length_unit.as_ref();
        let place = written.map_or(self.section.hardpoints.span(), Text::span);
        let symbol = unit.symbol();
        let message =
            format!("the hardpoints are {size:.3} {symbol} apart, which is no suspension");
        let help = "length_unit is the unit of every length in the file: \"mm\" or \"m\"";
        problems.add(place, message).help(help);
        None
    }

    /// A wheel is outboard of the points on the body, wherever the origin is.
    fn right_side(&self, problems: &mut Problems) -> Option<()> {
        let Suspension {
            mechanism, design, ..
        } = self.suspension;
        let inboard: Vec<f64> = mechanism
            .points
            .iter()
            .zip(design)
            .filter(|(point, _)| matches!(point.body, Body::Chassis | Body::Rack))
            .map(|(_, position)| position.y)
            .collect();
        let mean = inboard.iter().sum::<f64>() / inboard.len() as f64;
        let centre = mechanism.wheel_centre;
        if design[centre.0].y >= mean {
            return Some(());
        }
        let message = format!("{} is inboard of the points on the body", self.name(centre));
        let help = "side and frame must fit the coordinates: a left wheel has positive y in \"iso8855\", \
                    negative y in \"sae_j670\" and \"x_rear\"";
        problems.add(self.place(centre), message).help(help);
        None
    }
}
