//! `hardpoint optimise` of a car.

use super::super::exit::{Exit, Stop};
use super::super::optimise::{say_holding, say_side_effects};
use super::super::output::{Output, pool};
use super::super::{CurveArguments, interrupt};
use super::{headline, keep, open, page, solver};
use crate::optimise::Control;
use crate::report::{
    CarConstraintRecord, CarResults, CarTargetRecord, CarTuningRecord, CarVariableRecord,
    CarVerdict, StartSummary, car_constraints_table, car_targets_json, car_targets_table,
    car_variables_table, interrupted_in_words, misfit_table, optimised_car, side_effects_in_words,
    side_effects_table, starts_in_words, starts_table,
};
use crate::side_effects::{SideEffect, side_effects_of_car};
use crate::study::{CarStudy, TunedCar};
use serde_json::{Value, json};

/// Names of the tuned studies: the car, its front axle and its rear axle.
const TUNED_NAMES: [&str; 3] = [
    "optimised.toml",
    "optimised_front.toml",
    "optimised_rear.toml",
];

pub(in crate::cli) fn optimise(curves: &CurveArguments, with_prices: bool) -> Result<Exit, Stop> {
    if with_prices {
        return Err(Stop::wrong_input(
            "--prices is not available for a car, because the tuning of a car always searches for the smallest misfit",
        ));
    }
    let arguments = &curves.run;
    let path = &arguments.study.study;
    let study = CarStudy::read(path, &arguments.study.set)?;
    let Some(wanted) = &study.optimise else {
        return Err(Stop::no_section(path, "optimise", "variables and targets"));
    };
    let pool = pool(arguments.threads, wanted.run.starts as u64)?;
    let mut own_solver = solver(&study, path)?;
    let output = open(curves, &study, "optimise")?;
    let before = CarResults::solve(&study, &mut own_solver, study.cases.len());
    interrupt::stops_by_itself();
    let control = Control {
        interrupt: Some(interrupt::flag()),
        ..Control::default()
    };
    let unsolved = |why| Stop::unsolved(path, why);
    let tuned = pool.install(|| study.tuned(wanted, control));
    let tuned = tuned.map_err(unsolved)?;
    let [text, front, rear] = optimised_car(&study, &tuned.study.car, tuned.fit.x.as_slice());
    let [front_study, rear_study] = &study.axles;
    let texts = [
        text,
        output.text_here(front_study, front),
        output.text_here(rear_study, rear),
    ];
    let is_interrupted = interrupt::is_raised();
    if is_interrupted {
        // A signal has ended the tuning early. So the program writes the tuned design now, before it computes anything else.
        output.mark_interrupted();
        write_studies(&output, &texts)?;
    }
    let mut tuned_solver = solver(&tuned.study, path)?;
    let after = CarResults::solve(&tuned.study, &mut tuned_solver, tuned.study.cases.len());
    let effects = side_effects_of_car(&study, &tuned.study);
    let x = tuned.fit.x.as_slice();
    let prices = &tuned.tuning.prices;
    let results = TuningResults {
        study: &study,
        tuned: &tuned,
        before: &before,
        after: &after,
        texts: &texts,
        targets: after.target_records(wanted, &before, x),
        constraints: after.constraint_records(wanted, &before, x, prices),
        variables: after.variable_records(&study, &tuned.fit),
        starts: StartSummary::all(&tuned.tuning.starts),
        effects: effects.map_err(unsolved)?,
        is_interrupted,
    };
    let mut files = results.write(&output)?;
    files.extend(keep(&output, &study)?);
    let mut remarks = after.warnings();
    remarks.extend(results.interruption());
    remarks.extend(results.verdict().remarks());
    let mut record = after.record("optimise", &mut tuned_solver, None, &remarks);
    record.targets.clone_from(&results.targets);
    record.side_effects.clone_from(&results.effects);
    record.tuning = Some(results.record());
    let with_page = arguments.report && !is_interrupted;
    files.extend(page(&output, record, &files, with_page)?);
    output.finish()?;
    let exit = results.say(&output)?;
    output.print_files(&files)?;
    Ok(exit)
}

/// Results of a tuning.
struct TuningResults<'a> {
    study: &'a CarStudy,
    tuned: &'a TunedCar,
    before: &'a CarResults<'a>,
    after: &'a CarResults<'a>,
    /// Texts of the tuned studies, in the order of [`TUNED_NAMES`].
    texts: &'a [String; 3],
    targets: Vec<CarTargetRecord>,
    constraints: Vec<CarConstraintRecord>,
    variables: Vec<CarVariableRecord>,
    starts: Vec<StartSummary>,
    effects: Vec<SideEffect>,
    is_interrupted: bool,
}

impl TuningResults<'_> {
    /// Writes the files of the results and returns their names.
    fn write(&self, output: &Output) -> Result<Vec<&'static str>, Stop> {
        let fit = &self.tuned.fit;
        output.main_csv(TUNED_NAMES[0], self.texts[0].as_bytes())?;
        let mut files = write_studies(output, self.texts)?;
        output.file("cases.csv", &self.after.cases_csv())?;
        output.file("cases_before.csv", &self.before.cases_csv())?;
        let tuning = &self.tuned.tuning;
        let [interrupted, starts] = tuning.interrupted();
        let mut summary = json!({
            "command": "optimise",
            "study": self.study.name,
            "misfit_before": tuning.misfit_before,
            "misfit": fit.misfit(),
            "ended": fit.ended(),
            "iterations": fit.history.len().saturating_sub(1),
            "evaluations": fit.evaluations(),
            "starts": starts,
            "interrupted_starts": interrupted,
            "best_start": tuning.starts.best,
            "start_results": self.starts,
            "variables": self.variables,
            "targets": car_targets_json(&self.targets),
            "constraints": self.constraints,
            "contradiction": self.verdict().contradiction(),
            "side_effects": self.effects,
        });
        if let (Some(all), Value::Object(more)) = (summary.as_object_mut(), self.verdict().json()) {
            all.extend(more);
        }
        output.json("summary.json", &summary)?;
        files.extend(["cases.csv", "cases_before.csv", "summary.json"]);
        let effects = &self.effects;
        let csv = (!effects.is_empty()).then(|| side_effects_table(effects).csv(None).into_bytes());
        files.extend(output.file_if_any("side_effects.csv", csv)?);
        Ok(files)
    }

    fn verdict(&self) -> CarVerdict<'_> {
        CarVerdict {
            study: self.study,
            targets: &self.targets,
            constraints: &self.constraints,
            tuning: &self.tuned.tuning,
        }
    }

    /// Data of the tuning for the report page: misfit, variables, constraints, and results of the starts (searches from different
    /// designs).
    fn record(&self) -> CarTuningRecord {
        let fit = &self.tuned.fit;
        CarTuningRecord {
            misfits: [self.tuned.tuning.misfit_before, Some(fit.misfit())],
            ended: fit.ended(),
            variables: self.variables.clone(),
            constraints: self.constraints.clone(),
            starts: self.starts.clone(),
            best_start: self.tuned.tuning.starts.best,
        }
    }

    /// Describes the completed part of an interrupted tuning. `None` for a complete tuning.
    fn interruption(&self) -> Option<String> {
        self.is_interrupted
            .then(|| interrupted_in_words(self.tuned.tuning.interrupted()))
    }

    fn say(&self, output: &Output) -> Result<Exit, Stop> {
        let (tuning, fit) = (&self.tuned.tuning, &self.tuned.fit);
        let words = side_effects_in_words(&self.effects).map(|words| format!("; {words}"));
        output.say(&format!(
            "{}\nmisfit {} tolerances{}; {}\n\n",
            headline(self.study),
            self.record().misfits_in_words(),
            words.unwrap_or_default(),
            fit.ended()
        ))?;
        output.table_for_programs("misfit", || {
            misfit_table(tuning.misfit_before, Some(fit.misfit()))
        });
        let verdict = self.verdict();
        output.table("targets", &car_targets_table(&self.targets))?;
        output.text_only("\n")?;
        let missed = verdict.missed();
        for line in &missed {
            output.say(&format!("  {line}\n"))?;
        }
        if !missed.is_empty() {
            output.text_only("\n")?;
        }
        say_holding(output, &verdict.holding().unwrap_or_default())?;
        if let Some(table) = car_constraints_table(&self.constraints) {
            output.table("constraints", &table)?;
            output.text_only("\n")?;
        }
        output.table("variables", &car_variables_table(&self.variables))?;
        say_side_effects(output, &self.effects)?;
        output.say_remarks(verdict.remarks())?;
        self.say_starts(output)?;
        if let Some(words) = self.interruption() {
            output.say_failure(&format!("\n{words}\n"))?;
            return Ok(Exit::Interrupted);
        }
        Ok(Exit::of(
            fit.termination.at_minimum() && !tuning.falls_short(),
        ))
    }

    /// Prints the results of the starts (searches from different designs). In text format, prints them only if there are
    /// several starts.
    fn say_starts(&self, output: &Output) -> Result<(), Stop> {
        let best = self.tuned.tuning.starts.best;
        let words = starts_in_words(&self.starts, best, self.tuned.fit.misfit());
        if self.starts.len() < 2 && output.is_text() {
            return Ok(());
        }
        output.text_only("\n")?;
        match words.filter(|_| output.is_text()) {
            Some(words) => output.say(&format!("{words}; summary.json has all starts\n")),
            None => output.table("starts", &starts_table(&self.starts, best)),
        }
    }
}

/// Writes the tuned studies and returns their names.
fn write_studies(output: &Output, texts: &[String; 3]) -> Result<Vec<&'static str>, Stop> {
    for (name, text) in TUNED_NAMES.into_iter().zip(texts) {
        output.file(name, text.as_bytes())?;
    }
    Ok(TUNED_NAMES.to_vec())
}
