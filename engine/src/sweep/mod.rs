//! Sweeps: evaluation of many designs, in blocks, on all cores.
//!
//! [`Samples`] returns the design that has a given number. An [`Evaluator`](crate::evaluate::Evaluator) solves a block of
//! designs. A [`Worker`] makes a row for each design, and [`in_order()`] runs workers on all CPU threads. Each block has
//! separate sums, which are added in the order of the blocks ([`SweepStatistics`]). So results have the same bits for any
//! number of CPU threads, whether the sweep runs at once, in shards, or is resumed.

mod car;
pub mod csv;
mod effects;
mod front;
mod in_order;
mod margins;
mod moments;
mod or_null;
mod plan;
mod record;
mod rows;
mod samples;
mod sequence;
mod statistics;
mod swept;

pub use car::{CarNotBegun, CarSweepPlan, CarWorker};
pub use effects::{Effect, Effects};
pub use front::{Candidate, Front};
pub use in_order::in_order;
pub use moments::{BinnedSums, LevelSums, Moments, SaltelliSums};
pub use plan::{NotBegun, SweepPlan, Worker};
pub use record::{
    BLOCKS_OF_PART, ColumnFault, FORM, Kind, MoveRecord, OutputColumn, SweepRecord, TargetColumn,
    VariableRecord,
};
pub use rows::{Failing, Rows};
pub use samples::Samples;
pub use sequence::{latin_hypercube, sobol, uniform};
pub use statistics::{FailureCount, KEPT, OutputRange, SweepStatistics};
pub use swept::{Swept, SweptWorker};

/// SHA-256 digest of a text, in hexadecimal digits.
fn digest_of(text: &str) -> String {
    let digest = hmac_sha256::Hash::hash(text.as_bytes());
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
