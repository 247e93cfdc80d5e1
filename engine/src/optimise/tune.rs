//! Tuning of a study: from its targets, constraints and variables to the tuned design.
//!
//! Every start first lowers the misfit, until it is good enough or at a minimum. Let m be the study's `good_enough`. If the
//! smallest misfit found is larger than `good_enough`, m is 1.01 times this misfit. Every design with a misfit of at most m
//! then moves back towards the study's own design, as far as m and the constraints allow. The nearest of these designs is the
//! result. With `good_enough = 0` the result is the design with the smallest misfit.

use super::conflict::{is_satisfied_from, smallest_conflict};
use super::multistart::fits;
use super::pool::{Pool, PoolGuard};
use super::starts::STARTS_BEFORE_REFUSAL;
use super::trade::{Criterion, Distance};
use super::verdict::{Limit, Price, Residuals, Unmoved, unmoved_constraints};
use super::yield_search::{ExpectedYield, tune_for_yield};
use super::{
    Assessment, Bounds, Constrained, ConstrainedFit, ConstraintState, Control, Deviation, Fit,
    HoldingBound, Identifiability, Infeasible, LeastSquares, Linearisation, Margin, Minimum,
    Multistart, Objective, Options, StandardErrors, TargetLayout, Termination, moved_design,
};
use crate::mechanism::DesignFault;
use crate::model::Suspension;
use crate::number::{Vector3, Width};
use crate::study::{Optimise, RobustAim, Vehicle};
use crate::threads::on_large_stacks;
use nalgebra::{DMatrix, DVector};

/// Change of the residuals (root mean square, in multiples of the tolerance) for a move across the whole range. A direction
/// with a smaller effect counts as leaving the targets unchanged.
const UNSEEN: f64 = 0.01;
/// Violation of a constraint, in visible units (1 mm or 1 degree), up to which a move counts as keeping the constraint.
const MOVED_KEPT: f64 = 0.01;
/// Largest number of directions without effect that the tuning tests by moving along them.
const TRIED_OUT: usize = 8;

/// Result of a tuning.
#[derive(Clone, Debug)]
pub struct Tuning {
    /// Misfit and deviations of the study's own design, or the reason why they cannot be computed.
    pub before: Result<Fulfilment, Infeasible>,
    /// Smallest and largest value of each target at its stations in the study's own design, in the unit of the target's measure.
    /// Values of a robust tuning apply to the nominal design. `None` if a value cannot be computed.
    pub values: Option<Vec<[f64; 2]>>,
    /// All starts, and the index of the best.
    pub starts: Multistart,
    /// Best design. `None` if no start succeeded.
    pub best: Option<Best>,
    /// Missed targets on which the variables have too little effect.
    pub unmoved: Unmoved,
    /// Indices of violated constraints that no variable changes.
    pub unmoved_constraints: Vec<usize>,
    /// Indices of constraints that contradict one another. If any one of them were removed, the others could be satisfied.
    /// Empty if all can be satisfied together, or if no such set was found.
    pub contradiction: Vec<usize>,
    /// Expected yield of a tuning for yield, or the reason why a build has no values. `None` for all other tunings. Also
    /// `None` if no start satisfies the constraints, or if the tuning was stopped before the search for the yield.
    pub expected_yield: Option<Result<ExpectedYield, Infeasible>>,
}

/// Deviations of a design from the targets.
#[derive(Clone, Debug, PartialEq)]
pub struct Fulfilment {
    /// Root of the weighted mean of the targets' squared deviations, in multiples of the tolerance.
    pub misfit: f64,
    /// Deviation of the design from each target.
    pub targets: Vec<Deviation>,
}

/// Best design that the tuning found.
#[derive(Clone, Debug)]
pub struct Best {
    /// Offsets of the variables, in the study's axes.
    pub offsets: Vec<f64>,
    /// Tuned hardpoints in the order of the suspension's hardpoints. They are in the kernel's frame: a left wheel, x
    /// forward, y left, z up. The study of this design is [`Study::at_design`](crate::study::Study::at_design).
    pub design: Vec<Vector3<f64>>,
    /// Deviations of this design from the targets.
    pub after: Fulfilment,
    /// Directions that the targets determine at this design, in the space of the variables.
    pub identifiability: Identifiability,
    /// Outcome for each constraint.
    pub constraints: Vec<ConstraintOutcome>,
    /// Smallest and largest value of each target at its stations, as in [`Tuning::values`].
    pub values: Option<Vec<[f64; 2]>>,
    /// Bounds of variables that hold the misfit, the most effective first. `None` if the tuning did not end at a minimum of the
    /// misfit, or near one.
    pub holding: Option<Vec<HoldingBound>>,
    /// Standard errors of the variables. `None` unless the targets are measurements, there are no constraints, and the fit
    /// ended at a minimum. Also `None` if there are too few residuals.
    pub errors: Option<StandardErrors>,
}

/// Outcome of a constraint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstraintOutcome {
    /// Margin to the nearest limit, in the constraint's unit; negative if the limit is violated.
    pub margin: f64,
    /// Drive value of the station with the smallest margin, or of the extreme near it. `None` if the constraint does not change
    /// along the motion, or applies at only one drive value.
    pub at: Option<f64>,
    /// True if the nearest limit is the upper one.
    pub is_upper: bool,
    /// Price of the constraint's limits: reduction of the misfit if a limit moves outwards by one unit.
    pub price: Price,
}

/// Tunes a wheel or an axle. An error gives the reason why the design cannot be solved at all.
pub fn tune(
    vehicle: &Vehicle,
    optimise: &Optimise,
    control: Control<'_>,
) -> Result<Tuning, DesignFault> {
    // Each start is one task. The tuning uses at most as many CPU threads as the rayon pool of the caller.
    let starts = optimise.starts.max(STARTS_BEFORE_REFUSAL);
    let threads = starts.min(rayon::current_num_threads());
    on_large_stacks(threads, || match &optimise.scatter {
        Some(scatter) if let RobustAim::Yield(bands) = &scatter.aim => {
            tune_for_yield(vehicle, optimise, (scatter, bands), control)
        }
        _ => {
            let asked = TuningRequest::new(vehicle, optimise, control)?;
            Tuner::new(&asked)?.run()
        }
    })
}

/// Inputs and workspace of a requested tuning.
pub(super) struct TuningRequest<'a> {
    vehicle: &'a Vehicle,
    /// The assembled vehicle ([`Vehicle::assembled`]). `None` unless the tuning is robust.
    assembled: Option<Vehicle>,
    optimise: &'a Optimise,
    pub layout: TargetLayout,
    control: Control<'a>,
}

impl<'a> TuningRequest<'a> {
    pub(super) fn new(
        vehicle: &'a Vehicle,
        optimise: &'a Optimise,
        control: Control<'a>,
    ) -> Result<Self, DesignFault> {
        Ok(TuningRequest {
            vehicle,
            assembled: match &optimise.scatter {
                Some(_) => Some(vehicle.assembled()?),
                None => None,
            },
            optimise,
            layout: TargetLayout::of(optimise, vehicle),
            control,
        })
    }
}

pub(super) struct Tuner<'a> {
    pub suspension: &'a Suspension,
    assembled: Option<&'a Vehicle>,
    vehicle: &'a Vehicle,
    pub optimise: &'a Optimise,
    pub layout: &'a TargetLayout,
    pub bounds: Bounds,
    /// Offsets of the study's own design: all zero.
    pub design: DVector<f64>,
    pub control: Control<'a>,
    problems: Pool<Objective<'a>>,
}

impl<'a> Tuner<'a> {
    pub(super) fn new(asked: &'a TuningRequest<'a>) -> Result<Self, DesignFault> {
        let (suspension, optimise) = (asked.vehicle.wheel(), asked.optimise);
        let ranges: Vec<[f64; 2]> = optimise.variables.iter().map(|v| v.range).collect();
        // Every start uses this design, so an error here would occur in every start.
        let plain = Objective::new(suspension, &optimise.variables, &asked.layout)?;
        let is_plain = asked.assembled.is_none();
        Ok(Tuner {
            suspension,
            assembled: asked.assembled.as_ref(),
            vehicle: asked.vehicle,
            optimise,
            layout: &asked.layout,
            bounds: Bounds::new(&ranges).expect("a study's ranges are not empty"),
            design: DVector::zeros(ranges.len()),
            control: asked.control,
            problems: Pool::of(is_plain.then_some(plain)),
        })
    }

    pub(super) fn problem(&self) -> PoolGuard<'_, Objective<'a>> {
        let make = || self.problem_of(self.optimise, self.layout);
        self.problems.lend(make)
    }

    fn problem_of<'o>(&self, optimise: &'o Optimise, layout: &'o TargetLayout) -> Objective<'o>
    where
        'a: 'o,
    {
        let variables = &optimise.variables;
        let made = match (&optimise.scatter, self.assembled) {
            (Some(scatter), Some(assembled)) => {
                let width = Width::widest();
                Objective::of_builds(assembled, variables, layout, scatter, width)
            }
            _ => Objective::new(self.suspension, variables, layout),
        };
        made.expect("this design was accepted earlier in the run")
    }

    fn fulfilment(&self, evaluation: &Linearisation) -> Fulfilment {
        Fulfilment {
            misfit: evaluation.misfit(),
            targets: self.layout.deviations(&evaluation.residuals),
        }
    }

    pub(super) fn run(&self) -> Result<Tuning, DesignFault> {
        let optimise = self.optimise;
        let mut probe = self.problem();
        let mut evaluation = Linearisation::new(self.layout.residuals(), optimise.variables.len());
        let before = LeastSquares::evaluate(&mut probe, &self.design, &mut evaluation);
        let at_design = before.as_ref().ok().map(|()| evaluation.clone());
        let before = before.map(|()| self.fulfilment(&evaluation));
        let starts = self.starts(at_design.as_ref());
        let best = starts.best_fit().map(|fit| self.best(fit));
        let contradiction = match &best {
            Some(_) if !starts.best_fit().is_some_and(Fit::is_feasible) => {
                self.contradiction(&starts)
            }
            _ => Vec::new(),
        };
        let ends = fits(&starts.starts).map(|(_, fit)| &fit.evaluation);
        let seen: Vec<&Linearisation> = ends.chain(&at_design).collect();
        let unmoved = best.as_ref().zip(starts.best_fit());
        let unmoved = unmoved.map(|(best, fit)| self.unmoved(best, &fit.evaluation, &seen));
        Ok(Tuning {
            before,
            values: self.values(&self.design),
            unmoved_constraints: starts
                .best_fit()
                .map_or(Vec::new(), |fit| self.unmoved_constraints(fit)),
            starts,
            best,
            unmoved: unmoved.unwrap_or_default(),
            contradiction,
            expected_yield: None,
        })
    }

    /// Replaces the result of the best start by the result of a search for the largest yield.
    pub(super) fn keep(&self, tuning: &mut Tuning, found: &ConstrainedFit) {
        let mut problem = self.problem();
        let shape = problem.shape();
        let mut assessment = Assessment::new(&shape);
        let best = tuning
            .starts
            .best
            .map(|best| &mut tuning.starts.starts[best]);
        let Some(Ok(fit)) = best.map(|start| start.outcome.as_mut()) else {
            return;
        };
        if problem.assess(&found.x, &mut assessment).is_err() {
            return;
        }
        fit.active_bounds = self.bounds.active_bounds(&found.x);
        fit.x.clone_from(&found.x);
        fit.left = None;
        fit.residual = Some(found.imbalance);
        let end = found.termination.clone().checked(found.imbalance);
        fit.termination = if end.at_minimum() {
            Termination::LargestYield
        } else {
            Termination::YieldNotConverged
        };
        if let Some(state) = &mut fit.constraints {
            for (all, own) in state.movable.iter_mut().zip(&found.movable) {
                *all |= *own;
            }
            let counts = |row| state.counts(row);
            state.violation = assessment.violation_of(shape.equalities, &[], counts);
            state.values = assessment.rows.residuals;
            // Prices of limits are changes of the misfit, so a search for yield reports no prices.
            (state.multipliers, state.alternatives) = (None, None);
        }
        fit.evaluation = assessment.goal;
        let fit = fit.clone();
        tuning.best = Some(self.best(&fit));
    }

    /// Function that measures the distance of the variables from the design: fractions of the ranges, weighted with the costs.
    pub(super) fn distance(&self) -> Distance<'_> {
        let costs: Vec<f64> = self.optimise.variables.iter().map(|v| v.cost).collect();
        Distance::new(&self.design, &self.bounds, &costs)
    }

    /// Criterion for the misfit of all targets.
    pub(super) fn all_targets(&self) -> Criterion {
        let rows = self.layout.residuals();
        Criterion::misfit((0..rows).collect(), (rows as f64).sqrt())
    }

    /// Options for the end of a run.
    pub(super) fn options(&self) -> Options {
        Options {
            max_iterations: self.optimise.max_iterations,
            max_evaluations: self.optimise.max_iterations.saturating_mul(10),
            ..Options::default()
        }
    }

    /// Hardpoints at `x`.
    pub(super) fn moved_design(&self, x: &DVector<f64>) -> Vec<Vector3<f64>> {
        let Suspension { design, frame, .. } = self.suspension;
        let mut moved = design.clone();
        moved_design(design, frame, &self.optimise.variables, x, &mut moved);
        moved
    }

    fn best(&self, fit: &Fit) -> Best {
        Best {
            offsets: fit.x.iter().copied().collect(),
            design: self.moved_design(&fit.x),
            after: self.fulfilment(&fit.evaluation),
            identifiability: self.identifiability(fit),
            constraints: self.outcomes(fit),
            values: self.values(&fit.x),
            holding: self.holding_bounds(fit),
            errors: self.errors(fit),
        }
    }

    /// Smallest and largest value of each target at its stations, in the nominal design moved to `x`.
    fn values(&self, x: &DVector<f64>) -> Option<Vec<[f64; 2]>> {
        let nominal = self.optimise.nominal();
        let layout = TargetLayout::of(&nominal, self.vehicle).of_values();
        let mut problem = self.problem_of(&nominal, &layout);
        let mut values = Linearisation::new(layout.residuals(), x.len());
        LeastSquares::evaluate(&mut problem, x, &mut values).ok()?;
        values.check().ok()?;
        let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; nominal.targets.len()];
        for (target, value) in layout.targets_of_rows().into_iter().zip(&values.residuals) {
            let [low, high] = &mut ranges[target];
            (*low, *high) = (low.min(*value), high.max(*value));
        }
        Some(ranges)
    }

    /// Finds the bounds that hold the misfit, under the conditions of [`Best::holding`].
    fn holding_bounds(&self, fit: &Fit) -> Option<Vec<HoldingBound>> {
        let of_rows = self.layout.targets_of_rows();
        Minimum::of(fit, &of_rows, &self.bounds, &mut self.problem())
    }

    /// Returns the directions that the targets determine at a fit. Tests the directions without effect on the targets: moves the
    /// design along them until the misfit rises or a constraint is violated.
    fn identifiability(&self, fit: &Fit) -> Identifiability {
        let mut problem = self.problem();
        let shape = problem.shape();
        let mut at = Assessment::new(&shape);
        let violation = |row: usize, value: f64| self.layout.violation(row, value);
        // If the design violates a constraint, the move must not increase the violation.
        let mut most = vec![MOVED_KEPT; shape.rows];
        let mut kept = DMatrix::zeros(0, shape.variables);
        if shape.rows > 0 && problem.assess(&fit.x, &mut at).is_ok() {
            kept = at.rows.jacobian.rows(0, shape.equalities).into_owned();
            for (row, most) in most.iter_mut().enumerate() {
                *most = most.max(violation(row, at.rows.residuals[row]));
            }
        }
        let mut found = Identifiability::keeping(&fit.evaluation, &kept, &self.bounds, UNSEEN);
        for direction in found.unseen.iter_mut().take(TRIED_OUT) {
            direction.try_out(&fit.x, fit.misfit(), &self.bounds, |x| {
                if self.control.is_interrupted() {
                    return None;
                }
                problem.assess(x, &mut at).ok()?;
                let mut rows = at.rows.residuals.iter().enumerate();
                let is_kept = rows.all(|(row, value)| violation(row, *value) <= most[row]);
                is_kept.then(|| at.goal.misfit())
            });
        }
        found
    }

    /// Standard errors of a fit. `None` under the conditions of [`Best::errors`].
    fn errors(&self, fit: &Fit) -> Option<StandardErrors> {
        if !self.optimise.fit || !fit.termination.at_minimum() || fit.constraints.is_some() {
            return None;
        }
        let of = self.layout.targets_of_rows();
        let weights: Vec<f64> = of.iter().map(|target| self.layout.share(*target)).collect();
        let mut problem = self.problem();
        let evaluate = |x: &DVector<f64>, into: &mut Linearisation| {
            LeastSquares::evaluate(&mut problem, x, into).is_ok() && into.check().is_ok()
        };
        StandardErrors::of(&fit.x, &fit.evaluation, &self.bounds, &weights, evaluate)
    }

    /// Returns the outcome for each constraint.
    fn outcomes(&self, fit: &Fit) -> Vec<ConstraintOutcome> {
        let Some(state) = &fit.constraints else {
            return Vec::new();
        };
        let mut problem = self.problem();
        let mut at = Assessment::new(&problem.shape());
        let margins = problem.get_mut().margins(&fit.x, &mut at);
        let margins = margins.unwrap_or_else(|_| self.layout.margins(state.values.as_slice(), &[]));
        let outcome = |(number, own): (usize, Margin)| ConstraintOutcome {
            margin: own.margin,
            at: own.at,
            is_upper: own.is_upper,
            price: self.price(fit, state, number),
        };
        margins.into_iter().enumerate().map(outcome).collect()
    }

    /// Returns the price of a constraint's limits.
    fn price(&self, fit: &Fit, state: &ConstraintState, number: usize) -> Price {
        let layout = self.layout;
        let labels = layout.labels().iter().enumerate();
        let own = labels.filter(|(_, label)| label.constraint == number);
        let rows: Vec<usize> = own.map(|(row, _)| row).collect();
        let visible = self.optimise.constraints[number].visible();
        let values = state.values.as_slice();
        let limits = rows.iter().filter_map(|row| {
            let violation = |row, value| layout.violation(row, value);
            Limit::of_row(*row, layout.other_component(*row), values, violation)
        });
        Price::of(fit, limits, visible)
    }

    /// Indices of constraints with a violated row that no variable changes.
    fn unmoved_constraints(&self, fit: &Fit) -> Vec<usize> {
        let labels = self.layout.labels().iter();
        let of_rows: Vec<usize> = labels.map(|label| label.constraint).collect();
        unmoved_constraints(fit, &of_rows, |row, value| {
            self.layout.violation(row, value)
        })
    }

    /// Missed targets on which the variables have too little effect at all evaluated points.
    fn unmoved(&self, best: &Best, end: &Linearisation, seen: &[&Linearisation]) -> Unmoved {
        let residuals = Residuals {
            of_rows: &self.layout.targets_of_rows(),
            seen,
            bounds: &self.bounds,
        };
        let deviations = best.after.targets.iter().map(|deviation| deviation.rms);
        residuals.unmoved(&deviations.collect::<Vec<_>>(), end)
    }

    /// Indices of constraints that cannot be satisfied together.
    fn contradiction(&self, starts: &Multistart) -> Vec<usize> {
        let labels = self.layout.labels().iter();
        let of_rows: Vec<usize> = labels.map(|label| label.constraint).collect();
        let count = self.optimise.constraints.len();
        smallest_conflict(starts, &of_rows, count, |constraints| {
            let kept = constraints.iter();
            let kept = kept.map(|c| self.optimise.constraints[*c].clone());
            let some = Optimise {
                constraints: kept.collect(),
                // Constraints apply to the nominal design, so the tuning with some of them needs no builds.
                ..self.optimise.nominal()
            };
            let layout = TargetLayout::of(&some, self.vehicle);
            let problem = || self.problem_of(&some, &layout);
            is_satisfied_from(starts, &self.bounds, self.control, problem)
        })
    }
}
