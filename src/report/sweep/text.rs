//! Finished blocks as text, made in the workers so that it is done on all threads.

use super::curves_csv::CurvesCsv;
use super::rows_csv;
use crate::study::Study;
use crate::sweep::{SweepPlan, SweepRecord, SweepStatistics, Worker};

/// Turns blocks into text.
pub struct SweepText {
    curves: Option<CurvesCsv>,
}

impl SweepText {
    /// The text of a sweep. Curves are written beside the designs, in a directory only.
    pub fn of(plan: &SweepPlan, study: &Study, in_directory: bool) -> Self {
        let curves = plan.record.curves && in_directory;
        SweepText {
            curves: curves.then(|| CurvesCsv::of(plan, study)),
        }
    }

    /// The first line of the curves, where there are any.
    pub(super) fn curves_header(&self) -> Option<&[u8]> {
        self.curves.as_ref().map(|csv| &csv.header[..])
    }

    /// Works on a block: its rows and curves as text, and its statistics.
    pub fn finish(&self, record: &SweepRecord, worker: &mut Worker<'_>, block: u64) -> Finished {
        let rows = worker.rows(block);
        let (statistics, first) = (SweepStatistics::of(record, rows), rows.first);
        let (mut designs, mut curves) = (Vec::new(), Vec::new());
        rows_csv::append(rows, &mut designs);
        if let Some(csv) = &self.curves {
            csv.append(first, worker.block(), &mut curves);
        }
        Finished {
            designs,
            curves,
            statistics,
        }
    }
}

/// What has become of a block.
pub struct Finished {
    /// Its rows, as they stand in the file.
    pub designs: Vec<u8>,
    /// Its curves, as they stand in the file.
    pub curves: Vec<u8>,
    /// Its statistics.
    pub statistics: SweepStatistics,
}
