//! Exact suspension kinematics with analytic derivatives, and the tuning of hardpoints: `hardpoint` without its command
//! line, files and pages.
//!
//! ```
//! use hardpoint_engine::{Characteristic, Motion, Order, Study, Suspension};
//!
//! let suspension = Suspension::builder("semi_trailing_arm")
//!     .hardpoint("arm_pivot_inner", [420.0, 240.0, 330.0])
//!     .hardpoint("arm_pivot_outer", [350.0, 610.0, 310.0])
//!     .hardpoint("wheel_centre", [0.0, 730.0, 300.0])
//!     .static_angles_deg(-1.0, 0.1)
//!     .build()?;
//! let jounce = suspension.pose_at(40.0, 0.0)?;
//! let camber = jounce.characteristic(Characteristic::Camber).expect("every wheel has a camber");
//! let study = Study::of(suspension)
//!     .over(Motion::travel(-40.0..=40.0, 17)?)
//!     .asking(&[Characteristic::Camber, Characteristic::Toe], Order::Velocity)?;
//! let curves = study.curves()?;
//! assert_eq!(curves.columns[1].name, "camber_d1_deg_per_mm");
//! assert!((curves.stations[16].values[0].unwrap() - camber).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | convention | meaning for inputs and outputs |
//! |---|---|
//! | axes | x forward, y left, z up (ISO 8855), a left wheel, unless [`SuspensionBuilder::frame`] and [`SuspensionBuilder::side`] say otherwise |
//! | travel | height of the wheel centre above its design position, jounce positive |
//! | rack | displacement along the suspension's +y |
//! | units | lengths in the suspension's unit ([`LengthUnit`], by default millimetres), angles in degrees, derivatives per length unit of travel; column names end with the unit |
//! | signs | camber is positive with the top of the wheel outboard, toe with its front inboard; [`Characteristic::info`] gives the other signs |
//! | kernel's frame | designs ([`Suspension::design`], [`Best::design`]), loads and fields of targets describe a left wheel in ISO 8855 axes, with angles in radians |
//!
//! [`Study::sweep`] and [`Study::tune`] have examples. [`DesignFunction`] gives exact Jacobians to your own optimiser.
//! `hardpoint` re-exports the public items of this crate, and its first page has a map of its modules. A program that
//! embeds the solver depends on this crate alone and begins with `use hardpoint_engine as hardpoint`. In the
//! repository, `docs/rust.md` is the manual of both crates. It also gives the settings of a development profile.

// The engine prints nothing. Only commands print.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]
#![warn(clippy::allow_attributes_without_reason, unreachable_pub)]

#[doc(hidden)]
pub mod analyse;
pub mod ask;
#[doc(hidden)]
pub mod assembly;
#[doc(hidden)]
pub mod axle;
#[doc(hidden)]
pub mod bench_hooks;
#[doc(hidden)]
pub mod car;
#[doc(hidden)]
pub mod characteristics;
#[doc(hidden)]
pub mod compliance;
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
pub mod side_effects;
#[doc(hidden)]
pub mod solve;
mod sorting;
#[doc(hidden)]
pub mod study;
#[doc(hidden)]
pub mod sweep;
#[doc(hidden)]
pub mod threads;
#[doc(hidden)]
pub mod tolerance;

// Suspensions and their parts.
pub use mechanism::{BuildError, GeometryFault, HardpointFault, SuspensionBuilder};
pub use model::{
    Axis, AxlePosition, Frame, FrameConvention, Group, Hardpoint, LengthUnit, PointId, Rod, Side,
    Suspension, Topology, TorquePath, VehicleFigures,
};
pub use number::Vector3;

// Requests.
pub use ask::{Info, Need, Unit};
pub use axle::Axle;
pub use characteristics::{Characteristic, Measure, Quantity};
pub use study::{
    AxleSite, AxleStudy, Constraint, DesignTable, Designs, Drive, FileFormat, Formulation,
    Interpolation, Limit, Limited, Load, LoadPoint, Motion, Move, Optimise, Order, Outputs,
    Sampled, Sampling, Scatter, Setup, Site, Study, StudyError, StudyErrors, Sweep, SweepVariable,
    Target, TargetKind, TargetQuantity, TimeLaw, Tolerance, Turn, Variable, Vehicle, Wanted,
    WheelStudy,
};

// Results.
pub use curves::{Column, Curves, Proof, Sensitivity, Station, Status};
pub use front_door::{Error, SuspensionPose, SweepControl};
pub use function::{DesignFunction, DesignStatus, DesignVariable, Evaluation, FunctionError};
pub use mechanism::{DesignFault, Failure, LimitCause, Unproven, Work};
pub use optimise::{
    Best, ConfidenceInterval, ConstraintOutcome, Control, Deviation, Direction, Fit, Fulfilment,
    Identifiability, Infeasible, Iteration, Multistart, Price, ProgressCallback, StandardErrors,
    Start, Termination, Tuning,
};
pub use side_effects::{PlaceCoordinate, SideEffect};
pub use solve::Rejection;
pub use sweep::{Failing, Rows};

pub use nalgebra;
