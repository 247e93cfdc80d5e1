//! The mechanism in a pose: positions of its bodies, the equations between them, and reasons for missing poses.
//!
//! A [`Configuration`] is a design, a pose of the wheel carrier and a rack displacement. A configuration gives the
//! positions of points, rods and rockers. The [`Closure`] is the list of constraint equations that a pose must satisfy.
//! Each kind of constraint has a separate file. The code contains each equation once, for any number type.

mod arm;
mod builder;
mod closure;
pub(crate) mod constraint;
mod failure;
mod ground;
mod no_pose;
pub(crate) mod pose;
mod rocker;
mod rod_reach;
mod rod_tension;
mod tolerances;
mod validation;
mod work;

pub use builder::{BuildError, SuspensionBuilder};
pub(crate) use closure::RowSet;
pub use closure::{Closure, Driver};
pub use constraint::raises_its_joint;
pub use failure::{
    DesignFault, Failure, FormulationFailure, LimitCause, PartMeasure, Toggle, Unproven,
};
pub use ground::Ground;
pub use no_pose::NoPose;
pub use pose::{Configuration, Pose, Twist, Wrench};
pub use rocker::{BodyPlace, MovingAngle, MovingBody, MovingPoint, has_leverage};
pub(crate) use rocker::{Turn, is_effective};
pub use rod_reach::RodReach;
pub(crate) use tolerances::{DEGENERATE, GOOD_PREDICTION, ROUNDING};
pub use validation::{GeometryFault, HardpointFault};
pub use work::{Work, WorkCounter};
