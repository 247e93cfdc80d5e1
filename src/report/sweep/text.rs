//! Converts finished blocks of a sweep's designs to text. The workers do this, so it runs on all threads.

use super::curve_places::curves_csv;
use crate::study::Study;
use crate::sweep::csv::{CurvesCsv, append_rows};
use crate::sweep::{SweepPlan, SweepRecord, SweepStatistics, SweptWorker};
use std::sync::{Mutex, PoisonError};

/// Formatter that converts finished blocks of designs to text.
pub struct SweepText {
    curves: Option<CurvesCsv>,
    /// Buffers whose rows have been written. They are used again for the next blocks, because requesting new memory takes longer
    /// than filling it.
    spare: Mutex<Vec<Vec<u8>>>,
}

impl SweepText {
    /// Makes the formatter of a sweep. Curves are written only if the output is a directory.
    pub fn of(plan: &SweepPlan, study: &Study, in_directory: bool) -> Self {
        let curves = plan.record.curves && in_directory;
        SweepText {
            curves: curves.then(|| curves_csv(plan, study)),
            spare: Mutex::default(),
        }
    }

    /// Makes the formatter of a sweep without curves.
    pub fn without_curves() -> Self {
        SweepText {
            curves: None,
            spare: Mutex::default(),
        }
    }

    /// Header line of the curves, if there are any.
    pub fn curves_header(&self) -> Option<&[u8]> {
        self.curves.as_ref().map(|csv| &csv.header[..])
    }

    /// Curves of a worker's last block, as text for the curves file. `first` is the number of its first design. Empty if the sweep
    /// writes no curves.
    pub fn curves(&self, worker: &SweptWorker<'_>, first: u64) -> Vec<u8> {
        let mut curves = Vec::new();
        if let (Some(csv), Some(block)) = (&self.curves, worker.block()) {
            csv.append(first, block, &mut curves);
        }
        curves
    }

    /// Completes a block: its rows and curves as text, and its statistics.
    pub fn finish(
        &self,
        record: &SweepRecord,
        worker: &mut SweptWorker<'_>,
        block: u64,
    ) -> Finished {
        let rows = worker.rows(block);
        let (mut statistics, first) = (SweepStatistics::of(record, rows), rows.first);
        let mut designs = self.empty();
        append_rows(rows, &mut designs);
        statistics.one_by_one = worker.one_by_one() as u64;
        Finished {
            designs,
            curves: self.curves(worker, first),
            statistics,
        }
    }

    /// Empty buffer for rows, with the memory of an earlier block if there is one.
    fn empty(&self) -> Vec<u8> {
        let mut spare = self.spare.lock().unwrap_or_else(PoisonError::into_inner);
        spare.pop().unwrap_or_default()
    }

    /// Takes back a buffer whose rows have been written.
    pub(super) fn give_back(&self, mut designs: Vec<u8>) {
        designs.clear();
        let mut spare = self.spare.lock().unwrap_or_else(PoisonError::into_inner);
        spare.push(designs);
    }
}

/// Results of a block of designs.
pub struct Finished {
    /// Rows of the designs, as text for the file with the rows.
    pub designs: Vec<u8>,
    /// Curves as text for the curves file.
    pub curves: Vec<u8>,
    /// Statistics of the block.
    pub statistics: SweepStatistics,
}
