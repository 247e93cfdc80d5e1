//! Doubts about the targets of a tuning, and the constraints that a design violates.

use crate::mechanism::DesignFault;
use crate::optimise::{TargetLayout, assessed};
use crate::report::figure::brief;
use crate::study::{Limit, Optimise, Study, Target, Wanted};
use nalgebra::DVector;

/// Largest plausible span of a target's points, relative to that of its motion.
const SPAN: f64 = 4.0;
/// Violation below which a constraint counts as satisfied, in visible units such as a millimetre.
pub(crate) const VIOLATED: f64 = 1e-6;

/// Doubts about targets whose points span much more than their motion, one per line. Only a small part of their curve counts.
pub(super) fn target_doubts(study: &Study) -> Vec<String> {
    let targets = study.optimise.iter().flat_map(|o| &o.targets);
    targets
        .filter_map(|target| span_doubt(study, target))
        .collect()
}

fn span_doubt(study: &Study, target: &Target) -> Option<String> {
    let curve = |limit: &Option<Limit>| match limit {
        Some(Limit::Curve { points, .. }) => points.clone(),
        _ => Vec::new(),
    };
    let points = match &target.wanted {
        Wanted::Curve { points, .. } => points.clone(),
        Wanted::Band { lower, upper, .. } => [curve(lower), curve(upper)].concat(),
        Wanted::At { .. } | Wanted::Points(_) => return None,
    };
    let (drive, length) = (study.motion().drive, study.wheel().length_unit);
    let values = match (&target.site.axle, &target.site.motion) {
        (Some(site), _) => &site.values,
        (None, Some((_, motion))) => &motion.values,
        (None, None) => &study.motion().values,
    };
    let own = ends(points.iter().map(|[at, _]| *at))?;
    let moved = ends(values.iter().copied())?;
    let width = |[low, high]: [f64; 2]| high - low;
    if width(moved) == 0.0 || width(own) <= SPAN * width(moved) {
        return None;
    }
    let range = |ends: [f64; 2]| {
        let [low, high] = ends.map(|end| brief(target.printed_at(drive, end)));
        format!("{low} to {high}")
    };
    let unit = target.unit_at(drive, length);
    Some(format!(
        "please check: the points of the target {} run from {} {unit}, its motion only from {} {unit}. Are they in \
         another unit?",
        target.of.column,
        range(own),
        range(moved)
    ))
}

fn ends(values: impl Iterator<Item = f64> + Clone) -> Option<[f64; 2]> {
    let low = values.clone().reduce(f64::min)?;
    Some([low, values.reduce(f64::max)?])
}

/// Margin of a constraint in one design.
pub(crate) struct ConstraintMargin {
    /// Name, with the limits.
    pub name: String,
    /// Smallest margin to a limit in `unit`. Negative if the constraint is violated.
    pub room: f64,
    pub unit: String,
    pub is_violated: bool,
}

/// Smallest margin of each constraint over all stations at which it is checked.
pub(crate) fn constraint_margins(
    optimise: &Optimise,
    layout: &TargetLayout,
    rows: &DVector<f64>,
) -> Vec<ConstraintMargin> {
    let constraints = optimise.constraints.iter().enumerate();
    let room = |number: usize| {
        let labels = layout.labels().iter().enumerate();
        let own = labels.filter(|(_, label)| label.constraint == number);
        own.map(|(row, _)| layout.room(row, rows[row]))
            .fold(f64::INFINITY, f64::min)
    };
    constraints
        .map(|(number, constraint)| {
            let (room, part) = (room(number), &constraint.parts[0]);
            ConstraintMargin {
                name: constraint.name.clone(),
                room: room + 0.0,
                unit: part.unit.clone(),
                is_violated: room < -VIOLATED * part.visible,
            }
        })
        .collect()
}

/// Remarks on the constraints that the design of a study violates, one per line. A tuning may start outside its constraints. The
/// error says why the design cannot be solved.
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
    let margins = constraint_margins(optimise, &layout, &found.rows.residuals);
    let violated = margins.into_iter().filter(|own| own.is_violated);
    let words = violated.map(|own| {
        format!(
            "the design violates a constraint, and the tuning starts there: {}, missed by {} {}",
            own.name,
            brief(-own.room),
            own.unit
        )
    });
    Ok(words.collect())
}
