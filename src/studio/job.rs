//! A tuning that runs in the background.

use super::message::{JobState, Proposal, SideEffectRows, TuneRequest, YieldRows};
use super::overview::coordinates;
use super::rates::rate_edits;
use super::study_file::Opened;
use crate::model::Suspension;
use crate::number::Vector3;
use crate::optimise::{Control, Iteration, tune};
use crate::report::{TuningSummary, brief};
use crate::side_effects::side_effects;
use crate::study::{Study, Variable};
use crate::yields::{not_increased, yields};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Message that refuses to tune a study without `[optimise]`.
pub(super) const NO_SECTION: &str =
    "the study has no [optimise] section with variables and targets";
/// Message that refuses to tune a design in which every coordinate is locked.
pub(super) const ALL_LOCKED: &str =
    "every variable of the study moves a locked point: unlock a point, or add a variable";

/// Message for a tuning that has panicked.
fn panicked(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    format!(
        "the tuning failed because of an error in the program ({}); the study is unchanged, \
         please report it",
        text.unwrap_or("no message")
    )
}

/// Converts a range relative to the design in the file to a range relative to the present design. The page has moved the points
/// of the variable by `moved` units of the variable, one number for each point. The result always contains 0, the present position.
/// If the points have moved by different amounts, the range stays as it is and becomes relative to their present positions. The
/// second value is a note if the tuning may therefore go beyond the range in the file.
pub(super) fn counted_from_file(
    name: &str,
    [low, high]: [f64; 2],
    moved: &[f64],
) -> ([f64; 2], Option<String>) {
    let Some(first) = moved.first().copied() else {
        return ([low, high], None);
    };
    let is_together = |by: &f64| (by - first).abs() <= 1e-9 * (high - low);
    if !moved.iter().all(is_together) {
        let remark = format!(
            "{name}: its points were moved by different amounts, so its range is relative to their present \
             positions"
        );
        return ([low, high], Some(remark));
    }
    let range = [(low - first).min(0.0), (high - first).max(0.0)];
    let outside = (low - first).max(first - high);
    let remark = (outside > 1e-9 * (high - low)).then(|| {
        format!(
            "{name} is {} outside of its range in the file, {} to {}: the tuning used a range \
             extended to the present position",
            brief(outside),
            brief(low),
            brief(high)
        )
    });
    (range, remark)
}

/// Shifts the range of a variable, which is relative to the design in the file, so that it is relative to the design on the
/// page. The range of a rotation stays as it is. Returns a note if the tuning may go beyond the range in the file.
pub(super) fn count_from_file(
    variable: &mut Variable,
    file: &Suspension,
    now: &[Vector3<f64>],
) -> Option<String> {
    if let Some(turn) = &variable.turn {
        let is_moved = turn.points.iter().any(|p| file.design[p.0] != now[p.0]);
        return is_moved.then(|| {
            format!(
                "{} {}: its points were moved, so its range is relative to their present positions",
                variable.name,
                variable.way()
            )
        });
    }
    let moved = variable.moves.iter().map(|by| {
        let [was, is] = [file.design[by.point.0], now[by.point.0]].map(|point| point[by.axis]);
        file.frame.sign(by.axis) * (is - was) / by.factor
    });
    let moved: Vec<f64> = moved.collect();
    let (range, remark) = counted_from_file(&variable.name, variable.range, &moved);
    variable.range = range;
    remark
}

/// A tuning that is ready to run.
pub(super) type Tuning = Box<dyn FnOnce(&Job) -> Result<Proposal, String> + Send>;

/// A tuning, running or done.
pub(super) struct Job {
    number: u64,
    interrupt: AtomicBool,
    iterations: AtomicU64,
    /// Number of starts (searches from different designs) that have begun.
    starts: AtomicUsize,
    /// Smallest misfit that the tuning has reached so far. `None` before the first iteration.
    misfit: Mutex<Option<f64>>,
    ended: Mutex<Option<Result<Proposal, String>>>,
}

impl Job {
    /// Starts a tuning on a new thread.
    pub(super) fn begin(number: u64, tuning: Tuning) -> Result<Arc<Job>, String> {
        let job = Arc::new(Job {
            number,
            interrupt: AtomicBool::new(false),
            iterations: AtomicU64::new(0),
            starts: AtomicUsize::new(0),
            misfit: Mutex::new(None),
            ended: Mutex::new(None),
        });
        let own = job.clone();
        let run = move || {
            // A panic ends only this job. The page gets a message, and the next tuning can begin.
            let ended = catch_unwind(AssertUnwindSafe(|| tuning(&own)));
            let ended = ended.unwrap_or_else(|panic| Err(panicked(&*panic)));
            *own.ended.lock().unwrap_or_else(PoisonError::into_inner) = Some(ended);
        };
        let spawned = std::thread::Builder::new().spawn(run);
        spawned.map_err(|e| format!("cannot start to tune: {e}"))?;
        Ok(job)
    }

    /// Tuning of a design of a wheel or an axle, without the variables that move a locked coordinate. Returns an error without
    /// `[optimise]`, and if no variable is left.
    pub(super) fn of_study(opened: Arc<Opened>, request: &TuneRequest) -> Result<Tuning, String> {
        let mut study = opened.moved(&request.of.design)?;
        let study_design = study.wheel().design.clone();
        let Some(optimise) = &mut study.optimise else {
            return Err(NO_SECTION.into());
        };
        let free = |variable: &&Variable| {
            let points = variable.moves.iter().map(|m| (m.point.0, m.axis as usize));
            let turned = variable.turn.iter().flat_map(|turn| &turn.points);
            let turned = turned.flat_map(|p| (0..3).map(|axis| (p.0, axis)));
            !points
                .chain(turned)
                .any(|(point, axis)| request.is_locked(point, axis))
        };
        optimise.variables.retain(|variable| free(&variable));
        let (file, now) = (opened.study.wheel(), study_design.as_slice());
        let remarks = optimise
            .variables
            .iter_mut()
            .filter_map(|variable| count_from_file(variable, file, now));
        let remarks: Vec<String> = remarks.collect();
        if optimise.variables.is_empty() {
            return Err(ALL_LOCKED.to_owned());
        }
        Ok(Box::new(move |job| job.run(&study, &opened.text, remarks)))
    }

    /// Runs a tuning that reports its iterations and its smallest misfit to this job, and that stops if the job is cancelled.
    pub(super) fn controlled<R>(&self, tune: impl FnOnce(Control<'_>) -> R) -> R {
        let watch = |_: usize, iteration: &Iteration| {
            self.iterations.fetch_add(1, Ordering::Relaxed);
            if iteration.iteration == 0 {
                self.starts.fetch_add(1, Ordering::Relaxed);
            }
            let mut least = self.misfit.lock().unwrap_or_else(PoisonError::into_inner);
            *least = Some(least.map_or(iteration.misfit, |m| m.min(iteration.misfit)));
        };
        tune(Control {
            interrupt: Some(&self.interrupt),
            watch: Some(&watch),
        })
    }

    /// Returns true if the end of the tuning was requested.
    pub(super) fn is_cancelled(&self) -> bool {
        self.interrupt.load(Ordering::SeqCst)
    }

    fn run(&self, study: &Study, text: &str, remarks: Vec<String>) -> Result<Proposal, String> {
        let suspension = study.wheel();
        let optimise = study.optimise.as_ref().expect("the tuning was requested");
        let fault = |fault: crate::mechanism::DesignFault| fault.describe(&suspension.mechanism);
        let tuning = self.controlled(|control| tune(&study.vehicle, optimise, control));
        let tuning = tuning.map_err(fault)?;
        let Some(best) = &tuning.best else {
            let first = tuning.starts.starts.first();
            let why = first.and_then(|start| start.outcome.as_ref().err());
            return Err(why.map_or("no start was completed".to_owned(), |w| w.to_string()));
        };
        let mut summary = TuningSummary::of(study, optimise, &tuning, None);
        let tuned = study.moved(&best.offsets);
        summary.side_effects = side_effects(study, &tuned).map_err(fault)?;
        let expected = tuning.expected_yield.as_ref();
        let refused = expected.and_then(|found| found.as_ref().err());
        let refused = refused.map(not_increased);
        let expected = expected.and_then(|found| found.as_ref().ok());
        let yields = yields(study, optimise, Some(&tuned), expected, &self.interrupt);
        let of_yields = yields.iter().flat_map(|yields| {
            let surrogate = yields.surrogate_in_words();
            surrogate.into_iter().chain(yields.remark())
        });
        let of_yields: Vec<String> = of_yields.chain(refused).collect();
        let rates = rate_edits(study, text, &tuned);
        Ok(Proposal {
            edits: rates.edits,
            origins: rates.origins,
            rates: rates.words,
            design: coordinates(suspension, &best.design),
            headline: summary.headline(),
            side_effects: SideEffectRows::of(&summary.side_effects),
            yields: yields.as_ref().map(YieldRows::from),
            remarks: [
                remarks,
                summary.outcome_in_words(),
                summary.remarks(),
                of_yields,
            ]
            .concat(),
            interrupted: self.is_cancelled(),
        })
    }

    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// Requests that the tuning ends after its present iteration and returns the best design so far.
    pub(super) fn cancel(&self) {
        self.interrupt.store(true, Ordering::SeqCst);
    }

    pub(super) fn is_running(&self) -> bool {
        let ended = self.ended.lock().unwrap_or_else(PoisonError::into_inner);
        ended.is_none()
    }

    pub(super) fn state(&self) -> JobState {
        let ended = self.ended.lock().unwrap_or_else(PoisonError::into_inner);
        let misfit = *self.misfit.lock().unwrap_or_else(PoisonError::into_inner);
        JobState {
            job: self.number,
            iterations: self.iterations.load(Ordering::Relaxed),
            starts: self.starts.load(Ordering::Relaxed),
            misfit,
            done: ended.is_some(),
            error: ended.as_ref().and_then(|e| e.as_ref().err().cloned()),
            proposal: ended.as_ref().and_then(|e| e.as_ref().ok().cloned()),
        }
    }
}
