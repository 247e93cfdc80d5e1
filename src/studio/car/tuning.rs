//! Tuning of a car that runs for the page.

use super::misfit::{assessed_rigs, misfit};
use super::{OpenedCar, coordinates, solver};
use crate::car::CarVariable;
use crate::report::{
    CarResults, CarVerdict, brief, misfit_in_words, settings_of_car, side_effects_in_words,
};
use crate::side_effects::side_effects_of_car;
use crate::studio::job::{ALL_LOCKED, Job, NO_SECTION, Tuning, counted_from_file};
use crate::studio::message::{Proposal, SideEffectRows, TuneRequest};
use crate::studio::rates::TunedRates;
use crate::study::{CarStudy, PathStep, TunedCar, ValueEdit};
use std::sync::Arc;

/// Tuning of a design of a car, ready to run.
pub(super) fn tuning(opened: &Arc<OpenedCar>, request: &TuneRequest) -> Result<Tuning, String> {
    let mut study = opened.moved(&request.of.design)?;
    let first = [0, study.car.axles[0].left.design.len()];
    let Some(mut optimise) = study.optimise.take() else {
        return Err(NO_SECTION.to_owned());
    };
    optimise.retain(|variable| {
        let mut points = variable.moves.points().iter();
        !points.any(|at| request.is_locked(first[at.axle] + at.point.0, at.axis as usize))
    });
    if optimise.variables.is_empty() {
        return Err(ALL_LOCKED.to_owned());
    }
    let mut remarks = Vec::new();
    for variable in &mut optimise.variables {
        remarks.extend(count_from_file(variable, &opened.study, &study));
    }
    study.optimise = Some(optimise);
    let opened = opened.clone();
    Ok(Box::new(move |job| run(job, &opened, &study, remarks)))
}

/// Shifts the range of a variable. Before, the range is relative to the design in the files; then it is relative to the design
/// on the page (`now`). Returns a note if the tuning may go beyond the range in the files.
pub(super) fn count_from_file(
    variable: &mut CarVariable,
    file: &CarStudy,
    now: &CarStudy,
) -> Option<String> {
    let moved = variable.moves.points().iter().map(|at| {
        let [was, is] = [file, now].map(|study| {
            let wheel = &study.car.axles[at.axle].left;
            wheel.frame.sign(at.axis) * wheel.design[at.point.0][at.axis]
        });
        (is - was) / at.factor
    });
    let moved: Vec<f64> = moved.collect();
    let name = variable.moves.label(&file.car);
    let (range, remark) = counted_from_file(&name, variable.range, &moved);
    variable.range = range;
    remark
}

fn run(
    job: &Job,
    opened: &OpenedCar,
    study: &CarStudy,
    remarks: Vec<String>,
) -> Result<Proposal, String> {
    let optimise = study.optimise.as_ref().ok_or(NO_SECTION)?;
    let before = misfit_of(opened, study);
    let tuned = job.controlled(|control| study.tuned(optimise, control))?;
    let verdict = verdict(study, &tuned)?;
    let (after, fit) = (tuned.study, tuned.fit);
    let x = fit.x.as_slice();
    let effects = side_effects_of_car(study, &after)?;
    let rates = rates(study, &after, x);
    let words = side_effects_in_words(&effects).map(|words| format!("; {words}"));
    let before = before.map_or(String::new(), |before| {
        format!("{} -> ", misfit_in_words(before))
    });
    let headline = format!(
        "misfit {before}{} tolerances{}",
        misfit_in_words(fit.misfit()),
        words.unwrap_or_default()
    );
    let mut outcome = vec![fit.ended()];
    if !fit.is_feasible() {
        outcome.push("Not every constraint can be satisfied within the ranges.".to_owned());
    }
    outcome.extend(verdict);
    Ok(Proposal {
        design: coordinates(&after),
        edits: rates.edits,
        origins: rates.origins,
        rates: rates.words,
        headline,
        side_effects: SideEffectRows::of(&effects),
        yields: None,
        remarks: [remarks, outcome].concat(),
        interrupted: job.is_cancelled(),
    })
}

/// Sentences about missed targets of a tuned car, and remarks on its tuning.
fn verdict(study: &CarStudy, tuned: &TunedCar) -> Result<Vec<String>, String> {
    let Some(optimise) = &study.optimise else {
        return Ok(Vec::new());
    };
    let solved = |study| {
        let mut solver = solver(study)?;
        Ok::<_, String>(CarResults::solve(study, &mut solver, study.cases.len()))
    };
    let (before, after) = (solved(study)?, solved(&tuned.study)?);
    let (x, tuning) = (tuned.fit.x.as_slice(), &tuned.tuning);
    let verdict = CarVerdict {
        study,
        targets: &after.target_records(optimise, &before, x),
        constraints: &after.constraint_records(optimise, &before, x, &tuning.prices),
        tuning,
    };
    Ok([verdict.missed(), verdict.remarks()].concat())
}

/// Misfit of a car's design. `None` without targets, and if a load case or an axle cannot be solved.
fn misfit_of(opened: &OpenedCar, study: &CarStudy) -> Option<f64> {
    let mut solver = solver(study).ok()?;
    let results = CarResults::solve(study, &mut solver, study.cases.len());
    let rigs = assessed_rigs(opened, study);
    misfit(study, &mut solver, &results, rigs)?.value
}

/// Changes that write the tuned rates and other tuned values of the car into the texts.
fn rates(study: &CarStudy, after: &CarStudy, x: &[f64]) -> TunedRates {
    let variables = study.optimise.iter().flat_map(|o| &o.variables).zip(x);
    let own = variables.filter(|(variable, value)| {
        variable.moves.points().is_empty() && variable.moves.value(&study.car) != Some(**value)
    });
    let (variables, x): (Vec<CarVariable>, Vec<f64>) = own
        .map(|(variable, value)| (variable.clone(), *value))
        .unzip();
    let words = variables.iter().zip(&x).map(|(variable, value)| {
        let now = variable
            .moves
            .value(&study.car)
            .map_or(String::new(), brief);
        [variable.moves.label(&study.car), now, brief(*value)]
    });
    let words = words.collect();
    let edits_at = |car, x: &[f64]| -> Vec<ValueEdit> {
        let settings = settings_of_car(study, car, &variables, x);
        settings.iter().filter_map(|own| edit(own)).collect()
    };
    let present = variables.iter().zip(&x);
    let present = present.map(|(own, tuned)| own.moves.value(&study.car).unwrap_or(*tuned));
    let now = edits_at(&study.car, &present.collect::<Vec<_>>());
    let edits = edits_at(&after.car, &x);
    let origin = |edit: &ValueEdit| {
        let own = now.iter().find(|now| now.path == edit.path);
        own.and_then(|own| own.value.clone()).unwrap_or_default()
    };
    TunedRates {
        origins: edits.iter().map(origin).collect(),
        edits,
        words,
    }
}

/// Converts `path=value` to an edit of the texts.
fn edit(setting: &str) -> Option<ValueEdit> {
    let (path, value) = setting.split_once('=')?;
    let document: toml::Table = format!("value = {value}").parse().ok()?;
    let value = serde_json::to_value(document.get("value")?).ok()?;
    let path = path.split('.').map(|step| PathStep::Key(step.to_owned()));
    Some(ValueEdit {
        path: path.collect(),
        value: Some(value),
    })
}
