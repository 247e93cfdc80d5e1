//! Writes finished blocks as CSV, and reads rows back. The workers write while the sweep runs, on all threads. So this code
//! is in the engine, where everything is optimised, and not next to the code for other result files.

mod cells;
mod curves;
mod rows;

pub use cells::{append_number, append_text, append_whole};
pub use curves::CurvesCsv;
pub use rows::{RowsReader, append_candidate, append_rows, rows_header};
