//! Targets and constraints about one design, with their Jacobians, where nothing is tuned.

use super::{
    Assessment, Constrained, Infeasible, LeastSquares, Linearisation, Objective, TargetLayout,
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
) -> Result<Result<Linearisation, Infeasible>, DesignFault> {
    let mut objective = Objective::new(suspension, variables, layout)?;
    let mut evaluation = Linearisation::new(objective.residuals(), offsets.len());
    let x = DVector::from_column_slice(offsets);
    let evaluated = objective.evaluate(&x, &mut evaluation);
    Ok(evaluated.map(|()| evaluation))
}

/// Targets and constraints of the design itself, by these variables; or why it has none. An error says why the design itself
/// cannot be solved.
pub fn assessed(
    suspension: &Suspension,
    variables: &[Variable],
    layout: &TargetLayout,
) -> Result<Result<Assessment, Infeasible>, DesignFault> {
    assessed_at(suspension, variables, layout, &vec![0.0; variables.len()])
}

/// Targets and constraints with the variables at these offsets from the design; or why it has none. An error says why the
/// design itself cannot be solved.
pub fn assessed_at(
    suspension: &Suspension,
    variables: &[Variable],
    layout: &TargetLayout,
    offsets: &[f64],
) -> Result<Result<Assessment, Infeasible>, DesignFault> {
    let mut objective = Objective::new(suspension, variables, layout)?;
    let mut assessment = Assessment::new(&objective.shape());
    let x = DVector::from_column_slice(offsets);
    let assessed = objective.assess(&x, &mut assessment);
    Ok(assessed.map(|()| assessment))
}
