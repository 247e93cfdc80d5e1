//! Exact suspension kinematics with analytic derivatives, and the tuning of hardpoints: `hardpoint` without its command
//! line, files and pages.
//!
//! `hardpoint` re-exports what is public here, and its first page is the manual of both: conventions, examples, a map of
//! the rooms. A program that embeds the solver and wants no command line built beside it depends on this crate alone and
//! begins with `use hardpoint_engine as hardpoint`.

// Nothing here says anything: what is said, commands say.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]
#![warn(clippy::allow_attributes_without_reason, unreachable_pub)]

#[doc(hidden)]
pub mod analyse;
#[doc(hidden)]
pub mod attia;
#[doc(hidden)]
pub mod axle;
#[doc(hidden)]
pub mod bench;
#[doc(hidden)]
pub mod build;
#[doc(hidden)]
pub mod characteristics;
#[doc(hidden)]
pub mod curves;
#[doc(hidden)]
pub mod derive;
#[doc(hidden)]
pub mod evaluate;
mod front_door;
mod function;
mod linear;
#[doc(hidden)]
pub mod mechanism;
#[doc(hidden)]
pub mod model;
#[doc(hidden)]
pub mod number;
#[doc(hidden)]
pub mod optimise;
#[doc(hidden)]
pub mod plan;
#[doc(hidden)]
pub mod solve;
#[doc(hidden)]
pub mod study;
#[doc(hidden)]
pub mod sweep;
#[doc(hidden)]
pub mod threads;
#[doc(hidden)]
pub mod tolerance;

// Suspensions.
pub use mechanism::{BuildError, GeometryFault, HardpointFault, SuspensionBuilder};
pub use model::{
    Axis, AxlePosition, Frame, FrameConvention, Group, Hardpoint, LengthUnit, PointId, Side,
    Suspension, Topology, TorquePath, Vehicle,
};

// What is asked of them.
pub use characteristics::{Characteristic, Info, Measure, Need, Quantity, Unit};
pub use study::{
    Constraint, DesignTable, Designs, Drive, FileFormat, Formulation, Interpolation, Limit,
    Limited, Load, LoadPoint, Motion, Move, Optimise, Order, Outputs, Sampled, Sampling, Site,
    Study, StudyError, StudyErrors, Subject, Sweep, SweepVariable, Target, TimeLaw, Turn, Variable,
    Wanted,
};

// The answers.
pub use curves::{Column, Curves, Proof, Sensitivity, Station, Status};
pub use front_door::{Error, SuspensionPose, SweepControl};
pub use function::{DesignFunction, DesignStatus, DesignVariable, Evaluation, FunctionError};
pub use mechanism::{DesignFault, Failure, LimitCause, Unproven};
pub use optimise::{
    Best, ConstraintOutcome, Control, Deviation, Direction, Fulfilment, Identifiability,
    Infeasible, Iteration, Multistart, ProgressCallback, StandardError, StandardErrors, Start,
    Termination, Tuning,
};
pub use solve::Rejection;
pub use sweep::{Failing, Rows};

pub use nalgebra;
