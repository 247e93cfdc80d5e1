//! Labels of stations: their place on the motion.

use super::figure::as_written;
use super::table::Cell;
use crate::curves::Station;
use crate::study::Drive;
use serde::{Deserialize, Serialize};
use std::fmt;

/// The drive and the rack at a station.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct StationLabel {
    travel: Option<f64>,
    arm_angle_deg: Option<f64>,
    theta_deg: Option<f64>,
    rack: f64,
}

impl StationLabel {
    /// Travel, arm angle, theta and rack, as cells of a table.
    pub(super) fn cells(&self) -> [Cell; 4] {
        let rack = Some(self.rack);
        [self.travel, self.arm_angle_deg, self.theta_deg, rack].map(Cell::from)
    }

    /// Label of a station of a motion with this drive.
    pub(super) fn of(station: &Station, drive: Drive) -> Self {
        let angle_of = |this: Drive| station.angle.filter(|_| drive == this);
        StationLabel {
            travel: station.travel,
            arm_angle_deg: angle_of(Drive::ArmAngle),
            theta_deg: angle_of(Drive::PaperTheta),
            rack: station.rack,
        }
    }
}

impl fmt::Display for StationLabel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.arm_angle_deg, self.theta_deg, self.travel) {
            (Some(angle), _, _) => write!(f, "arm angle {} deg", as_written(angle))?,
            (None, Some(theta), _) => write!(f, "theta {} deg", as_written(theta))?,
            (None, None, Some(travel)) => write!(f, "travel {}", as_written(travel))?,
            (None, None, None) => f.write_str("unknown travel")?,
        }
        match self.rack {
            0.0 => Ok(()),
            rack => write!(f, ", rack {}", as_written(rack)),
        }
    }
}
