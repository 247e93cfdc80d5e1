//! Results as files and tables.

mod files;
mod run_directory;
mod solve_summary;
mod table;
mod tuning_summary;

pub use files::{curves_csv, history_csv, sensitivities_csv};
pub use run_directory::{RunDirectory, WriteError};
pub use solve_summary::SolveSummary;
pub use table::{Format, Table};
pub use tuning_summary::TuningSummary;

/// A number as results write it: the shortest decimal that reads back to the same bits, and no
/// negative zero.
pub fn shortest(value: f64) -> String {
    format!("{:?}", value + 0.0)
}
