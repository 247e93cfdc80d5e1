//! Tuning of hardpoints: the targets form a nonlinear least-squares problem with box bounds, solved from one or several
//! starts.
//!
//! [`tune()`] writes the targets of a study as an [`Objective`]. The solvers do not depend on suspensions. A [`LeastSquares`]
//! problem computes residuals, in multiples of the tolerance, and the exact Jacobian of the residuals in one pass. [`fit()`]
//! finds a minimum from one start, [`multistart()`] from several in parallel. [`Identifiability`] names the directions in
//! which the residuals do not change. This module is the only one that uses argmin.
//!
//! Steps are measured in fractions of the variables' ranges. The ranges define which moves are of equal size, so the result
//! does not depend on units. MINPACK scales by the column norms of the Jacobian instead. With that scale, variables with
//! little effect on the residuals make large moves. In a rank-deficient fit, these variables should not move.

mod active_set;
mod at_design;
mod axle;
mod bounded_least_squares;
mod bounds;
mod builds;
mod carried;
mod carried_triangle;
mod choices;
mod conflict;
mod constrained;
mod covariance;
mod elastic;
mod elastic_axle;
mod extremes;
mod fit;
mod fit_record;
mod fixed;
mod front;
mod holding;
mod identifiability;
mod lane_builds;
mod lane_parts;
mod lane_rows;
mod layout;
mod levenberg_marquardt;
mod local_model;
mod moved_wheel;
mod moves;
mod multistart;
mod nearest;
mod objective;
mod options;
mod pool;
mod problem;
mod profile;
mod profile_interval;
mod qr;
mod robust;
mod simulated_fits;
mod standard_errors;
mod starts;
mod station_reader;
mod stationarity;
mod student;
#[cfg(test)]
mod test_problems;
#[cfg(test)]
mod tests;
mod trade;
mod tune;
mod verdict;
mod yield_search;

pub use active_set::{ActiveSet, Held, Outcome, Rows};
pub(crate) use at_design::DesignAssessor;
pub use at_design::{Assessed, assessed, assessed_at, evaluated};
pub use bounded_least_squares::{ActiveBound, BoundedLeastSquares};
pub use bounds::{Bounds, EmptyRange};
pub use choices::{Choice, Front, front, price_list};
pub(crate) use conflict::{is_satisfied_from, smallest_conflict};
pub use constrained::{Assessment, Constrained, ConstrainedFit, Shape, constrained_fit};
pub use fit::{ConstraintState, Control, Fit, Iteration, ProgressCallback, Termination, fit};
pub use fit_record::ArgminState;
pub(crate) use fixed::{Without, starts_without_fixed};
pub use holding::HoldingBound;
pub(crate) use holding::Minimum;
pub use identifiability::{Direction, Identifiability};
pub use layout::{Deviation, Margin, RowLabel, TargetLayout, VIOLATED};
pub use levenberg_marquardt::LevenbergMarquardt;
pub use moves::{PointRate, moved_design, point_rates};
pub use multistart::{Multistart, Start, constrained_multistart, multistart, starting_point};
pub use objective::Objective;
pub use options::Options;
pub use problem::{Infeasible, LeastSquares, Linearisation};
pub use profile_interval::ConfidenceInterval;
pub use standard_errors::StandardErrors;
pub use tune::{Best, ConstraintOutcome, Fulfilment, Tuning, tune};
pub(crate) use verdict::{Limit, Residuals, unmoved_constraints};
pub use verdict::{Price, SlightEffect, Unmoved};
pub use yield_search::ExpectedYield;
