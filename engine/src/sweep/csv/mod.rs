//! Finished blocks as CSV, and rows read back. Written in the workers, so that it is done on all threads, while the sweep
//! runs: so it is here, where everything is optimised, and not beside the other files that a run leaves.

mod cells;
mod curves;
mod rows;

pub use cells::{append_number, append_text, append_whole};
pub use curves::CurvesCsv;
pub use rows::{RowsReader, append_candidate, append_rows, rows_header};
