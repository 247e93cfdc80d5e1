//! Several starts, and the best of where they end.

use super::fit::fit_start;
use super::{Bounds, Control, Fit, Infeasible, LeastSquares, Options};
use nalgebra::DVector;
use rayon::prelude::*;

/// Misfits closer than this fraction of the least are the same: runs that end at one minimum agree
/// in it to about [`Options::reduction_below`].
const SAME_MISFIT: f64 = 1e-9;

/// One start and what became of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Where it began.
    pub x: DVector<f64>,
    /// Where it ended, or why there were no residuals where it began.
    pub outcome: Result<Fit, Infeasible>,
}

/// All starts, and the best.
#[derive(Clone, Debug, PartialEq)]
pub struct Multistart {
    /// In their order.
    pub starts: Vec<Start>,
    /// The index of the best; none if every start failed.
    pub best: Option<usize>,
}

impl Multistart {
    /// The fit of the best start.
    pub fn best_fit(&self) -> Option<&Fit> {
        self.starts[self.best?].outcome.as_ref().ok()
    }
}

/// Minimises from `starts` points in parallel, on the threads of the current rayon pool: from the
/// point of the box nearest to `design`, and from points of a low-discrepancy sequence over the box.
///
/// `problem` makes a problem for each start. The result does not depend on the number of threads.
/// Kept is the fit of least misfit. Among fits equally good ([`Options::misfit_below`], or the same
/// minimum found again) it is the one that moves least from the design, in fractions of the ranges,
/// and then the earliest.
pub fn multistart<P: LeastSquares>(
    problem: impl Fn() -> P + Sync,
    bounds: &Bounds,
    design: &DVector<f64>,
    starts: usize,
    seed: u32,
    options: &Options,
    control: Control<'_>,
) -> Multistart {
    let run = |index| {
        let x = starting_point(bounds, design, index, seed);
        let outcome = fit_start(index, problem(), bounds, &x, options, control);
        Start { x, outcome }
    };
    let starts: Vec<Start> = (0..starts).into_par_iter().map(run).collect();
    let best = best_of(&starts, bounds, design, options);
    Multistart { starts, best }
}

/// The start number `index`: the design itself, then the Owen-scrambled Sobol sequence of `seed`.
pub fn starting_point(
    bounds: &Bounds,
    design: &DVector<f64>,
    index: usize,
    seed: u32,
) -> DVector<f64> {
    if index == 0 {
        return bounds.nearest(design);
    }
    // The sequence has 2^16 points of 256 dimensions; another seed goes on where it ends.
    let (dimensions, points) = (sobol_burley::NUM_DIMENSIONS as usize, 1 << 16);
    let sample = index - 1;
    let blocks = bounds.variables().div_ceil(dimensions);
    DVector::from_fn(bounds.variables(), |j, _| {
        let block = sample / points * blocks + j / dimensions;
        let seed = seed.wrapping_add(block as u32);
        let dimension = (j % dimensions) as u32;
        let fraction = sobol_burley::sample((sample % points) as u32, dimension, seed);
        let (lower, upper) = (bounds.lower()[j], bounds.upper()[j]);
        (lower + bounds.width()[j] * f64::from(fraction)).min(upper)
    })
}

fn best_of(
    starts: &[Start],
    bounds: &Bounds,
    design: &DVector<f64>,
    options: &Options,
) -> Option<usize> {
    let fits = || {
        let fits = starts.iter().enumerate();
        fits.filter_map(|(index, start)| Some((index, start.outcome.as_ref().ok()?)))
    };
    let least = fits().map(|(_, fit)| fit.misfit()).min_by(f64::total_cmp)?;
    let good = (least * (1.0 + SAME_MISFIT)).max(options.misfit_below);
    let moves: Vec<(usize, f64)> = fits()
        .filter(|(_, fit)| fit.misfit() <= good)
        .map(|(index, fit)| (index, bounds.distance(design, &fit.x)))
        .collect();
    let shortest = moves
        .iter()
        .map(|&(_, length)| length)
        .min_by(f64::total_cmp)?;
    let short = shortest * (1.0 + SAME_MISFIT);
    let first = moves.iter().find(|&&(_, length)| length <= short);
    first.map(|&(index, _)| index)
}
