//! A file of points, whatever its format: a table of text, a workbook, a map in JSON or YAML, a subsystem of
//! Adams/Car or a `suspensions.ini` of Assetto Corsa.

use super::adams::{self, Symmetry};
use super::axes::{Axes, Declared};
use super::names::marks_of_title;
use super::table::{Figure, Marks, NamedPoint, PointTable};
use super::{assetto_in, delimited, map, points, workbook, yaml};
use crate::model::{AxlePosition, FrameConvention, Side};
use crate::study::read_bytes;
use std::path::Path;

/// The largest file that is read, in bytes.
const MOST_BYTES: u64 = 64 << 20;

/// Points of a file; `sheet` names a sheet of a workbook, `axle` one of two axles.
pub fn read(
    path: &Path,
    sheet: Option<&str>,
    axle: Option<AxlePosition>,
) -> Result<PointTable, String> {
    let bytes = bytes_of(path)?;
    let is_workbook = bytes.starts_with(b"PK\x03\x04");
    if !is_workbook && let Some(sheet) = sheet {
        return Err(format!(
            "the file is not a workbook, so it has no sheet {sheet:?}"
        ));
    }
    if is_workbook {
        return of_workbook(bytes, sheet, axle);
    }
    // The container of old binary workbooks and of encrypted ones.
    if bytes.starts_with(&[0xd0, 0xcf, 0x11, 0xe0]) {
        return Err("it is an old or an encrypted workbook; save it as .xlsx or .csv".to_owned());
    }
    let text = decoded(&bytes)?;
    if adams::is_subsystem(&text) {
        return of_subsystem(&text);
    }
    if assetto_in::is_ini(path, &text) {
        return assetto_in::points_of(&text);
    }
    if yaml::is_named(path) {
        return map::points_of(&yaml::read(&text)?)?.ok_or_else(|| NO_POINTS.to_owned());
    }
    if map::is_json(&text) {
        return map::points_of(&map::of_json(&text)?)?.ok_or_else(|| NO_POINTS.to_owned());
    }
    let table = points::read(&delimited::read(&text)?)?;
    table.ok_or_else(|| NO_POINTS.to_owned())
}

const NO_POINTS: &str = "it has no table of points: a header with a column of names and the columns x, y and z, \
                         or lines of a name and three numbers, or names with three numbers in JSON or YAML";

/// The bytes of a file, up to a bound. Devices and named pipes are refused.
pub fn bytes_of(path: &Path) -> Result<Vec<u8>, String> {
    read_bytes(path, MOST_BYTES)
}

/// Text in UTF-8, in UTF-16 with its mark as spreadsheets write it, or else a byte for each character.
fn decoded(bytes: &[u8]) -> Result<String, String> {
    let wide = |big: bool| {
        let units = bytes[2..].chunks_exact(2).map(|pair| match big {
            true => u16::from_be_bytes([pair[0], pair[1]]),
            false => u16::from_le_bytes([pair[0], pair[1]]),
        });
        char::decode_utf16(units)
            .map(|c| c.unwrap_or('\u{fffd}'))
            .collect()
    };
    let text = match bytes {
        [0xff, 0xfe, ..] => wide(false),
        [0xfe, 0xff, ..] => wide(true),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            Err(_) => adams::text_of(bytes),
        },
    };
    match text.contains('\0') {
        true => Err("it is no text, no workbook and no subsystem of Adams/Car".to_owned()),
        false => Ok(text),
    }
}

fn of_workbook(
    bytes: Vec<u8>,
    wanted: Option<&str>,
    axle: Option<AxlePosition>,
) -> Result<PointTable, String> {
    let book = workbook::Workbook::open(bytes)?;
    let names: Vec<String> = book.names().map(str::to_owned).collect();
    let quoted = |names: &[String]| {
        let quoted: Vec<String> = names.iter().map(|name| format!("{name:?}")).collect();
        quoted.join(", ")
    };
    if let Some(wanted) = wanted {
        let found = names.iter().position(|name| name == wanted);
        let number = found
            .ok_or_else(|| format!("there is no sheet {wanted:?}; there are {}", quoted(&names)))?;
        let table = points::read(&book.sheet(number)?)?;
        return table.ok_or_else(|| format!("sheet {wanted:?}: {NO_POINTS}"));
    }
    let mut found: Vec<(String, PointTable)> = Vec::new();
    let mut refused = None;
    for (number, name) in names.iter().enumerate() {
        // A sheet that the user did not name may hold anything.
        match book.sheet(number).and_then(|sheet| points::read(&sheet)) {
            Ok(Some(table)) => found.push((name.clone(), table)),
            Ok(None) => (),
            Err(reason) => refused = refused.or(Some(format!("sheet {name:?}: {reason}"))),
        }
    }
    let mut by_axle = false;
    // `--axle` chooses between sheets named after axles.
    let axle_of = |name: &str| {
        let words = super::names::cut(name);
        let of = |wanted: &str| words.iter().any(|word| word == wanted);
        match (of("front"), of("rear")) {
            (true, false) => Some(AxlePosition::Front),
            (false, true) => Some(AxlePosition::Rear),
            _ => marks_of_title(name).and_then(|marks| marks.axle),
        }
    };
    if found.len() > 1 && axle.is_some() {
        let of_axle = found.iter().filter(|(name, _)| axle_of(name) == axle);
        if of_axle.count() == 1 {
            found.retain(|(name, _)| axle_of(name) == axle);
            by_axle = true;
        }
    }
    match found.len() {
        0 => Err(refused.unwrap_or_else(|| NO_POINTS.to_owned())),
        1 => {
            let (name, mut table) = found.remove(0);
            if names.len() > 1 {
                table.notes.push(match by_axle {
                    true => format!("sheet {name:?}: the one of the axle that --axle names"),
                    false => format!("sheet {name:?}: the only one with points"),
                });
            }
            Ok(table)
        }
        _ => {
            let with_points: Vec<String> = found.into_iter().map(|(name, _)| name).collect();
            let names = quoted(&with_points);
            let of_axles = with_points.iter().any(|name| axle_of(name).is_some());
            Err(format!(
                "points are in several sheets, {names}: choose one with --sheet{}",
                if of_axles { " or --axle" } else { "" }
            ))
        }
    }
}

fn of_subsystem(text: &str) -> Result<PointTable, String> {
    let subsystem = adams::read(text)?;
    let mut table = PointTable {
        unit: subsystem.length,
        declared: Declared::whole(Axes::of(FrameConvention::XRear)),
        ..PointTable::default()
    };
    if let Some(template) = &subsystem.template {
        table
            .notes
            .push(format!("a subsystem of Adams/Car, made for {template}"));
    }
    for point in subsystem.points {
        let side = match point.symmetry {
            Symmetry::Left => Some(Side::Left),
            Symmetry::Right => Some(Side::Right),
            Symmetry::Both | Symmetry::Single => None,
        };
        table.points.push(NamedPoint {
            read_as: point.name.clone(),
            name: point.name,
            marks: Marks { side, axle: None },
            mirrored: point.symmetry == Symmetry::Both,
            position: Ok(point.position),
            body: None,
            place: format!("line {}", point.line),
        });
    }
    for parameter in subsystem.parameters {
        // Only these two are geometry, and the same for both wheels in nearly every file.
        let is_angle = ["camber_angle", "toe_angle"].contains(&parameter.name.as_str());
        if is_angle && parameter.symmetry != Symmetry::Right {
            let degrees = match subsystem.degrees {
                true => parameter.value,
                false => parameter.value.to_degrees(),
            };
            table.figures.push(Figure {
                read_as: parameter.name.clone(),
                name: parameter.name,
                value: degrees,
                marks: Marks::default(),
                remark: String::new(),
                place: format!("line {}", parameter.line),
            });
        }
    }
    Ok(table)
}
