//! Rows: the results that are kept of each design of a block.

use crate::car::{FailedCases, NoEquilibrium};
use crate::curves::Status;
use crate::mechanism::{DesignFault, Failure, NoPose};
use crate::model::{Drive, Mechanism};

/// Rows of consecutive designs, in the units they are printed in.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    /// Number of the first design.
    pub first: u64,
    /// For each design, the reason why some station was not solved; `None` if all were solved.
    pub failing: Vec<Option<Failing>>,
    /// `[design][variable]`
    pub variables: Vec<f64>,
    /// `[design][output]`, NaN where there is no value.
    pub outputs: Vec<f64>,
}

/// Reason why a design was not solved at every station.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Failing {
    /// The word in the `status` column.
    pub status: String,
    /// The reason without numbers, so that equal reasons can be counted.
    pub reason: String,
    /// Number of stations without a pose.
    pub stations: u64,
    /// The drive value, as printed, of that one which is nearest to the design position. `None` if the design cannot be
    /// solved at all.
    pub at: Option<f64>,
}

impl Rows {
    /// Number of designs.
    pub fn designs(&self) -> usize {
        self.failing.len()
    }

    /// The variables of a design, by its index in the rows.
    pub fn variables(&self, place: usize) -> &[f64] {
        let width = self.variables.len() / self.designs();
        &self.variables[place * width..][..width]
    }

    /// The outputs of a design, by its index in the rows.
    pub fn outputs(&self, place: usize) -> &[f64] {
        let width = self.outputs.len() / self.designs();
        &self.outputs[place * width..][..width]
    }
}

impl Failing {
    /// Describes a design that has stations without a pose; `failure` and `at` are those of the station nearest to the
    /// design position.
    pub(super) fn stations(failure: &NoPose, at: f64) -> Self {
        Failing {
            status: Status::Failed(*failure).word().to_owned(),
            reason: no_pose(failure),
            stations: 0,
            at: Some(at),
        }
    }

    /// Describes a design of a car with cases that have no equilibrium; `case` is the name of the first of them.
    pub(super) fn case(case: &str, failed: &FailedCases) -> Self {
        let reason = match &failed.why {
            NoEquilibrium::NoPose { axle, failure } => {
                format!("{} axle, {}", ["front", "rear"][*axle], no_pose(failure))
            }
            why => why.to_string(),
        };
        Failing {
            status: failed.why.status().to_owned(),
            reason: format!("case {case}: {reason}"),
            stations: failed.count as u64,
            at: Some(failed.first as f64),
        }
    }

    /// Describes a design that cannot be solved at all, for a reason in words; all its `stations` fail.
    pub(super) fn of_design(reason: String, stations: usize) -> Self {
        Failing {
            status: "degenerate".to_owned(),
            reason,
            stations: stations as u64,
            at: None,
        }
    }

    /// Describes a design that cannot be solved at all; all its `stations` fail.
    pub(super) fn degenerate(fault: &DesignFault, mechanism: &Mechanism, stations: usize) -> Self {
        Failing::of_design(fault.describe(mechanism), stations)
    }
}

/// Reason why a station has no pose, with the wheel, without the value at which the mechanism folds.
fn no_pose(failure: &NoPose) -> String {
    match failure {
        NoPose::Corner(failure) => reason(failure),
        NoPose::Wheel { side, failure, .. } => side.about(&reason(failure)),
        NoPose::RigidAxle { failure, .. } => reason(failure),
        NoPose::NoEquilibrium { .. } => "no equilibrium".to_owned(),
        failure => failure.to_string(),
    }
}

/// Reason why a station has no pose, without the value at which the mechanism folds.
fn reason(failure: &Failure) -> String {
    match failure {
        Failure::Unreachable {
            drive: Drive::Travel,
            cause,
            ..
        } => format!("the wheel travel ends: {cause}"),
        Failure::Unreachable { cause, .. } => format!("the arm turns no further: {cause}"),
        Failure::RackUnreachable { cause, .. } => format!("the rack moves no further: {cause}"),
        other => other.to_string(),
    }
}
