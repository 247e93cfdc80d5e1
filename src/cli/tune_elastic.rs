//! `hardpoint optimise` of a study with elastic parts: hardpoints and rates for kinematics and compliance together.

use super::RunArguments;
use super::exit::{Exit, Stop};
use super::interrupt;
use super::kc::results;
use super::optimise::{say_openings, say_outcome, tune_with_progress};
use super::output::{Output, design_fault, pool};
use crate::report::{TuningSummary, history_csv};
use crate::study::{ComplianceStudy, Optimise, Study};
use std::path::Path;

/// Tunes a study with elastic parts and writes its figures beside the tuned study.
pub(super) fn run(
    arguments: &RunArguments,
    prices: bool,
    study: &Study,
    elastic: &ComplianceStudy,
    optimise: &Optimise,
) -> Result<Exit, Stop> {
    let path = &arguments.study.study;
    if arguments.report || arguments.plots.is_some() || prices {
        return Err(Stop::wrong_input(
            "`hardpoint optimise` with [compliance] writes tables, without --report, --plots and --prices",
        ));
    }
    let pool = pool(arguments.threads, optimise.starts as u64)?;
    let fault = |why| design_fault(study, path, &why).after_its_input();
    let output = Output::open(arguments, study, "optimise")?;
    interrupt::stops_by_itself();
    let tuning = pool.install(|| tune_with_progress(study, optimise));
    let tuning = tuning.map_err(fault)?;
    let interrupted = interrupt::is_raised();
    if interrupted {
        output.mark_interrupted();
    }
    let tuned = tuning.best.as_ref().map(|best| study.moved(&best.offsets));
    let summary = TuningSummary::of(study, optimise, &tuning, None);
    let mut files = vec!["history.csv", "summary.json"];
    output.file("history.csv", &history_csv(&tuning.starts))?;
    output.json("summary.json", &summary)?;
    let mut refused = None;
    let mut failures = Vec::new();
    match tuned.as_ref().and_then(|t| Some((t, t.compliance()?))) {
        Some((tuned, own)) => {
            // The tuned design held every target's station.
            if let Ok(found) = results(tuned, own) {
                output.main_csv("kc.csv", &found.kc_csv())?;
                failures = found.failures();
                files.insert(0, "kc.csv");
            }
            let text = study.with_points_of(tuned);
            output.file("optimised.toml", text.as_bytes())?;
            let directory = path.parent().unwrap_or(Path::new(""));
            refused = Study::elastic_from_text("optimised.toml", &text, directory).err();
            files.insert(1, "optimised.toml");
        }
        None => {
            output.without("kc.csv")?;
            output.without("optimised.toml")?;
        }
    }
    output.finish()?;
    say_outcome(&output, study, &summary)?;
    let links = elastic.link_names.len();
    let bushings = elastic.parts.bushings.len();
    output.text_only(&format!(
        "\nAll values are of the equilibrium with {bushings} bushings and {links} elastic links.\n"
    ))?;
    for failure in &failures {
        output.say_failure(&format!("\nnot solved: {failure}\n"))?;
    }
    let is_whole = failures.is_empty() && !summary.falls_short() && refused.is_none();
    say_openings(&output, study, &summary, refused)?;
    if interrupted {
        let words = summary.interrupted_in_words();
        output.say_failure(&format!("\n{words}\n"))?;
    }
    output.print_files(&files)?;
    Ok(match interrupted {
        true => Exit::Interrupted,
        false => Exit::of(is_whole),
    })
}
