//! Failed stations, gathered: neighbours that failed for one reason are one stretch.

use super::figure::as_written;
use crate::curves::{Curves, Station, Status};
use crate::model::Suspension;
use crate::study::Drive;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Neighbouring stations that failed for one reason.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FailureRange {
    /// Index of the first station.
    pub first: usize,
    /// Index of the last one.
    pub last: usize,
    /// The word in the `status` column.
    pub status: String,
    /// Reason why there is no pose.
    pub reason: String,
    /// Place on the motion, in words.
    pub place: String,
}

impl FailureRange {
    /// The failed stretches of some curves of a wheel, in the order of their stations.
    pub fn all(curves: &Curves, drive: Drive, wheel: &Suspension) -> Vec<FailureRange> {
        let stations = &curves.stations;
        let mut stretches: Vec<FailureRange> = Vec::new();
        for (index, station) in stations.iter().enumerate() {
            let Status::Failed(failure) = station.status else {
                continue;
            };
            let reason = failure.describe(wheel.length_unit, wheel.frame);
            let continues = |s: &&mut FailureRange| {
                let last = &stations[s.last];
                s.last + 1 == index && s.reason == reason && last.rack == station.rack
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
            stretch.place = place(&stations[stretch.first..=stretch.last], drive);
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

/// Neighbouring stations at one displacement of the rack, in words.
fn place(stations: &[Station], drive: Drive) -> String {
    let [first, last] = [&stations[0], &stations[stations.len() - 1]];
    let unit = if drive.is_angle() { " deg" } else { "" };
    let drive = drive.key().replace('_', " ");
    let value = |s: &Station| s.angle.or(s.travel).map_or_else(String::new, as_written);
    let mut text = match stations.len() {
        1 => format!("{drive} {}{unit}", value(first)),
        _ => format!("{drive} {} to {}{unit}", value(first), value(last)),
    };
    if first.rack != 0.0 {
        text += &format!(", rack {}", as_written(first.rack));
    }
    match stations.len() {
        1 => text,
        n => format!("{text} ({n} stations)"),
    }
}
