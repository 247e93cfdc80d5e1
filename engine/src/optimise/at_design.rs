//! Targets and constraints of given designs, without tuning.

use super::{
    Assessment, Constrained, Deviation, Infeasible, LeastSquares, Linearisation, Margin, Objective,
    TargetLayout,
};
use crate::axle::Axle;
use crate::mechanism::DesignFault;
use crate::model::Suspension;
use crate::number::Vector3;
use crate::study::{Variable, Vehicle};
use nalgebra::DVector;

/// Targets and constraints at a design.
#[derive(Clone, Debug)]
pub struct Assessed {
    /// Residuals of the targets, with their derivatives.
    pub goal: Linearisation,
    /// Rows of the constraints, with their derivatives. If a value of a rigid wheel has a worse extreme near a station, the
    /// row contains the value at this extreme.
    pub rows: Linearisation,
    /// Smallest margin (distance to the limit) of each constraint along its motion.
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

/// Assessor of many designs, for a sweep. It computes deviations from targets and margins of constraints, but no derivatives
/// with respect to points.
pub(crate) struct DesignAssessor<'a> {
    objective: Objective<'a>,
    layout: &'a TargetLayout,
    /// Axle of the designs. `None` for one wheel.
    axle: Option<&'a Axle>,
    right: Vec<Vector3<f64>>,
    rates: DVector<f64>,
    assessment: Assessment,
}

impl<'a> DesignAssessor<'a> {
    /// Makes the assessor of a vehicle's designs. `rates` are the variables that are rates of elastic parts. An error says
    /// why the vehicle's own design cannot be solved.
    pub(crate) fn new(
        vehicle: &'a Vehicle,
        rates: &'a [Variable],
        layout: &'a TargetLayout,
    ) -> Result<Self, DesignFault> {
        let objective = Objective::new(vehicle.wheel(), rates, layout)?;
        Ok(DesignAssessor {
            assessment: Assessment::new(&objective.shape()),
            objective,
            layout,
            axle: match vehicle {
                Vehicle::Axle(both) => Some(&both.axle),
                Vehicle::Wheel(_) => None,
            },
            right: Vec::new(),
            rates: DVector::zeros(rates.len()),
        })
    }

    /// Returns the deviations from the targets and the margins of the constraints of a design. `left` contains the points of
    /// the wheel, or of the left wheel of an axle. `rates` contains the values of the variables that are rates.
    pub(crate) fn assess(
        &mut self,
        left: &[Vector3<f64>],
        rates: &[f64],
    ) -> Result<(Vec<Deviation>, Vec<Margin>), Infeasible> {
        self.right.clear();
        let right = self.axle.and_then(|axle| axle.right_design(left));
        self.right.extend(right.into_iter().flatten());
        self.rates.copy_from_slice(rates);
        let designs = [left, &self.right];
        let assessment = &mut self.assessment;
        let margins = (self.objective).margins_of_design(designs, &self.rates, assessment)?;
        let residuals = &self.assessment.goal.residuals;
        Ok((self.layout.deviations(residuals), margins))
    }
}
