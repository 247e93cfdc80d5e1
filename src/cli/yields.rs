//! Shares of builds within all bands, before and after a robust tuning.

use super::interrupt;
use crate::optimise::{Control, ExpectedYield, tune};
use crate::report::YieldRecord;
use crate::study::{Optimise, Study, Tolerance};
use crate::tolerance::{MonteCarlo, Problem, monte_carlo};
use std::ops::ControlFlow;

/// For a robust tuning: yields of the design before it, of the optimum without scatter and of the tuned design. All
/// are of the same builds by Monte Carlo, as in `hardpoint tolerance`. They are independent of the builds of the
/// tuning. `None` if the tuning is not robust, without bands, or after an interruption.
pub(super) fn yields(
    study: &Study,
    optimise: &Optimise,
    tuned: Option<&Study>,
    expected: Option<&ExpectedYield>,
) -> Option<YieldRecord> {
    optimise.scatter.as_ref()?;
    let tolerance = study.tolerance.as_ref().filter(|t| !t.bands.is_empty())?;
    let tuned = tuned?;
    let plain = match expected {
        // The search began there.
        Some(expected) => Some(study.moved(&expected.plain)),
        None => plain_optimum(study, optimise),
    };
    let of = |study: &Study| builds(study, tolerance);
    let yields = YieldRecord::of(
        tolerance,
        of(study),
        plain.as_ref().and_then(of),
        of(tuned),
        expected,
    );
    // After an interruption they would be of different numbers of builds.
    (!interrupt::is_raised()).then_some(yields)
}

/// The tuned study if builds do not scatter.
fn plain_optimum(study: &Study, optimise: &Optimise) -> Option<Study> {
    let plain = Optimise {
        scatter: None,
        ..optimise.clone()
    };
    let control = Control {
        interrupt: Some(interrupt::flag()),
        watch: None,
    };
    let tuning = tune(&study.vehicle, &plain, control).ok()?;
    Some(study.moved(&tuning.best?.offsets))
}

/// The builds of a study, if it can be built.
fn builds(study: &Study, tolerance: &Tolerance) -> Option<MonteCarlo> {
    let problem = Problem::of(study, tolerance).ok()?;
    let problem = problem.interruptible(interrupt::flag());
    let nominal = problem.drawn().ok()?;
    let found = monte_carlo(&problem, &nominal, |_| match interrupt::is_raised() {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    });
    found.ok()
}
