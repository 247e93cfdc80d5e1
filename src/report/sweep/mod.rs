//! Files and results of a sweep.
//!
//! A sweep is divided into parts. A part has 1,024 blocks ([`crate::sweep::BLOCKS_OF_PART`]), 64 blocks in a sweep of cars, or 8
//! blocks in some sweeps of elastic designs. The directory of a sweep has these files:
//!
//! | file | content |
//! |---|---|
//! | `sweep.json` | [`SweepRecord`](crate::sweep::SweepRecord): columns, sampling of the designs, targets |
//! | `part-000000000.csv` | rows of a part |
//! | `part-000000000.json` | statistics of a part, and the lengths and checksums of its files |
//! | `curves-000000000.csv` | all curves of a part, with `curves = true` |
//! | `pareto.csv` | Pareto front, if there are several targets; from the statistics alone |
//! | `summary.json` | [`SweepSummary`], from the statistics alone |
//! | `shown_designs.json` | some designs with their curves ([`DrawnDesigns`]) |
//!
//! A sweep with one part calls the part's files `designs.csv`, `designs.json` and `curves.csv`. With `format = "parquet"`, files
//! of rows and curves end in `.parquet`. The bytes of a part do not depend on the process that computes it. A complete part is
//! never computed again.

mod checksum;
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

pub use directory::{Done, MergeError, SweepDirectory};
pub use drawn::DrawnDesigns;
pub use merge::Parts;
pub use part::{PartOutcome, PartRecord, write_part};
pub use run::SweepRun;
pub use shown::{Choice, ShownDesigns};
pub(super) use summary::OutputSummary;
pub use summary::{SweepSummary, pareto_csv};
pub use table_file::TableFile;
pub use text::{Finished, SweepText};

use crate::sweep::SweepRecord;

/// Header line of a sweep's rows.
pub fn rows_header(record: &SweepRecord) -> Vec<u8> {
    crate::sweep::csv::rows_header(record)
}
