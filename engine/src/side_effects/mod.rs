//! Side effects of a tuning: changes that no target requests.
//!
//! A target gives values of a quantity at some stations. A change at these stations is intended. At all other stations, and
//! for every other quantity, a change is a side effect. With b(s) and a(s) the values before and after the tuning at station
//! s, the side effect is
//!
//! ```text
//! c(s) = a(s) - b(s)                              if no target concerns the quantity,           (1)
//! c(s) = (a(s) - b(s)) - (a(n) - b(n))            n: nearest station with such a target,       (2)
//! ```
//!
//! If the change at s is between 0 and the change requested at n, c(s) is 0. If the two changes have opposite signs, equation (1)
//! applies.
//!
//! Example: a target requests a change of caster in the design position. Then a change of caster by up to the same amount is
//! allowed over the whole travel. A larger change, or a change in the other direction, is a side effect. Distances between
//! stations are measured in shares of the motion's ranges. If a named motion has no target for the quantity, n is the
//! station of `[motion]` with the nearest drive value.
//!
//! A target for a gain also counts for the quantity whose slope is the gain: bump steer for toe, motion ratio for spring
//! length. Limits of a constraint also count as a target, because the study allows any value between these limits.

mod axle;
mod car;
mod comparison;
mod corner;
mod customary;
mod observed;

pub use car::side_effects_of_car;

use crate::mechanism::DesignFault;
use crate::sorting::sort_by;
use crate::study::Study;
use serde::{Deserialize, Serialize};

/// Change of an output between the design before and after a tuning, over one motion. For an axle, a quantity of both wheels
/// is one output.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SideEffect {
    /// Name of the output without its unit. It includes the name of the motion, except for `[motion]`.
    pub output: String,
    /// Unit of all values, as in column names. Empty for a plain number.
    pub unit: String,
    /// Smallest value before the tuning at the compared stations. `None` if there is no value.
    pub before_min: Option<f64>,
    /// Largest value before the tuning at the compared stations.
    pub before_max: Option<f64>,
    /// Smallest value after the tuning at the compared stations.
    pub after_min: Option<f64>,
    /// Largest value after the tuning at the compared stations.
    pub after_max: Option<f64>,
    /// Largest change that no target requests, with its sign. Changes are compared in multiples of the tolerance. 0 if
    /// all changes are rounding errors or requested. `None` if no station has a value both before and after.
    pub largest_change: Option<f64>,
    /// Largest part of a change at the same stations that follows from targets, with its sign. 0 if there is none.
    #[serde(default)]
    pub asked_change: f64,
    /// Station of the largest change. Empty if nothing changes.
    pub at: Vec<PlaceCoordinate>,
    /// Load case of the largest change, for results of a car's load cases.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case: Option<String>,
    /// Wheel with the largest change: `left` or `right` for an axle, `front_left` and so on for a car. `None` for other
    /// outputs.
    pub wheel: Option<String>,
    /// Customary tolerance at the station of the largest change. `None` if the output has none.
    pub tolerance: Option<f64>,
    /// True if the change exceeds the tolerance, or if the output no longer has a value at some stations.
    pub flagged: bool,
    /// Number of stations with a value before the tuning and none after it.
    pub lost: usize,
}

/// Coordinate of a station.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlaceCoordinate {
    /// Name of the coordinate, as in `[motion]`.
    pub name: String,
    /// Value in the study's unit.
    pub value: f64,
    /// Unit of the value.
    pub unit: String,
}

impl SideEffect {
    /// Name of the output with its unit, as in the column of curves.
    pub fn column(&self) -> String {
        match self.output.split_once(", ") {
            Some((output, motion)) => {
                format!("{}, {motion}", crate::ask::with_unit(output, &self.unit))
            }
            None => crate::ask::with_unit(self.output.as_str(), &self.unit),
        }
    }

    /// Returns true if no value was lost, and all changes are rounding errors or requested by targets.
    pub fn is_unchanged(&self) -> bool {
        self.lost == 0 && self.largest_change.unwrap_or(0.0) == 0.0
    }
}

/// Compares a study's design with a tuned design, over `[motion]` and over the named motions with curves. Flagged outputs come
/// first, in three groups: outputs that lost their value at some stations, angles, and other flagged outputs. Within each group,
/// the largest change comes first, in multiples of the tolerance. Outputs without a flag follow in their usual order. The list is
/// empty without `[optimise]`, or if `[optimise]` has `side_effects = false`.
///
/// # Errors
/// Returns an error if one of the two designs cannot be solved.
pub fn side_effects(before: &Study, after: &Study) -> Result<Vec<SideEffect>, DesignFault> {
    let asked = before.optimise.as_ref();
    if !asked.is_some_and(|optimise| optimise.side_effects) {
        return Ok(Vec::new());
    }
    let mut found = over_all_motions(before, after)?;
    by_severity(&mut found);
    Ok(found)
}

/// Returns the side effects over `[motion]` and over the named motions with curves, in the order of the outputs.
fn over_all_motions(before: &Study, after: &Study) -> Result<Vec<SideEffect>, DesignFault> {
    let mut found = Vec::new();
    let mut asked = comparison::RequestedChanges::default();
    let named = before.motion_names().into_iter().map(Some);
    for motion in std::iter::once(None).chain(named) {
        let [before, after] = [before, after].map(|study| observed::observe(study, motion));
        let (before, after) = (before?, after?);
        found.extend(comparison::compare(&before, &after, &asked));
        if motion.is_none() {
            asked = comparison::RequestedChanges::of(&before, &after);
        }
    }
    Ok(found)
}

/// Sorts side effects in the order that [`side_effects`] describes.
fn by_severity(effects: &mut [SideEffect]) {
    sort_by(effects, |one, other| {
        let (one, other) = (severity(one), severity(other));
        one.0.cmp(&other.0).then(other.1.total_cmp(&one.1))
    });
}

/// Group of a side effect, and its largest change in multiples of the tolerance. Groups: 0 for lost values, 1 for flagged angles, 2
/// for other flagged outputs, 3 without a flag.
fn severity(effect: &SideEffect) -> (u8, f64) {
    let share = effect.largest_change.zip(effect.tolerance);
    let share = share.map_or(0.0, |(change, tolerance)| change.abs() / tolerance);
    match (effect.flagged, effect.lost, effect.unit.as_str()) {
        (true, 1.., _) => (0, share),
        (true, 0, "deg") => (1, share),
        (true, 0, _) => (2, share),
        // Outputs without a flag keep their order.
        (false, ..) => (3, 0.0),
    }
}
