//! Curves: every output of a plan at every station of the motion.

mod column;
mod drive_law;
mod frames;
mod influence;
mod loads;
mod paper_theta;
mod point_coordinates;
mod prover;
mod run;
pub mod thinned;

pub use column::Column;
pub(crate) use column::per;
pub use drive_law::DriveLaw;
pub use frames::{Frame, OtherWheel, Placement, Turn, frames};
pub use influence::{Influence, influences};
pub(crate) use loads::Loads;
pub use paper_theta::PaperTheta;
pub(crate) use prover::Prover;
pub use run::curves;

use crate::mechanism::{Failure, FormulationFailure, Work};
use crate::model::{Axis, PointId, Rod};
use crate::solve::Rejection;

/// Status of a station: solved or not, and the quality of its values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Status {
    /// Solved; every value that exists is present.
    Ok,
    /// Solved, but close to a singular pose: derivatives and sensitivities have fewer than six correct digits.
    IllConditioned,
    /// Solved, but nothing supports the loads: the spring has too little leverage for six correct digits of the forces. The
    /// forces have no values.
    Unsupported,
    /// Solved, but this rod is at a toggle here or nearer to the design position. Quantities that move with its rocker have no
    /// values.
    Toggle(Rod),
    /// Not solved, for this reason.
    Failed(Failure),
}

impl Status {
    /// The word in the `status` column.
    pub fn word(&self) -> &'static str {
        match self {
            Status::Ok => "ok",
            Status::IllConditioned => "ill_conditioned",
            Status::Unsupported => "unsupported",
            Status::Toggle(_) => "toggle",
            Status::Failed(failure) => match failure {
                Failure::Unreachable { .. }
                | Failure::RackUnreachable { .. }
                | Failure::DeadCentre => "unreachable",
                Failure::Singular => "singular",
                Failure::Toggle(_) => "toggle",
                Failure::Uncertified(_) => "uncertified",
                Failure::PointCoordinates(failure) => match failure {
                    FormulationFailure::DriveEnds { .. }
                    | FormulationFailure::ThetaEnds { .. }
                    | FormulationFailure::RackEnds { .. } => "unreachable",
                    FormulationFailure::Singular { .. } | FormulationFailure::NotFinite => {
                        "singular"
                    }
                },
            },
        }
    }
}

/// A station with its values, in the units they are printed in.
#[derive(Clone, Debug, PartialEq)]
pub struct Station {
    /// Wheel travel; `None` where another drive has no pose.
    pub travel: Option<f64>,
    /// The drive's angle in degrees, where an angle drives.
    pub angle: Option<f64>,
    /// Rack displacement, in the study's axes.
    pub rack: f64,
    /// Time, where the drive is a function of it.
    pub time: Option<f64>,
    /// Status of the station.
    pub status: Status,
    /// A value for each column; `None` if it does not exist.
    pub values: Vec<Option<f64>>,
    /// Condition number of the equations; to within a factor of ten where the closed form gave the pose
    /// and the number is below 1000. `None` where there is no pose.
    pub condition: Option<f64>,
    /// Proof of the pose, if the study requests it and it exists.
    pub proof: Option<Proof>,
}

/// Bounds proved for a station's pose, as lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proof {
    /// No point of the wheel carrier is further than this from its exact position.
    pub position_error: f64,
    /// Least difference of any other pose: in a coordinate of its origin or, at the mechanism's size, in an entry of its
    /// rotation.
    pub uniqueness: f64,
}

/// The derivative of an output, or of its derivative, by a hardpoint coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensitivity {
    /// Index of the station.
    pub station: usize,
    /// Index of the differentiated column.
    pub column: usize,
    /// The hardpoint.
    pub point: PointId,
    /// The coordinate, in the study's axes.
    pub axis: Axis,
    /// The derivative, in the column's unit per length unit.
    pub value: f64,
}

/// Curves of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// The columns, in the order of [`Station::values`].
    pub columns: Vec<Column>,
    /// Stations of the motion: rack displacement by rack displacement, for each in the order of the drive values.
    pub stations: Vec<Station>,
    /// Sensitivities, station by station; empty unless the study requests them.
    pub sensitivities: Vec<Sensitivity>,
    /// Counts of the work done.
    pub work: Work,
    /// Reasons for which the tracker left stations to the continuation, each with its count.
    pub left_to_continuation: Vec<(Rejection, usize)>,
}

impl Curves {
    /// Number of stations without a pose.
    pub fn failed(&self) -> usize {
        self.stations
            .iter()
            .filter(|s| matches!(s.status, Status::Failed(_)))
            .count()
    }

    /// Returns true if every requested value exists at every station. A quantity may be undefined at some stations, but not at
    /// all of them.
    pub fn are_complete(&self) -> bool {
        let lacks = |s: &Station| {
            let status = &s.status;
            matches!(
                status,
                Status::Failed(_) | Status::Unsupported | Status::Toggle(_)
            )
        };
        let is_empty = |column: usize| self.stations.iter().all(|s| s.values[column].is_none());
        !self.stations.iter().any(lacks) && !(0..self.columns.len()).any(is_empty)
    }
}
