//! Sweeps: many designs, in blocks, on all cores.
//!
//! [`Samples`] give the design of each number, [`Evaluator`] solves a block of designs, a [`Worker`] keeps a row of each, and
//! [`in_order()`] does so on all threads. Each block is summed by itself, and the sums are added in the order of the blocks
//! ([`SweepStatistics`]). So results are the same to the bit for any number of threads, in one run, in shards or resumed.

mod aligned;
mod axle;
mod axle_lanes;
pub mod csv;
mod effects;
mod evaluate;
mod front;
mod gradients;
mod in_order;
mod lanes;
mod moments;
mod one_by_one;
mod or_null;
mod plan;
mod rate_slopes;
mod record;
mod rows;
mod samples;
mod sequence;
mod stations;
mod statistics;

pub(crate) use axle::AxleStations;
pub use effects::{Effect, Effects};
pub use evaluate::{BLOCK, Block, Evaluator, FailedStation};
pub use front::{Candidate, Front};
pub use gradients::{AngleTarget, Deviations, Gradients, Jacobians};
pub use in_order::in_order;
pub use lanes::NotInLanes;
pub(crate) use lanes::scatter;
pub use moments::{BinnedSums, LevelSums, Moments, SaltelliSums};
pub use plan::{NotBegun, SweepPlan, Worker};
pub use record::{
    BLOCKS_OF_PART, FORM, Kind, MoveRecord, OutputColumn, SweepRecord, TargetColumn, VariableRecord,
};
pub use rows::{Failing, Rows};
pub use samples::Samples;
pub use sequence::{latin_hypercube, sobol, uniform};
pub use stations::Stations;
pub(crate) use stations::place_of;
pub use statistics::{FailureCount, OutputRange, SweepStatistics};
