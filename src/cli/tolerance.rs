//! `hardpoint tolerance`

use super::ToleranceArguments;
use super::exit::{Exit, Stop};
use super::output::{Output, design_fault, pool};
use super::report::ReportOptions;
use super::terminal;
use super::{interrupt, progress};
use crate::assembly::NoSetUp;
use crate::mechanism::DesignFault;
use crate::report::{BandCurve, ToleranceSummary};
use crate::solved::Solved;
use crate::study::{Outputs, Study, Tolerance};
use crate::tolerance::{Expansion, Forecast, MonteCarlo, Problem, monte_carlo};
use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;

/// The curves of a page: the drawing and percentiles, by their place among [`crate::tolerance::PERCENTILES`].
const FANS: [(&str, &str, usize); 4] = [
    ("1 %", "curves_p1.csv", 1),
    ("5 %", "curves_p5.csv", 2),
    ("95 %", "curves_p95.csv", 4),
    ("99 %", "curves_p99.csv", 5),
];

pub(super) fn run(arguments: &ToleranceArguments) -> Result<Exit, Stop> {
    let (build, arguments) = (arguments.build, &arguments.run);
    let path = &arguments.study.study;
    let study = Study::read(path, &arguments.study.set)?;
    let tolerance = scatter(&study, path)?;
    if let Some(number) = build {
        return print_build(&problem(&study, tolerance, path)?, number);
    }
    let fault = |fault: DesignFault| design_fault(&study, path, &fault);
    let pool = pool(
        arguments.threads,
        tolerance.builds.div_ceil(crate::sweep::BLOCK as u64),
    )?;
    let problem = problem(&study, tolerance, path)?.interruptible(interrupt::flag());
    let drawn = problem.drawn().map_err(fault)?;
    let record = || {
        let plain = curves_alone(&study);
        let drawn = Solved::of(&plain)?;
        let mut record = Solved::record("tolerance", &[("drawn", "curves.csv", &drawn)])?;
        record.bands = bands(&study, tolerance);
        Ok(record)
    };
    let report = ReportOptions::open(arguments, &study, record)?;
    let output = Output::open(arguments, &study, "tolerance")?;
    let expansion = pool
        .install(|| Expansion::of(&problem))
        .map_err(|reason| not_aligned(&study, path, reason).after_its_input())?;
    // Before the builds: afterwards an interrupted run only writes.
    let forecast = Forecast::of(&problem, &expansion, &drawn);
    let builds = pool
        .install(|| with_progress(&problem, tolerance, &drawn))
        .map_err(|fault| Stop::unsolved(path, fault.describe(&study.suspension.mechanism)))?;
    let interrupted = builds.builds < tolerance.builds;
    if interrupted && builds.builds == 0 {
        interrupt::end();
    }
    if interrupted {
        output.mark_interrupted();
    }
    let yields = forecast.as_ref().map(|forecast| forecast.rank(&builds));
    let summary = ToleranceSummary::of(&problem, &drawn, &expansion, &builds, yields.as_ref());

    let unit = study.suspension.length_unit.symbol();
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
        files.extend(report.show(output.directory())?);
    }
    output.finish()?;

    output.say(&format!("{}: {}\n\n", study.name, summary.headline()))?;
    output.table("values", &summary.values_table())?;
    if summary.bands.is_empty() {
        output.text_only("\nshares of the builds' variance in the drawn position: of first order, and what that leaves\n\n")?;
        output.table("shares", &summary.shares_table(&contributors))?;
    } else {
        output.text_only("\n")?;
        output.table("bands", &summary.bands_table())?;
        output.text_only("\nwhat to hold tighter, what may be looser\n\n")?;
        output.table("ranking", &summary.ranking_table())?;
    }
    output.say_remarks(summary.failures())?;
    if interrupted {
        output.say_failure(&format!(
            "\ninterrupted: these are {} of the {} builds asked for\n",
            builds.builds, tolerance.builds
        ))?;
    }
    output.print_files(&files)?;
    Ok(match interrupted {
        true => Exit::Interrupted,
        false => Exit::Done,
    })
}

/// The bands of one wheel as they are drawn beside its curves.
fn bands(study: &Study, tolerance: &Tolerance) -> Vec<BandCurve> {
    let drive = study.motion.drive;
    let drives: Vec<f64> = study
        .motion
        .values
        .iter()
        .map(|v| drive.printed(*v))
        .collect();
    let of_wheel = tolerance.bands.iter().filter(|_| study.axle.is_none());
    let drawn = of_wheel.map(|band| BandCurve::of_tolerance(band, &drives));
    drawn.collect()
}

/// How the parts of a study scatter.
pub(super) fn scatter<'s>(study: &'s Study, path: &Path) -> Result<&'s Tolerance, Stop> {
    let tolerance = study.tolerance.as_ref();
    tolerance.ok_or_else(|| Stop::no_section(path, "tolerance", "how parts scatter"))
}

/// A study's tolerances, made ready.
pub(super) fn problem<'s>(
    study: &'s Study,
    tolerance: &'s Tolerance,
    path: &Path,
) -> Result<Problem<'s>, Stop> {
    Problem::of(study, tolerance).map_err(|reason| not_aligned(study, path, reason))
}

fn not_aligned(study: &Study, path: &Path, reason: NoSetUp) -> Stop {
    match reason {
        NoSetUp::Fault(reason) => design_fault(study, path, &reason),
        NoSetUp::Reject(reject) => Stop::in_file(path, reject),
        NoSetUp::Unsettled | NoSetUp::OutOfReach(_) | NoSetUp::Absurd { .. } => Stop::in_file(
            path,
            "aligned = true, but what [setup] adjusts does not move toe and camber one by one",
        ),
    }
}

/// Prints a build as a study.
fn print_build(problem: &Problem, number: u64) -> Result<Exit, Stop> {
    let (study, seed) = (problem.study, problem.tolerance.seed);
    match problem.built_wheels(number) {
        Ok(built) => {
            let aligned = match problem.tolerance.aligned {
                true => "aligned",
                false => "as assembled",
            };
            let text = format!(
                "# Build {number} of {} (seed {seed}, {aligned}): the design that its parts make at rest.\n{}",
                study.name,
                match &built[..] {
                    [left, right] => study.with_built_axle([left, right]),
                    built => study.with_built(&built[0]),
                }
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
        match interrupt::is_raised() && done < tolerance.builds {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    });
    line.finish_and_clear();
    found
}

/// The study as its curves are drawn: of what builds are looked at for, in the drawing.
fn curves_alone(study: &Study) -> Study {
    let mut plain = study.clone();
    plain.formulation = crate::study::Formulation::KnucklePose;
    plain.outputs = Outputs::of(plain.outputs.characteristics);
    if let Some(both) = &mut plain.axle {
        both.plan = both.plan.quantities_alone();
    }
    plain
}

/// Writes the curves of the drawing and of percentiles of builds, each at every station by itself, with what a page needs; the
/// files that makes.
fn fans(
    output: &Output,
    path: &Path,
    problem: &Problem,
    builds: &MonteCarlo,
) -> Result<Vec<&'static str>, Stop> {
    let plain = curves_alone(problem.study);
    let fault = |why| Stop::unsolved(path, why);
    let drawn = Solved::of(&plain).map_err(fault)?;
    let stations: Vec<usize> = problem.stations.of_motion().collect();
    let fans = FANS.map(|(name, file, percentile)| {
        let found = drawn.with_values(|output, station| {
            builds.spreads[problem.cell(output, stations[station])].percentiles[percentile]
        });
        (name, file, found)
    });
    let fans = fans.iter().map(|(name, file, found)| (*name, *file, found));
    // What matters most is the last.
    let designs: Vec<_> = fans.chain([("drawn", "curves.csv", &drawn)]).collect();
    let mut files = Vec::new();
    for (_, file, curves) in &designs {
        output.file(file, &curves.csv())?;
        files.push(*file);
    }
    let mut record = Solved::record("tolerance", &designs).map_err(fault)?;
    record.bands = bands(problem.study, problem.tolerance);
    output.record("report.json", &record)?;
    files.push("report.json");
    Ok(files)
}
