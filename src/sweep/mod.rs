//! Sweeps: many designs, in blocks, on all cores.

mod evaluate;
mod in_order;
mod samples;
mod sequence;
mod stations;

pub use evaluate::{BLOCK, Block, Evaluator, FailedStation};
pub use in_order::in_order;
pub use samples::Samples;
pub use sequence::{latin_hypercube, sobol, uniform};
pub use stations::Stations;
