//! Targets and constraints at one given design, with their Jacobians, without tuning.

use super::{
    Assessment, Constrained, Infeasible, LeastSquares, Linearisation, Margin, Objective,
    TargetLayout,
};
use crate::mechanism::DesignFault;
use crate::model::Suspension;
use crate::study::Variable;
use nalgebra::DVector;

/// Targets and constraints at a design.
#[derive(Clone, Debug)]
pub struct Assessed {
    /// Residuals of the targets, with their derivatives.
    pub goal: Linearisation,
    /// Rows of the constraints, with their derivatives. If a value has an extreme between stations, the row contains the
    /// value at this extreme.
    pub rows: Linearisation,
    /// Smallest margin of each constraint.
    pub margins: Vec<Margin>,
}

/// Returns the deviations from the targets at the design plus these offsets of the variables. If the deviations cannot be
/// computed, returns the reason. The outer error gives the reason why the design cannot be solved at all.
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

/// Returns targets and constraints of the design itself, with their derivatives with respect to these variables, and the
/// margins of the constraints. If these values cannot be computed, returns the reason. The outer error gives the reason why
/// the design cannot be solved at all.
pub fn assessed(
    suspension: &Suspension,
    variables: &[Variable],
    layout: &TargetLayout,
) -> Result<Result<Assessed, Infeasible>, DesignFault> {
    let mut objective = Objective::new(suspension, variables, layout)?;
    let mut assessment = Assessment::new(&objective.shape());
    let margins = objective.margins(&DVector::zeros(variables.len()), &mut assessment);
    let Assessment { goal, rows, .. } = assessment;
    Ok(margins.map(|margins| Assessed {
        goal,
        rows,
        margins,
    }))
}

/// Returns targets and constraints at the design plus these offsets of the variables, as a tuning evaluates them. If these
/// values cannot be computed, returns the reason. The outer error gives the reason why the design cannot be solved at all.
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
