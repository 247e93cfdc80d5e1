//! Alternatives to the tuned design: the trade-off between a study's goals, and the price list (smallest misfit for each size of
//! the design change).

use super::constrained::{Constrained, KEPT};
use super::front::{Found, Tracer};
use super::multistart::fits;
use super::trade::Criterion;
use super::tune::{Tuner, TuningRequest};
use super::{Control, Fit, Tuning};
use crate::mechanism::DesignFault;
use crate::study::{Optimise, Scatter, Vehicle};
use nalgebra::DVector;

/// Limit for the misfit of each target outside the Pareto front, as a multiple of the target's misfit after the tuning of
/// all targets. If this limit is below one tolerance, the limit is one tolerance.
const AS_GOOD: f64 = 1.01;
/// Number of sizes of the design change for which a price list has the smallest misfit.
const STEPS: usize = 10;

/// A design that the user can choose.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Offsets of the variables, in the study's axes.
    pub offsets: Vec<f64>,
    /// Value of each criterion. For a Pareto front: misfits of the goals. For a price list: misfit of all targets, and size of
    /// the change. The size is the root of a sum over the variables: cost of the variable, times the square of (move / range).
    pub amounts: Vec<f64>,
    /// Weight of each criterion; the weights add up to 1. To reduce criterion i by one unit, criterion j must rise by (weight
    /// i / weight j) units. All are zero if there is no trade-off.
    pub weights: Vec<f64>,
}

/// The Pareto front of a study's goals.
#[derive(Clone, Debug, PartialEq)]
pub struct Front {
    /// Designs of the Pareto front, in the order of rising misfit of the first goal. No design is better than another in all
    /// goals.
    pub choices: Vec<Choice>,
    /// Indices of choices after which the Pareto front has a gap.
    pub breaks: Vec<usize>,
}

/// Computes the Pareto front of `[optimise] front`, starting from the tuned design. An error gives the reason why the
/// design cannot be solved at all.
pub fn front(
    vehicle: &Vehicle,
    optimise: &Optimise,
    tuning: &Tuning,
    control: Control<'_>,
) -> Result<Front, DesignFault> {
    let asked = TuningRequest::new(vehicle, optimise, control)?;
    Ok(Tuner::new(&asked)?.front(tuning))
}

/// Computes the least misfit for each size of change: about ten designs, from the study's own design to the design with the
/// least misfit. An error gives the reason why the design cannot be solved at all.
pub fn price_list(
    vehicle: &Vehicle,
    optimise: &Optimise,
    tuning: &Tuning,
    control: Control<'_>,
) -> Result<Vec<Choice>, DesignFault> {
    // If a study maximises the yield, the price list uses the misfits of the nominal design.
    let drawing = Optimise {
        scatter: optimise.scatter.clone().filter(Scatter::lowers_misfit),
        ..optimise.clone()
    };
    let asked = TuningRequest::new(vehicle, &drawing, control)?;
    Ok(Tuner::new(&asked)?.price_list(tuning))
}

impl Tuner<'_> {
    fn choice(&self, found: Found) -> Choice {
        Choice {
            offsets: found.x.iter().map(|x| x + 0.0).collect(),
            amounts: found.amounts,
            weights: found.weights,
        }
    }

    fn front(&self, tuning: &Tuning) -> Front {
        let (distance, options) = (self.distance(), self.options());
        let goals = &self.optimise.front;
        let ends = fits(&tuning.starts.starts).map(|(_, fit)| &fit.x);
        let starts: Vec<&DVector<f64>> = ends.chain([&self.design]).collect();
        let others: Vec<usize> = (0..self.optimise.targets.len())
            .filter(|target| !goals.iter().any(|goal| goal.targets.contains(target)))
            .collect();
        let tracer = |rest: Vec<(Criterion, f64)>| Tracer {
            problem: || self.problem(),
            bounds: &self.bounds,
            distance: &distance,
            aims: goals
                .iter()
                .map(|goal| self.layout.aim(&goal.targets))
                .collect(),
            rest,
            options: &options,
            control: self.control,
        };
        let aims: Vec<Criterion> = others.iter().map(|own| self.layout.aim(&[*own])).collect();
        let all = Tracer {
            aims: aims.clone(),
            ..tracer(Vec::new())
        };
        let best = tuning.starts.best_fit().and_then(|fit| all.amounts(&fit.x));
        let best = best.unwrap_or_else(|| vec![1.0; aims.len()]);
        let levels = best.iter().map(|best| (AS_GOOD * best).max(1.0));
        let rest = aims.into_iter().zip(levels).collect();
        let traced = tracer(rest).front(&starts, self.optimise.good_enough);
        Front {
            choices: traced
                .points
                .into_iter()
                .map(|found| self.choice(found))
                .collect(),
            breaks: traced.breaks,
        }
    }

    fn price_list(&self, tuning: &Tuning) -> Vec<Choice> {
        let (distance, options) = (self.distance(), self.options());
        let Some(best) = tuning.starts.best_fit() else {
            return Vec::new();
        };
        let tracer = Tracer {
            problem: || self.problem(),
            bounds: &self.bounds,
            distance: &distance,
            aims: vec![self.all_targets(), Criterion::movement()],
            rest: Vec::new(),
            options: &options,
            control: self.control,
        };
        let found = tracer.list(&self.design, &best.x, STEPS);
        let untraded = |x: &DVector<f64>| {
            tracer.amounts(x).map(|amounts| Found {
                x: x.clone(),
                weights: vec![0.0; amounts.len()],
                amounts,
            })
        };
        let unmoved = untraded(&self.design).filter(|_| self.keeps_constraints(best));
        // The price list also contains the tuned design, if this design satisfies the constraints.
        let kept = untraded(&best.x).filter(|_| best.is_feasible());
        let mut all: Vec<Found> = unmoved.into_iter().chain(found).collect();
        if let Some(kept) = kept {
            let place = all.partition_point(|other| other.amounts[1] < kept.amounts[1]);
            let near = |other: &Found| (other.amounts[1] - kept.amounts[1]).abs() < 1e-6;
            match all.iter().position(near) {
                Some(same) => {
                    // The tuned design has no weights of its own. So it takes the weights of the list's entry with nearly
                    // the same size of change.
                    let weights = std::mem::take(&mut all[same].weights);
                    all[same] = Found { weights, ..kept };
                }
                None => all.insert(place, kept),
            }
        }
        all.into_iter().map(|found| self.choice(found)).collect()
    }

    /// Returns true if the study's own design satisfies the constraints. Rows that no variable moves do not count, as in the
    /// best fit.
    fn keeps_constraints(&self, best: &Fit) -> bool {
        let mut problem = self.problem();
        let shape = problem.shape();
        let mut at = super::Assessment::new(&shape);
        let assessed = problem.assess(&self.design, &mut at);
        let counts = |row| best.constraints.as_ref().is_none_or(|own| own.counts(row));
        assessed.is_ok() && at.violation_of(shape.equalities, &[], counts) <= KEPT
    }
}
