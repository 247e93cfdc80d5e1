//! Failed stations, gathered: neighbours that failed for one reason are one stretch.

use super::shortest;
use crate::curves::{Curves, Station, Status};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Neighbouring stations that failed for one reason.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stretch {
    /// Index of the first station.
    pub first: usize,
    /// Index of the last one.
    pub last: usize,
    /// The word in the `status` column.
    pub status: String,
    /// Why there is no pose.
    pub reason: String,
    /// Where on the motion they are, in words.
    pub place: String,
}

impl Stretch {
    /// The failed stretches of some curves, in the order of their stations.
    pub fn all(curves: &Curves) -> Vec<Stretch> {
        let mut stretches: Vec<Stretch> = Vec::new();
        for (index, station) in curves.stations.iter().enumerate() {
            let Status::Failed(failure) = station.status else {
                continue;
            };
            let reason = failure.to_string();
            match stretches.last_mut() {
                Some(s) if s.last + 1 == index && s.reason == reason => s.last = index,
                _ => stretches.push(Stretch {
                    first: index,
                    last: index,
                    status: station.status.word().to_owned(),
                    reason,
                    place: String::new(),
                }),
            }
        }
        for stretch in &mut stretches {
            let [first, last] = [stretch.first, stretch.last].map(|i| place(&curves.stations[i]));
            stretch.place = match stretch.last - stretch.first {
                0 => first,
                more => format!("{first} to {last} ({} stations)", more + 1),
            };
        }
        stretches
    }
}

impl fmt::Display for Stretch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.reason)
    }
}

/// A station in words.
fn place(station: &Station) -> String {
    let drive = match (station.angle, station.travel) {
        (Some(angle), _) => format!("drive at {} deg", shortest(angle)),
        (None, travel) => format!("travel {}", travel.map_or_else(String::new, shortest)),
    };
    match station.rack {
        0.0 => drive,
        rack => format!("{drive}, rack {}", shortest(rack)),
    }
}
