//! A study's points for other tools: as a table, as the hardpoints of an Adams/Car subsystem.

use super::adams::{self, Symmetry};
use super::names;
use super::workbook::{Page, Value};
use crate::model::{Frame, FrameConvention, LengthUnit, PointId, Side, Suspension};
use crate::number::Vector3;
use crate::study::Study;
use toml_edit::Document;

/// The points of a study as a table: a row for each with its side, axes and, where another is possible,
/// its body; then static camber and toe and the wheel's radius, where the study gives them.
pub fn point_rows(study: &Study, design: &[Vector3<f64>]) -> Vec<Vec<Value>> {
    let suspension = &study.suspension;
    let mechanism = &suspension.mechanism;
    let unit = suspension.length_unit.symbol();
    let (convention, side) = suspension.frame.meaning();
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
    for (number, (point, position)) in mechanism.points.iter().zip(design).enumerate() {
        let [x, y, z] = suspension
            .frame
            .vector(*position)
            .to_array()
            .map(Value::Number);
        let name = text(&point.name);
        let id = PointId(number);
        let is_extra = mechanism.topology.hardpoint(&point.name).is_none();
        let body = match is_extra || !mechanism.possible_bodies(id).is_empty() {
            true => mechanism
                .bodies
                .iter()
                .find(|(_, body)| *body == point.body),
            false => None,
        };
        let body = body.map_or(Value::Empty, |(name, _)| text(name));
        let frame = text(convention.name());
        rows.push(vec![name, x, y, z, text(side.name()), frame, body]);
    }
    for (name, number) in figures(study) {
        rows.push(vec![Value::Text(name), Value::Number(number)]);
    }
    rows
}

/// Static camber and toe and the wheel's radius, as the study writes them.
fn figures(study: &Study) -> Vec<(String, f64)> {
    let unit = study.suspension.length_unit.symbol();
    let document = Document::parse(study.text.as_str()).ok();
    let number = |key: &str| {
        let item = document.as_ref()?.get("wheel")?.get(key)?;
        item.as_float().or(item.as_integer().map(|n| n as f64))
    };
    let radius = format!("wheel_radius_{unit}");
    let keys = [
        ("static_camber", "static_camber_deg"),
        ("static_toe", "static_toe_deg"),
        ("radius", radius.as_str()),
    ];
    let given = keys
        .iter()
        .filter_map(|(key, name)| Some(((*name).to_owned(), number(key)?)));
    given.collect()
}

/// Rows as text between commas.
pub fn csv(rows: &[Vec<Value>]) -> Vec<u8> {
    let mut writer = csv::WriterBuilder::new()
        .flexible(true)
        .from_writer(Vec::new());
    let columns = rows.first().map_or(0, Vec::len);
    for row in rows {
        let cell = |column: usize| match row.get(column) {
            Some(Value::Text(text)) => text.clone(),
            Some(Value::Number(number)) => format!("{:?}", number + 0.0),
            Some(Value::Empty) | None => String::new(),
        };
        let record: Vec<String> = (0..columns).map(cell).collect();
        writer
            .write_record(&record)
            .expect("memory takes everything");
    }
    writer.into_inner().expect("memory takes everything")
}

/// A CSV file of results as a sheet: numbers as numbers.
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

/// An Adams/Car subsystem that was written.
pub struct Written {
    /// The file.
    pub bytes: Vec<u8>,
    /// Notes on parts of the study that have no place in it.
    pub notes: Vec<String>,
}

/// A new subsystem with a study's hardpoints. Those of a right wheel are mirrored: such files give the
/// left one for both.
pub fn subsystem(study: &Study, design: &[Vector3<f64>]) -> Written {
    let suspension = &study.suspension;
    let mechanism = &suspension.mechanism;
    let points = mechanism.points.iter().zip(design);
    let points: Vec<_> = points
        .map(|(point, position)| {
            let name = match mechanism.topology.hardpoint(&point.name) {
                Some(hardpoint) => names::in_adams(hardpoint.name),
                None => point.name.as_str(),
            };
            let position = Frame::new(FrameConvention::XRear, Side::Left).vector(*position);
            (name.to_owned(), Symmetry::Both, position.to_array())
        })
        .collect();
    let parameters: Vec<_> = figures(study)
        .into_iter()
        .filter_map(|(name, value)| match name.as_str() {
            "static_camber_deg" => Some(("camber_angle".to_owned(), value)),
            "static_toe_deg" => Some(("toe_angle".to_owned(), value)),
            _ => None,
        })
        .collect();
    Written {
        bytes: adams::bytes_of(&adams::written(
            suspension.length_unit,
            &points,
            &parameters,
        )),
        notes: without_bodies(suspension),
    }
}

/// The file of a subsystem with a study's hardpoints in their rows; everything else stays as it is.
pub fn into_subsystem(
    study: &Study,
    design: &[Vector3<f64>],
    file: &[u8],
) -> Result<Written, String> {
    let suspension = &study.suspension;
    let mechanism = &suspension.mechanism;
    let topology = mechanism.topology;
    let text = adams::text_of(file);
    if !adams::is_subsystem(&text) {
        return Err("it has no block [HARDPOINT]: it is no subsystem of Adams/Car".to_owned());
    }
    let subsystem = adams::read(&text)?;
    let own = suspension.length_unit;
    let unit = subsystem.length.unwrap_or(own);
    let (_, side) = suspension.frame.meaning();
    let mut meanings: Vec<(&str, PointId)> = Vec::new();
    for point in &subsystem.points {
        let extra = mechanism.point(&point.name).map(|_| point.name.as_str());
        let name = names::hardpoint(&point.name, topology).or(extra);
        let Some(id) = name.and_then(|name| mechanism.point(name)) else {
            continue;
        };
        let same = |(known, other): &&(&str, PointId)| *other == id && *known != point.name;
        if let Some((other, _)) = meanings.iter().find(same) {
            return Err(format!(
                "{:?} and {other:?} both seem to be {}: which is to be written is not certain",
                point.name,
                mechanism.name(id)
            ));
        }
        meanings.push((&point.name, id));
    }
    let is_for = |symmetry: Symmetry| match symmetry {
        Symmetry::Both | Symmetry::Single => true,
        Symmetry::Left => side == Side::Left,
        Symmetry::Right => side == Side::Right,
    };
    let rewritten = adams::rewritten(&text, |name, symmetry| {
        let (_, id) = meanings.iter().find(|(known, _)| *known == name)?;
        let side = if symmetry == Symmetry::Right {
            Side::Right
        } else {
            Side::Left
        };
        let frame = Frame::new(FrameConvention::XRear, side);
        let position = frame.vector(design[id.0]).to_array();
        is_for(symmetry).then(|| position.map(|number| converted(number, own, unit)))
    });
    let mut notes = vec![format!("{} rows of [HARDPOINT] written", rewritten.rows)];
    let is_written = |id: PointId| meanings.iter().any(|(_, known)| *known == id);
    let absent: Vec<&str> = (0..mechanism.points.len())
        .filter(|number| !is_written(PointId(*number)))
        .map(|number| mechanism.name(PointId(number)))
        .collect();
    if !absent.is_empty() {
        notes.push(format!("without a row there: {}", absent.join(", ")));
    }
    let others = subsystem
        .points
        .iter()
        .filter(|point| !is_for(point.symmetry));
    if others.count() > 0 {
        notes.push(format!(
            "rows of the other wheel stay: the study is of the {} one",
            side.name()
        ));
    }
    if unit != own {
        notes.push(format!(
            "converted from {} to {}",
            own.symbol(),
            unit.symbol()
        ));
    }
    notes.extend(without_bodies(suspension));
    Ok(Written {
        bytes: adams::bytes_of(&rewritten.text),
        notes,
    })
}

/// Notes on parts that an Adams/Car subsystem keeps in its template.
fn without_bodies(suspension: &Suspension) -> Vec<String> {
    let mechanism = &suspension.mechanism;
    let names: Vec<&'static str> = mechanism
        .points
        .iter()
        .filter_map(|point| mechanism.topology.hardpoint(&point.name))
        .map(|hardpoint| hardpoint.name)
        .collect();
    let usual = (mechanism.topology.build)(mechanism.topology, &names);
    let moved: Vec<&str> = mechanism
        .points
        .iter()
        .filter(|point| {
            let id = usual.point(&point.name);
            id.is_some_and(|id| usual.body(id) != point.body)
        })
        .map(|point| point.name.as_str())
        .collect();
    match moved.is_empty() {
        true => Vec::new(),
        false => vec![format!(
            "a subsystem does not say on which body a point is; [suspension.bodies] does, of {}",
            moved.join(", ")
        )],
    }
}

/// A length in another unit.
fn converted(length: f64, from: LengthUnit, to: LengthUnit) -> f64 {
    if from == to {
        return length;
    }
    let millimetres = match from {
        LengthUnit::Millimetre => length,
        LengthUnit::Metre => length * 1000.0,
        LengthUnit::Inch => length * 25.4,
    };
    match to {
        LengthUnit::Millimetre => millimetres,
        LengthUnit::Metre => millimetres / 1000.0,
        LengthUnit::Inch => millimetres / 25.4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_converted() {
        let [mm, m, inch] = LengthUnit::ALL;
        for (length, from, to, expected) in [
            (25.4, mm, inch, 1.0),
            (1.0, inch, mm, 25.4),
            (0.3, m, mm, 300.0),
            (25.4, mm, mm, 25.4),
        ] {
            assert_eq!(converted(length, from, to), expected);
        }
    }
}
