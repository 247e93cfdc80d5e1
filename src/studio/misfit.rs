//! Misfit of a design and its exact gradient with respect to every coordinate.
//!
//! r are the residuals of the targets, and m is their number. J is the Jacobian of r with respect to the coordinates x. The
//! misfit is M = |r| / sqrt(m), so
//!
//! ```text
//! dM/dx = r . J / (m M)                                                     (1)
//! ```
//!
//! For one target, the n residuals are the deviations (as multiples of the tolerance) times a factor s. The gradient of the rms
//! deviation is
//!
//! ```text
//! d rms/dx = r . J / (s^2 n rms),    r and J of this target only           (2)
//! ```
//!
//! A misfit M of zero has no gradient. In this case, the gradient is given as zero, because the square of the misfit has its
//! minimum there.
//!
//! The page shows the misfit of the nominal design, even if a tuning lowers the misfit of builds (parts with random deviations).

use super::message::{Coordinates, Misfit, TargetMisfit};
use super::study_file::Opened;
use crate::mechanism::DesignFault;
use crate::optimise::{Assessed, TargetLayout, assessed};
use crate::report::constraint_margins;
use crate::study::{Optimise, Study};
use nalgebra::{DMatrix, DVector};
use std::borrow::Cow;

impl Opened {
    /// Stations at which the targets of a moved design are evaluated, if there are targets. The stations in `layout` contain the
    /// points of the right wheel. If the study gives the right wheel its own points, they move with the design, so this function
    /// makes the stations again.
    pub(super) fn layout_of(&self, moved: &Study) -> Option<Cow<'_, TargetLayout>> {
        let layout = self.layout.as_ref()?;
        let has_own = moved.axle().is_some_and(|both| both.axle.right.is_some());
        Some(match &moved.optimise {
            Some(optimise) if has_own => {
                Cow::Owned(TargetLayout::nominal(optimise, &moved.vehicle))
            }
            _ => Cow::Borrowed(layout),
        })
    }
}

/// Misfit of the design of a wheel or an axle. `None` if its study has no targets.
pub(super) fn misfit(opened: &Opened, study: &Study) -> Result<Option<Misfit>, DesignFault> {
    let (Some(optimise), Some(layout)) = (&study.optimise, opened.layout_of(study)) else {
        return Ok(None);
    };
    let found = assessed(study.wheel(), &opened.every, &layout)?;
    Ok(Some(match found {
        Ok(found) => of_assessment(study, optimise, &layout, &found),
        Err(infeasible) => Misfit {
            value: None,
            reason: Some(infeasible.to_string()),
            gradient: Vec::new(),
            targets: Vec::new(),
            constraints: Vec::new(),
        },
    }))
}

/// Misfit, deviations from targets, and margins of constraints of an assessed design. The columns of the Jacobian in `found` are
/// the coordinates of all points.
pub(super) fn of_assessment(
    study: &Study,
    optimise: &Optimise,
    layout: &TargetLayout,
    found: &Assessed,
) -> Misfit {
    let (drive, length) = (study.motion().drive, study.wheel().length_unit);
    let (residuals, jacobian) = (&found.goal.residuals, &found.goal.jacobian);
    let value = found.goal.misfit();
    let of_rows = layout.targets_of_rows();
    let all: Vec<usize> = (0..of_rows.len()).collect();
    let targets = layout.deviations(residuals).into_iter().enumerate();
    let targets = targets.map(|(number, deviation)| {
        let rows: Vec<usize> = all
            .iter()
            .copied()
            .filter(|r| of_rows[*r] == number)
            .collect();
        let share = layout.share(number);
        let target = &optimise.targets[number];
        TargetMisfit {
            column: target.of.column.clone(),
            rms: deviation.rms,
            worst: deviation.worst,
            worst_at: Some(target.printed_at(drive, deviation.worst_at)),
            worst_at_unit: target.unit_at(drive, length).to_owned(),
            gradient: gradient(
                residuals,
                jacobian,
                &rows,
                share * share * rows.len() as f64 * deviation.rms,
            ),
        }
    });
    Misfit {
        value: Some(value),
        reason: None,
        gradient: gradient(residuals, jacobian, &all, all.len() as f64 * value),
        targets: targets.collect(),
        constraints: constraint_margins(optimise, &found.margins),
    }
}

impl Misfit {
    /// Number of met targets and names of violated constraints, in short sentences for people. A target is met if its largest
    /// deviation is within its tolerance.
    pub(super) fn verdict(&self) -> String {
        if let Some(reason) = &self.reason {
            return format!("The design has no misfit: {reason}.");
        }
        let all = self.targets.len();
        let met = self.targets.iter().filter(|t| t.worst.abs() <= 1.0).count();
        let mut words = format!("{met} of {all} targets are within their tolerance.");
        for broken in self.constraints.iter().filter(|c| c.is_violated) {
            words += &format!(" Violated: {}.", broken.name);
        }
        words
    }
}

/// Product r . J of equations (1) and (2) of this module, summed over `rows` and divided by `divisor`, for each coordinate. 0 if
/// `divisor` is 0.
fn gradient(
    residuals: &DVector<f64>,
    jacobian: &DMatrix<f64>,
    rows: &[usize],
    divisor: f64,
) -> Coordinates {
    let along = |column: usize| match divisor {
        0.0 => 0.0,
        _ => {
            let terms = rows
                .iter()
                .map(|row| residuals[*row] * jacobian[(*row, column)]);
            terms.sum::<f64>() / divisor
        }
    };
    let points = 0..jacobian.ncols() / 3;
    points
        .map(|point| std::array::from_fn(|axis| along(3 * point + axis)))
        .collect()
}
