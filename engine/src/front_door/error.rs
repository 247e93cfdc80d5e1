//! Errors of the interface for Rust programs.

use crate::characteristics::Characteristic;
use crate::mechanism::DesignFault;
use crate::model::Suspension;
use crate::study::StudyErrors;
use crate::sweep::NotBegun;
use thiserror::Error;

/// Reason why there is no answer.
#[derive(Clone, Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// No point of the suspension has this name.
    #[error("there is no point {name:?} in a {topology} suspension; there are {known}")]
    UnknownPoint {
        /// The name.
        name: String,
        /// The topology.
        topology: &'static str,
        /// The names there are.
        known: String,
    },
    /// The suspension lacks something that a characteristic needs.
    #[error("{characteristic} needs {need}, which the suspension does not have")]
    Lacking {
        /// The characteristic's name.
        characteristic: &'static str,
        /// The figure or part that it needs.
        need: &'static str,
    },
    /// A figure is not a finite number, or out of its range.
    #[error("{what} is {value}; expected {expected}")]
    Number {
        /// The figure.
        what: String,
        /// Value of the figure.
        value: f64,
        /// The expected values, in words.
        expected: &'static str,
    },
    /// The study does not request this.
    #[error("the study has {0}")]
    NotAsked(&'static str),
    /// A list is empty.
    #[error("no {0} is given; expected at least one")]
    Empty(&'static str),
    /// The study is of an axle, and the called function is for one wheel.
    #[error("the study is of an axle: {0}")]
    Axle(&'static str),
    /// A variable of a sweep moves no coordinate.
    #[error(
        "{0} moves no coordinate: a sweep takes variables that move coordinates, and not turns"
    )]
    MovesNothing(String),
    /// The design itself cannot be solved.
    #[error("{0}")]
    Design(String),
    /// The wheel cannot be there.
    #[error("no pose at travel {travel} {unit}, rack {rack} {unit}: {reason}")]
    NoPose {
        /// Wheel travel.
        travel: f64,
        /// Rack displacement, in the suspension's axes.
        rack: f64,
        /// Unit of both, and of lengths in the reason.
        unit: &'static str,
        /// Reason.
        reason: String,
    },
    /// A file that the study names is wrong.
    #[error("{0}")]
    File(StudyErrors),
    /// Two columns of a sweep's rows would have this name.
    #[error("two columns would be named {0}; give a variable another name")]
    TwoColumns(String),
    /// The threads could not be started.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// Number of threads.
        threads: usize,
        /// Reason.
        reason: String,
    },
}

impl Error {
    /// A design that cannot be solved, in words with the names of its points.
    pub(super) fn design(suspension: &Suspension, fault: &DesignFault) -> Self {
        Error::Design(fault.describe(&suspension.mechanism))
    }

    pub(super) fn not_begun(suspension: &Suspension, reason: NotBegun) -> Self {
        match reason {
            NotBegun::Designs(errors) => Error::File(errors),
            NotBegun::Fault(fault) => Error::design(suspension, &fault),
            NotBegun::TwoColumns(name) => Error::TwoColumns(name),
        }
    }

    /// Errors if the suspension lacks something that a characteristic needs.
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

/// The figure, if it is finite.
pub(super) fn finite(what: &str, value: f64) -> Result<f64, Error> {
    checked(what, value, "a finite number", f64::is_finite)
}

/// Returns the figure if it is in the expected range.
pub(super) fn checked(
    what: &str,
    value: f64,
    expected: &'static str,
    is_right: impl Fn(f64) -> bool,
) -> Result<f64, Error> {
    match is_right(value) {
        true => Ok(value),
        false => Err(Error::Number {
            what: what.to_owned(),
            value,
            expected,
        }),
    }
}
