//! Margins of the constraints of a tuning in one design.

use super::figure::brief;
use super::tuning_summary::ConstraintStatus;
use crate::mechanism::DesignFault;
use crate::optimise::{Margin, TargetLayout, assessed};
use crate::study::{Optimise, Study};
use serde::Serialize;

/// Margin of a constraint in one design.
#[derive(Serialize)]
pub(crate) struct ConstraintMargin {
    /// Name of the constraint, with its limits.
    pub name: String,
    /// Distance from the value to the nearest limit, in `unit`. Negative if the constraint is violated, NaN if a value is missing.
    pub margin: f64,
    /// Unit of `margin`.
    pub unit: String,
    /// True if the constraint is violated by more than rounding errors, or if the margin is NaN.
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
                is_violated: ConstraintStatus::of(margin / part.visible).is_violated(),
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
    let words = violated.map(
        |ConstraintMargin {
             name, margin, unit, ..
         }| {
            let missed = if margin.is_nan() {
                "which has no value".to_owned()
            } else {
                format!("missed by {} {unit}", brief(-margin))
            };
            format!(
                "the design violates a constraint, and the tuning starts there: {name}, {missed}"
            )
        },
    );
    Ok(words.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// A force that no member can carry has no value, so its margin is NaN.
    #[test]
    fn a_constraint_without_a_value_is_violated() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/macpherson_steering.toml");
        let study = Study::read(&path, &[]).unwrap();
        let optimise = study.optimise.as_ref().unwrap();
        let margins = [f64::NAN, 0.5, -0.5].map(|margin| Margin {
            margin,
            at: None,
            is_upper: false,
        });
        let found = constraint_margins(optimise, &margins);
        let violated: Vec<bool> = found.iter().map(|own| own.is_violated).collect();
        assert_eq!(violated, [true, false, true]);
    }
}
