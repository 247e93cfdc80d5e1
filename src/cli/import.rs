//! `hardpoint import`

use super::exit::{Exit, Stop};
use super::save::save;
use super::terminal::note;
use crate::exchange::{ImportOptions, import, read_points, unit_of};
use crate::model::{FrameConvention, LengthUnit, Side, Topology};
use clap::Args;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

/// What is imported, and what is known of it.
#[derive(Args)]
pub(super) struct ImportArguments {
    /// Points: a table (.csv, .xlsx), a map (.json) or an Adams/Car subsystem (.sub)
    file: PathBuf,
    /// Kind of suspension, such as double_wishbone
    #[arg(long, value_parser = topology)]
    topology: &'static Topology,
    /// Names in the file by hardpoint, as TOML: lower_arm_front = "LCA 1"
    #[arg(long, value_name = "NAMES.toml")]
    map: Option<PathBuf>,
    /// Unit of length, mm, m or in [default: what the file says, or the one that makes it a car's]
    #[arg(long, value_parser = unit)]
    unit: Option<LengthUnit>,
    /// Axes: iso8855, sae_j670 or x_rear [default: those that the points fit]
    #[arg(long, value_parser = frame)]
    frame: Option<FrameConvention>,
    /// Which wheel, left or right [default: the left one, or the one there is]
    #[arg(long, value_parser = side)]
    side: Option<Side>,
    /// Sheet of a workbook [default: the one with points]
    #[arg(long, value_name = "NAME")]
    sheet: Option<String>,
    /// Where the study goes [default: standard output]
    #[arg(long, value_name = "STUDY")]
    out: Option<PathBuf>,
    /// Replace a file that is there
    #[arg(long)]
    force: bool,
}

/// A topology by its name.
pub(super) fn topology(name: &str) -> Result<&'static Topology, String> {
    Topology::named(name).ok_or_else(|| {
        let names: Vec<&str> = Topology::ALL.iter().map(|t| t.name).collect();
        format!("expected one of {}", names.join(", "))
    })
}

pub(super) fn unit(name: &str) -> Result<LengthUnit, String> {
    unit_of(name).ok_or_else(|| "expected mm, m or in".to_owned())
}

pub(super) fn frame(name: &str) -> Result<FrameConvention, String> {
    let mut all = FrameConvention::ALL.into_iter();
    all.find(|frame| frame.name() == name)
        .ok_or_else(|| "expected iso8855, sae_j670 or x_rear".to_owned())
}

fn side(name: &str) -> Result<Side, String> {
    let mut all = Side::ALL.into_iter();
    all.find(|side| side.name() == name)
        .ok_or_else(|| "expected left or right".to_owned())
}

pub(super) fn run(arguments: &ImportArguments) -> Result<Exit, Stop> {
    let shown = arguments.file.display().to_string();
    let refused = |reason: String| Stop::in_file(&arguments.file, reason);
    let names = match &arguments.map {
        Some(path) => names(path)?,
        None => BTreeMap::new(),
    };
    let table = read_points(&arguments.file, arguments.sheet.as_deref()).map_err(refused)?;
    let options = ImportOptions {
        topology: arguments.topology,
        unit: arguments.unit,
        frame: arguments.frame,
        side: arguments.side,
        names: &names,
    };
    let imported = import(&table, &options).map_err(refused)?;
    let notes: String = imported
        .notes
        .iter()
        .map(|line| format!("  {line}\n"))
        .collect();
    let file_name = arguments
        .file
        .file_name()
        .unwrap_or_default()
        .to_string_lossy();
    let study = imported
        .study("the imported study", &file_name)
        .map_err(|reason| {
            refused(format!(
                "the points do not make a suspension\n{notes}{reason}"
            ))
        })?;
    match &arguments.out {
        Some(out) => {
            let inputs = [Some(arguments.file.clone()), arguments.map.clone()];
            let inputs: Vec<PathBuf> = inputs.into_iter().flatten().collect();
            save(out, study.as_bytes(), arguments.force, &inputs)?;
        }
        None => std::io::stdout().write_all(study.as_bytes())?,
    }
    note(&format!(
        "{shown}: {} hardpoints of {}\n{notes}",
        imported.hardpoints.len(),
        imported.topology.name
    ));
    Ok(Exit::Done)
}

/// Reads the names given to hardpoints in the file.
fn names(path: &Path) -> Result<BTreeMap<String, String>, Stop> {
    let refused = |reason: String| Stop::in_file(path, reason);
    let text = std::fs::read_to_string(path).map_err(|error| refused(error.to_string()))?;
    toml::from_str(&text).map_err(|error| {
        refused(format!(
            "expected lines such as lower_arm_front = \"LCA 1\": {}",
            error.message().replace('\n', "; ")
        ))
    })
}
