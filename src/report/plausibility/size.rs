//! Warnings about ranges of variables and scatters that are large for the size of the suspension. Their unit may be wrong.

use super::PlausibilityRemarks;
use crate::report::figure::{as_written, brief};
use crate::study::{Contributor, Move, Study};

/// Largest plausible move of a point, in wheel radii. For a wheel radius of 300 mm, this move is 150 mm. It moves a joint of the
/// upright out of the rim, and it is a large part of the length of an arm. The sample suspensions use up to 0.3.
const MOVE: f64 = 0.5;
/// Largest plausible standard deviation of a dimension, in wheel radii. For a wheel radius of 300 mm, this deviation is 3 mm. Three
/// standard deviations are then 9 mm, which is more than the coarsest class of ISO 13920 allows for welded lengths up to 400 mm.
const SCATTER: f64 = 0.01;

/// Warnings about the scatters of `[tolerance]`, one for each part.
pub fn scatter_doubts(study: &Study) -> Vec<String> {
    let mut remarks = PlausibilityRemarks {
        suspension: study.wheel(),
        found: Vec::new(),
    };
    for contributor in study.tolerance.iter().flat_map(|own| &own.scatter) {
        remarks.scatter(contributor);
    }
    remarks.found
}

impl PlausibilityRemarks<'_> {
    /// Warning about a variable that moves a point far for the size of the wheel.
    pub(super) fn reach(&mut self, moves: &[Move], absolute: bool, range: [f64; 2]) {
        let Some(radius) = self.usual_radius() else {
            return;
        };
        let reach = |one: &Move| {
            let designed = self.suspension.frame.vector(self.at(one.point))[one.axis];
            let from = if absolute { designed } else { 0.0 };
            let [low, high] = range.map(|end| (one.factor * end - from).abs());
            low.max(high)
        };
        let moved = moves.iter().map(|one| (one, reach(one)));
        let Some((one, reach)) = moved.max_by(|a, b| a.1.total_cmp(&b.1)) else {
            return;
        };
        if reach > MOVE * radius {
            let (name, axis) = (self.name(one.point), one.axis.name());
            let (unit, wheel) = (self.unit(), self.wheel_in_words(radius));
            self.say(format!(
                "the range of {axis} of {name} reaches {} {unit} from the design, more than half of the wheel radius ({wheel}). \
                 Is the unit of the range {unit}?",
                brief(reach)
            ));
        }
    }

    /// Warning about a part whose scatter is large for the size of the wheel.
    fn scatter(&mut self, contributor: &Contributor) {
        let Some(radius) = self.usual_radius() else {
            return;
        };
        let dimensional = contributor.sources.iter().filter(|one| one.rate.is_none());
        let deviations = dimensional.flat_map(|source| {
            let sigma = source.law.variance().sqrt();
            let changes = source.changes.iter();
            changes.map(move |(_, change)| sigma * change.abs())
        });
        let largest = deviations.max_by(f64::total_cmp);
        if let Some(largest) = largest.filter(|largest| *largest > SCATTER * radius) {
            let (unit, wheel) = (self.unit(), self.wheel_in_words(radius));
            self.say(format!(
                "the scatter of {} has a standard deviation of {} {unit}; usual tolerances of fabrication are below 1 % of the \
                 wheel radius ({wheel}). Is the unit of the scatter {unit}?",
                contributor.name,
                brief(largest)
            ));
        }
    }

    fn unit(&self) -> &'static str {
        self.suspension.length_unit.symbol()
    }

    /// Wheel radius with its unit, in words. The text says so if the study does not give the radius.
    fn wheel_in_words(&self, radius: f64) -> String {
        match self.suspension.wheel_radius {
            Some(_) => format!("{} {}", as_written(radius), self.unit()),
            None => format!(
                "assumed: {} {}; [wheel] radius is not given",
                brief(radius),
                self.unit()
            ),
        }
    }
}
