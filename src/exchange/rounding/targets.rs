//! Misfit and constraints of designs whose hardpoints are rounded to a grid.

use super::{Candidate, MOST_TRIALS, Problem, missed};
use crate::number::Vector3;
use crate::optimise::{Linearisation, TargetLayout, assessed, evaluated};
use crate::report::{ConstraintMargin, constraint_margins};
use crate::study::{Optimise, Study, Variable};

/// Targets and constraints of a study as functions of all coordinates of its hardpoints.
pub(super) struct Targets<'a> {
    pub(super) study: &'a Study,
    pub(super) optimise: Optimise,
    pub(super) variables: Vec<Variable>,
    pub(super) layout: TargetLayout,
}

impl Targets<'_> {
    /// Residuals of the targets (deviations divided by tolerances) in a design, and their derivatives with respect to the
    /// coordinates.
    pub(super) fn evaluated(&self, design: &[Vector3<f64>]) -> Result<Linearisation, String> {
        let mut suspension = self.study.wheel().clone();
        suspension.design = design.to_vec();
        let here = vec![0.0; self.variables.len()];
        evaluated(&suspension, &self.variables, &self.layout, &here)
            .map_err(|fault| fault.describe(&suspension.mechanism))?
            .map_err(|infeasible| infeasible.to_string())
    }

    /// Misfit of a design, and margins of its constraints.
    pub(super) fn assessed(
        &self,
        design: &[Vector3<f64>],
    ) -> Result<(f64, Vec<ConstraintMargin>), String> {
        let mut suspension = self.study.wheel().clone();
        suspension.design = design.to_vec();
        // Without variables, the evaluation computes no derivatives.
        let found = assessed(&suspension, &[], &self.layout)
            .map_err(|fault| fault.describe(&suspension.mechanism))?
            .map_err(|infeasible| infeasible.to_string())?;
        let margins = constraint_margins(&self.optimise, &found.margins);
        Ok((found.goal.misfit(), margins))
    }

    /// Evaluates the design with its hardpoints rounded to the grid: `steps` has all coordinates in grid steps. `None` if this
    /// design cannot be solved.
    pub(super) fn candidate(&self, problem: &Problem<'_>, steps: Vec<f64>) -> Option<Candidate> {
        let design = problem.result(&steps, None).design;
        let (misfit, margins) = self.assessed(&design).ok()?;
        let constraints = margins.iter().zip(&self.optimise.constraints);
        Some(Candidate {
            violation: constraints
                .map(|(own, of)| missed(own) / of.visible())
                .sum(),
            misfit,
            margins,
            steps,
        })
    }

    /// Moves single coordinates and pairs of coordinates to their other neighbours on the grid while this improves the rounding.
    /// Ends if no such move is an improvement, or after [`MOST_TRIALS`] evaluated roundings.
    pub(super) fn improved(&self, problem: &Problem<'_>, mut best: Candidate) -> Candidate {
        let ends = |coordinate: usize| problem.neighbours(coordinate);
        let movable: Vec<usize> = (0..problem.before.len())
            .filter(|coordinate| problem.free[*coordinate])
            .filter(|coordinate| ends(*coordinate).0 < ends(*coordinate).1)
            .collect();
        let singles = movable.iter().map(|one| vec![*one]);
        let pairs = movable.iter().enumerate().flat_map(|(k, one)| {
            let others = movable[..k].iter();
            others.map(move |other| vec![*other, *one])
        });
        let flips: Vec<Vec<usize>> = singles.chain(pairs).collect();
        let (mut trials, mut since_improvement) = (0, 0);
        for flip in flips.iter().cycle() {
            if since_improvement == flips.len() || trials == MOST_TRIALS {
                break;
            }
            let mut steps = best.steps.clone();
            for coordinate in flip {
                let (least, most) = ends(*coordinate);
                steps[*coordinate] = least + most - steps[*coordinate];
            }
            (trials, since_improvement) = (trials + 1, since_improvement + 1);
            if let Some(other) = self.candidate(problem, steps)
                && other.is_better(&best)
            {
                (best, since_improvement) = (other, 0);
            }
        }
        best
    }
}
