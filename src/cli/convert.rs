//! `hardpoint convert`: writes a study in other units and axes, or for the wheel on the other side.

use super::exit::{Exit, Stop};
use super::import::{frame, side, unit};
use super::save::{file_of_out, save, save_all};
use super::terminal::note;
use crate::model::{FrameConvention, LengthUnit, MassUnit, Side};
use crate::report::car_with_axles;
use crate::study::{CarStudy, Study, UnitChoice, Units};
use clap::{ArgGroup, Args};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Arguments of a conversion.
#[derive(Args)]
#[command(group(ArgGroup::new("units").required(true).multiple(true)))]
pub(super) struct ConvertArguments {
    /// The study file of a wheel, an axle or a car
    study: PathBuf,
    /// Unit of lengths: mm, m or in
    #[arg(long, visible_alias = "length-unit", value_parser = unit, group = "units")]
    unit: Option<LengthUnit>,
    /// Unit of forces: N or lbf (lbf only with lengths in inches)
    #[arg(long, value_parser = pounds_force, group = "units")]
    force_unit: Option<bool>,
    /// Unit of masses: kg or lb
    #[arg(long, value_parser = mass, group = "units")]
    mass_unit: Option<MassUnit>,
    /// Axes: iso8855, sae_j670 or x_rear
    #[arg(long, value_parser = frame, group = "units")]
    frame: Option<FrameConvention>,
    /// Side of the wheel: left or right. The other side gives the mirror image; not for axles and cars
    #[arg(long, value_parser = side, group = "units")]
    side: Option<Side>,
    /// Override a field of the study before the conversion; may be given more than once
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
    /// File for the study [default: standard output]; directory for the files of a car
    #[arg(long, short = 'o', value_name = "STUDY")]
    out: Option<PathBuf>,
    /// Replace an existing file, but never an input
    #[arg(long)]
    force: bool,
}

fn pounds_force(name: &str) -> Result<bool, String> {
    let mut units = [LengthUnit::Inch, LengthUnit::InchPound].into_iter();
    let found = units.find(|unit| unit.force_symbol() == name);
    found
        .map(|unit| unit == LengthUnit::InchPound)
        .ok_or_else(|| "expected N or lbf".to_owned())
}

fn mass(name: &str) -> Result<MassUnit, String> {
    let mut units = MassUnit::ALL.into_iter();
    units
        .find(|unit| unit.symbol() == name)
        .ok_or_else(|| "expected kg or lb".to_owned())
}

pub(super) fn run(arguments: &ConvertArguments) -> Result<Exit, Stop> {
    let choice = UnitChoice {
        length: arguments.unit,
        pounds_force: arguments.force_unit,
        mass: arguments.mass_unit,
        frame: arguments.frame,
        side: arguments.side,
    };
    if CarStudy::is_at(&arguments.study) {
        return car(arguments, &choice);
    }
    let study = Study::read_elastic(&arguments.study, &arguments.set)?;
    let text = study.in_units(&arguments.study.display().to_string(), &choice)?;
    let inputs = [std::slice::from_ref(&arguments.study), &study.inputs[..]].concat();
    let out = file_of_out(&arguments.out);
    let directory = out.and_then(Path::parent).unwrap_or(Path::new(""));
    let text = study.with_paths_in(text, directory);
    match out {
        None => std::io::stdout().write_all(text.as_bytes())?,
        Some(out) => save(out, text.as_bytes(), arguments.force, &inputs)?,
    }
    let new = Study::elastic_from_text("converted.toml", &text, directory)?;
    describe(&arguments.study, study.units(), new.units());
    Ok(Exit::Done)
}

/// Converts the three files of a car.
fn car(arguments: &ConvertArguments, choice: &UnitChoice) -> Result<Exit, Stop> {
    let Some(directory) = &arguments.out else {
        return Err(Stop::wrong_input(
            "a car has three studies: give a directory for them with --out",
        ));
    };
    let study = CarStudy::read(&arguments.study, &arguments.set)?;
    let shown = |file: usize| {
        let path = study.inputs.get(file);
        path.map_or_else(String::new, |path| path.display().to_string())
    };
    let shown = [0, 1, 2].map(shown);
    let shown = shown.each_ref().map(String::as_str);
    let [text, front, rear] = study.in_units(shown, choice)?;
    let [front_study, rear_study] = &study.axles;
    let front = front_study.with_paths_in(front, directory);
    let rear = rear_study.with_paths_in(rear, directory);
    let names = names(&arguments.study, &study.text);
    let [own, of_front, of_rear] = names.each_ref().map(String::as_str);
    let text = car_with_axles(&text, of_front, of_rear);
    let files = [(own, &*text), (of_front, &*front), (of_rear, &*rear)];
    save_all(directory, &files, arguments.force, &study.inputs)?;
    let new = CarStudy::read(&directory.join(own), &[])?;
    describe(&arguments.study, study.units()[0], new.units()[0]);
    Ok(Exit::Done)
}

/// Names of the converted files of a car: car, front axle, rear axle. They equal the names of the old files. If two old files
/// have the same name, the files of the axles get other names.
fn names(car: &Path, text: &str) -> [String; 3] {
    let name = |path: &Path| {
        let name = path.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    };
    let table: toml::Table = text.parse().unwrap_or_default();
    let of_axle = |end: &str| {
        let path = table.get("car").and_then(|car| car.get(end)?.as_str());
        name(Path::new(path.unwrap_or_default()))
    };
    let own = name(car);
    let [front, rear] = ["front", "rear"].map(of_axle);
    if own != front && own != rear && front != rear {
        return [own, front, rear];
    }
    let axle = |end: &str| format!("{}_{end}.toml", own.trim_end_matches(".toml"));
    [own.clone(), axle("front"), axle("rear")]
}

/// Prints the units, axes and side of a study before and after the conversion.
fn describe(path: &Path, from: Units, to: Units) {
    let words = |units: Units| {
        let mut words = vec![
            units.length.symbol(),
            units.length.force_symbol(),
            units.mass.symbol(),
            units.frame.name(),
        ];
        if from.side != to.side {
            words.push(units.side.name());
        }
        words.join(", ")
    };
    note(&format!(
        "{}: from {} to {}. Comments are unchanged and may state old values and units.\n",
        path.display(),
        words(from),
        words(to)
    ));
}
