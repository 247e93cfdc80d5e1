//! A sweep that is read from its directory, or computed again for its page.

use super::directory::SweepDirectory;
use super::drawn::DrawnDesigns;
use super::shown::{Choice, ShownDesigns};
use super::summary::SweepSummary;
use crate::report::finished::NotARun;
use crate::sweep::{SweepPlan, SweepRecord, SweepStatistics, Swept, in_order};
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::path::Path;

/// A sweep, or the complete parts of an unfinished sweep.
#[derive(Clone, Debug)]
pub struct SweepRun {
    /// Description of the sweep.
    pub record: SweepRecord,
    /// Summary of the sweep's results.
    pub summary: SweepSummary,
    /// Choice of the designs that the page shows.
    pub choice: Choice,
    /// Rows of the designs that the page shows.
    pub shown: ShownDesigns,
    /// Some designs with their curves and mechanism, if this sweep has stored any.
    pub drawn: Option<DrawnDesigns>,
    /// Names of the existing files. A star represents the numbers of parts.
    pub files: Vec<String>,
}

impl SweepRun {
    /// Computes the sweep of a plan without files. It solves all designs for the statistics. Then it solves them once more for
    /// the rows on the page. `drawn` computes the curves of some designs. `go_on` returns false to end the sweep early, and must
    /// then stay false. The result is then `None`.
    pub fn of<E>(
        plan: &SweepPlan<'_>,
        go_on: impl Fn() -> bool + Sync,
        drawn: impl FnOnce(&SweepSummary) -> Result<Option<DrawnDesigns>, E>,
    ) -> Result<Option<Self>, E> {
        let record = &plan.record;
        let all = || 0..record.blocks();
        let swept = Swept::Suspension(plan);
        let mut statistics = SweepStatistics::empty(record);
        let absorbed: Result<(), Infallible> = in_order(
            all(),
            || swept.worker(),
            |worker, block| {
                go_on().then(|| {
                    let mut found = SweepStatistics::of(record, worker.rows(block));
                    found.one_by_one = worker.one_by_one() as u64;
                    found
                })
            },
            |block| {
                statistics.absorb(record, &block);
                Ok(())
            },
        );
        let Ok(()) = absorbed;
        let summary = SweepSummary::of(record, &statistics);
        let choice = Choice::of(record, &summary);
        let mut shown = ShownDesigns::default();
        swept.run(all(), &go_on, |rows| {
            shown.take(rows, &choice);
            ControlFlow::Continue(())
        });
        if !go_on() {
            return Ok(None);
        }
        Ok(Some(SweepRun {
            drawn: drawn(&summary)?,
            record: record.clone(),
            summary,
            choice,
            shown,
            files: Vec::new(),
        }))
    }

    /// Reads a sweep's directory in constant memory. The results come from the statistics of the parts, and the shown designs
    /// from the rows. An error if no part is complete, or if the rows contradict the statistics.
    pub fn read(path: &Path) -> Result<Self, NotARun> {
        let directory = SweepDirectory::read(path)?;
        let record = directory.record.clone();
        let done = directory.done()?;
        if done.statistics.designs == 0 {
            let reason =
                "no part of the sweep is complete; `hardpoint sweep` with --resume continues it";
            return Err(NotARun::at(path, reason));
        }
        let summary = SweepSummary::of(&record, &done.statistics);
        let choice = Choice::of(&record, &summary);
        let mut shown = ShownDesigns::default();
        let is_complete = |part: &u64| done.missing.binary_search(part).is_err();
        for part in (0..record.parts()).filter(is_complete) {
            directory.each_block(part, |rows| shown.take(rows, &choice))?;
        }
        let misfit = record.misfit().map(|m| record.variables.len() + m);
        for best in &summary.best {
            let row = shown.row(best.design);
            let value = misfit.zip(row).and_then(|(m, row)| shown.columns[m][row]);
            if value != Some(best.misfit) {
                let reason = format!(
                    "design {} has a different misfit in the statistics of its part; run the \
                     sweep again",
                    best.design
                );
                return Err(NotARun::at(path, reason));
            }
        }
        let mut files = SweepDirectory::part_files(&record);
        for name in [
            "pareto.csv",
            "summary.json",
            "sweep.json",
            "shown_designs.json",
        ] {
            files.extend(path.join(name).is_file().then(|| name.to_owned()));
        }
        // Data from another version or another sweep are not shown.
        // Versions before 0.2.0 wrote `drawn.json`.
        let mut names = ["shown_designs.json", "drawn.json"].into_iter();
        let drawn = names.find_map(|name| std::fs::read(path.join(name)).ok());
        let drawn: Option<DrawnDesigns> = drawn.and_then(|text| serde_json::from_slice(&text).ok());
        let drawn = drawn.filter(|d| d.digest == record.digest && d.is_whole());
        Ok(SweepRun {
            drawn,
            record,
            summary,
            choice,
            shown,
            files,
        })
    }
}
