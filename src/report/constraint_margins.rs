//! Margins of the constraints of a tuning in one design.

use super::figure::brief;
use crate::mechanism::DesignFault;
use crate::optimise::{Margin, TargetLayout, VIOLATED, assessed};
use crate::study::{Optimise, Study};
use serde::Serialize;

/// Margin of a constraint in one design.
#[derive(Serialize)]
pub(crate) struct ConstraintMargin {
    /// Name, with the limits.
    pub name: String,
    /// Smallest margin to a limit in `unit`. Negative if the constraint is violated, NaN if a value is missing.
    pub margin: f64,
    /// Unit of the margin.
    pub unit: String,
    /// True if the constraint is violated by more than rounding errors.
    pub is_violated: bool,
}

/// Margins of the constraints of a study, with names and units for the user.
pub(crate) fn constraint_margins(optimise: &Optimise, margins: &[Margin]) -> Vec<ConstraintMargin> {
    let constraints = optimise.constraints.iter().zip(margins);
    constraints
        .map(|(constraint, Margin { margin, .. })| {
            let part = &constraint.parts[0];
            ConstraintMargin {
                name: constraint.name.clone(),
                margin: margin + 0.0,
                unit: part.unit.clone(),
                is_violated: *margin < -VIOLATED * part.visible,
            }
        })
        .collect()
}

/// Remarks on the constraints that the design of a study violates, one per line. A tuning may start outside its constraints. The
/// list is empty if the constraints cannot be computed along the motion. An error explains why the design cannot be solved.
pub fn violated_constraints(study: &Study) -> Result<Vec<String>, DesignFault> {
    let Some(optimise) = study
        .optimise
        .as_ref()
        .filter(|o| !o.constraints.is_empty())
    else {
        return Ok(Vec::new());
    };
    let layout = TargetLayout::nominal(optimise, &study.vehicle);
    let Ok(found) = assessed(study.wheel(), &optimise.variables, &layout)? else {
        return Ok(Vec::new());
    };
    let margins = constraint_margins(optimise, &found.margins);
    let violated = margins.into_iter().filter(|own| own.is_violated);
    let words = violated.map(|own| {
        format!(
            "the design violates a constraint, and the tuning starts there: {}, missed by {} {}",
            own.name,
            brief(-own.margin),
            own.unit
        )
    });
    Ok(words.collect())
}
