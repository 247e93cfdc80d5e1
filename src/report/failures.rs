//! Failed stations: neighbours that failed for the same reason form one range.

use super::figure::as_written;
use super::ranges::ends;
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
    /// Position on the motion, in words: `travel 288 to 300 mm (5 stations)`.
    pub place: String,
}

impl FailureRange {
    /// Failed ranges of curves, in the order of their stations. `wheel` is the wheel of a study of one wheel, or the left wheel
    /// of an axle.
    pub fn all(curves: &Curves, wheel: &Suspension) -> Vec<FailureRange> {
        let stations = &curves.stations;
        let mut ranges: Vec<FailureRange> = Vec::new();
        for (index, station) in stations.iter().enumerate() {
            let Status::Failed(reason) = station.status else {
                continue;
            };
            let reason = reason.describe(wheel.length_unit, wheel.frame);
            let goes_on = |range: &&mut FailureRange| {
                range.reason == reason && continues(curves, [range.first, range.last], index)
            };
            if let Some(range) = ranges.last_mut().filter(goes_on) {
                range.last = index;
            } else {
                ranges.push(FailureRange {
                    first: index,
                    last: index,
                    status: station.status.word().to_owned(),
                    reason,
                    place: String::new(),
                });
            }
        }
        for range in &mut ranges {
            range.place = place(curves, range.first, range.last);
        }
        ranges
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

/// Index of the motion coordinate in which two stations differ. Only coordinates that the study gives are compared. `None` if the
/// stations differ in several of them, or in the rack.
fn moves_on(curves: &Curves, first: usize, last: usize) -> Option<usize> {
    let [first, last] = [first, last].map(|station| &curves.stations[station].at);
    let given = (0..curves.motion.len()).filter(|k| curves.motion[*k].is_given);
    let mut moving = given.filter(|k| first[*k] != last[*k]);
    moving
        .next()
        .filter(|k| curves.motion[*k].key != "rack" && moving.next().is_none())
}

/// True if the station `next` directly follows a range of stations, and changes only the coordinate that changes within the
/// range.
fn continues(curves: &Curves, [first, last]: [usize; 2], next: usize) -> bool {
    let along = moves_on(curves, last, next);
    last + 1 == next
        && along.is_some()
        && (first == last || along == moves_on(curves, first, first + 1))
}

/// Position of neighbouring stations in words. One coordinate changes from station to station. The text has the smallest and the
/// largest value of this coordinate, because a motion over time may reverse within the stations.
fn place(curves: &Curves, first: usize, last: usize) -> String {
    let text = place_in_words(curves, first);
    let along = (first < last).then(|| moves_on(curves, first, first + 1));
    let Some(k) = along.flatten() else {
        return text;
    };
    let value = |station: usize| curves.stations[station].at[k];
    let range = ends((first..=last).filter_map(value));
    let (Some(start), Some(end), Some([low, high])) = (value(first), value(last), range) else {
        return text;
    };
    let [from, to] = if end < start {
        [high, low]
    } else {
        [low, high]
    };
    let key = curves.motion[k].key.replace('_', " ");
    let unit = curves.motion[k].unit;
    let one = format!("{key} {} {unit}", as_written(start));
    let both = format!("{key} {} to {} {unit}", as_written(from), as_written(to));
    let stations = last + 1 - first;
    format!("{} ({stations} stations)", text.replacen(&one, &both, 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::{MotionColumn, Station};
    use crate::mechanism::NoPose;

    /// Failed stations at these values of travel and rack.
    fn failed(stations: &[[f64; 2]]) -> Curves {
        let column = |key| MotionColumn {
            key,
            unit: "mm",
            is_given: true,
            is_written: true,
        };
        let station = |at: &[f64; 2]| Station {
            at: at.map(Some).to_vec(),
            status: Status::Failed(NoPose::NoLoad),
            values: Vec::new(),
            condition: None,
            proof: None,
        };
        Curves {
            motion: ["travel", "rack"].map(column).to_vec(),
            stations: stations.iter().map(station).collect(),
            ..Curves::default()
        }
    }

    #[test]
    fn the_place_has_the_whole_range_of_a_motion_that_reverses() {
        let up = failed(&[[288.0, 5.0], [297.0, 5.0], [300.0, 5.0]]);
        assert_eq!(
            place(&up, 0, 2),
            "travel 288 to 300 mm, rack 5 mm (3 stations)"
        );
        let down = failed(&[[-80.0, 0.0], [-90.0, 0.0]]);
        assert_eq!(place(&down, 0, 1), "travel -80 to -90 mm (2 stations)");
        assert_eq!(place(&down, 1, 1), "travel -90 mm");
        let travels = [288.0, 300.0, 297.0, 288.0];
        let back = failed(&travels.map(|travel| [travel, 0.0]));
        assert_eq!(place(&back, 0, 3), "travel 288 to 300 mm (4 stations)");
    }

    #[test]
    fn a_range_has_one_coordinate_that_changes() {
        let mut curves = failed(&[[1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [3.0, 4.0]]);
        assert!(continues(&curves, [0, 1], 2));
        assert!(!continues(&curves, [0, 0], 2));
        assert!(!continues(&curves, [0, 2], 3));
        // In a table of rows, each row may change another coordinate.
        curves.motion[1].key = "heave";
        assert!(continues(&curves, [2, 2], 3));
        assert!(!continues(&curves, [0, 2], 3));
    }
}
