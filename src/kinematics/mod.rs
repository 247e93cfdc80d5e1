//! Position, rates and sensitivities of a mechanism, exactly.
//!
//! ```text
//! design --Solver--> pose --pose_series--> rates, curvature --Linearised--> sensitivities
//! ```
//!
//! [`path`](Solver) finds poses connected to the design position: by the closed form of [`strut`] where
//! there is one and the pose is an ordinary one, else by following the closure equations step by step.
//! Derivatives always come from the [`Closure`]: its rows are written once, over any number.

mod closure;
mod lu;
mod motion;
mod paper_theta;
mod path;
pub mod point_coordinates;
mod pose;
mod rates;
mod sensitivity;
mod strut;

pub use closure::{Closure, Driver};
pub use motion::{Lifted, MotionPoint};
pub use paper_theta::PaperTheta;
pub use path::{DesignFault, Failure, March, Solver};
pub use pose::{Pose, Posture};
pub use sensitivity::{Linearised, Seeds};
