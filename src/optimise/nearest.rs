//! Of all designs that are good enough, the nearest.

use super::constrained::{Assessment, Constrained, Shape};
use super::{Bounds, Evaluation, Infeasible};
use nalgebra::DVector;

/// A problem's goal held to a level, and the move from the design as the goal.
pub(super) struct NearDesign<'a, P> {
    problem: P,
    /// One over the range, times the root of the cost, by variable.
    weights: DVector<f64>,
    design: &'a DVector<f64>,
    level: f64,
    assessment: Assessment,
}

impl<'a, P: Constrained> NearDesign<'a, P> {
    /// Holds the misfit of a problem to `misfit`; `costs` weigh the moves of the variables.
    pub fn new(
        problem: P,
        bounds: &Bounds,
        design: &'a DVector<f64>,
        costs: &[f64],
        misfit: f64,
    ) -> Self {
        let shape = problem.shape();
        let weights = bounds.width().iter().zip(costs);
        let weights: Vec<f64> = weights.map(|(width, cost)| cost.sqrt() / width).collect();
        NearDesign {
            level: misfit * (shape.goal as f64).sqrt(),
            weights: weights.into(),
            design,
            assessment: Assessment::new(shape, bounds.variables()),
            problem,
        }
    }
}

impl<P: Constrained> Constrained for NearDesign<'_, P> {
    fn variables(&self) -> usize {
        self.design.len()
    }

    fn shape(&self) -> Shape {
        let of = self.problem.shape();
        Shape {
            goal: self.design.len(),
            level: of.goal,
            ..of
        }
    }

    fn level(&self) -> f64 {
        self.level
    }

    fn assess(&mut self, x: &DVector<f64>, into: &mut Assessment) -> Result<(), Infeasible> {
        self.problem.assess(x, &mut self.assessment)?;
        std::mem::swap(&mut into.level, &mut self.assessment.goal);
        std::mem::swap(&mut into.rows, &mut self.assessment.rows);
        let Evaluation {
            residuals,
            jacobian,
        } = &mut into.goal;
        jacobian.fill(0.0);
        for (j, weight) in self.weights.iter().enumerate() {
            residuals[j] = weight * (x[j] - self.design[j]);
            jacobian[(j, j)] = *weight;
        }
        Ok(())
    }
}
