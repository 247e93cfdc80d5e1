//! Targets and constraints at one given design, with their Jacobians, without tuning.

use super::{
    Assessment, Constrained, Infeasible, LeastSquares, Linearisation, Objective, TargetLayout,
};
use crate::mechanism::DesignFault;
use crate::model::Suspension;
use crate::study::Variable;
use nalgebra::DVector;

/// Returns the deviations from the targets at the design plus these offsets of the variables. If the deviations cannot be
/// computed, returns the reason. The outer error says why the design itself cannot be solved.
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

/// Returns targets and constraints of the design itself, with their derivatives with respect to these variables. If these
/// values cannot be computed, returns the reason. The outer error says why the design itself cannot be solved.
pub fn assessed(
    suspension: &Suspension,
    variables: &[Variable],
    layout: &TargetLayout,
) -> Result<Result<Assessment, Infeasible>, DesignFault> {
    assessed_at(suspension, variables, layout, &vec![0.0; variables.len()])
}

/// Returns targets and constraints at the design plus these offsets of the variables. If these values cannot be computed,
/// returns the reason. The outer error says why the design itself cannot be solved.
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
