//! `hardpoint optimise`: tunes the hardpoints until they meet the targets.

use super::OptimiseArguments;
use super::choices::Choices;
use super::exit::{Exit, Stop};
use super::output::{Output, design_fault, pool};
use super::report::ReportOptions;
use super::{interrupt, progress, terminal};
use crate::checked::{AllMotions, NamedCurves, not_solved};
use crate::in_motions::InMotion;
use crate::optimise::{Control, Tuning, tune};
use crate::report::{
    FrontRecord, HOLDING_NOTE, HoldingRecord, PriceRecord, Record, TuningSummary, counted,
    curves_csv, further_in_words, history_csv, holding_table, shown_holding, shown_side_effects,
    side_effects_table, variable_plausibility,
};
use crate::rig::RigTests;
use crate::side_effects::{SideEffect, side_effects};
use crate::solved::Solved;
use crate::study::{CarStudy, Optimise, Study, StudyErrors};
use crate::yields::{not_increased, yields};
use std::path::Path;

/// Largest number of printed moves of the points that hardly change the misfit. The page and `summary.json` contain all such
/// moves.
const MOST_DIRECTIONS: usize = 2;

/// Prints the result of a tuning: misfit, targets, variables and constraints.
pub(super) fn say_outcome(
    output: &Output,
    study: &Study,
    summary: &TuningSummary,
) -> Result<(), Stop> {
    output.say(&format!("{}: {}\n\n", study.name, summary.headline()))?;
    output.table_for_programs("misfit", || summary.misfit_table());
    if summary.has_design() {
        output.table("targets", &summary.targets_table())?;
        output.text_only(&format!("\n  {}\n", summary.deviations_in_words()))?;
        for (_, column, by) in summary.missed() {
            output.say(&format!("  missed: {column}, by up to {by}\n"))?;
        }
        output.text_only("\n")?;
        say_holding(output, summary.holding.as_deref().unwrap_or_default())?;
        output.table("variables", &summary.variables_table())?;
    }
    if let Some(table) = summary.constraints_table().filter(|_| summary.has_design()) {
        output.text_only("\n")?;
        output.table("constraints", &table)?;
    }
    say_side_effects(output, &summary.side_effects)?;
    output.say_remarks(summary.remarks())
}

/// Prints the bounds of variables that keep missed targets from their goals.
pub(super) fn say_holding(output: &Output, records: &[HoldingRecord]) -> Result<(), Stop> {
    if records.is_empty() {
        return Ok(());
    }
    output.table_for_programs("holding_bounds", || holding_table(records));
    let (shown, more) = shown_holding(records);
    output.text_only(&holding_table(&shown).text(terminal::width()))?;
    output.text_only(&format!("\n  {HOLDING_NOTE}\n"))?;
    if more > 0 {
        let words = counted(more, "further row");
        output.text_only(&format!("  {words} in summary.json\n"))?;
    }
    output.text_only("\n")
}

/// Prints the side effects of the tuning, flagged ones first.
pub(super) fn say_side_effects(output: &Output, effects: &[SideEffect]) -> Result<(), Stop> {
    if effects.is_empty() {
        return Ok(());
    }
    output.table_for_programs("side_effects", || side_effects_table(effects));
    if !output.is_text() {
        return Ok(());
    }
    let (shown, more) = shown_side_effects(effects);
    if !shown.is_empty() {
        output.say("\n")?;
        output.say(&side_effects_table(&shown).text(terminal::width()))?;
    }
    let more =
        (more > 0).then(|| format!("{} in side_effects.csv", counted(more, "further change")));
    for line in more.into_iter().chain(further_in_words(effects)) {
        output.say(&format!("\n  {line}\n"))?;
    }
    Ok(())
}

/// Prints the moves of points that hardly change the misfit, and the results of the starts (searches from different designs).
/// `refused` holds the errors for which other commands refuse the tuned study, if any. They are printed first.
pub(super) fn say_openings(
    output: &Output,
    summary: &TuningSummary,
    refused: Option<StudyErrors>,
) -> Result<(), Stop> {
    if let Some(errors) = refused {
        output.say(&format!(
            "\nwarning: other commands do not accept the tuned design:\n{}\n",
            errors.render(false)
        ))?;
    }
    let unseen = summary.unseen();
    for combination in unseen.iter().take(MOST_DIRECTIONS) {
        output.say(&format!(
            "\n  These moves together {}: {combination}\n",
            summary.unseen_guarantee()
        ))?;
    }
    if unseen.len() > MOST_DIRECTIONS {
        let more = unseen.len() - MOST_DIRECTIONS;
        output.say(&format!(
            "\n  and {}, in summary.json\n",
            counted(more, "more such move")
        ))?;
    }
    output.text_only("\n")?;
    match summary.starts_in_words().filter(|_| output.is_text()) {
        Some(words) => output.say(&format!("{words}\n"))?,
        None => output.table("starts", &summary.starts_table())?,
    }
    Ok(())
}

pub(super) fn run(arguments: &OptimiseArguments) -> Result<Exit, Stop> {
    let OptimiseArguments { curves, prices } = arguments;
    let arguments = &curves.run;
    let path = &arguments.study.study;
    if CarStudy::is_at(path) {
        return super::car::optimise(curves, *prices);
    }
    let study = Study::read_elastic(path, &arguments.study.set)?;
    let Some(optimise) = &study.optimise else {
        let what = "variables and targets";
        return Err(Stop::no_section(path, "optimise", what));
    };
    if *prices && optimise.fit {
        return Err(Stop::wrong_input(
            "--prices is not available with fit = true, because a fit always searches for the smallest misfit",
        ));
    }
    let pool = pool(arguments.threads, optimise.starts as u64)?;
    // The nominal design is solved first, so that an error in it is known before any file is written.
    let fault = |why| Stop::in_file(path, why);
    let before = Solved::with_targets(&study).map_err(fault)?;
    let record = || {
        let motions = InMotion::all(&[("before", &study)], true)?.into_iter();
        Ok(Record {
            motions: motions.map(|own| own.record).collect(),
            ..Solved::record("optimise", &[("before", "curves_before.csv", &before)])?
        })
    };
    let report = ReportOptions::open(curves, &study, "optimise", record)?;
    let output = Output::open(arguments, &study, "optimise")?;
    let of_wheel = |why| design_fault(&study, path, &why).after_its_input();
    interrupt::stops_by_itself();
    let tuning = pool.install(|| tune_with_progress(&study, optimise));
    let tuning = tuning.map_err(of_wheel)?;
    let best = tuning.best.as_ref();
    let tuned = best.map(|best| study.moved(&best.offsets));
    if interrupt::is_raised() {
        keep(&output, &study, &tuning, tuned.as_ref())?;
    }
    let after = tuned.as_ref().map(Solved::with_targets).transpose();
    let after = after.map_err(|why| Stop::unsolved(path, why))?;
    let designs = [("before", Some(&study)), ("after", tuned.as_ref())];
    let designs = designs
        .into_iter()
        .filter_map(|(label, own)| Some((label, own?)));
    let in_motions = InMotion::all(&designs.collect::<Vec<_>>(), true);
    let in_motions = in_motions.map_err(|why| Stop::unsolved(path, why))?;
    let prices = *prices || arguments.report;
    let choices = pool.install(|| Choices::of(&study, optimise, &tuning, prices));
    let choices = choices.map_err(of_wheel)?;
    let curves = after.as_ref().map(Solved::curves);
    let mut summary = TuningSummary::of(&study, optimise, &tuning, curves);
    let kept = best.map(|best| &best.offsets[..]);
    summary.prices = PriceRecord::all(optimise, &choices.prices, kept);
    if let Some(tuned) = &tuned {
        summary.side_effects = side_effects(&study, tuned).map_err(of_wheel)?;
    }
    let expected = tuning.expected_yield.as_ref();
    let expected = expected.and_then(|found| found.as_ref().ok());
    summary.yields = pool.install(|| {
        yields(
            &study,
            optimise,
            tuned.as_ref(),
            expected,
            interrupt::flag(),
        )
    });
    let finished = Finished {
        path,
        study: &study,
        optimise,
        tuning: &tuning,
        before: &before,
        tuned: tuned.as_ref().zip(after.as_ref()),
        in_motions: &in_motions,
        choices: &choices,
        summary: &summary,
        is_interrupted: interrupt::is_raised(),
    };
    let (files, refused) = finished.write(&output, &report)?;
    let exit = finished.say(&output, refused)?;
    output.print_files(&files)?;
    Ok(exit)
}

/// A finished tuning with its results.
struct Finished<'a> {
    path: &'a Path,
    study: &'a Study,
    optimise: &'a Optimise,
    tuning: &'a Tuning,
    before: &'a Solved<'a>,
    /// Tuned design with its curves. `None` if no start reached a design.
    tuned: Option<(&'a Study, &'a Solved<'a>)>,
    /// Curves of the nominal and the tuned design over the named motions of the study.
    in_motions: &'a [InMotion],
    choices: &'a Choices,
    summary: &'a TuningSummary,
    is_interrupted: bool,
}

impl Finished<'_> {
    /// Writes all files. Returns their names, and the errors of the tuned study if other commands refuse it.
    fn write(
        &self,
        output: &Output,
        report: &ReportOptions,
    ) -> Result<(Vec<&'_ str>, Option<StudyErrors>), Stop> {
        let (study, summary) = (self.study, self.summary);
        let fault = |why| Stop::unsolved(self.path, why);
        if self.is_interrupted {
            output.mark_interrupted();
        }
        let mut refused = None;
        let mut files = vec!["curves_before.csv", "history.csv", "summary.json"];
        output.file("curves_before.csv", &self.before.csv())?;
        output.file("history.csv", &history_csv(&self.tuning.starts))?;
        output.json("summary.json", summary)?;
        let mut designs = vec![("before", "curves_before.csv", self.before)];
        if let Some((tuned, after)) = self.tuned {
            designs.push(("after", "curves.csv", after));
            output.main_csv("curves.csv", &after.csv())?;
            files.extend(output.file_if_any("kc.csv", figures_of(tuned).map_err(fault)?)?);
            let tuned = study.with_points_of(tuned);
            let directory = self.path.parent().unwrap_or(Path::new(""));
            refused = Study::elastic_from_text("optimised.toml", &tuned, directory).err();
            let tuned = output.text_here(study, tuned);
            output.file("optimised.toml", tuned.as_bytes())?;
            files = [&["curves.csv", "optimised.toml"], &files[..]].concat();
        } else {
            output.without("curves.csv")?;
            output.without("optimised.toml")?;
        }
        for (file, curves) in self.in_motions.iter().flat_map(InMotion::files) {
            output.file(file, &curves_csv(curves))?;
            files.push(file);
        }
        let effects = &summary.side_effects;
        let csv = (!effects.is_empty()).then(|| side_effects_table(effects).csv(None).into_bytes());
        files.extend(output.file_if_any("side_effects.csv", csv)?);
        let csv = self.tuned.and_then(|(_, after)| after.sensitivities_csv());
        files.extend(output.file_if_any("sensitivities.csv", csv)?);
        files.extend(self.choices.write(output, study, self.optimise)?);
        if output.directory().is_some() {
            let record = Solved::record("optimise", &designs).map_err(fault)?;
            let front = self.choices.front.as_ref();
            let front =
                front.map(|front| FrontRecord::of(study, self.optimise, front, Solved::table));
            let motions = self.in_motions.iter().map(|own| own.record.clone());
            let record = Record {
                front,
                motions: motions.collect(),
                ..record
            };
            output.record("report.json", &record)?;
            files.push("report.json");
        }
        if !self.is_interrupted {
            files.extend(report.show(output)?);
        }
        output.finish()?;
        Ok((files, refused))
    }

    /// Prints the results. `refused` holds the errors of the tuned study, if it has any.
    fn say(&self, output: &Output, refused: Option<StudyErrors>) -> Result<Exit, Stop> {
        let summary = self.summary;
        say_outcome(output, self.study, summary)?;
        let has_front = self.choices.say(output, self.optimise, summary)?;
        if let Some(yields) = &summary.yields {
            output.say(&format!("\n{}\n\n", yields.headline()))?;
            output.table("yields", &yields.table())?;
            if let Some(words) = yields.surrogate_in_words() {
                output.say(&format!("\n{words}\n"))?;
            }
            output.say_remarks(yields.remark())?;
        }
        if let Some(Err(reason)) = &self.tuning.expected_yield {
            let words = not_increased(reason);
            output.say_failure(&format!("\n{words}\n"))?;
        }
        let after = self.tuned.map(|(_, after)| after);
        let of_motions = self.in_motions.iter().filter_map(NamedCurves::of_last);
        let of_motions: Vec<NamedCurves> = of_motions.collect();
        let motions = after.map(|after| AllMotions {
            own: after.curves(),
            named: &of_motions,
        });
        let is_complete = motions.as_ref().is_some_and(AllMotions::are_complete);
        let plausibility = after.map(Solved::plausibility).transpose();
        let plausibility = plausibility.map_err(|why| Stop::unsolved(self.path, why))?;
        let plausibility = plausibility.into_iter().flatten();
        let plausibility = plausibility.chain(variable_plausibility(self.study));
        let wheel = self.study.wheel();
        let remarks = motions.iter().flat_map(|motions| motions.remarks(wheel));
        output.say_plausibility(plausibility.chain(remarks), after.is_none() || is_complete)?;
        let failures = after.map(|after| not_solved(after, &of_motions, wheel));
        for failure in failures.into_iter().flatten() {
            output.say_failure(&format!("\n{failure}\n"))?;
        }
        let is_whole = is_complete && has_front && !summary.falls_short() && refused.is_none();
        let is_whole = is_whole && !matches!(self.tuning.expected_yield, Some(Err(_)));
        say_openings(output, summary, refused)?;
        if self.is_interrupted {
            let words = summary.interrupted_in_words();
            output.say_failure(&format!("\n{words}\n"))?;
            return Ok(Exit::Interrupted);
        }
        Ok(Exit::of(is_whole))
    }
}

/// Content of `kc.csv`, the rig test results, for a tuned design with elastic parts. `None` for a rigid design.
fn figures_of(tuned: &Study) -> Result<Option<Vec<u8>>, String> {
    let tests = tuned
        .is_elastic()
        .then(|| RigTests::of(tuned, None))
        .transpose()?;
    Ok(tests.map(|tests| tests.results.kc_csv()))
}

/// Writes the design that an interrupted tuning has reached, before any further computation with it. Ends the process if the
/// tuning has reached no design.
fn keep(
    output: &Output,
    study: &Study,
    tuning: &Tuning,
    tuned: Option<&Study>,
) -> Result<(), Stop> {
    let Some(tuned) = tuned else {
        interrupt::end();
    };
    output.mark_interrupted();
    let text = output.text_here(study, study.with_points_of(tuned));
    output.file("optimised.toml", text.as_bytes())?;
    output.file("history.csv", &history_csv(&tuning.starts))
}

pub(super) fn tune_with_progress(
    study: &Study,
    optimise: &Optimise,
) -> Result<Tuning, crate::mechanism::DesignFault> {
    let line = progress::line(optimise.starts as u64, "starts");
    let watch = |start: usize, iteration: &crate::optimise::Iteration| {
        if iteration.iteration == 0 {
            line.inc(1);
        }
        line.set_message(format!("start {start}: misfit {:.3}", iteration.misfit));
    };
    let control = Control {
        interrupt: Some(interrupt::flag()),
        watch: (!line.is_hidden()).then_some(&watch),
    };
    let tuning = tune(&study.vehicle, optimise, control);
    line.finish_and_clear();
    tuning
}
