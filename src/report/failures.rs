//! Failed stations: neighbours that failed for the same reason form one range.

use super::figure::as_written;
use super::station_label::place_in_words;
use crate::curves::{Curves, Status};
use crate::model::Suspension;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Neighbouring stations that failed for the same reason.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FailureRange {
    /// Index of the first station.
    pub first: usize,
    /// Index of the last station.
    pub last: usize,
    /// Word in the `status` column.
    pub status: String,
    /// Reason why there is no pose.
    pub reason: String,
    /// Position on the motion, in words.
    pub place: String,
}

impl FailureRange {
    /// Failed ranges of curves, in the order of their stations. `wheel` is the wheel of a study of one wheel, or the left wheel
    /// of an axle.
    pub fn all(curves: &Curves, wheel: &Suspension) -> Vec<FailureRange> {
        let stations = &curves.stations;
        let mut stretches: Vec<FailureRange> = Vec::new();
        for (index, station) in stations.iter().enumerate() {
            let Status::Failed(reason) = station.status else {
                continue;
            };
            let reason = reason.describe(wheel.length_unit, wheel.frame);
            let continues = |s: &&mut FailureRange| {
                s.last + 1 == index
                    && s.reason == reason
                    && moves_on(curves, s.last, index).is_some()
            };
            if let Some(stretch) = stretches.last_mut().filter(continues) {
                stretch.last = index;
            } else {
                stretches.push(FailureRange {
                    first: index,
                    last: index,
                    status: station.status.word().to_owned(),
                    reason,
                    place: String::new(),
                });
            }
        }
        for stretch in &mut stretches {
            stretch.place = place(curves, stretch.first, stretch.last);
        }
        stretches
    }

    /// Number of stations.
    pub fn stations(&self) -> usize {
        (self.last + 1).saturating_sub(self.first)
    }
}

impl fmt::Display for FailureRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.reason)
    }
}

/// Index of the given coordinate in which two stations differ. `None` if they differ in several coordinates, or in the
/// rack.
fn moves_on(curves: &Curves, first: usize, last: usize) -> Option<usize> {
    let [first, last] = [first, last].map(|station| &curves.stations[station].at);
    let given = (0..curves.motion.len()).filter(|k| curves.motion[*k].is_given);
    let mut moving = given.filter(|k| first[*k] != last[*k]);
    moving
        .next()
        .filter(|k| curves.motion[*k].key != "rack" && moving.next().is_none())
}

/// Position of neighbouring stations in words.
fn place(curves: &Curves, first: usize, last: usize) -> String {
    let text = place_in_words(curves, first);
    let Some(k) = moves_on(curves, first, last) else {
        return text;
    };
    let [from, to] = [first, last].map(|station| curves.stations[station].at[k]);
    let (Some(from), Some(to)) = (from, to) else {
        return text;
    };
    let key = curves.motion[k].key.replace('_', " ");
    let unit = curves.motion[k].unit;
    let one = format!("{key} {} {unit}", as_written(from));
    let both = format!("{key} {} to {} {unit}", as_written(from), as_written(to));
    let stations = last + 1 - first;
    format!("{} ({stations} stations)", text.replacen(&one, &both, 1))
}
