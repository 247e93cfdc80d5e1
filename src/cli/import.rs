//! `hardpoint import`: makes a study from a file of points.

use super::exit::{Exit, Stop};
use super::import_car;
use super::import_summary::{summary, warnings};
use super::instead::instead_of;
use super::save::{file_of_out, save};
use super::terminal::{eprint, note};
use crate::exchange::{
    Axes, FileUnit, ImportOptions, Imported, PointTable, Question, Refusal, STANDARD_INPUT,
    bytes_of, for_shell, import, read_map, read_points, unit_of,
};
use crate::model::{AxlePosition, FrameConvention, LengthUnit, Side, Topology};
use clap::Args;
use std::collections::BTreeMap;
use std::io::{BufRead, IsTerminal, Write};
use std::path::{Path, PathBuf};

/// Arguments of an import.
#[derive(Args)]
pub(super) struct ImportArguments {
    /// Points: a table (.csv, .xlsx), a map (.json, .yaml), an Adams/Car subsystem (.sub), suspensions.ini, or - for standard input
    pub(super) file: PathBuf,
    /// Kind of suspension, such as double_wishbone; for a car FRONT,REAR or one for both [default: from the file]
    #[arg(long, value_parser = topology, value_delimiter = ',', value_name = "TOPOLOGY")]
    pub(super) topology: Vec<&'static Topology>,
    /// Import both axles of the file as a car: three studies in the directory of --out
    #[arg(long, requires = "out", conflicts_with_all = ["side", "axle", "corner", "map", "body", "half_track"])]
    car: bool,
    /// TOML file with the name of each hardpoint in the file of points: lower_arm_front = "LCA 1"
    #[arg(long, value_name = "NAMES.toml")]
    map: Option<PathBuf>,
    /// Unit of length, mm, cm, m, in or ft [default: the file's, or the unit that gives the size of a car's suspension]
    #[arg(long, value_parser = file_unit)]
    unit: Option<FileUnit>,
    /// Axes: iso8855, sae_j670 or x_rear [default: from the file or its points]
    #[arg(long, value_parser = frame, conflicts_with = "axes")]
    pub(super) frame: Option<FrameConvention>,
    /// Directions of the file's x, y and z, each forward, rearward, left, right, up or down: left,forward,up
    #[arg(long, value_name = "X,Y,Z", value_parser = Axes::parse)]
    axes: Option<Axes>,
    /// Wheel to import: left or right [default: the left one, or the only one in the file]
    #[arg(long, value_parser = side)]
    side: Option<Side>,
    /// Axle to import from a file with two axles: front or rear
    #[arg(long, value_parser = axle)]
    axle: Option<AxlePosition>,
    /// Wheel to import from a file with four wheels: FL, FR, RL or RR
    #[arg(long, value_parser = corner, conflicts_with_all = ["axle", "side"])]
    corner: Option<(AxlePosition, Side)>,
    /// Distance of the wheel centre from the centre plane, for a file with its origin at the wheel
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    half_track: Option<f64>,
    /// Loaded radius of the wheels, in the file's unit; for a car FRONT,REAR or one for both
    #[arg(long, value_name = "LENGTH", value_parser = length, value_delimiter = ',')]
    pub(super) radius: Vec<f64>,
    /// Body that carries an end of a spring or rod, as in drop_link_outer=rocker; may be given more than once
    #[arg(long, value_name = "HARDPOINT=BODY", value_parser = body)]
    body: Vec<(String, String)>,
    /// Import the bushings of an Adams/Car subsystem, for `hardpoint kc`
    #[arg(long, conflicts_with = "car")]
    bushings: bool,
    /// Sheet of a workbook [default: the one with points]
    #[arg(long, value_name = "NAME")]
    sheet: Option<String>,
    /// File for the study [default: standard output]; directory for the files of a car
    #[arg(long, value_name = "STUDY")]
    pub(super) out: Option<PathBuf>,
    /// Replace an existing file, but never an input
    #[arg(long)]
    pub(super) force: bool,
}

/// Returns the topology with this name.
pub(super) fn topology(name: &str) -> Result<&'static Topology, String> {
    Topology::named(name).ok_or_else(|| {
        let names: Vec<&str> = Topology::ALL.iter().map(|t| t.name).collect();
        let answer = instead_of(name).map_or_else(String::new, |answer| format!("{answer}; "));
        format!("{answer}expected one of {}", names.join(", "))
    })
}

pub(super) fn unit(name: &str) -> Result<LengthUnit, String> {
    unit_of(name).ok_or_else(|| "expected mm, m or in".to_owned())
}

fn file_unit(name: &str) -> Result<FileUnit, String> {
    FileUnit::named(name).ok_or_else(|| "expected mm, cm, m, in or ft".to_owned())
}

pub(super) fn frame(name: &str) -> Result<FrameConvention, String> {
    FrameConvention::named(name).ok_or_else(|| "expected iso8855, sae_j670 or x_rear".to_owned())
}

pub(super) fn side(name: &str) -> Result<Side, String> {
    let mut all = Side::ALL.into_iter();
    all.find(|side| side.name() == name)
        .ok_or_else(|| "expected left or right".to_owned())
}

fn axle(name: &str) -> Result<AxlePosition, String> {
    match name {
        "front" => Ok(AxlePosition::Front),
        "rear" => Ok(AxlePosition::Rear),
        _ => Err("expected front or rear".to_owned()),
    }
}

fn corner(name: &str) -> Result<(AxlePosition, Side), String> {
    match name.to_ascii_uppercase().as_str() {
        "FL" => Ok((AxlePosition::Front, Side::Left)),
        "FR" => Ok((AxlePosition::Front, Side::Right)),
        "RL" => Ok((AxlePosition::Rear, Side::Left)),
        "RR" => Ok((AxlePosition::Rear, Side::Right)),
        _ => Err("expected FL, FR, RL or RR".to_owned()),
    }
}

fn length(text: &str) -> Result<f64, String> {
    let length = text.parse::<f64>().ok();
    let length = length.filter(|length| (1e-9..=1e6).contains(length));
    length.ok_or_else(|| "expected a length above 0, as in 600".to_owned())
}

fn body(text: &str) -> Result<(String, String), String> {
    let parts = text.split_once('=');
    let parts =
        parts.map(|(hardpoint, body)| (hardpoint.trim().to_owned(), body.trim().to_owned()));
    parts.ok_or_else(|| "expected HARDPOINT=BODY, as in drop_link_outer=rocker".to_owned())
}

/// Answers to the questions that the content of a file leaves open.
#[derive(Clone, Default)]
pub(super) struct Answers {
    pub(super) sheet: Option<String>,
    pub(super) unit: Option<FileUnit>,
    pub(super) axes: Option<Axes>,
    side: Option<Side>,
    axle: Option<AxlePosition>,
    half_track: Option<f64>,
}

impl Answers {
    fn of(arguments: &ImportArguments) -> Self {
        let corner = arguments.corner;
        Answers {
            sheet: arguments.sheet.clone(),
            unit: arguments.unit,
            axes: arguments.axes,
            side: arguments.side.or(corner.map(|(_, side)| side)),
            axle: arguments.axle.or(corner.map(|(axle, _)| axle)),
            half_track: arguments.half_track,
        }
    }

    /// Stores an answer in the same way as its command-line flag.
    fn take(&mut self, flag: &str, value: &str) -> Result<(), String> {
        match flag {
            "--sheet" => self.sheet = Some(value.to_owned()),
            "--unit" => self.unit = Some(file_unit(value)?),
            "--axes" => self.axes = Some(Axes::parse(value)?),
            "--side" => self.side = Some(side(value)?),
            "--axle" => self.axle = Some(axle(value)?),
            "--half-track" => self.half_track = Some(length(value)?),
            _ => return Err(format!("{flag} cannot be asked for here")),
        }
        Ok(())
    }
}

/// Largest number of questions that a file leaves open: sheet, axle, side, unit, axes and half track.
const MOST_QUESTIONS: usize = 6;

/// Asks the user the questions that a file leaves open.
pub(super) struct Questions<'a> {
    file: &'a Path,
    can_ask: bool,
    asked: usize,
}

impl<'a> Questions<'a> {
    fn of(arguments: &'a ImportArguments, can_ask: bool) -> Self {
        Questions {
            file: &arguments.file,
            can_ask,
            asked: 0,
        }
    }

    /// Returns the result of `read` for the answers so far. If `read` returns an open question, the program asks the user at
    /// the terminal. Without a terminal or an answer, the question becomes the reason of the refusal.
    pub(super) fn settle<T>(
        &mut self,
        answers: &mut Answers,
        mut read: impl FnMut(&Answers) -> Result<T, Refusal>,
    ) -> Result<T, Stop> {
        let refused = |reason: String| Stop::in_file(self.file, reason);
        loop {
            let question = match read(answers) {
                Ok(found) => return Ok(found),
                Err(Refusal::Open(question)) if self.can_ask && self.asked < MOST_QUESTIONS => {
                    question
                }
                Err(refusal) => return Err(refused(refusal.to_string())),
            };
            self.asked += 1;
            eprint(&format!("{}: {}\n", self.file.display(), question.reason));
            let answer = ask(&question, &mut std::io::stdin().lock(), eprint);
            let Some((flag, value)) = answer else {
                return Err(refused(Refusal::Open(question).to_string()));
            };
            answers.take(flag, &value).map_err(refused)?;
            eprint(&format!("In a script: {flag} {}\n", for_shell(&value)));
        }
    }
}

pub(super) fn run(arguments: &ImportArguments) -> Result<Exit, Stop> {
    let names = match &arguments.map {
        Some(path) => names(path)?,
        None => BTreeMap::new(),
    };
    let mut answers = Answers::of(arguments);
    let is_input = arguments.file == Path::new(STANDARD_INPUT);
    let has_terminal = std::io::stdin().is_terminal() && std::io::stderr().is_terminal();
    let can_ask = has_terminal && !is_input;
    let mut questions = Questions::of(arguments, can_ask);
    if arguments.car {
        return import_car::run(arguments, &mut questions, &mut answers);
    }
    let table = questions.settle(&mut answers, |answers| {
        read_points(&arguments.file, answers.sheet.as_deref(), answers.axle)
    })?;
    let mut imported = imported(arguments, &table, &names, &mut questions, &mut answers)?;
    let study = study_text(arguments, &mut imported)?;
    let out = file_of_out(&arguments.out);
    match out {
        Some(out) => {
            let inputs = [Some(arguments.file.clone()), arguments.map.clone()];
            let inputs: Vec<PathBuf> = inputs.into_iter().flatten().collect();
            save(out, study.as_bytes(), arguments.force, &inputs)?;
        }
        None => std::io::stdout().write_all(study.as_bytes())?,
    }
    let shown = arguments.file.display();
    let (count, kind) = (imported.hardpoints.len(), imported.topology.name);
    let summary = summary(&imported, Some(out));
    let part = if imported.topology.carries_both_wheels() {
        "left half".to_owned()
    } else {
        format!("{} wheel", imported.side.name())
    };
    note(&format!(
        "{}{shown}: {count} hardpoints of {kind}, {part}, {}, {}\n{summary}",
        warnings(&imported.notes),
        imported.unit.symbol(),
        imported.frame.name()
    ));
    Ok(Exit::Done)
}

/// Imports without writing a file. Returns the text of the study and the summary. `points` is a JSON map that replaces the file.
/// `names` has priority over the names of `--map`.
pub(super) fn in_memory(
    arguments: &ImportArguments,
    points: Option<&str>,
    names: &BTreeMap<String, String>,
) -> Result<(String, String), Stop> {
    if arguments.car {
        return Err(Stop::wrong_input(
            "--car writes three studies, but this function returns one study: leave out --car",
        ));
    }
    let mut all = match &arguments.map {
        Some(path) => self::names(path)?,
        None => BTreeMap::new(),
    };
    all.extend(names.clone());
    let names = &all;
    let mut answers = Answers::of(arguments);
    let mut questions = Questions::of(arguments, false);
    let table = questions.settle(&mut answers, |answers| match points {
        Some(json) => read_map(json),
        None => read_points(&arguments.file, answers.sheet.as_deref(), answers.axle),
    })?;
    let mut imported = imported(arguments, &table, names, &mut questions, &mut answers)?;
    let study = study_text(arguments, &mut imported)?;
    let summary = warnings(&imported.notes) + &summary(&imported, None);
    Ok((study, summary))
}

/// Makes a suspension from a table of points.
fn imported(
    arguments: &ImportArguments,
    table: &PointTable,
    names: &BTreeMap<String, String>,
    questions: &mut Questions<'_>,
    answers: &mut Answers,
) -> Result<Imported, Stop> {
    let only_one = |count: usize, flag: &str| match count {
        0 | 1 => Ok(()),
        _ => Err(Stop::wrong_input(format!(
            "{flag}: expected one value; two values need --car"
        ))),
    };
    only_one(arguments.topology.len(), "--topology")?;
    only_one(arguments.radius.len(), "--radius")?;
    let bodies: BTreeMap<String, String> = arguments.body.iter().cloned().collect();
    questions.settle(answers, |answers| {
        let topology = match arguments.topology.first() {
            Some(topology) => *topology,
            None => table.topology(answers.axle)?,
        };
        let options = ImportOptions {
            topology,
            unit: answers.unit,
            frame: arguments.frame,
            axes: answers.axes,
            side: answers.side,
            axle: answers.axle,
            half_track: answers.half_track,
            radius: arguments.radius.first().copied(),
            bushings: arguments.bushings,
            names,
            bodies: &bodies,
        };
        import(table, &options)
    })
}

/// Name of the file with the points, or `standard input`, for a comment in the imported study.
pub(super) fn origin(file: &Path) -> String {
    if file == Path::new(STANDARD_INPUT) {
        return "standard input".to_owned();
    }
    let name = file.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// Text of the imported study, if its points form a suspension. Adds warnings about the points, and a note if the range of motion
/// is shorter than usual.
fn study_text(arguments: &ImportArguments, imported: &mut Imported) -> Result<String, Stop> {
    let study = imported.study_and_notes("the imported study", &origin(&arguments.file));
    let (text, notes) = study.map_err(|reason| {
        let summary = warnings(&imported.notes) + &summary(imported, None);
        let reason = format!("the points do not form a valid suspension\n{summary}{reason}");
        Stop::in_file(&arguments.file, reason)
    })?;
    imported.notes.add(&notes);
    Ok(text)
}

/// Asks a question until the user answers it. `None` at the end of the input, or after three lines that are no answer.
fn ask(
    question: &Question,
    input: &mut impl BufRead,
    mut say: impl FnMut(&str),
) -> Option<(&'static str, String)> {
    for (number, (flag, value)) in question.choices.iter().enumerate() {
        let value = for_shell(value);
        say(&format!("  {}) {flag} {value}\n", number + 1));
    }
    let last = question.choices.len();
    if let Some((flag, example)) = question.free {
        say(&format!("  or a value for {flag}: {example}\n"));
    }
    const MOST_TRIES: usize = 3;
    for _ in 0..MOST_TRIES {
        say("> ");
        let mut line = String::new();
        if input.read_line(&mut line).ok()? == 0 {
            return None;
        }
        let answer = line.trim();
        let number = answer.parse::<usize>().ok();
        let by_number =
            number.filter(|n| (1..=last).contains(n) && question.free.is_none_or(|_| *n <= last));
        let chosen = by_number.map(|n| &question.choices[n - 1]);
        let chosen = chosen.or_else(|| question.choices.iter().find(|(_, value)| value == answer));
        if let Some((flag, value)) = chosen {
            return Some((flag, value.clone()));
        }
        if let Some((flag, _)) = question.free
            && !answer.is_empty()
        {
            return Some((flag, answer.to_owned()));
        }
    }
    None
}

/// Reads the user's map from hardpoints to names in the file.
fn names(path: &Path) -> Result<BTreeMap<String, String>, Stop> {
    let refused = |reason: String| Stop::in_file(path, reason);
    let text = bytes_of(path).map_err(refused)?;
    let text = String::from_utf8(text).map_err(|_| refused("it is not UTF-8 text".to_owned()))?;
    toml::from_str(&text).map_err(|error| {
        refused(format!(
            "expected lines such as lower_arm_front = \"LCA 1\": {}",
            error.message().replace('\n', "; ")
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A question accepts the number of a choice, or a value. If the choices are fixed, the question accepts no other value.
    #[test]
    fn questions_take_answers_that_flags_take() {
        let of_axle = Question {
            reason: String::new(),
            choices: vec![
                ("--axle", "front".to_owned()),
                ("--axle", "rear".to_owned()),
            ],
            free: None,
        };
        let of_track = Question {
            reason: String::new(),
            choices: Vec::new(),
            free: Some(("--half-track", "LENGTH")),
        };
        let answer = |question: &Question, text: &str| ask(question, &mut text.as_bytes(), |_| ());
        let rear = Some(("--axle", "rear".to_owned()));
        assert_eq!(answer(&of_axle, "2\n"), rear);
        assert_eq!(answer(&of_axle, "middle\nrear\n"), rear);
        assert_eq!(answer(&of_axle, "3\n\nboth\nrear\n"), None);
        assert_eq!(answer(&of_axle, ""), None);
        let track = Some(("--half-track", "610".to_owned()));
        assert_eq!(answer(&of_track, "610\n"), track);
        let mut answers = Answers::default();
        answers.take("--axle", "rear").unwrap();
        answers.take("--half-track", "610").unwrap();
        assert_eq!(
            (answers.axle, answers.half_track),
            (Some(AxlePosition::Rear), Some(610.0))
        );
        assert!(answers.take("--half-track", "wide").is_err());
    }
}
