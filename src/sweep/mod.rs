//! Sweeps: many designs, in blocks, on all cores.

mod evaluate;
mod stations;

pub use evaluate::{BLOCK, Block, Evaluator, FailedStation};
pub use stations::Stations;
