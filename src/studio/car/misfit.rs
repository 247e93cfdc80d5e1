//! Misfit of a car and its exact gradient with respect to every coordinate of both axles.
//!
//! d_t is the deviation from target t as a multiple of the tolerance, and w_t is the weight of the target. For a target of a
//! single axle, d_t is the root mean square over the target's stations. M is the misfit, and x is a coordinate. Then
//!
//! ```text
//! M^2 = sum w_t d_t^2 / sum w_t          dM/dx = sum w_t d_t d d_t/dx / (M sum w_t)                              (1)
//! ```
//!
//! A misfit M of zero has no gradient. In this case, the gradient is given as zero, because the square of the misfit has its
//! minimum there.

use super::OpenedCar;
use crate::car::{
    AxleParameter, CarGradient, CarQuantity, CarSolver, CarTarget, Case, NoEquilibrium, Parameter,
    RigGoals,
};
use crate::optimise::{TargetLayout, VIOLATED, assessed};
use crate::report::{CarResults, CarState, ConstraintMargin};
use crate::studio::message::{Coordinates, Misfit, TargetMisfit};
use crate::studio::misfit::of_assessment;
use crate::study::{CarOptimise, CarStudy};

/// Deviation from a target, with the weight of the target in the misfit.
pub(super) struct Weighed {
    target: TargetMisfit,
    weight: f64,
}

/// Deviations from targets, and margins of constraints.
type Found = (Vec<Weighed>, Vec<ConstraintMargin>);

/// Deviations and margins of the front and the rear axle alone. `None` for an axle without targets and constraints. An error is
/// the reason in words why the axle cannot be solved.
pub(super) type Rigs = [Option<Result<Found, String>>; 2];

/// Evaluates the targets and constraints that belong to a single axle, for each axle. They need no load case.
pub(super) fn assessed_rigs(opened: &OpenedCar, study: &CarStudy) -> Rigs {
    [0, 1].map(|end| {
        let goals = study.optimise.as_ref()?.rigs[end].as_ref()?;
        Some(of_axle(opened, study, end, goals))
    })
}

/// Misfit of a car's design. `None` if its study has no `[optimise]`. `rigs` has the evaluated targets of the single axles.
pub(super) fn misfit<'s>(
    study: &'s CarStudy,
    solver: &mut CarSolver<'s>,
    results: &CarResults<'s>,
    rigs: Rigs,
) -> Option<Misfit> {
    let optimise = study.optimise.as_ref()?;
    let found = of_cases(study, optimise, solver, results).and_then(|mut found| {
        for rig in rigs.into_iter().flatten() {
            let (targets, constraints) = rig?;
            found.0.extend(targets);
            found.1.extend(constraints);
        }
        Ok(found)
    });
    Some(match found {
        Ok((targets, constraints)) => summed(targets, constraints),
        Err(reason) => Misfit {
            value: None,
            reason: Some(reason),
            gradient: Vec::new(),
            targets: Vec::new(),
            constraints: Vec::new(),
        },
    })
}

/// Misfit of all targets with its gradient, by equation (1) of this module.
fn summed(targets: Vec<Weighed>, constraints: Vec<ConstraintMargin>) -> Misfit {
    let weights: f64 = targets.iter().map(|own| own.weight).sum();
    let squares = targets
        .iter()
        .map(|own| own.weight * own.target.rms.powi(2));
    let value = (squares.sum::<f64>() / weights).sqrt();
    let points = targets.first().map_or(0, |own| own.target.gradient.len());
    let along = |point: usize, axis: usize| match value * weights {
        0.0 => 0.0,
        divisor => {
            let terms = targets
                .iter()
                .map(|own| own.weight * own.target.rms * own.target.gradient[point][axis]);
            terms.sum::<f64>() / divisor
        }
    };
    Misfit {
        value: Some(value),
        reason: None,
        gradient: (0..points)
            .map(|point| std::array::from_fn(|axis| along(point, axis)))
            .collect(),
        targets: targets.into_iter().map(|own| own.target).collect(),
        constraints,
    }
}

/// Name of a target of a load case: result and load case.
pub(super) fn name_of(target: &CarTarget, study: &CarStudy) -> String {
    let case = &study.cases[target.case].name;
    format!("{} in {case}", target.quantity.name())
}

/// Name of a target or a constraint of a single axle (`end` is 0 for the front, 1 for the rear).
pub(super) fn name_on_rig(name: &str, end: usize) -> String {
    format!("{name} of the {} axle", crate::car::AXLE_NAMES[end])
}

/// Deviations from the targets of the load cases, and margins of their constraints. Returns an error if a load case that they
/// need has no equilibrium.
fn of_cases<'s>(
    study: &'s CarStudy,
    optimise: &CarOptimise,
    solver: &mut CarSolver<'s>,
    results: &CarResults<'s>,
) -> Result<Found, String> {
    let failed = |case: &Case, why: &NoEquilibrium| {
        format!("case {}: {}", case.name, why.describe(&study.car))
    };
    let mut targets: Vec<Option<Weighed>> = optimise.targets.iter().map(|_| None).collect();
    for (number, case) in study.cases.iter().enumerate() {
        let own = (0..targets.len()).filter(|k| optimise.targets[*k].case == number);
        let own: Vec<usize> = own.collect();
        if own.is_empty() {
            continue;
        }
        let found = match &results.states[number] {
            CarState::Solved { found, .. } => found,
            CarState::Failed(why) => return Err(failed(case, why)),
        };
        let quantities: Vec<CarQuantity> =
            own.iter().map(|k| optimise.targets[*k].quantity).collect();
        let gradients = solver.gradients(case, found, &quantities);
        let gradients = gradients.map_err(|why| failed(case, &why))?;
        for (k, gradient) in own.into_iter().zip(&gradients) {
            let target = &optimise.targets[k];
            targets[k] = Some(of_target(target, study, gradient));
        }
    }
    let mut constraints = Vec::new();
    for own in &optimise.constraints {
        let case = &study.cases[own.case];
        let value = match &results.states[own.case] {
            CarState::Solved { solved, .. } => own.quantity.printed(solved, case),
            CarState::Failed(why) => return Err(failed(case, why)),
        };
        let value = value.ok_or_else(|| format!("{} has no value in {}", own.name, case.name))?;
        let margin = own.margin(value);
        constraints.push(ConstraintMargin {
            name: own.name.clone(),
            margin,
            unit: own.quantity.info().unit.suffix(study.car.length_unit),
            is_violated: margin < -VIOLATED * own.visible,
        });
    }
    Ok((targets.into_iter().flatten().collect(), constraints))
}

/// Deviation from a target of a load case, with its gradient. Such a target has only one deviation, so the root mean square is the
/// absolute value of this deviation.
fn of_target(target: &CarTarget, study: &CarStudy, gradient: &CarGradient) -> Weighed {
    let length = study.car.length_unit;
    let factor = target.quantity.info().unit.printed_factor(length);
    let deviation = target.deviation(factor * gradient.value) / target.tolerance;
    let sign = match deviation {
        0.0 => 0.0,
        _ => deviation.signum(),
    };
    let by_points = by_coordinates(study, gradient).into_iter();
    let slopes = by_points.map(|own| own.map(|by| sign * factor * by / target.tolerance));
    Weighed {
        weight: target.weight,
        target: TargetMisfit {
            column: name_of(target, study),
            rms: deviation.abs(),
            worst: deviation,
            worst_at: None,
            worst_at_unit: study.cases[target.case].name.clone(),
            gradient: slopes.collect(),
        },
    }
}

/// Derivatives of a result (in internal units, not printed units) with respect to every coordinate of the page. If the
/// study gives the wheelbase, the rear axle moves so that the wheelbase stays constant when wheel centres move.
pub(super) fn by_coordinates(study: &CarStudy, gradient: &CarGradient) -> Coordinates {
    let frame = study.frame();
    let offset = Parameter::Axle(1, AxleParameter::OffsetX).place();
    let by_offset = match study.wheelbase {
        Some(_) => gradient.parameters[offset],
        None => 0.0,
    };
    let axles = study.car.axles.iter().zip(&gradient.hardpoints);
    let axles = axles.zip([by_offset, -by_offset]);
    let points = axles.flat_map(|((axle, by), follows)| {
        let centre = axle.left.mechanism.wheel_centre.0;
        by.iter().enumerate().map(move |(point, by)| {
            let mut by = *by;
            if point == centre {
                by.x += follows;
            }
            frame.vector(by).to_array()
        })
    });
    points.collect()
}

/// Deviations from the targets of a single axle, and margins of its constraints.
fn of_axle(
    opened: &OpenedCar,
    study: &CarStudy,
    end: usize,
    goals: &RigGoals,
) -> Result<Found, String> {
    let own = &study.axles[end];
    let wheel = own.wheel();
    let layout = TargetLayout::of(&goals.optimise, &own.vehicle);
    let found = assessed(wheel, &opened.every[end], &layout)
        .map_err(|fault| fault.describe(&wheel.mechanism))?
        .map_err(|why| name_on_rig(&why.to_string(), end))?;
    let misfit = of_assessment(own, &goals.optimise, &layout, &found);
    let points = study.axles.each_ref().map(|axle| axle.wheel().design.len());
    // The axes of the rear axle's study may differ from the axes of the front study, which the page uses.
    let turned = |by: [f64; 3]| {
        study
            .frame()
            .vector(wheel.frame.vector(by.into()))
            .to_array()
    };
    let goals = misfit.targets.into_iter().zip(&goals.optimise.targets);
    let targets = goals.map(|(target, goal)| {
        let mut gradient = vec![[0.0; 3]; points[0] + points[1]];
        for (into, by) in gradient[end * points[0]..].iter_mut().zip(target.gradient) {
            *into = turned(by);
        }
        Weighed {
            weight: goal.weight,
            target: TargetMisfit {
                column: name_on_rig(&target.column, end),
                gradient,
                ..target
            },
        }
    });
    let constraints = misfit.constraints.into_iter().map(|own| ConstraintMargin {
        name: name_on_rig(&own.name, end),
        ..own
    });
    Ok((targets.collect(), constraints.collect()))
}
