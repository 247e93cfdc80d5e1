//! Yield before and after a robust tuning: share of builds (assembled parts with random deviations) within all bands.

use crate::optimise::{Control, ExpectedYield, tune};
use crate::report::YieldRecord;
use crate::study::{Optimise, Study};
use crate::tolerance::{MonteCarlo, Problem, monte_carlo};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// Yields for a robust tuning: of the design before it, of the optimum without scatter, and of the tuned design. All three yields
/// come from the same Monte Carlo builds, as in `hardpoint tolerance`. The tuning uses other builds. `None` if the tuning is not
/// robust, has no bands, found no design, or was stopped by the flag `stop`.
pub fn yields(
    study: &Study,
    optimise: &Optimise,
    tuned: Option<&Study>,
    expected: Option<&ExpectedYield>,
    stop: &AtomicBool,
) -> Option<YieldRecord> {
    optimise.scatter.as_ref()?;
    let tolerance = study.tolerance.as_ref().filter(|t| !t.bands.is_empty())?;
    let tuned = tuned?;
    let plain = match expected {
        // The search for the robust design began at the optimum without scatter.
        Some(expected) => Some(study.moved(&expected.plain)),
        None => plain_optimum(study, optimise, stop),
    };
    let of = |study: &Study| builds(study, stop);
    let yields = YieldRecord::of(
        tolerance,
        of(study),
        plain.as_ref().and_then(of),
        of(tuned),
        expected,
    );
    // After an interruption, the yields would be based on different numbers of builds.
    (!stop.load(Ordering::SeqCst)).then_some(yields)
}

/// Sentence about a search that did not increase the yield.
pub fn not_increased(reason: impl std::fmt::Display) -> String {
    format!("the yield was not increased: {reason}")
}

/// Study with the design that a tuning without scatter reaches. `None` if the tuning reaches no design.
fn plain_optimum(study: &Study, optimise: &Optimise, stop: &AtomicBool) -> Option<Study> {
    let plain = optimise.nominal();
    let control = Control {
        interrupt: Some(stop),
        watch: None,
    };
    let tuning = tune(&study.vehicle, &plain, control).ok()?;
    Some(study.moved(&tuning.best?.offsets))
}

/// Results of Monte Carlo builds of a study. Points, lengths and rates scatter about the values of this study. `None` if the
/// study cannot be built.
fn builds(study: &Study, stop: &AtomicBool) -> Option<MonteCarlo> {
    let problem = Problem::of(study, study.tolerance.as_ref()?).ok()?;
    let problem = problem.interruptible(stop);
    let nominal = problem.drawn().ok()?;
    let found = monte_carlo(&problem, &nominal, |_| {
        if stop.load(Ordering::SeqCst) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    found.ok()
}
