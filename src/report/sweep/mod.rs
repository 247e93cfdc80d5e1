//! The files of a sweep, and what it came to.
//!
//! A sweep's directory has `sweep.json` ([`SweepRecord`](crate::sweep::SweepRecord): what the columns are, how
//! designs were sampled, targets), the rows in `designs.csv`, the rows of the Pareto front in
//! `pareto.csv`, with `curves = true` every curve in `curves.csv`, and [`SweepSummary`] in `summary.json`:
//! all that a page of the sweep needs. With
//! `format = "parquet"` designs and curves end in `.parquet`.

mod curves_csv;
mod files;
mod merge;
#[cfg(feature = "parquet")]
mod parquet_file;
mod rows_csv;
mod run;
mod shown;
mod summary;
mod table_file;

pub use files::{Finished, NotThisSweep, Resumed, SweepFiles, SweepText};
pub use merge::{MergeError, Parts};
pub use run::SweepRun;
pub use shown::{Choice, ShownDesigns};
pub(super) use summary::OutputSummary;
pub use summary::{SweepSummary, pareto_csv};

use crate::report::WriteError;
use std::path::Path;

/// Says what could not be written where.
fn unwritten(path: &Path) -> impl FnOnce(std::io::Error) -> WriteError + '_ {
    move |source| WriteError {
        path: path.to_owned(),
        source,
    }
}
