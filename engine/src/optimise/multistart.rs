//! Several starts, and the selection of the best result.

use super::fit::fit;
use super::{
    Bounds, Constrained, Control, Fit, Infeasible, LeastSquares, Options, Termination, VIOLATED,
    constrained_fit,
};
use crate::sweep::sobol;
use nalgebra::DVector;
use rayon::prelude::*;
use std::ops::Range;

/// Relative difference up to which misfits count as equal. Runs that end at the same minimum agree to about
/// [`Options::reduction_below`].
const SAME_MISFIT: f64 = 1e-9;

/// Relative difference up to which violations of constraints count as equal. A smaller violation by less than [`VIOLATED`] counts
/// as equal, too.
const SAME_VIOLATION: f64 = 1e-6;

/// One start and its outcome.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// The start point.
    pub x: DVector<f64>,
    /// The final fit, or the reason why the start point has no residuals.
    pub outcome: Result<Fit, Infeasible>,
}

/// All starts, and the index of the best.
#[derive(Clone, Debug, PartialEq)]
pub struct Multistart {
    /// Starts in the order of their numbers.
    pub starts: Vec<Start>,
    /// Index of the best start. `None` if every start failed.
    pub best: Option<usize>,
}

impl Multistart {
    /// Fit of the best start.
    pub fn best_fit(&self) -> Option<&Fit> {
        self.starts[self.best?].outcome.as_ref().ok()
    }

    /// Number of starts that were interrupted.
    pub fn interrupted(&self) -> usize {
        let stopped = |start: &&Start| match &start.outcome {
            Ok(fit) => fit.termination == Termination::Interrupted,
            Err(reason) => *reason == Infeasible::Interrupted,
        };
        self.starts.iter().filter(stopped).count()
    }
}

/// Minimises from `starts` points in parallel, on the CPU threads of the current rayon pool. The first start is `design`,
/// or the nearest point within `bounds`. The other starts are points of a low-discrepancy sequence within `bounds`.
///
/// `problem` makes a problem for each start. The result does not depend on the number of CPU threads. The best fit is the one
/// with the least misfit. Fits count as equal if their misfits are below [`Options::misfit_below`], or if they found the same
/// minimum. Among equal fits, the one with the smallest move from the design wins, in fractions of the ranges. If two moves
/// are equally small, the earlier start wins.
pub fn multistart<P: LeastSquares>(
    problem: impl Fn() -> P + Sync,
    bounds: &Bounds,
    design: &DVector<f64>,
    starts: usize,
    seed: u32,
    options: &Options,
    control: Control<'_>,
) -> Multistart {
    let run = |index, x: &DVector<f64>| fit(index, problem(), bounds, x, options, control);
    let starts = every_start(0..starts, bounds, design, seed, control, run);
    let best = nearest_of_least(&starts, bounds, design, options);
    Multistart { starts, best }
}

/// Minimises from several starts like [`multistart`], under constraints. If no start satisfies them, the result is the one with
/// the smallest violation.
pub fn constrained_multistart<P: Constrained>(
    problem: impl Fn() -> P + Sync,
    bounds: &Bounds,
    design: &DVector<f64>,
    starts: usize,
    seed: u32,
    options: &Options,
    control: Control<'_>,
) -> Multistart {
    let run = |index, x: &DVector<f64>| {
        let fit = constrained_fit(index, problem(), bounds, x, options, control)?;
        Ok(fit.into_fit(bounds, true))
    };
    let starts = every_start(0..starts, bounds, design, seed, control, run);
    let best = nearest_of_least(&starts, bounds, design, options);
    let best = best.or_else(|| least_violation(&starts));
    Multistart { starts, best }
}

/// Index of the start nearest to the design, among those with the smallest misfit. `None` if no start satisfies the constraints.
fn nearest_of_least(
    starts: &[Start],
    bounds: &Bounds,
    design: &DVector<f64>,
    options: &Options,
) -> Option<usize> {
    let good = (least_misfit(starts)? * (1.0 + SAME_MISFIT)).max(options.misfit_below);
    let distance = |x: &DVector<f64>| bounds.distance(design, x);
    nearest(starts, good, distance, SAME_MISFIT)
}

/// Index of the start with the smallest violation of the constraints. Among equal violations, the smallest misfit wins.
pub(super) fn least_violation(starts: &[Start]) -> Option<usize> {
    let violations = fits(starts).map(|(_, fit)| fit.violation());
    let least = violations.min_by(f64::total_cmp)?;
    let is_least =
        |(_, fit): &(usize, &Fit)| fit.violation() <= least + VIOLATED.max(SAME_VIOLATION * least);
    let equal = fits(starts).filter(is_least);
    let best = equal.min_by(|a, b| a.1.misfit().total_cmp(&b.1.misfit()));
    best.map(|(index, _)| index)
}

/// Runs the starts with these numbers in parallel. After a request to stop, only the first start still runs.
pub(super) fn every_start(
    numbers: Range<usize>,
    bounds: &Bounds,
    design: &DVector<f64>,
    seed: u32,
    control: Control<'_>,
    run: impl Fn(usize, &DVector<f64>) -> Result<Fit, Infeasible> + Sync,
) -> Vec<Start> {
    let run = |index| {
        let x = starting_point(bounds, design, index, seed);
        let outcome = if index > 0 && control.is_interrupted() {
            Err(Infeasible::Interrupted)
        } else {
            run(index, &x)
        };
        Start { x, outcome }
    };
    numbers.into_par_iter().map(run).collect()
}

/// Start point number `index`: first the design, then the Owen-scrambled Sobol sequence of `seed`.
pub fn starting_point(
    bounds: &Bounds,
    design: &DVector<f64>,
    index: usize,
    seed: u32,
) -> DVector<f64> {
    if index == 0 {
        return bounds.nearest(design);
    }
    DVector::from_fn(bounds.variables(), |j, _| {
        let fraction = sobol(index as u64 - 1, j, bounds.variables(), seed);
        let (lower, upper) = (bounds.lower()[j], bounds.upper()[j]);
        (lower + bounds.width()[j] * fraction).min(upper)
    })
}

/// Fits of all starts that did not fail, each with the index of its start.
pub(super) fn fits(starts: &[Start]) -> impl Iterator<Item = (usize, &Fit)> {
    let fits = starts.iter().enumerate();
    fits.filter_map(|(index, start)| Some((index, start.outcome.as_ref().ok()?)))
}

/// Least misfit of the starts that satisfy the constraints.
pub(super) fn least_misfit(starts: &[Start]) -> Option<f64> {
    let kept = fits(starts).filter(|(_, fit)| fit.is_feasible());
    kept.map(|(_, fit)| fit.misfit()).min_by(f64::total_cmp)
}

/// Chooses the start with the smallest move among those that satisfy the constraints with a misfit up to `good`. A distance
/// counts as equal to the smallest distance if it is larger by at most the fraction `share`. The earliest of equally near
/// starts wins.
pub(super) fn nearest(
    starts: &[Start],
    good: f64,
    distance: impl Fn(&DVector<f64>) -> f64,
    share: f64,
) -> Option<usize> {
    let moves: Vec<(usize, f64)> = fits(starts)
        .filter(|(_, fit)| fit.is_feasible() && fit.misfit() <= good)
        .map(|(index, fit)| (index, distance(&fit.x)))
        .collect();
    let shortest = moves.iter().map(|m| m.1).min_by(f64::total_cmp)?;
    let short = shortest * (1.0 + share);
    moves.iter().find(|m| m.1 <= short).map(|m| m.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimise::test_problems::{Function, freudenstein_roth, stated, vector, written};

    fn freudenstein_roth_from(starts: usize, threads: usize) -> Multistart {
        let problem = || written(freudenstein_roth, &[0.5, -2.0]);
        let bounds = Bounds::new(&[[-20.0, 20.0], [-6.0, 6.0]]).unwrap();
        let pool = crate::threads::pool(threads).unwrap();
        let (design, options) = (vector(&[0.5, -2.0]), Options::default());
        pool.install(|| {
            multistart(
                problem,
                &bounds,
                &design,
                starts,
                1,
                &options,
                Control::default(),
            )
        })
    }

    #[test]
    fn several_starts_find_what_one_does_not() {
        let one = freudenstein_roth_from(1, 1);
        assert!(one.best_fit().unwrap().misfit() > 1.0);
        let several = freudenstein_roth_from(8, 2);
        assert!((&several.best_fit().unwrap().x - vector(&[5.0, 4.0])).amax() < 1e-9);
        assert_eq!(several.starts[0], one.starts[0]);
    }

    /// Two rows contradict each other, so every start ends with the same violation. A residual of the second variable is left, and
    /// the starts end with different misfits. The result is the start with the smallest misfit, not the first start.
    #[test]
    fn among_equal_violations_the_smallest_misfit_is_kept() {
        let at = |x: &[f64]| {
            let goal = vec![(x[1] - 3.0, vec![0.0, 1.0])];
            let at_least = (1.0 - x[0], vec![-1.0, 0.0]);
            let at_most = (x[0] + 1.0, vec![1.0, 0.0]);
            [goal, vec![], vec![at_least, at_most]]
        };
        let found = constrained_multistart(
            || stated(&[0.0; 2], 0, f64::INFINITY, at),
            &Bounds::new(&[[-5.0, 5.0], [-2.0, 2.0]]).unwrap(),
            &vector(&[0.0, -1.0]),
            8,
            3,
            &Options::default(),
            Control::default(),
        );
        let violations: Vec<f64> = fits(&found.starts).map(|(_, f)| f.violation()).collect();
        assert!(
            violations.iter().all(|v| (v - 1.0).abs() < 1e-9),
            "{violations:?}"
        );
        let misfits: Vec<f64> = fits(&found.starts).map(|(_, f)| f.misfit()).collect();
        let least = misfits.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(misfits[0] > least, "{misfits:?}");
        assert_eq!(found.best_fit().unwrap().misfit(), least);
    }

    #[test]
    fn the_number_of_threads_changes_nothing() {
        let one = freudenstein_roth_from(16, 1);
        for threads in [2, 3] {
            assert_eq!(freudenstein_roth_from(16, threads), one);
        }
    }

    /// The residuals are zero at -1 and at 0.5. The result is the zero that is nearer to the design. Some starts have no
    /// residuals.
    #[test]
    fn of_equal_fits_the_smallest_move_is_kept_and_failures_are_reported() {
        let rows: Function = |x| {
            if x[0] > 1.5 {
                Err(Infeasible::Refused("too far".into()))
            } else {
                Ok(vec![((x[0] + 1.0) * (x[0] - 0.5), vec![2.0 * x[0] + 0.5])])
            }
        };
        let problem = || written(rows, &[0.0]);
        let bounds = Bounds::new(&[[-3.0, 3.0]]).unwrap();
        for (design, nearest) in [(-0.4, -1.0), (-0.1, 0.5), (2.5, 0.5)] {
            let design = vector(&[design]);
            let found = multistart(
                problem,
                &bounds,
                &design,
                12,
                5,
                &Options::default(),
                Control::default(),
            );
            let best = found.best_fit().unwrap();
            assert!(
                (best.x[0] - nearest).abs() < 1e-9,
                "{} {nearest}",
                best.x[0]
            );
            let failed = found.starts.iter().filter(|start| start.outcome.is_err());
            assert!(failed.count() > 0);
        }
    }

    #[test]
    fn starting_points_fill_the_box_in_any_dimension() {
        let ranges: Vec<[f64; 2]> = (0..300)
            .map(|j| [-f64::from(j), 1.0])
            .map(|[a, b]| [a - 1.0, b])
            .collect();
        let bounds = Bounds::new(&ranges).unwrap();
        let design = DVector::zeros(300);
        for j in [0, 255, 256, 299] {
            let fraction = |index: usize| {
                let x = starting_point(&bounds, &design, index, 7);
                (x[j] - bounds.lower()[j]) / bounds.width()[j]
            };
            // Sixteen points of the sequence lie in sixteen different sixteenths of the range.
            let mut cells: Vec<usize> = (1..=16)
                .map(|index| (fraction(index) * 16.0) as usize)
                .collect();
            cells.sort_unstable();
            assert_eq!(cells, (0..16).collect::<Vec<_>>());
        }
        let far = starting_point(&bounds, &design, 70_000, 7);
        assert_eq!(bounds.nearest(&far), far);
    }
}
