//! Points of a study as a table.

use super::outgoing::Outgoing;
use super::workbook::{Page, Value};
use crate::model::{PointId, Side, SpinAxis};

/// Points of a study as a table. Each point has a row with its wheel and axes. The row also has the body that carries the
/// point, if another body is possible. Rows for static camber and toe follow, if no point defines them, and a row for the wheel's
/// radius. The header names the unit.
pub fn point_rows(outgoing: &Outgoing<'_>) -> Vec<Vec<Value>> {
    let unit = outgoing.unit.symbol();
    let text = |text: &str| Value::Text(text.to_owned());
    let header = [
        "hardpoint",
        &format!("x_{unit}"),
        &format!("y_{unit}"),
        &format!("z_{unit}"),
        "side",
        "frame",
        "body",
    ]
    .map(text);
    let mut rows = vec![header.to_vec()];
    for side in outgoing.different_wheels() {
        for (name, id, position) in outgoing.points(side) {
            let [x, y, z] = position.map(Value::Number);
            let (id, name, row_side) = match right_half(outgoing, id) {
                Half::Right(near, name) => (near, name, Side::Right),
                Half::MirrorImage => continue,
                Half::Left => (id, name, side),
            };
            let body = outgoing.body(side, id).map_or(Value::Empty, text);
            let (side, frame) = (text(row_side.name()), text(outgoing.convention.name()));
            rows.push(vec![text(name), x, y, z, side, frame, body]);
        }
    }
    for (name, number) in figures(outgoing) {
        rows.push(vec![Value::Text(name), Value::Number(number)]);
    }
    rows
}

/// Half of a solid axle or a twist beam to which a point belongs.
enum Half<'a> {
    /// Left half. Every point of an independent wheel counts as left.
    Left,
    /// Right half, as the mirror image of a point on the left. The table has no row for such a point.
    MirrorImage,
    /// Right half, with its own row. Contains the matching point of the left half and the name of that point.
    Right(PointId, &'a str),
}

/// Finds the half to which a point belongs.
fn right_half<'a>(outgoing: &'a Outgoing<'_>, id: PointId) -> Half<'a> {
    let mechanism = &outgoing.study.wheel().mechanism;
    let pairs = mechanism.rigid_axle.iter().flat_map(|axle| &axle.pairs);
    let Some([near, _]) = pairs.into_iter().find(|[_, far]| *far == id) else {
        // Some points of the right half move with other points, for example in a twist beam. A study does not give them, so
        // they have no row.
        return if mechanism.is_far(id) {
            Half::MirrorImage
        } else {
            Half::Left
        };
    };
    let place = |id: PointId| outgoing.place(Side::Left, id);
    let (left, right) = (place(*near), place(id));
    let name = mechanism.name(*near);
    // In an axle with a Panhard rod, the importer reads an upper link as a single link if its right half has no row.
    let may_be_single =
        name.starts_with("upper_link_") && mechanism.point("panhard_axle").is_some();
    if (right.x, right.y, right.z) == (left.x, -left.y, left.z) && !may_be_single {
        Half::MirrorImage
    } else {
        Half::Right(*near, name)
    }
}

/// Static angles in degrees that no point defines, and the wheel radius in the file's unit, with their names.
fn figures(outgoing: &Outgoing<'_>) -> Vec<(String, f64)> {
    let mut figures = Vec::new();
    let wheels = outgoing.different_wheels();
    for (number, side) in wheels.into_iter().enumerate() {
        let suspension = outgoing.suspension(side);
        if matches!(suspension.mechanism.spin_axis, SpinAxis::From(_)) {
            continue;
        }
        // Only an axle has a separate right wheel.
        let prefix = match (number, side) {
            (1, Side::Right) => "right_",
            _ => "",
        };
        let names = ["static_camber_deg", "static_toe_deg"];
        for (name, angle) in names.iter().zip(outgoing.static_angles(side)) {
            figures.push((format!("{prefix}{name}"), angle));
        }
    }
    let radius = outgoing.study.wheel().wheel_radius;
    let unit = outgoing.unit.symbol();
    figures.extend(radius.map(|r| (format!("wheel_radius_{unit}"), outgoing.length(r))));
    figures
}

/// Rows as comma-separated text. Short rows get empty cells up to the longest row.
pub fn csv(rows: &[Vec<Value>]) -> Vec<u8> {
    let mut writer = csv::WriterBuilder::new()
        .flexible(true)
        .from_writer(Vec::new());
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    for row in rows {
        let cell = |column: usize| match row.get(column) {
            Some(Value::Text(text)) => text.clone(),
            Some(Value::Number(number)) => format!("{:?}", number + 0.0),
            Some(Value::Empty) | None => String::new(),
        };
        let record: Vec<String> = (0..columns).map(cell).collect();
        writer
            .write_record(&record)
            .expect("writing to memory does not fail");
    }
    writer
        .into_inner()
        .expect("writing to memory does not fail")
}

/// Converts a CSV file of results to a sheet, with cells of finite numbers as numbers.
///
/// # Errors
/// The file is not valid CSV with rows of equal length, or has more rows than a sheet.
pub fn page_of_csv(name: &str, text: &[u8]) -> Result<Page, String> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(text);
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| error.to_string())?;
        let cell = |text: &str| match text.parse::<f64>() {
            _ if text.is_empty() => Value::Empty,
            Ok(number) if number.is_finite() => Value::Number(number),
            _ => Value::Text(text.to_owned()),
        };
        rows.push(record.iter().map(cell).collect());
        if rows.len() > super::workbook::MOST_ROWS {
            return Err(format!(
                "a sheet has {} rows at most",
                super::workbook::MOST_ROWS
            ));
        }
    }
    let name = name.to_owned();
    Ok(Page { name, rows })
}
