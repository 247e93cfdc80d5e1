//! Reads a file of points. The formats are: text table, workbook, map in JSON or YAML, Adams/Car subsystem, Project Chrono
//! vehicle, Assetto Corsa `suspensions.ini`.

use super::adams::{self, Symmetry};
use super::axes::{Axes, Declared};
use super::refusal::Refusal;
use super::subsystem::ANGLES;
use super::table::{Figure, Marks, NamedPoint, PointTable};
use super::unit::FileUnit;
use super::{adams_bushings, assetto_in, chrono_vehicle, delimited, map, points, sheets, yaml};
use crate::model::{AxlePosition, FrameConvention, LengthUnit, Side};
use crate::study::{read_bytes, read_input_bytes};
use std::path::Path;

/// Largest size of a file that is read, in bytes.
const MOST_BYTES: u64 = 64 << 20;

/// Path that means standard input.
pub const STANDARD_INPUT: &str = "-";

/// Points of a file, or of standard input for the path `-`. `sheet` names a sheet of a workbook; `axle` selects one of two axles.
///
/// # Errors
/// The file has no readable points, or several sheets of a workbook have points and none is named.
pub fn read(
    path: &Path,
    sheet: Option<&str>,
    axle: Option<AxlePosition>,
) -> Result<PointTable, Refusal> {
    of_bytes(path, all_bytes(path)?, sheet, axle)
}

/// Points of both axles of a car. Without `sheet`, a workbook with one sheet for each axle gives the points of both sheets.
///
/// # Errors
/// The file has no readable points, it has points of one axle only, or the sheets of both axles contradict each other.
pub fn read_car(path: &Path, sheet: Option<&str>) -> Result<PointTable, Refusal> {
    let bytes = all_bytes(path)?;
    let table = match sheet {
        None if is_workbook(&bytes) => sheets::of_car(bytes)?,
        _ => of_bytes(path, bytes, sheet, None)?,
    };
    if table.has_two_axles() {
        Ok(table)
    } else {
        Err(Refusal::Wrong(
            "--car: the file does not have points of a front and a rear axle".to_owned(),
        ))
    }
}

/// Bytes of a file, or of standard input for the path `-`.
fn all_bytes(path: &Path) -> Result<Vec<u8>, String> {
    if path == Path::new(STANDARD_INPUT) {
        read_input_bytes(MOST_BYTES)
    } else {
        bytes_of(path)
    }
}

fn is_workbook(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
}

fn of_bytes(
    path: &Path,
    bytes: Vec<u8>,
    sheet: Option<&str>,
    axle: Option<AxlePosition>,
) -> Result<PointTable, Refusal> {
    if is_workbook(&bytes) {
        return sheets::of_workbook(bytes, sheet, axle);
    }
    if let Some(sheet) = sheet {
        return Err(Refusal::Wrong(format!(
            "the file is not a workbook, so it has no sheet {sheet:?}"
        )));
    }
    of_plain_file(path, &bytes).map_err(Refusal::Wrong)
}

/// Points of a JSON map in memory.
///
/// # Errors
/// The map has no points.
pub fn read_map(json: &str) -> Result<PointTable, Refusal> {
    of_plain_file(Path::new("points.json"), json.as_bytes()).map_err(Refusal::Wrong)
}

/// Points of a file that is not a workbook.
fn of_plain_file(path: &Path, bytes: &[u8]) -> Result<PointTable, String> {
    if let Some(kind) = cad(path, bytes) {
        return Err(format!(
            "it is a {kind} file, and the import reads no CAD files. Export the points from CAD as a table with names, x, y and z \
             (.csv or .xlsx), and import the table. If its names are not known, assign them with --map"
        ));
    }
    // Old binary workbooks and encrypted workbooks begin with these bytes.
    if bytes.starts_with(&[0xd0, 0xcf, 0x11, 0xe0]) {
        return Err("it is an old or an encrypted workbook; save it as .xlsx or .csv".to_owned());
    }
    let text = decoded(bytes)?;
    if adams::is_subsystem(&text) {
        return of_subsystem(path, &text);
    }
    if assetto_in::is_ini(path, &text) {
        return assetto_in::points_of(path, &text);
    }
    if text.lines().any(|line| line.trim() == "[BODY]") && text.contains("[BAR]") {
        return Err(
            "it is a suspension of rFactor (.pm), bodies and bars without names of hardpoints; give its points as a table \
             of names, x, y and z"
                .to_owned(),
        );
    }
    if yaml::is_named(path) {
        return map::points_of(&yaml::read(&text)?)?.ok_or_else(|| NO_POINTS.to_owned());
    }
    if map::is_json(&text) {
        let root = map::of_json(&text).map_err(|reason| match path.extension() {
            Some(extension) if !extension.eq_ignore_ascii_case("json") => {
                format!("{NO_POINTS}; it begins like JSON, but it is {reason}")
            }
            _ => reason,
        })?;
        if let Some(table) = chrono_vehicle::read(path, &root)? {
            return Ok(table);
        }
        return map::points_of(&root)?.ok_or_else(|| NO_POINTS.to_owned());
    }
    let table = points::read(&delimited::read(&text)?)?;
    table.ok_or_else(|| NO_POINTS.to_owned())
}

/// Kind of a CAD file, by its content or the ending of its name. `None` for other files.
fn cad(path: &Path, bytes: &[u8]) -> Option<&'static str> {
    const ENDINGS: &[(&str, &str)] = &[
        ("dxf", "DXF"),
        ("dwg", "DWG"),
        ("step", "STEP"),
        ("stp", "STEP"),
        ("iges", "IGES"),
        ("igs", "IGES"),
        ("stl", "STL"),
        ("sldprt", "SolidWorks"),
        ("sldasm", "SolidWorks"),
        ("catpart", "CATIA"),
        ("catproduct", "CATIA"),
    ];
    let begins = bytes.trim_ascii_start();
    if begins.starts_with(b"ISO-10303-21;") {
        return Some("STEP");
    }
    let second = begins.strip_prefix(b"0").unwrap_or_default();
    if second.trim_ascii_start().starts_with(b"SECTION") {
        return Some("DXF");
    }
    let ending = path.extension()?.to_str()?;
    let mut known = ENDINGS.iter();
    let found = known.find(|(known, _)| ending.eq_ignore_ascii_case(known));
    found.map(|(_, kind)| *kind)
}

pub(super) const NO_POINTS: &str = "it has no table of points: a header with a column of names \
                                    and the columns x, y and z, or lines with a name and three \
                                    numbers, or names with three numbers in JSON or YAML";

/// Bytes of a file. Refuses files above 64 MiB, devices and named pipes.
pub fn bytes_of(path: &Path) -> Result<Vec<u8>, String> {
    read_bytes(path, MOST_BYTES)
}

/// Decodes a text: UTF-8, or UTF-16 with a byte-order mark as spreadsheets write it, or else one byte per character. A zero
/// character is an error.
pub(super) fn decoded(bytes: &[u8]) -> Result<String, String> {
    let wide = |big: bool| {
        let units = bytes[2..].chunks_exact(2).map(|pair| {
            if big {
                u16::from_be_bytes([pair[0], pair[1]])
            } else {
                u16::from_le_bytes([pair[0], pair[1]])
            }
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
    if text.contains('\0') {
        Err("it is not a text, a workbook or a subsystem of Adams/Car".to_owned())
    } else {
        Ok(text)
    }
}

fn of_subsystem(path: &Path, text: &str) -> Result<PointTable, String> {
    let subsystem = adams::read(text)?;
    let unit = subsystem.length.unwrap_or(LengthUnit::Millimetre);
    let mut table = PointTable {
        unit: subsystem.length.map(FileUnit::of),
        declared: Declared::whole(Axes::of(FrameConvention::XRear)),
        bushings: adams_bushings::of_subsystem(path, text, unit),
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
            position: Ok(point.content),
            has_number: true,
            body: None,
            place: format!("line {}", point.line),
        });
    }
    let has_right: Vec<String> = subsystem
        .parameters
        .iter()
        .filter(|parameter| parameter.symmetry == Symmetry::Right)
        .map(|parameter| parameter.name.clone())
        .collect();
    for parameter in subsystem.parameters {
        // Camber and toe are the only parameters that describe the geometry. If only the left wheel has a value, it applies to
        // both wheels.
        let is_angle = ANGLES.contains(&parameter.name.as_str());
        let side = match parameter.symmetry {
            Symmetry::Right => Some(Side::Right),
            Symmetry::Left if has_right.contains(&parameter.name) => Some(Side::Left),
            _ => None,
        };
        if is_angle {
            let degrees = parameter.angle(subsystem.degrees);
            table.figures.push(Figure {
                read_as: parameter.name.clone(),
                name: parameter.name,
                value: degrees,
                marks: Marks { side, axle: None },
                remark: String::new(),
                place: format!("line {}", parameter.line),
            });
        }
    }
    Ok(table)
}
