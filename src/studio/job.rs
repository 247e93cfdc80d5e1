//! A tuning that runs in the background.

use super::message::{JobState, Proposal, SideEffectRows, TuneRequest};
use super::overview::coordinates;
use super::rates::rate_edits;
use super::study_file::Opened;
use crate::model::Suspension;
use crate::number::Vector3;
use crate::optimise::{Control, Iteration, tune};
use crate::report::TuningSummary;
use crate::side_effects::side_effects;
use crate::study::{Study, Variable};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Message about a tuning that has panicked.
fn panicked(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    format!(
        "the tuning failed by a fault of the program ({}); the study is unchanged, please report it",
        text.unwrap_or("no message")
    )
}

/// Makes the range of a variable relative to the design in the file, although the page has moved its points since. The present
/// position stays within the range. If the variable's points have moved by different amounts, the range stays relative to their
/// present positions.
fn count_from_file(variable: &mut Variable, file: &Suspension, now: &[Vector3<f64>]) {
    let moved = variable.moves.iter().map(|by| {
        let [was, is] = [file.design[by.point.0], now[by.point.0]].map(|point| point[by.axis]);
        file.frame.sign(by.axis) * (is - was) / by.factor
    });
    let moved: Vec<f64> = moved.collect();
    let Some(first) = moved.first().copied() else {
        return;
    };
    let [low, high] = variable.range;
    let is_together = |by: &f64| (by - first).abs() <= 1e-9 * (high - low);
    if moved.iter().all(is_together) {
        variable.range = [(low - first).min(0.0), (high - first).max(0.0)];
    }
}

/// A tuning that runs or has ended.
pub(super) struct Job {
    number: u64,
    interrupt: AtomicBool,
    iterations: AtomicU64,
    starts: AtomicUsize,
    /// Smallest misfit so far.
    misfit: Mutex<Option<f64>>,
    ended: Mutex<Option<Result<Proposal, String>>>,
}

impl Job {
    /// Starts to tune a design on its own thread.
    pub(super) fn begin(
        number: u64,
        opened: Arc<Opened>,
        request: &TuneRequest,
    ) -> Result<Arc<Job>, String> {
        let mut study = opened.moved(&request.of.design)?;
        let study_design = study.wheel().design.clone();
        let Some(optimise) = &mut study.optimise else {
            return Err("the study has no [optimise] section with variables and targets".into());
        };
        let free = |variable: &&Variable| {
            let points = variable.moves.iter().map(|m| (m.point.0, m.axis as usize));
            let turned = variable.turn.iter().flat_map(|turn| &turn.points);
            let turned = turned.flat_map(|p| (0..3).map(|axis| (p.0, axis)));
            let locked = |(point, axis): (usize, usize)| {
                request.locked.get(point).is_some_and(|axes| axes[axis])
            };
            !points.chain(turned).any(locked)
        };
        optimise.variables.retain(|variable| free(&variable));
        let (file, now) = (opened.study.wheel(), study_design.as_slice());
        for variable in &mut optimise.variables {
            count_from_file(variable, file, now);
        }
        if optimise.variables.is_empty() {
            return Err("every variable of the study moves a point that is locked".to_owned());
        }
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
            // A panic ends only this job. The page gets a message, and the next tuning can start.
            let ended = catch_unwind(AssertUnwindSafe(|| own.run(&study, &opened.text)));
            let ended = ended.unwrap_or_else(|panic| Err(panicked(&*panic)));
            *own.ended.lock().unwrap_or_else(PoisonError::into_inner) = Some(ended);
        };
        let spawned = std::thread::Builder::new().spawn(run);
        spawned.map_err(|e| format!("cannot start to tune: {e}"))?;
        Ok(job)
    }

    fn run(&self, study: &Study, text: &str) -> Result<Proposal, String> {
        let suspension = study.wheel();
        let optimise = study.optimise.as_ref().expect("it was asked for");
        let watch = |_: usize, iteration: &Iteration| {
            self.iterations.fetch_add(1, Ordering::Relaxed);
            if iteration.iteration == 0 {
                self.starts.fetch_add(1, Ordering::Relaxed);
            }
            let mut least = self.misfit.lock().unwrap_or_else(PoisonError::into_inner);
            *least = Some(least.map_or(iteration.misfit, |m| m.min(iteration.misfit)));
        };
        let control = Control {
            interrupt: Some(&self.interrupt),
            watch: Some(&watch),
        };
        let fault = |fault: crate::mechanism::DesignFault| fault.describe(&suspension.mechanism);
        let tuning = tune(&study.vehicle, optimise, control).map_err(fault)?;
        let Some(best) = &tuning.best else {
            let first = tuning.starts.starts.first();
            let why = first.and_then(|start| start.outcome.as_ref().err());
            return Err(why.map_or("no start came to an end".to_owned(), |w| w.to_string()));
        };
        let mut summary = TuningSummary::of(study, optimise, &tuning, None);
        let tuned = study.moved(&best.offsets);
        summary.side_effects = side_effects(study, &tuned).map_err(fault)?;
        let (edits, rates) = rate_edits(study, text, &tuned);
        Ok(Proposal {
            edits,
            rates,
            design: coordinates(suspension, &best.design),
            headline: summary.headline(),
            side_effects: SideEffectRows::of(&summary.side_effects),
            remarks: [summary.outcome_in_words(), summary.remarks()].concat(),
            interrupted: self.interrupt.load(Ordering::SeqCst),
        })
    }

    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// Requests the end of the tuning after the present iteration, with its present result.
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
