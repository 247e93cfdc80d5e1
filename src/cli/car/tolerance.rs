//! `hardpoint tolerance` of a car.

use super::super::ToleranceArguments;
use super::super::exit::{Exit, Stop};
use super::super::output::pool;
use super::super::tolerance::ended;
use super::super::{interrupt, progress};
use super::{keep, open};
use crate::assembly::SetUpError;
use crate::report::CarToleranceSummary;
use crate::study::{CarStudy, CarTolerance};
use crate::tolerance::{CarBuilds, CarProblem};
use std::ops::ControlFlow;
use std::path::Path;

pub(in crate::cli) fn tolerance(arguments: &ToleranceArguments) -> Result<Exit, Stop> {
    if arguments.build.is_some() {
        return Err(Stop::wrong_input(
            "--build is not available for a car: it prints one study, but a build of a car has three",
        ));
    }
    let curves = &arguments.curves;
    let arguments = &curves.run;
    let path = &arguments.study.study;
    let study = CarStudy::read(path, &arguments.study.set)?;
    let Some(tolerance) = &study.tolerance else {
        let what = "the scatter of the parts";
        return Err(Stop::no_section(path, "tolerance", what));
    };
    let problem = CarProblem::of(&study, tolerance).map_err(|why| refused(&study, path, &why))?;
    let fault = |fault| Stop::in_file(path, study.car.describe_fault(&fault));
    let nominal = problem.nominal().map_err(fault)?;
    let pool = pool(arguments.threads, tolerance.builds)?;
    let output = open(curves, &study, "tolerance")?;
    let expansion = problem.expansion();
    let expansion = expansion.map_err(|why| refused(&study, path, &why).after_its_input())?;
    let builds = pool.install(|| with_progress(&problem, tolerance, &nominal));
    let interrupted = builds.builds < tolerance.builds;
    if interrupted && builds.builds == 0 {
        interrupt::end();
    }
    if interrupted {
        output.mark_interrupted();
    }
    let summary = CarToleranceSummary::of(&problem, &nominal, &expansion, &builds);
    output.main_csv("tolerance.csv", &summary.csv())?;
    output.file("contributors.csv", &summary.contributors_csv())?;
    output.json("summary.json", &summary)?;
    let mut files = vec!["tolerance.csv", "contributors.csv", "summary.json"];
    files.extend(keep(&output, &study)?);
    output.finish()?;
    output.say(&format!("{}: {}\n\n", study.name, summary.headline()))?;
    output.table("values", &summary.values_table())?;
    if !tolerance.bands.is_empty() {
        output.text_only("\n")?;
        output.table("bands", &summary.bands_table())?;
        output.say_remarks(&summary.nominal_outside)?;
    }
    output.text_only("\nContributors to the scatter, sorted by their largest share of the variance of a value\n\n")?;
    output.table("ranking", &summary.ranking_table())?;
    output.say_remarks(summary.failure())?;
    ended(
        &output,
        interrupted,
        [builds.builds, tolerance.builds],
        &files,
    )
}

fn refused(study: &CarStudy, path: &Path, (axle, why): &(usize, SetUpError)) -> Stop {
    let reason = crate::scatter::refusal(&study.axles[*axle], why.clone());
    Stop::in_file(
        path,
        format!("{} axle: {reason}", crate::car::AXLE_NAMES[*axle]),
    )
}

fn with_progress(problem: &CarProblem<'_>, tolerance: &CarTolerance, nominal: &[f64]) -> CarBuilds {
    let line = progress::line(tolerance.builds, "builds");
    interrupt::stops_by_itself();
    let builds = problem.monte_carlo(nominal, |done| {
        line.set_position(done);
        if interrupt::is_raised() && done < tolerance.builds {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    line.finish_and_clear();
    builds
}
