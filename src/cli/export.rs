//! `hardpoint export`: writes points and curves in the file formats of other tools.

use super::exit::{Exit, Stop};
use super::export_source::Source;
use super::import::{frame, unit};
use super::save::{file_of_out, note_saved, save};
use super::terminal::note;
use crate::exchange::{
    Envelope, Page, Span, Tool, Tyre, Value, Written, bytes_of, csv, curves_in, drawing,
    into_subsystem, length_with_unit, optimum_k_rows, point_rows, property_file, subsystem,
    suspensions_ini, under_names_of, workbook,
};
use crate::model::{FrameConvention, LengthUnit};
use crate::study::Study;
use clap::{Args, ValueEnum};
use std::io::Write;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// Arguments of an export.
#[derive(Args)]
pub(super) struct ExportArguments {
    /// A study file, or the directory of a run
    pub(super) source: PathBuf,
    /// Format of the file
    #[arg(long, value_enum)]
    pub(super) to: Target,
    /// Unit of lengths in the file: mm, m or in [default: the unit of the format or of the study]
    #[arg(long, value_parser = unit)]
    pub(super) unit: Option<LengthUnit>,
    /// Axes of the file: iso8855, sae_j670 or x_rear [default: the axes of the study or of the format]
    #[arg(long, value_parser = frame)]
    pub(super) frame: Option<FrameConvention>,
    /// Round coordinates to multiples of this length, with the smallest increase of the misfit. Rounds coordinates that --set,
    /// --design or a tuning changed. If the exported file is a study, it also rounds the coordinates of the study's variables. The
    /// length has a unit, as in 0.5mm, or else the unit of the file
    #[arg(long, value_name = "LENGTH", value_parser = step)]
    pub(super) round: Option<Step>,
    /// With --round: round every coordinate of the hardpoints
    #[arg(long)]
    pub(super) round_all: bool,
    /// With --to csv: the curves instead of the points
    #[arg(long)]
    pub(super) curves: bool,
    /// With --to csv: only the curves that another tool defines in the same way, with the names of that tool
    #[arg(long, value_enum)]
    pub(super) names: Option<Names>,
    /// With --to stl: wheel travel, as in --travel -30..30; append /N for N values [default: 9]
    #[arg(long, value_name = "A..B", value_parser = span, allow_hyphen_values = true)]
    travel: Option<Span>,
    /// With --to stl: rack displacement along the file's y axis, as in --rack -20..20 [default: straight ahead]
    #[arg(long, value_name = "C..D", value_parser = span, allow_hyphen_values = true)]
    rack: Option<Span>,
    /// With --to stl: length to add to the tyre on all sides
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    grow: Option<f64>,
    /// With --to adams: an existing subsystem; the result is a copy of it with the hardpoints of the study
    #[arg(long, value_name = "FILE.sub")]
    into: Option<PathBuf>,
    /// With --to bus: the hardpoint of the bushing [default: the only one]
    #[arg(long, value_name = "HARDPOINT")]
    bushing: Option<String>,
    /// Export the points of one design of the study's sweep, by its number
    #[arg(long, value_name = "NUMBER")]
    pub(super) design: Option<u64>,
    /// Override a field of the study, as in --set motion.rack=5.0; may be given more than once
    #[arg(long, value_name = "PATH=VALUE")]
    pub(super) set: Vec<String>,
    /// File for the result [default: standard output; workbooks and solids need a file]
    #[arg(long, value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
    /// Replace an existing file, but never an input
    #[arg(long)]
    pub(super) force: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Target {
    /// The hardpoints as a table, or with --curves the curves over the motion
    Csv,
    /// The hardpoints and the curves over the motion as a workbook
    Xlsx,
    /// The hardpoints as an Adams/Car subsystem
    Adams,
    /// The hardpoints in the layout of OptimumKinematics: a workbook, or a table (.csv, standard output)
    Optimumk,
    /// The axle's section of Assetto Corsa's suspensions.ini
    Assetto,
    /// Hardpoints, and centre lines of the links, for CAD
    Dxf,
    /// The space of the tyre over travel and steer, as solids for CAD
    Stl,
    /// A bushing as a property file of Adams Car
    Bus,
    /// The study at the exported design: rounded, or one design of a sweep
    Toml,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Names {
    /// Adams/Car
    Adams,
    /// Altair MotionView
    Altair,
    /// Suspension parameter measuring machine: refused, because its definitions are not published
    Spmm,
}

/// Length with its unit. Without a unit, the length has the unit of the file.
pub(super) type Step = (f64, Option<LengthUnit>);

fn step(text: &str) -> Result<Step, String> {
    let step = length_with_unit(text).filter(|(length, _)| LENGTHS.contains(length));
    step.ok_or_else(|| "expected a length above 0, as in 0.1 or 0.5mm".to_owned())
}

/// Range of the lengths that an option accepts, in the unit of the length.
const LENGTHS: RangeInclusive<f64> = 1e-9..=1e6;

fn length(text: &str) -> Result<f64, String> {
    let length = text.parse::<f64>().ok();
    let length = length.filter(|length| LENGTHS.contains(length));
    length.ok_or_else(|| "expected a length above 0, as in 0.1".to_owned())
}

/// Largest number of values in the range of `--travel` or `--rack`. The number of exported poses is the product of both numbers.
const MOST_VALUES: usize = 200;

fn span(text: &str) -> Result<Span, String> {
    let expected = || format!("expected two lengths, as in -30..30 or -30..30/9, found {text:?}");
    let (ends, values) = match text.split_once('/') {
        Some((ends, values)) => (ends, values.parse().map_err(|_| expected())?),
        None => (text, 9),
    };
    if !(2..=MOST_VALUES).contains(&values) {
        return Err(format!(
            "expected 2 to {MOST_VALUES} values, found {values}"
        ));
    }
    let (first, last) = ends.split_once("..").ok_or_else(expected)?;
    let end = |text: &str| {
        let number = text.trim().parse::<f64>().ok();
        number.filter(|n| n.abs() <= 1e6).ok_or_else(expected)
    };
    Ok(Span {
        ends: [end(first)?, end(last)?],
        values,
    })
}

pub(super) fn run(arguments: &ExportArguments) -> Result<Exit, Stop> {
    run_of(arguments, None)
}

/// Exports the given study. Without a given study, exports the source that the arguments name.
pub(super) fn run_of(arguments: &ExportArguments, given: Option<&Study>) -> Result<Exit, Stop> {
    check_call(arguments)?;
    let source = match given {
        Some(study) => Source::of_study(arguments, study.clone())?,
        None => match super::car::file_of(&arguments.source) {
            Some(car) => return super::car::export(arguments, &car),
            None => Source::read(arguments)?,
        },
    };
    let bytes = match arguments.to {
        Target::Csv if arguments.curves || arguments.names.is_some() => curves(&source, arguments)?,
        Target::Csv => csv(&point_rows(&source.outgoing()?)),
        Target::Xlsx => workbook(&source.pages()?),
        Target::Adams => say(adams(&source, arguments)?),
        Target::Optimumk => optimum_k(&source, arguments)?,
        Target::Assetto => {
            let refused = |reason: String| Stop::in_file(&arguments.source, reason);
            say(suspensions_ini(&source.outgoing()?).map_err(refused)?)
        }
        Target::Dxf => drawing(&source.outgoing()?),
        Target::Stl => envelope(&source, arguments)?,
        Target::Bus => {
            let refused = |reason: String| Stop::in_file(&arguments.source, reason);
            let written = property_file(&source.outgoing()?, arguments.bushing.as_deref());
            say(written.map_err(refused)?)
        }
        Target::Toml => source.study_text(file_of_out(&arguments.out))?.into_bytes(),
    };
    match file_of_out(&arguments.out) {
        None => std::io::stdout().write_all(&bytes)?,
        Some(out) => {
            save(out, &bytes, arguments.force, &inputs(&source, arguments))?;
            note_saved(out);
        }
    }
    Ok(Exit::of(source.keeps_constraints()))
}

/// Returns an error if options contradict each other, or do not work with the format of `--to`.
fn check_call(arguments: &ExportArguments) -> Result<(), Stop> {
    let to = arguments.to;
    let only = |given: bool, option: &str, target: Target, name: &str| {
        if given && to != target {
            Err(Stop::wrong_input(format!("{option} needs --to {name}")))
        } else {
            Ok(())
        }
    };
    only(arguments.into.is_some(), "--into", Target::Adams, "adams")?;
    only(arguments.bushing.is_some(), "--bushing", Target::Bus, "bus")?;
    if to == Target::Bus && (arguments.frame.is_some() || arguments.round.is_some()) {
        return Err(Stop::wrong_input(
            "a property file contains force laws, not points: leave out --frame and --round",
        ));
    }
    if to == Target::Toml && (arguments.unit.is_some() || arguments.frame.is_some()) {
        return Err(Stop::wrong_input(
            "--to toml keeps the unit and the axes of the study: leave out --unit and --frame, and use `hardpoint convert`",
        ));
    }
    only(arguments.curves, "--curves", Target::Csv, "csv")?;
    only(arguments.names.is_some(), "--names", Target::Csv, "csv")?;
    only(arguments.travel.is_some(), "--travel", Target::Stl, "stl")?;
    only(arguments.rack.is_some(), "--rack", Target::Stl, "stl")?;
    only(arguments.grow.is_some(), "--grow", Target::Stl, "stl")?;
    if arguments.round_all && arguments.round.is_none() {
        return Err(Stop::wrong_input("--round-all needs --round LENGTH"));
    }
    if arguments.names == Some(Names::Spmm) {
        return Err(Stop::wrong_input(
            "--names spmm: no public source defines the channels of that machine, so the names of \
             its channels are not available",
        ));
    }
    if matches!(to, Target::Xlsx | Target::Stl) && file_of_out(&arguments.out).is_none() {
        return Err(Stop::wrong_input(
            "workbooks and solids cannot be written to a terminal: give a file with --out",
        ));
    }
    let own_axes = match to {
        Target::Adams => Some((FrameConvention::XRear, "an Adams/Car subsystem")),
        Target::Optimumk => Some((FrameConvention::Iso8855, "OptimumKinematics")),
        _ => None,
    };
    if let (Some((own, what)), Some(asked)) = (own_axes, arguments.frame)
        && own != asked
    {
        return Err(Stop::wrong_input(format!(
            "--frame {}: {what} always has the axes {}; leave out --frame",
            asked.name(),
            own.name()
        )));
    }
    if to == Target::Assetto && (arguments.frame.is_some() || arguments.unit.is_some()) {
        return Err(Stop::wrong_input(
            "suspensions.ini has fixed axes and is in metres: leave out --unit and --frame",
        ));
    }
    if arguments.into.is_some() && arguments.unit.is_some() {
        return Err(Stop::wrong_input(
            "--into keeps the unit of the file: leave out --unit",
        ));
    }
    Ok(())
}

/// Files that the export reads: the files of the source, and the subsystem of `--into`.
fn inputs(source: &Source, arguments: &ExportArguments) -> Vec<PathBuf> {
    let mut inputs = source.inputs.clone();
    inputs.extend(arguments.into.clone());
    inputs
}

/// Prints the notes about content that the file format cannot contain, and returns the bytes of the exported file.
pub(super) fn say(written: Written) -> Vec<u8> {
    for line in written.notes {
        note(&format!("{line}\n"));
    }
    written.bytes
}

fn adams(source: &Source, arguments: &ExportArguments) -> Result<Written, Stop> {
    let outgoing = source.outgoing()?;
    let Some(path) = &arguments.into else {
        return Ok(subsystem(&outgoing));
    };
    if outgoing.different_wheels().len() > 1 {
        return Err(Stop::in_file(
            &arguments.source,
            "axle.right: --into writes only the left wheel, but the right wheel has different \
             points; leave out --into",
        ));
    }
    let refused = |reason: String| Stop::in_file(path, reason);
    let file = bytes_of(path).map_err(refused)?;
    into_subsystem(&outgoing, &file).map_err(refused)
}

fn optimum_k(source: &Source, arguments: &ExportArguments) -> Result<Vec<u8>, Stop> {
    let outgoing = source.outgoing()?;
    let refused = |reason: String| Stop::in_file(&arguments.source, reason);
    let (rows, notes) = optimum_k_rows(&outgoing).map_err(refused)?;
    let is_table = |out: &Path| {
        let extension = out.extension().unwrap_or_default();
        extension.eq_ignore_ascii_case("csv")
    };
    let bytes = if file_of_out(&arguments.out).is_none_or(is_table) {
        csv(&rows)
    } else {
        let position = outgoing.study.wheel().vehicle.position;
        let axle = position.map_or(String::new(), |axle| format!("{axle:?} "));
        let name = format!("{axle}Suspension");
        workbook(&[Page { name, rows }])
    };
    Ok(say(Written { bytes, notes }))
}

/// CSV table of the curves. With `--names`, the table has the names of another tool and only the curves that this tool defines.
fn curves(source: &Source, arguments: &ExportArguments) -> Result<Vec<u8>, Stop> {
    let outgoing = source.outgoing()?;
    let page = curves_in(&outgoing, source.curves()?);
    let tool = match arguments.names {
        None => return Ok(csv(&page.rows)),
        Some(Names::Adams) => Tool::Adams,
        Some(Names::Altair | Names::Spmm) => Tool::Altair,
    };
    let (named, left_out) = under_names_of(tool, &outgoing, &page);
    if !left_out.is_empty() {
        note(&format!(
            "omitted, because that tool publishes no curve with the same definition: {}\n",
            left_out.join(", ")
        ));
    }
    let motion = page.rows.first().map_or(0, Vec::len) - left_out.len();
    let is_named = |cell: &Value| matches!(cell, Value::Text(name) if name.contains('['));
    if motion == 0
        || !named
            .rows
            .first()
            .is_some_and(|row| row.iter().any(is_named))
    {
        return Err(Stop::in_file(
            &arguments.source,
            "none of its curves has a name in that tool; docs/exchange.md lists the curves that have one",
        ));
    }
    Ok(csv(&named.rows))
}

fn envelope(source: &Source, arguments: &ExportArguments) -> Result<Vec<u8>, Stop> {
    let outgoing = source.outgoing()?;
    let suspension = outgoing.study.wheel();
    let lacking = |key: &str, what: &str| {
        Stop::in_file(
            &arguments.source,
            format!("[wheel] {key} is missing: the envelope needs the {what}"),
        )
    };
    let radius = suspension.wheel_radius;
    let radius = radius.ok_or_else(|| lacking("radius", "radius of the tyre"))?;
    let width = suspension.tyre_width;
    let width = width.ok_or_else(|| lacking("tyre_width", "width of the tyre"))?;
    let travel = arguments
        .travel
        .ok_or_else(|| Stop::wrong_input("--to stl needs --travel, as in --travel -30..30"))?;
    let rack = arguments.rack.unwrap_or(Span {
        ends: [0.0; 2],
        values: 1,
    });
    let grow = arguments.grow.unwrap_or(0.0);
    let tyre = Tyre {
        radius: outgoing.length(radius) + grow,
        width: outgoing.length(width) + 2.0 * grow,
    };
    let envelope = Envelope::of(&outgoing, tyre, travel, rack)
        .map_err(|reason| Stop::not_met(format!("{}: {reason}", arguments.source.display())))?;
    let unit = outgoing.unit.symbol();
    let digits = match outgoing.unit {
        LengthUnit::Millimetre => 2,
        LengthUnit::Inch | LengthUnit::InchPound => 3,
        LengthUnit::Metre => 5,
    };
    note(&format!(
        "{} solids, one for each pose, {} triangles; unit {unit}, frame {}. Between the poses the \
         tyre reaches up to {:.digits$} {unit} outside the solids: more values (/N) reduce this, \
         --grow compensates for it.\n",
        envelope.solids.len(),
        envelope.triangles(),
        outgoing.convention.name(),
        envelope.gap()
    ));
    if arguments.grow.is_none() {
        note(&format!(
            "The radius is the loaded radius, {:?} {unit}; the unloaded tyre is larger. --grow \
             LENGTH increases radius and width on each side.\n",
            outgoing.length(radius)
        ));
    }
    Ok(envelope.stl())
}
