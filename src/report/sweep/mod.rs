//! The files of a sweep, and its results.
//!
//! A sweep is divided into parts of 1,024 blocks ([`crate::sweep::BLOCKS_OF_PART`]). Its directory has `sweep.json`
//! ([`SweepRecord`](crate::sweep::SweepRecord): what the columns are, how designs were sampled, targets), for each
//! part its rows in `part-000000000.csv`, its statistics in `part-000000000.json` and with `curves = true` every
//! curve in `curves-000000000.csv`, and from the statistics alone `pareto.csv` and [`SweepSummary`] in
//! `summary.json`, and in `drawn.json` some designs with their curves ([`DrawnDesigns`]). A sweep of one part calls these `designs.csv`, `designs.json` and `curves.csv`. With
//! `format = "parquet"` rows and curves end in `.parquet`. The parts are the result: whoever does one, its bytes
//! are the same, and one that is whole is not done again.

mod curve_places;
mod directory;
mod drawn;
mod merge;
#[cfg(feature = "parquet")]
mod parquet_file;
mod part;
mod run;
mod shown;
mod summary;
mod table_file;
mod text;

pub use directory::{Done, SweepDirectory};
pub use drawn::DrawnDesigns;
pub use merge::{MergeError, Parts};
pub use part::{PartOutcome, PartRecord, write_part};
pub use run::SweepRun;
pub use shown::{Choice, ShownDesigns};
pub(super) use summary::OutputSummary;
pub use summary::{SweepSummary, pareto_csv};
pub use table_file::TableFile;
pub use text::{Finished, SweepText};

use crate::sweep::SweepRecord;

/// The first line of a sweep's rows.
pub fn rows_header(record: &SweepRecord) -> Vec<u8> {
    crate::sweep::csv::rows_header(record)
}
