//! Moves of a car's points that leave its targets unchanged, to first order.
//!
//! d_t are the deviations from target t as multiples of the tolerance, n_t is their number, and w_t is the weight of the
//! target. N is the number of rows of all targets. The residuals are
//!
//! ```text
//! r = d_t sqrt(w_t N / (n_t sum w_t))                                                                             (1)
//! ```
//!
//! Their root mean square is the misfit of a tuning.

use super::{OpenedCar, overview::variable, solver, tuning::count_from_file};
use crate::car::{CarQuantity, CarVariable, RigGoals};
use crate::optimise::{Linearisation, TargetLayout, assessed};
use crate::studio::directions::unseen;
use crate::studio::message::{Designed, DirectionsAnswer, VariableOverview};
use crate::study::{CarOptimise, CarStudy};

/// One residual of equation (1) of this module without the factor sqrt(N / sum w_t), which all residuals share. The row has the
/// deviation times sqrt(w_t / n_t), and the derivatives of this product with respect to the variables.
type Row = (f64, Vec<f64>);

/// Combinations of the study's hardpoint variables that leave the targets unchanged, to first order.
pub(super) fn directions(opened: &OpenedCar, of: &Designed) -> Result<DirectionsAnswer, String> {
    let study = opened.moved(&of.design)?;
    let Some(optimise) = &study.optimise else {
        return Ok(DirectionsAnswer::none());
    };
    let all = &optimise.variables;
    // Variables that move no point, such as a spring rate, are left out.
    let straight: Vec<usize> = (0..all.len())
        .filter(|k| !all[*k].moves.points().is_empty())
        .collect();
    let Some(rows) = rows(&study, optimise)? else {
        return Ok(DirectionsAnswer::none());
    };
    let weights = optimise.targets.iter().map(|target| target.weight);
    let rigs = optimise.rigs.iter().flatten();
    let of_rigs = rigs.flat_map(|rig| rig.optimise.targets.iter().map(|target| target.weight));
    let weights: f64 = weights.chain(of_rigs).sum();
    let scale = (rows.len() as f64 / weights).sqrt();
    let mut goal = Linearisation::new(rows.len(), straight.len());
    for (number, (residual, slopes)) in rows.iter().enumerate() {
        goal.residuals[number] = scale * residual;
        for (column, k) in straight.iter().enumerate() {
            goal.jacobian[(number, column)] = scale * slopes[*k];
        }
    }
    let shown = |own: &CarVariable| variable(own, &study);
    let shown: Vec<VariableOverview> = straight.iter().map(|k| shown(&all[*k])).collect();
    let left = straight.iter().map(|k| {
        let mut own = all[*k].clone();
        count_from_file(&mut own, &opened.study, &study);
        own.range
    });
    let left: Vec<[f64; 2]> = left.collect();
    Ok(unseen(&goal, &shown, &left, of.design.len()))
}

/// Rows (residuals with derivatives) of all targets. `None` if a load case or a single axle has no solution.
fn rows(study: &CarStudy, optimise: &CarOptimise) -> Result<Option<Vec<Row>>, String> {
    let Some(mut rows) = of_cases(study, optimise)? else {
        return Ok(None);
    };
    for (end, goals) in optimise.rigs.iter().enumerate() {
        let Some(goals) = goals else { continue };
        let Some(own) = of_axle(study, end, goals, optimise.variables.len())? else {
            return Ok(None);
        };
        rows.extend(own);
    }
    Ok(Some(rows))
}

fn of_cases(study: &CarStudy, optimise: &CarOptimise) -> Result<Option<Vec<Row>>, String> {
    let mut solver = solver(study)?;
    let mut rows = Vec::new();
    for (number, case) in study.cases.iter().enumerate() {
        let own = optimise.targets.iter().filter(|t| t.case == number);
        let own: Vec<_> = own.collect();
        if own.is_empty() {
            continue;
        }
        let quantities: Vec<CarQuantity> = own.iter().map(|target| target.quantity).collect();
        let found = solver.solve(case);
        let found = found.and_then(|found| solver.gradients(case, &found, &quantities));
        let Ok(gradients) = found else {
            return Ok(None);
        };
        for (target, gradient) in own.into_iter().zip(&gradients) {
            let printed = target.quantity.info().unit;
            let printed = printed.printed_factor(study.car.length_unit);
            let factor = target.weight.sqrt() / target.tolerance;
            let deviation = target.deviation(printed * gradient.value);
            let is_inside = deviation == 0.0 && target.wanted[0] < target.wanted[1];
            let slope = |variable: &CarVariable| {
                if is_inside {
                    0.0
                } else {
                    factor * printed * variable.moves.slope(&study.car, gradient)
                }
            };
            let slopes = optimise.variables.iter().map(slope).collect();
            rows.push((factor * deviation, slopes));
        }
    }
    Ok(Some(rows))
}

/// Rows (residuals with derivatives) of the targets of a single axle. Each row has a derivative for each of the `variables`
/// variables of the car. `None` if the axle has no solution.
fn of_axle(
    study: &CarStudy,
    end: usize,
    goals: &RigGoals,
    variables: usize,
) -> Result<Option<Vec<Row>>, String> {
    let own = &study.axles[end];
    let wheel = own.wheel();
    let layout = TargetLayout::of(&goals.optimise, &own.vehicle);
    let found = assessed(wheel, &goals.optimise.variables, &layout)
        .map_err(|fault| fault.describe(&wheel.mechanism))?;
    let Ok(found) = found else {
        return Ok(None);
    };
    let of_rows = layout.targets_of_rows();
    let row = |(number, target): (usize, &usize)| {
        // `layout` gives each residual as the deviation times `share` of its target. So the factor contains a division by `share`.
        let count = of_rows.iter().filter(|other| *other == target).count() as f64;
        let weight = goals.optimise.targets[*target].weight;
        let factor = (weight / count).sqrt() / layout.share(*target);
        let mut slopes = vec![0.0; variables];
        for (column, k) in goals.columns.iter().enumerate() {
            slopes[*k] += factor * found.goal.jacobian[(number, column)];
        }
        (factor * found.goal.residuals[number], slopes)
    };
    Ok(Some(of_rows.iter().enumerate().map(row).collect()))
}
