//! `hardpoint tolerance`: computes the effect of manufacturing scatter, from many builds (assembled parts with random deviations).

use super::ToleranceArguments;
use super::exit::{Exit, Stop};
use super::output::{Output, design_fault, pool};
use super::report::ReportOptions;
use super::terminal;
use super::{interrupt, progress};
use crate::assembly::SetUpError;
use crate::mechanism::DesignFault;
use crate::report::{BandCurve, ToleranceSummary, VALUES_NOTE};
use crate::scatter;
use crate::solved::Solved;
use crate::study::{CarStudy, Study, Tolerance};
use crate::tolerance::{Expansion, Forecast, MonteCarlo, Problem, monte_carlo};
use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;

pub(super) fn run(arguments: &ToleranceArguments) -> Result<Exit, Stop> {
    if CarStudy::is_at(&arguments.curves.run.study.study) {
        return super::car::tolerance(arguments);
    }
    let (build, curves) = (arguments.build, &arguments.curves);
    let arguments = &curves.run;
    let path = &arguments.study.study;
    let study = Study::read_elastic(path, &arguments.study.set)?;
    let tolerance = tolerance_of(&study, path)?;
    if let Some(number) = build {
        return print_build(&problem(&study, tolerance, path)?, number);
    }
    let fault = |fault: DesignFault| design_fault(&study, path, &fault);
    let pool = pool(
        arguments.threads,
        tolerance.builds.div_ceil(crate::evaluate::BLOCK as u64),
    )?;
    let problem = problem(&study, tolerance, path)?.interruptible(interrupt::flag());
    let drawn = problem.drawn().map_err(fault)?;
    let record = || {
        let plain = scatter::curves_alone(&study);
        let drawn = Solved::of(&plain)?;
        let mut record = Solved::record("tolerance", &[("nominal", "curves.csv", &drawn)])?;
        record.motion.bands = bands(&study, tolerance);
        Ok(record)
    };
    let report = ReportOptions::open(curves, &study, "tolerance", record)?;
    let output = Output::open(arguments, &study, "tolerance")?;
    let expansion = pool
        .install(|| Expansion::of(&problem))
        .map_err(|reason| not_aligned(&study, path, reason).after_its_input())?;
    // The forecast (predicted yields for other tolerances) is computed before the builds, because after an interruption the
    // run only writes files.
    let forecast = Forecast::of(&problem, &expansion, &drawn);
    let builds = pool
        .install(|| with_progress(&problem, tolerance, &drawn))
        .map_err(|fault| Stop::unsolved(path, fault.describe(&study.wheel().mechanism)))?;
    let interrupted = builds.builds < tolerance.builds;
    if interrupted && builds.builds == 0 {
        interrupt::end();
    }
    if interrupted {
        output.mark_interrupted();
    }
    let yields = forecast.as_ref().map(|forecast| forecast.rank(&builds));
    let summary = ToleranceSummary::of(&problem, &drawn, &expansion, &builds, yields.as_ref());

    let unit = study.wheel().length_unit.symbol();
    let contributors: Vec<String> = tolerance.scatter.iter().map(|c| c.name.clone()).collect();
    output.main_csv("tolerance.csv", &summary.csv(unit))?;
    output.file(
        "contributors.csv",
        &summary.contributors_csv(&contributors, unit),
    )?;
    output.json("summary.json", &summary)?;
    let mut files = vec!["tolerance.csv", "contributors.csv", "summary.json"];
    if output.directory().is_some() {
        files.extend(fans(&output, path, &problem, &builds)?);
    }
    if !interrupted {
        files.extend(report.show(&output)?);
    }
    output.finish()?;

    print(&output, &study, &summary, &contributors)?;
    ended(
        &output,
        interrupted,
        [builds.builds, tolerance.builds],
        &files,
    )
}

/// Prints the tables of a tolerance summary, and remarks about builds without values of outputs.
fn print(
    output: &Output,
    study: &Study,
    summary: &ToleranceSummary,
    contributors: &[String],
) -> Result<(), Stop> {
    output.say(&format!("{}: {}\n\n", study.name, summary.headline()))?;
    let unit = study.wheel().length_unit.symbol();
    output.table("values", &summary.values_table(unit))?;
    output.text_only(&format!("\n{VALUES_NOTE}\n"))?;
    if summary.bands.is_empty() {
        output.text_only("\nShares of the variance of the builds, in the design position: first-order share of each contributor, and the remainder\n\n")?;
        output.table("shares", &summary.shares_table(contributors))?;
    } else {
        output.text_only("\n")?;
        output.table("bands", &summary.bands_table())?;
        output.say_remarks(&summary.nominal_outside)?;
        output.text_only(
            "\nContributors, with the predicted yield at half and at twice the tolerance of each\n\n",
        )?;
        output.table("ranking", &summary.ranking_table())?;
    }
    output.say_remarks(summary.failures())
}

/// Prints the files of the run. After an interruption, also prints the numbers of finished and of requested builds.
pub(super) fn ended(
    output: &Output,
    interrupted: bool,
    [done, requested]: [u64; 2],
    files: &[&str],
) -> Result<Exit, Stop> {
    if interrupted {
        output.say_failure(&format!(
            "\ninterrupted: {done} of the {requested} requested builds are done\n"
        ))?;
    }
    output.print_files(files)?;
    Ok(if interrupted {
        Exit::Interrupted
    } else {
        Exit::Done
    })
}

/// Limit bands of the outputs of one wheel over the drive, as its charts show them. Empty for an axle.
fn bands(study: &Study, tolerance: &Tolerance) -> Vec<BandCurve> {
    let drive = study.motion().drive;
    let drives: Vec<f64> = study
        .motion()
        .values
        .iter()
        .map(|v| drive.printed(*v))
        .collect();
    let of_wheel = tolerance.bands.iter().filter(|_| study.axle().is_none());
    let drawn = of_wheel.map(|band| BandCurve::of_tolerance(band, &drives));
    drawn.collect()
}

/// Section `[tolerance]` of a study, with the scatter of the parts. Returns an error if the study does not have it.
pub(super) fn tolerance_of<'s>(study: &'s Study, path: &Path) -> Result<&'s Tolerance, Stop> {
    let tolerance = study.tolerance.as_ref();
    tolerance.ok_or_else(|| Stop::no_section(path, "tolerance", "the scatter of the parts"))
}

/// Prepares the tolerance analysis of a study.
pub(super) fn problem<'s>(
    study: &'s Study,
    tolerance: &'s Tolerance,
    path: &Path,
) -> Result<Problem<'s>, Stop> {
    Problem::of(study, tolerance).map_err(|reason| not_aligned(study, path, reason))
}

fn not_aligned(study: &Study, path: &Path, reason: SetUpError) -> Stop {
    Stop::in_file(path, scatter::refusal(study, reason))
}

/// Prints one build as a study.
fn print_build(problem: &Problem, number: u64) -> Result<Exit, Stop> {
    let (study, seed) = (problem.study, problem.tolerance.seed);
    match problem.built_text(number) {
        Ok(built) => {
            let aligned = if problem.tolerance.aligned {
                "aligned"
            } else {
                "as assembled"
            };
            let text = format!(
                "# Build {number} of {} (seed {seed}, {aligned}): design of the assembled parts \
                 in the static position.\n{built}",
                study.name,
            );
            std::io::stdout().write_all(text.as_bytes())?;
            Ok(Exit::Done)
        }
        Err((side, reject)) => {
            let reject = crate::report::rejected(side, &reject);
            terminal::eprint(&format!(
                "build {number} of {} (seed {seed}): {reject}\n",
                study.name
            ));
            Ok(Exit::Incomplete)
        }
    }
}

fn with_progress(
    problem: &Problem,
    tolerance: &Tolerance,
    drawn: &[f64],
) -> Result<MonteCarlo, DesignFault> {
    let line = progress::line(tolerance.builds, "builds");
    interrupt::stops_by_itself();
    let found = monte_carlo(problem, drawn, |done| {
        line.set_position(done);
        if interrupt::is_raised() && done < tolerance.builds {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    line.finish_and_clear();
    found
}

/// Writes the curves of the nominal design and the percentile curves of the outputs at each station. Also writes the data of the
/// report page. Returns the names of the files.
fn fans(
    output: &Output,
    path: &Path,
    problem: &Problem,
    builds: &MonteCarlo,
) -> Result<Vec<&'static str>, Stop> {
    let fault = |why| Stop::unsolved(path, why);
    let written = scatter::with_fans(problem, builds, |designs| {
        for (_, file, curves) in designs {
            output.file(file, &curves.csv())?;
        }
        let mut record = Solved::record("tolerance", designs).map_err(fault)?;
        record.motion.bands = bands(problem.study, problem.tolerance);
        output.record("report.json", &record)
    });
    written.map_err(fault)??;
    Ok([&scatter::FAN_FILES[..], &["report.json"]].concat())
}
