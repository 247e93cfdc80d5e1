//! `hardpoint import --car`: imports both axles of a file, and writes a study of the car that names them.

use super::exit::{Exit, Stop};
use super::import::{Answers, ImportArguments, Questions, origin};
use super::import_summary::{listed, roles, warnings};
use super::save::save_all;
use super::terminal::note;
use crate::exchange::{
    CAR_FILES, ImportOptions, ImportedCar, Notes, for_shell, import_car, read_car_points,
};
use crate::model::{AxlePosition, Topology};
use crate::study::CarStudy;
use std::collections::BTreeMap;
use std::path::Path;

/// Value of one axle, from a list with one value for both axles or one value for each axle. `end` is 0 for the front, 1 for the
/// rear.
fn of_axle<T: Copy>(values: &[T], end: usize) -> Option<T> {
    values.get(end).or(values.first()).copied()
}

pub(super) fn run(
    arguments: &ImportArguments,
    questions: &mut Questions<'_>,
    answers: &mut Answers,
) -> Result<Exit, Stop> {
    let directory = arguments.out.as_deref().expect("--car requires --out");
    for (count, flag) in [
        (arguments.topology.len(), "--topology"),
        (arguments.radius.len(), "--radius"),
    ] {
        if count > 2 {
            return Err(Stop::wrong_input(format!(
                "{flag}: expected one value for both axles, or FRONT,REAR"
            )));
        }
    }
    let table = questions.settle(answers, |answers| {
        read_car_points(&arguments.file, answers.sheet.as_deref())
    })?;
    let origin = origin(&arguments.file);
    let none = BTreeMap::new();
    let car = questions.settle(answers, |answers| {
        let topology = |end: usize, axle: AxlePosition| -> Result<&'static Topology, _> {
            match of_axle(&arguments.topology, end) {
                Some(topology) => Ok(topology),
                None => table.topology(Some(axle)),
            }
        };
        let options = |end: usize, axle: AxlePosition| {
            Ok::<_, crate::exchange::Refusal>(ImportOptions {
                topology: topology(end, axle)?,
                unit: answers.unit,
                frame: arguments.frame,
                axes: answers.axes,
                side: None,
                axle: Some(axle),
                half_track: None,
                radius: of_axle(&arguments.radius, end),
                bushings: false,
                names: &none,
                bodies: &none,
            })
        };
        let front = options(0, AxlePosition::Front)?;
        let rear = options(1, AxlePosition::Rear)?;
        import_car(&table, [&front, &rear], &origin)
    })?;
    let files = CAR_FILES.iter().zip(&car.files);
    let files: Vec<(&str, &str)> = files.map(|(name, text)| (*name, text.as_str())).collect();
    save_all(
        directory,
        &files,
        arguments.force,
        std::slice::from_ref(&arguments.file),
    )?;
    note(&summary(&arguments.file, directory, &car));
    Ok(Exit::Done)
}

fn summary(file: &Path, directory: &Path, car: &ImportedCar) -> String {
    let mut text = String::new();
    let mut notes = Notes::default();
    let mut left_out: Vec<String> = Vec::new();
    for (axle, name) in car.axles.iter().zip(crate::car::AXLE_NAMES) {
        text += &format!(
            "{}: {name} axle, {} hardpoints of {}, {}, {}\n{}",
            file.display(),
            axle.hardpoints.len(),
            axle.topology.name,
            axle.unit.symbol(),
            axle.frame.name(),
            roles(axle)
        );
        notes.add(&axle.notes);
        for line in &axle.left_out {
            if !left_out.contains(line) {
                left_out.push(line.clone());
            }
        }
    }
    notes.push(
        "rear drive is assumed, because files of points do not give the drive: drive_share_front = 0.0 in [car]"
            .to_owned(),
    );
    text = warnings(&notes) + &text;
    text += &listed("Values read and assumed", notes.facts());
    text += &listed("Left out", &left_out);
    let paths = CAR_FILES.map(|file| directory.join(file));
    let [whole, front, rear] = paths
        .each_ref()
        .map(|path| for_shell(&path.display().to_string()));
    if car.missing.is_empty() {
        if let Err(errors) = CarStudy::read(&paths[0], &[]) {
            text += &listed(
                "The car cannot be solved yet",
                [errors.render(false).trim_end().replace('\n', "\n  ")],
            );
        }
        text += &format!("To view it: hardpoint check {whole}, hardpoint studio {front}\n");
        return text;
    }
    text += &listed(
        "Missing data, needed before the car can be solved",
        &car.missing,
    );
    text += &format!("To view the axles: hardpoint studio {front}, hardpoint studio {rear}\n");
    text
}
