//! Writes finished blocks as CSV, and reads rows back. The workers write on all CPU threads while the sweep runs. So this
//! code is in the engine, which is compiled with full optimisation, and not with the code for other result files.

mod cells;
mod curves;
mod rows;

pub use cells::{append_number, append_text, append_whole};
pub use curves::CurvesCsv;
pub use rows::{RowsReader, append_candidate, append_rows, rows_header};
