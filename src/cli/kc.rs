//! `hardpoint kc`

use super::exit::{Exit, Stop};
use super::output::Output;
use super::terminal;
use super::{KcArguments, Names};
use crate::compliance::{Compliance, ElasticFault, KcRun, KcTest};
use crate::report::{KcResults, OtherProgram, counted};
use crate::study::{ComplianceStudy, Drive, Study};
use serde_json::json;
use std::path::Path;

pub(super) fn run(arguments: &KcArguments) -> Result<Exit, Stop> {
    let other = match arguments.names {
        None => None,
        Some(Names::Adams) => Some(OtherProgram::Adams),
        Some(Names::Altair) => Some(OtherProgram::Altair),
        Some(Names::Spmm) => {
            return Err(Stop::wrong_input(
                "--names spmm is not available: no published definition of these sheets gives all signs, and sheets differ \
                 in the sign of toe and side force. kc.csv has our signs (docs/compliance.md)",
            ));
        }
    };
    let arguments = &arguments.run;
    let path = &arguments.study.study;
    let study = Study::read_elastic(path, &arguments.study.set)?;
    if study.axle().is_some() {
        let reason = "axle: `hardpoint kc` is not available for axles: its tests load one wheel. Remove [axle] to use it on \
                      the left wheel";
        return Err(Stop::in_file(path, reason));
    }
    if arguments.report || arguments.plots.is_some() {
        return Err(Stop::wrong_input(
            "`hardpoint kc` writes tables, without --report and --plots",
        ));
    }
    let elastic = elastic_or_rigid(&study, path)?;
    let output = Output::open(arguments, &study, "kc")?;
    // A study with elastic parts was tried when it was read.
    let fault = |fault: ElasticFault| {
        Stop::in_file(path, format!("the design position is singular: {fault:?}"))
    };
    let results = KcResults {
        other,
        ..results(&study, &elastic).map_err(fault)?
    };
    let mut files = vec!["kc.csv"];
    output.main_csv("kc.csv", &results.kc_csv())?;
    files.extend(output.file_if_any("levels.csv", results.levels_csv())?);
    files.extend(output.file_if_any("compliance_matrix.csv", results.matrix_csv())?);
    let points = study.one_wheel().map(|own| &own.outputs.sensitivities[..]);
    let run = KcRun::new(study.wheel(), &elastic.parts, elastic.tyre_rate).map_err(fault)?;
    let csv = results.sensitivities_csv(&run, &elastic.parts, points.unwrap_or_default());
    files.extend(output.file_if_any("sensitivities.csv", csv)?);
    let (failures, warnings) = (results.failures(), results.warnings());
    let summary = json!({
        "command": "kc",
        "study": study.name,
        "is_rigid": elastic.parts.is_rigid(),
        "design_load_N": results.design_load,
        "stations": results.stations.len(),
        "without_equilibrium": failures,
        "warnings": warnings,
    });
    output.json("summary.json", &summary)?;
    files.push("summary.json");
    output.finish()?;

    let stations = counted(results.stations.len(), "station");
    let parts = elastic.parts.bushings.len() + elastic.parts.links.len();
    let parts = match elastic.parts.is_rigid() {
        true => "rigid mechanism".to_owned(),
        false => counted(parts, "elastic part"),
    };
    output.say(&format!("{}: {parts}, {stations}\n", study.name))?;
    if let Some(load) = results.design_load {
        output.say(&format!("design load: {load:.0} N at the contact point\n"))?;
    }
    output.table_for_programs("figures", || results.table());
    for (place, table) in results.tables_for_readers() {
        output.text_only(&format!("\n{place}\n\n{}", table.text(terminal::width())))?;
    }
    output.text_only(
        "\nDerivatives at the station and secants over the window, of a left wheel. Signs: docs/compliance.md\n",
    )?;
    output.say_remarks(warnings)?;
    for failure in &failures {
        output.say_failure(&format!("\nnot solved: {failure}\n"))?;
    }
    output.print_files(&files)?;
    Ok(Exit::of(results.is_complete()))
}

/// The tests of a study at its stations.
pub(super) fn results<'s>(
    study: &'s Study,
    elastic: &ComplianceStudy,
) -> Result<KcResults<'s>, ElasticFault> {
    let run = KcRun::new(study.wheel(), &elastic.parts, elastic.tyre_rate)?;
    let mechanism = &study.wheel().mechanism;
    let parts = elastic.parts.bushings.iter();
    Ok(KcResults {
        suspension: study.wheel(),
        design_load: run.wheel().design_load(),
        bushings: parts
            .map(|part| mechanism.name(part.point).to_owned())
            .collect(),
        links: elastic.link_names.clone(),
        other: None,
        stations: run.run(&study.motion().values, &study.motion().rack, &elastic.tests),
    })
}

/// The elastic parts of a study, or the rigid mechanism with its tests.
fn elastic_or_rigid(study: &Study, path: &Path) -> Result<ComplianceStudy, Stop> {
    if let Some(elastic) = study.compliance() {
        return Ok(elastic.clone());
    }
    if study.wheel().wheel_radius.is_none() {
        let why = "`hardpoint kc` needs radius in [wheel]: loads act at the contact point";
        return Err(Stop::in_file(path, why));
    }
    if study.motion().drive != Drive::Travel {
        let why = "`hardpoint kc` needs stations of wheel travel: expected travel in [motion]";
        return Err(Stop::in_file(path, why));
    }
    Ok(ComplianceStudy {
        parts: Compliance::rigid(None),
        link_names: Vec::new(),
        tests: KcTest::defaults(true, false, study.wheel().length_unit),
        tyre_rate: None,
    })
}
