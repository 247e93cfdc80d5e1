//! Poses that are connected to the design position.
//!
//! The [`Solver`] follows a path from the design position to every station. A [`CornerTracker`] does the same for
//! several designs at a time, one in each SIMD lane of the processor.

pub(crate) mod cause;
pub(crate) mod closed_form;
mod conditioning;
pub(crate) mod continuation;
mod formulation;
mod path;
mod toggles;
mod tracker;

pub use conditioning::{Conditioning, LEAST_DIGITS, rate_digits};
pub(crate) use formulation::point_coordinates;
pub use formulation::{
    Drive, Formulation, FormulationMotion, FormulationPose, FormulationVisit, register_formulation,
};
pub(crate) use path::Station;
pub use path::{Solver, StationOrder};
pub use toggles::Toggles;
pub use tracker::{
    Acceptance, AdjointConstants, AdjointPose, AxleTracker, CornerTracker, GroundContact,
    KnucklePoint, KnuckleVector, LaneAdjoint, LaneDesign, LanePose, LaneRates, PairDrive,
    PairStations, Rejection, Tracked, Visit, VisitPair,
};
pub(crate) use tracker::{AlongTravel, SeriesDesign};

/// Returns true if poses of this mechanism come from a closed form; otherwise they come from six equations.
pub fn has_closed_form(mechanism: &crate::model::Mechanism) -> bool {
    closed_form::Roles::of(mechanism).is_some()
}
