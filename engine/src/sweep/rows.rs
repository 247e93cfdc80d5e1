//! Rows: the results of each design of a block.

use crate::car::{Car, FailedCases, NoEquilibrium};
use crate::curves::Status;
use crate::mechanism::{DesignFault, Failure, NoPose};
use crate::model::{Drive, Mechanism};

/// Rows of consecutive designs, in printed units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    /// Number of the first design.
    pub first: u64,
    /// For each design, the reason why a station was not solved, or why targets or constraints have no value. `None` if
    /// there is no such reason.
    pub failing: Vec<Option<Failing>>,
    /// Values of the variables, `[design][variable]`.
    pub variables: Vec<f64>,
    /// Outputs, `[design][output]`. NaN if there is no value.
    pub outputs: Vec<f64>,
}

/// Reason why a design was not solved at every station, or why its targets or constraints have no value.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Failing {
    /// Kind of failure: the word in the `status` column.
    pub status: String,
    /// Reason without numbers, so that equal reasons can be counted.
    pub reason: String,
    /// Number of stations at which the design has no pose.
    pub stations: u64,
    /// Drive value, in printed units, of the failed station nearest to the design position. For a car, the index of the first
    /// failed load case. `None` if the design cannot be solved at all, or if only targets or constraints have no value.
    pub at: Option<f64>,
}

impl Rows {
    /// Number of designs in the rows.
    pub fn designs(&self) -> usize {
        self.failing.len()
    }

    /// Values of the variables of a design. `place` is its index in the rows.
    pub fn variables(&self, place: usize) -> &[f64] {
        let width = self.variables.len() / self.designs();
        &self.variables[place * width..][..width]
    }

    /// Outputs of a design. `place` is its index in the rows.
    pub fn outputs(&self, place: usize) -> &[f64] {
        let width = self.outputs.len() / self.designs();
        &self.outputs[place * width..][..width]
    }
}

impl Failing {
    /// Describes a design that has no pose at some stations. `failure` and `at` describe the failed station nearest to the
    /// design position.
    pub(super) fn stations(failure: &NoPose, at: f64) -> Self {
        Failing {
            status: Status::Failed(*failure).word().to_owned(),
            reason: no_pose(failure),
            stations: 0,
            at: Some(at),
        }
    }

    /// Describes a car design that has no equilibrium in some cases. `case` is the name of the first failed case.
    pub(super) fn case(case: &str, failed: &FailedCases, car: &Car) -> Self {
        let reason = match &failed.why {
            NoEquilibrium::NoPose { axle, failure } => {
                format!(
                    "{} axle, {}",
                    crate::car::AXLE_NAMES[*axle],
                    no_pose(failure)
                )
            }
            why => why.describe(car),
        };
        Failing {
            status: failed.why.status().to_owned(),
            reason: format!("case {case}: {reason}"),
            stations: failed.count as u64,
            at: Some(failed.first as f64),
        }
    }

    /// Describes a design of an axle that does not reach a station of a target outside of `[motion]`.
    pub(super) fn beside(failure: &NoPose) -> Self {
        let own = Failing::stations(failure, 0.0);
        Failing {
            reason: format!("target of another motion: {}", own.reason),
            at: None,
            ..own
        }
    }

    /// Describes a design whose stations of the sweep are all solved, but whose targets or constraints have no value in the
    /// motion with this name. The reason has no numbers, so that equal reasons can be counted.
    pub(super) fn of_goals(motion: &str) -> Self {
        Failing {
            status: "unreachable".to_owned(),
            reason: format!(
                "{motion}: a target or a constraint has no value at one of its stations"
            ),
            stations: 0,
            at: None,
        }
    }

    /// Describes a car design whose load cases are all solved, but whose targets or constraints of a single axle have no values.
    pub(super) fn axle_alone(axle: &str) -> Self {
        Failing::of_goals(&format!("{axle} axle alone"))
    }

    /// Describes a design that cannot be solved at all, with the reason in words. All `stations` of the design fail.
    pub(super) fn of_design(reason: String, stations: usize) -> Self {
        Failing {
            status: "degenerate".to_owned(),
            reason,
            stations: stations as u64,
            at: None,
        }
    }

    /// Describes a design that cannot be solved at all. All `stations` of the design fail.
    pub(super) fn degenerate(fault: &DesignFault, mechanism: &Mechanism, stations: usize) -> Self {
        Failing::of_design(fault.describe(mechanism), stations)
    }
}

/// Returns the reason why a station has no pose. The reason names the wheel, but not the value at which the motion ends.
fn no_pose(failure: &NoPose) -> String {
    match failure {
        NoPose::Corner(failure) => reason(failure),
        NoPose::Wheel { side, failure, .. } => side.about(&reason(failure)),
        NoPose::RigidAxle { failure, .. } => reason(failure),
        NoPose::NoEquilibrium { .. } => "no equilibrium".to_owned(),
        failure => failure.to_string(),
    }
}

/// Returns the reason why a station has no pose, without the value at which the motion ends.
fn reason(failure: &Failure) -> String {
    match failure {
        Failure::Unreachable {
            drive: Drive::Travel,
            cause,
            ..
        } => format!("the wheel travel ends: {cause}"),
        Failure::Unreachable { cause, .. } => format!("the arm cannot turn further: {cause}"),
        Failure::RackUnreachable { cause, .. } => format!("the rack cannot move further: {cause}"),
        other => other.to_string(),
    }
}
