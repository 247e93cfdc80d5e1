//! Targets and constraints about one design, with their Jacobians, where nothing is tuned.

use super::{
    Assessment, Constrained, Evaluation, Infeasible, LeastSquares, Objective, TargetLayout,
};
use crate::mechanism::DesignFault;
use crate::model::Suspension;
use crate::study::Variable;
use nalgebra::DVector;

/// Deviations from the targets with the variables at these offsets from the design; or why it has none. An error says why
/// the design itself cannot be solved.
pub fn evaluated(
    suspension: &Suspension,
    variables: &[Variable],
    layout: &TargetLayout,
    offsets: &[f64],
) -> Result<Result<Evaluation, Infeasible>, DesignFault> {
    fn of<const N: usize>(
        mut objective: Objective<'_, N>,
        offsets: &[f64],
    ) -> Result<Evaluation, Infeasible> {
        let mut evaluation = Evaluation::new(objective.residuals(), offsets.len());
        let x = DVector::from_column_slice(offsets);
        objective.evaluate(&x, &mut evaluation).map(|()| evaluation)
    }
    Ok(match layout.rate_order() {
        0 => of(Objective::<1>::new(suspension, variables, layout)?, offsets),
        _ => of(Objective::<2>::new(suspension, variables, layout)?, offsets),
    })
}

/// Targets and constraints of the design itself, by these variables; or why it has none. An error says why the design itself
/// cannot be solved.
pub fn assessed(
    suspension: &Suspension,
    variables: &[Variable],
    layout: &TargetLayout,
) -> Result<Result<Assessment, Infeasible>, DesignFault> {
    fn of<const N: usize>(mut objective: Objective<'_, N>) -> Result<Assessment, Infeasible> {
        let shape = objective.shape();
        let mut assessment = Assessment::new(&shape);
        let here = DVector::zeros(shape.variables);
        objective
            .assess(&here, &mut assessment)
            .map(|()| assessment)
    }
    Ok(match layout.rate_order() {
        0 => of(Objective::<1>::new(suspension, variables, layout)?),
        _ => of(Objective::<2>::new(suspension, variables, layout)?),
    })
}
