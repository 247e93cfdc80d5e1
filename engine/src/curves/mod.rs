//! Curves: every output of a plan at every station of the motion, of one wheel or of an axle.

mod by_time;
mod column;
mod drive_law;
mod elastic;
mod elastic_loads;
mod frames;
mod influence;
mod loads;
mod paper_theta;
mod point_coordinates;
mod prover;
mod run;
pub mod thinned;

pub(crate) use by_time::ByTime;
pub use column::Column;
pub(crate) use column::{per, velocity_name};
pub use drive_law::DriveLaw;
pub(crate) use elastic_loads::MemberColumns;
pub use frames::{Frame, OtherWheel, Placement, Turn, frames, wheel_frames};
pub use influence::{Influence, influences};
pub(crate) use loads::Loads;
pub use paper_theta::PaperTheta;
pub(crate) use prover::Prover;
pub use run::curves;

use crate::ask::{NoValue, with_unit};
use crate::mechanism::{DesignFault, Failure, FormulationFailure, NoPose, Work};
use crate::model::{Axis, PointId, Rod, Side};
use crate::plan::Plan;
use crate::solve::Rejection;
use crate::study::WheelStudy;

/// Computes the curves of one wheel that a plan requests: from equilibria if there are elastic parts, otherwise from poses. An
/// error says why the design position cannot be solved.
pub fn wheel_curves(own: &WheelStudy, plan: &Plan) -> Result<Curves, DesignFault> {
    match &own.compliance {
        Some(elastic) => elastic::elastic_curves(&own.suspension, elastic, plan),
        None => curves(&own.suspension, plan),
    }
}

/// Status of a station: solved or not, and accuracy of its values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Status {
    /// Solved; every value that exists is present.
    Ok,
    /// Solved, but close to a singular pose: derivatives and sensitivities have fewer than six correct digits.
    IllConditioned,
    /// Solved, but no member supports the loads: the leverage of the spring is too small for six correct digits of the
    /// forces. With elastic parts: no equilibrium exists under a load. The forces of this load have no values.
    Unsupported,
    /// Solved, but a rod has reached its toggle at this station, or earlier on the way from the design position. The first element
    /// is the rod of the left (or only) wheel, the second the rod of the right wheel. Quantities that depend on the rocker of such
    /// a rod have no values.
    Toggle([Option<Rod>; 2]),
    /// Not solved, for this reason.
    Failed(NoPose),
}

impl Status {
    /// Status of a station that is solved, with every defined value.
    pub const WHOLE: [Status; 2] = [Status::Ok, Status::IllConditioned];

    /// Word in the `status` column.
    pub fn word(&self) -> &'static str {
        match self {
            Status::Ok => "ok",
            Status::IllConditioned => "ill_conditioned",
            Status::Unsupported => "unsupported",
            Status::Toggle(_) => "toggle",
            Status::Failed(NoPose::NoEquilibrium { .. } | NoPose::NoModel) => "no_equilibrium",
            Status::Failed(NoPose::Unstable) => "unstable",
            Status::Failed(NoPose::NoDerivatives) => "singular",
            Status::Failed(reason) => match reason.of_wheel() {
                None if reason.is_unproven() => "uncertified",
                None => "unreachable",
                Some(failure) => match failure {
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
            },
        }
    }

    /// Returns true if the station is solved and every defined value is present.
    pub fn is_whole(&self) -> bool {
        Self::WHOLE.contains(self)
    }
}

/// Coordinate of the motion. The study gives it, or it follows from the pose.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionColumn {
    /// Name without the unit, for example `travel`.
    pub key: &'static str,
    /// Unit, for example `mm`.
    pub unit: &'static str,
    /// True if the coordinate names a station: the study gives it. False if it follows from the pose, and for the time.
    pub is_given: bool,
    /// True if files have a column for the coordinate.
    pub is_written: bool,
}

impl MotionColumn {
    /// Makes a coordinate that the study gives and that has a column in files.
    pub(crate) fn given(key: &'static str, unit: &'static str) -> Self {
        MotionColumn {
            key,
            unit,
            is_given: true,
            is_written: true,
        }
    }

    /// Name of the coordinate's column in files.
    pub fn name(&self) -> String {
        with_unit(self.key, self.unit)
    }
}

/// A station with its values, in printed units.
#[derive(Clone, Debug, PartialEq)]
pub struct Station {
    /// Value of each column of [`Curves::motion`]. `None` if it depends on a pose that does not exist.
    pub at: Vec<Option<f64>>,
    /// Status of the station.
    pub status: Status,
    /// Value of each column of [`Curves::columns`], or the reason why it has no value.
    pub values: Vec<Result<f64, NoValue>>,
    /// Condition number of the equations. For an axle, the larger of the two wheels' condition numbers. A number below
    /// 1000 is accurate only within a factor of ten if the pose comes from the closed form. `None` if there is no pose.
    pub condition: Option<f64>,
    /// Certified bounds of the pose. `None` if the study does not request them, or if they were not found.
    pub proof: Option<Proof>,
}

impl Station {
    /// Value of a column. `None` if the value does not exist.
    pub fn value(&self, column: usize) -> Option<f64> {
        self.values.get(column)?.ok()
    }
}

/// Certified bounds for a station's pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Proof {
    /// Bound on the distance of any point of a wheel carrier from its exact position.
    pub position_error: f64,
    /// Smallest distance to any other pose. Any other pose differs by at least this length in a coordinate of a carrier's
    /// origin, in an entry of a rotation matrix or in the roll angle. These entries and the roll angle are multiplied by
    /// the mechanism's size.
    pub uniqueness: f64,
    /// All certified bounds, including `position_error` and `uniqueness`, in the order of [`Curves::bounds`].
    pub bounds: Vec<f64>,
}

/// Derivative of an output, or of an output's derivative, with respect to a hardpoint coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensitivity {
    /// Index of the station.
    pub station: usize,
    /// Index of the differentiated column.
    pub column: usize,
    /// Wheel whose hardpoint moves. `None` if there is only one wheel, or if both wheels move as mirror images.
    pub side: Option<Side>,
    /// Hardpoint with respect to which the column is differentiated.
    pub point: PointId,
    /// Coordinate of this hardpoint, in the study's axes.
    pub axis: Axis,
    /// Derivative, in the column's unit per length unit.
    pub value: f64,
}

/// Curves of a study: of one wheel, or of an axle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curves {
    /// Coordinates of the motion, in the order of [`Station::at`].
    pub motion: Vec<MotionColumn>,
    /// Columns, in the order of [`Station::values`].
    pub columns: Vec<Column>,
    /// Names of the certified bounds, in the order of [`Proof::bounds`]. Empty unless the study requests certification.
    pub bounds: Vec<String>,
    /// Stations of the motion, rack displacement by rack displacement. For each rack displacement they are in the order of
    /// the motion's values.
    pub stations: Vec<Station>,
    /// Sensitivities, station by station. Empty unless the study requests them.
    pub sensitivities: Vec<Sensitivity>,
    /// Counts of the work done. All zero for an axle, and for elastic parts.
    pub work: Work,
    /// Reasons why the slower continuation method solved stations instead of the tracker, each with the number of stations.
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

    /// Index of the motion's coordinate with this name (without unit). `None` if the motion does not have it.
    pub fn motion_index(&self, key: &str) -> Option<usize> {
        self.motion.iter().position(|column| column.key == key)
    }

    /// Values at each station of the motion's coordinate with this name (without unit). `None` if the coordinate follows from
    /// a pose that does not exist, or if the motion does not have it.
    pub fn along<'c>(&'c self, key: &str) -> impl Iterator<Item = Option<f64>> + 'c {
        let index = self.motion_index(key);
        self.stations.iter().map(move |station| station.at[index?])
    }

    /// Returns true if every station is solved with all its defined values, and every column has a value at some
    /// station.
    pub fn are_complete(&self) -> bool {
        self.are_whole() && (0..self.columns.len()).all(|column| self.has_value(column))
    }

    /// Returns true if every station is solved and every defined value is present.
    pub fn are_whole(&self) -> bool {
        self.stations.iter().all(|s| s.status.is_whole())
    }

    /// Returns true if a column has a value at some station.
    pub fn has_value(&self, column: usize) -> bool {
        self.stations.iter().any(|s| s.values[column].is_ok())
    }

    /// Numbers of empty cells for each column and reason, at stations with a pose and without a toggle. The count omits cells
    /// that are empty because of a missing support: the station's status reports a toggle or a missing support.
    pub fn empty_cells(&self) -> Vec<(usize, NoValue, usize)> {
        let mut counts: Vec<(usize, NoValue, usize)> = Vec::new();
        for column in 0..self.columns.len() {
            let has_pose = |s: &&Station| s.status.is_whole() || s.status == Status::Unsupported;
            let stations = self.stations.iter().filter(has_pose);
            let cells = stations.filter_map(|s| s.values[column].err());
            for reason in cells.filter(|reason| !reason.is_about_loads()) {
                match counts.iter_mut().find(|c| c.0 == column && c.1 == reason) {
                    Some(count) => count.2 += 1,
                    None => counts.push((column, reason, 1)),
                }
            }
        }
        counts
    }
}
