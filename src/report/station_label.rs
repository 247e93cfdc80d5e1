//! Labels of stations: their position on the motion.

use super::figure::as_written;
use super::table::Cell;
use crate::curves::{Curves, MotionColumn};
use crate::study::Drive;
use serde::{Deserialize, Serialize};

/// Position of a station on the motion: numbers for a study of one wheel, words for an axle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub(super) enum StationLabel {
    /// A station in a study of one wheel: travel and rack in the study's length unit. An angle is `None` unless it drives the
    /// motion. `travel` is `None` if an angle drives the motion and the station has no pose.
    Corner {
        travel: Option<f64>,
        arm_angle_deg: Option<f64>,
        theta_deg: Option<f64>,
        rack: f64,
    },
    /// A station of an axle.
    Axle(String),
}

impl StationLabel {
    /// Label of the station with this index.
    pub(super) fn of(curves: &Curves, station: usize) -> Self {
        let number = |key: &str| curves.stations[station].at[curves.motion_index(key)?];
        match curves.motion_index(Drive::Travel.key()) {
            Some(_) => StationLabel::Corner {
                travel: number(Drive::Travel.key()),
                arm_angle_deg: number(Drive::ArmAngle.key()),
                theta_deg: number(Drive::PaperTheta.key()),
                rack: number("rack").unwrap_or(0.0),
            },
            None => StationLabel::Axle(place_in_words(curves, station)),
        }
    }

    /// True if the label belongs to a study of one wheel.
    pub(super) fn is_of_corner(&self) -> bool {
        matches!(self, StationLabel::Corner { .. })
    }

    /// Travel, arm angle, theta and rack displacement of a station in a study of one wheel, as table cells. `None` for an axle.
    pub(super) fn cells(&self) -> Option<[Cell; 4]> {
        match *self {
            StationLabel::Corner {
                travel,
                arm_angle_deg,
                theta_deg,
                rack,
            } => Some([travel, arm_angle_deg, theta_deg, Some(rack)].map(Cell::from)),
            StationLabel::Axle(_) => None,
        }
    }
}

/// Coordinates that the study gives for a station, in words, as in `roll 2 deg, heave 0 mm`. A rack at 0 is left out.
pub(super) fn place_in_words(curves: &Curves, station: usize) -> String {
    let at = &curves.stations[station].at;
    let part = |(column, value): (&MotionColumn, &Option<f64>)| {
        let value =
            value.filter(|value| column.is_given && (column.key != "rack" || *value != 0.0));
        let key = column.key.replace('_', " ");
        Some(format!("{key} {} {}", as_written(value?), column.unit))
    };
    let parts: Vec<String> = curves.motion.iter().zip(at).filter_map(part).collect();
    parts.join(", ")
}
