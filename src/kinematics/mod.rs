//! Position, rates and sensitivities of a mechanism, exactly.
//!
//! ```text
//! design --Solver--> pose --pose_series--> rates, curvature --Linearised--> sensitivities
//! ```
//!
//! [`path`](Solver) finds poses connected to the design position: by the closed form (`closed_form`) where
//! there is one and the pose is an ordinary one, else by following the closure equations step by step.
//! Derivatives always come from the [`Closure`]: its rows are written once, over any number.

mod accuracy;
mod assemblies;
mod batch;
mod certificate;
mod closed_form;
mod closure;
mod conditioning;
mod constraint;
mod continuation;
mod limits;
mod loads;
mod lu;
mod motion;
mod paper_theta;
mod path;
pub mod point_coordinates;
mod pose;
mod rates;
mod rocker;
mod sensitivity;
mod steering;
pub(crate) mod trial;
mod work;

pub use accuracy::PoseError;
pub use assemblies::{Assemblies, Assembly, Trait, Undecided};
pub use batch::{
    Batch, KnucklePoint, KnuckleVector, LaneAdjoint, LaneDesign, LaneMembers, LanePose, LaneRates,
    Visit,
};
pub use certificate::{Certificate, Certifier, Unproven};
pub use closure::{Closure, Driver};
pub use conditioning::{Conditioning, LEAST_DIGITS, rate_digits};
pub use constraint::raises_its_joint;
pub use limits::{Limit, LimitCause, Limits, Range, RangeEnd, RockerRange, Toggle};
pub use loads::{Balance, Load, Reaction, Reactions, Support};
pub use motion::{Lifted, MotionPoint};
pub use paper_theta::PaperTheta;
pub use path::{DesignFault, Failure, March, Solver};
pub use pose::{Pose, Posture, Twist, Wrench};
pub use rocker::{MovingAngle, MovingPoint, Toggles, has_leverage};
pub use sensitivity::{DesignedSpinAxis, Gradient, Linearised, Seeds};
pub(crate) use work::Tally;
pub use work::Work;

/// Whether poses of this mechanism come from a closed form; else from six equations.
pub fn has_closed_form(mechanism: &crate::model::Mechanism) -> bool {
    closed_form::Roles::of(mechanism).is_some()
}
