//! A sweep that is ready to run, for a suspension or a car.

use super::{CarSweepPlan, CarWorker, Rows, SweepPlan, SweepRecord, Worker, in_order};
use crate::evaluate::Block;
use std::ops::{ControlFlow, Range};

/// A sweep that is ready to run.
#[derive(Clone, Copy, Debug)]
pub enum Swept<'s> {
    /// Designs of one wheel or of an axle over a motion.
    Suspension(&'s SweepPlan<'s>),
    /// Designs of a car in load cases.
    Car(&'s CarSweepPlan<'s>),
}

impl<'s> Swept<'s> {
    /// Description of the results, as in `sweep.json`.
    pub fn record(self) -> &'s SweepRecord {
        match self {
            Swept::Suspension(plan) => &plan.record,
            Swept::Car(plan) => &plan.record,
        }
    }

    /// Makes a worker. Each CPU thread has one worker.
    pub fn worker(self) -> SweptWorker<'s> {
        match self {
            Swept::Suspension(plan) => {
                let worker = plan.worker();
                let worker = worker.expect("this design was accepted earlier in the run");
                SweptWorker::Suspension(Box::new(worker))
            }
            Swept::Car(plan) => SweptWorker::Car(plan.worker()),
        }
    }

    /// Solves blocks of the sweep on the CPU threads of the current rayon pool. Passes their rows to `take`, in order, while
    /// the sweep runs. Ends early if `go_on` or `take` requests a stop. All earlier rows have then been passed to `take`.
    pub fn run(
        self,
        blocks: Range<u64>,
        go_on: impl Fn() -> bool + Sync,
        mut take: impl FnMut(&Rows) -> ControlFlow<()> + Send,
    ) {
        // An early stop is not an error.
        let _: Result<(), ()> = in_order(
            blocks,
            || self.worker(),
            |worker, block| go_on().then(|| worker.rows(block).clone()),
            |rows: Rows| match take(&rows) {
                ControlFlow::Continue(()) => Ok(()),
                ControlFlow::Break(()) => Err(()),
            },
        );
    }
}

/// Worker that solves blocks of designs and writes their rows.
pub enum SweptWorker<'s> {
    /// Designs of one wheel or of an axle.
    Suspension(Box<Worker<'s>>),
    /// Designs of a car.
    Car(CarWorker<'s>),
}

impl SweptWorker<'_> {
    /// Computes the rows of a block of the sweep.
    pub fn rows(&mut self, block: u64) -> &Rows {
        match self {
            SweptWorker::Suspension(worker) => worker.rows(block),
            SweptWorker::Car(worker) => worker.rows(block),
        }
    }

    /// Number of designs of the last block that the worker solved singly, because the lanes could not solve them. 0 for a car,
    /// whose sweep has no such lanes.
    pub fn one_by_one(&self) -> usize {
        match self {
            SweptWorker::Suspension(worker) => worker.one_by_one().len(),
            SweptWorker::Car(_) => 0,
        }
    }

    /// Curves from which the latest rows were made, for a suspension.
    pub fn block(&self) -> Option<&Block> {
        match self {
            SweptWorker::Suspension(worker) => Some(worker.block()),
            SweptWorker::Car(_) => None,
        }
    }
}
