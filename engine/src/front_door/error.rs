//! Errors of the interface for Rust programs.

use crate::characteristics::Characteristic;
use crate::mechanism::DesignFault;
use crate::model::Suspension;
use crate::study::StudyErrors;
use crate::sweep::{ColumnFault, NotBegun};
use thiserror::Error;

/// Error of the interface for Rust programs.
#[derive(Clone, Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// No point of the suspension has this name.
    #[error("there is no point {name:?} in a {topology} suspension; there are {known}")]
    UnknownPoint {
        /// Name that no point has.
        name: String,
        /// Name of the suspension's topology.
        topology: &'static str,
        /// Names of the existing points.
        known: String,
    },
    /// The suspension lacks an input or a part that a characteristic needs.
    #[error("{characteristic} needs {need}, which the suspension does not have")]
    Lacking {
        /// Name of the characteristic that needs it.
        characteristic: &'static str,
        /// Missing input or part.
        need: &'static str,
    },
    /// A number is not finite, or out of its range.
    #[error("{what} is {value}; expected {expected}")]
    Number {
        /// Name of the number.
        what: String,
        /// Value of the number.
        value: f64,
        /// Expected values, in words.
        expected: &'static str,
    },
    /// The study does not request this result. The text names the missing request.
    #[error("the study has {0}")]
    NotAsked(&'static str),
    /// A list is empty. The text names the missing item.
    #[error("no {0} is given; expected at least one")]
    Empty(&'static str),
    /// The study describes an axle, and the called function is for one wheel.
    #[error("the study describes an axle: {0}")]
    Axle(&'static str),
    /// A variable of a sweep moves no coordinate.
    #[error(
        "{0} moves no coordinate: a sweep accepts variables that move coordinates, but no rotations"
    )]
    MovesNothing(String),
    /// The design itself cannot be solved.
    #[error("{0}")]
    Design(String),
    /// The wheel has no pose at this travel and rack displacement.
    #[error("no pose at travel {travel} {unit}, rack {rack} {unit}: {reason}")]
    NoPose {
        /// Wheel travel at which the wheel has no pose.
        travel: f64,
        /// Rack displacement, in the suspension's axes.
        rack: f64,
        /// Unit of travel and rack displacement, and of lengths in the reason.
        unit: &'static str,
        /// Reason why the wheel has no pose, in words.
        reason: String,
    },
    /// A file that the study names has an error.
    #[error("{0}")]
    File(StudyErrors),
    /// The columns of a sweep's rows cannot be written.
    #[error("{0}")]
    Columns(ColumnFault),
    /// The system could not start the CPU threads.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// Requested number of CPU threads.
        threads: usize,
        /// Reason why the threads could not start, in words.
        reason: String,
    },
}

impl Error {
    /// Converts the fault of a design into an error, with the names of its points.
    pub(super) fn design(suspension: &Suspension, fault: &DesignFault) -> Self {
        Error::Design(fault.describe(&suspension.mechanism))
    }

    pub(super) fn not_begun(suspension: &Suspension, reason: NotBegun) -> Self {
        match reason {
            NotBegun::Designs(errors) => Error::File(errors),
            NotBegun::Fault(fault) => Error::design(suspension, &fault),
            NotBegun::Columns(fault) => Error::Columns(fault),
        }
    }

    /// Returns an error if the suspension lacks an input or part that a characteristic needs.
    pub(super) fn if_lacking(
        suspension: &Suspension,
        characteristic: Characteristic,
    ) -> Result<(), Self> {
        let info = characteristic.info();
        match info.needs.iter().find(|need| !need.met_by(suspension)) {
            None => Ok(()),
            Some(need) => Err(Error::Lacking {
                characteristic: info.name,
                need: need.words(),
            }),
        }
    }
}

/// Returns the number if it is finite.
pub(super) fn finite(what: &str, value: f64) -> Result<f64, Error> {
    checked(what, value, "a finite number", f64::is_finite)
}

/// Returns the number if it is in the expected range.
pub(super) fn checked(
    what: &str,
    value: f64,
    expected: &'static str,
    is_right: impl Fn(f64) -> bool,
) -> Result<f64, Error> {
    if is_right(value) {
        Ok(value)
    } else {
        Err(Error::Number {
            what: what.to_owned(),
            value,
            expected,
        })
    }
}
