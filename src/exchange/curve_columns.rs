//! Curves in another unit, in other axes, and with the names of other tools.
//!
//! The name of a column ends with its unit (`bump_steer_deg_per_mm`), so the name shows which columns contain lengths.
//! Coordinates of points, angular velocities and rack displacements change their signs with the axes. All other columns have
//! signs that refer to the car and do not change ([`Characteristic::info`]).
//!
//! [`Characteristic::info`]: crate::characteristics::Characteristic::info

use super::outgoing::Outgoing;
use super::workbook::{Page, Value};
use crate::model::{Axis, LengthUnit, Side};

/// Converts curves from the unit and axes of the study to those of the file, and renames the columns accordingly.
pub fn curves_in(outgoing: &Outgoing<'_>, mut page: Page) -> Page {
    let Some((header, rows)) = page.rows.split_first_mut() else {
        return page;
    };
    let from = outgoing.study.wheel().length_unit;
    for (column, name) in header.iter_mut().enumerate() {
        let Value::Text(name) = name else { continue };
        let (renamed, power) = in_unit(name, from, outgoing.unit);
        let sign = sign(outgoing, &name[..unit_start(name)]);
        *name = renamed;
        for value in rows.iter_mut().filter_map(|row| row.get_mut(column)) {
            if let Value::Number(number) = value {
                *number = sign * in_power(*number, power, from, outgoing.unit);
            }
        }
    }
    let text = |text: &str| Value::Text(text.to_owned());
    let of_one_wheel = outgoing.study.axle().is_none();
    let (_, side) = outgoing.study.wheel().frame.meaning();
    if of_one_wheel {
        header.push(text("side"));
    }
    header.push(text("frame"));
    for row in rows {
        if of_one_wheel {
            row.push(text(side.name()));
        }
        row.push(text(outgoing.convention.name()));
    }
    page
}

/// Converts a number whose unit contains a power of a length.
fn in_power(number: f64, power: i32, from: LengthUnit, to: LengthUnit) -> f64 {
    match power {
        _ if from == to => number,
        1 => to.convert(number, from),
        -1 => from.convert(number, to),
        _ => number * to.convert(1.0, from).powi(power),
    }
}

/// Words in units that are not lengths.
const UNIT_WORDS: [&str; 9] = ["deg", "percent", "N", "lbf", "ft", "per", "rad", "s", "Hz"];

/// Position in a column name at which the unit starts, including the separator before it.
fn unit_start(name: &str) -> usize {
    let is_unit = |word: &str| {
        let word = word.trim_end_matches(|c: char| c.is_ascii_digit());
        UNIT_WORDS.contains(&word) || LengthUnit::ALL.iter().any(|unit| unit.symbol() == word)
    };
    let mut start = name.len();
    while let Some(at) = name[..start].rfind('_') {
        if !is_unit(&name[at + 1..start]) {
            break;
        }
        start = at;
    }
    start
}

/// Unit in the name of a column. Empty for a dimensionless number.
pub fn unit_of_column(name: &str) -> &str {
    name[unit_start(name)..].trim_start_matches('_')
}

/// Name of a column in another unit of length, and the power of the length in its unit. Newton metres do not change: they are
/// printed in metres with every unit of length.
fn in_unit(name: &str, from: LengthUnit, to: LengthUnit) -> (String, i32) {
    let start = unit_start(name);
    let (mut renamed, mut power) = (name[..start].to_owned(), 0);
    let (mut sign, mut before) = (1, "");
    for word in name[start..].split('_').skip(1) {
        let letters = word.trim_end_matches(|c: char| c.is_ascii_digit());
        let digits = &word[letters.len()..];
        renamed.push('_');
        if letters == from.symbol() && before != "N" {
            power += sign * digits.parse().unwrap_or(1);
            renamed += to.symbol();
            renamed += digits;
        } else {
            renamed += word;
        }
        if word == "per" {
            sign = -1;
        }
        before = word;
    }
    (renamed, power)
}

/// Sign factor of a column: -1 if the axes of the file reverse its sign. `stem` is the name without the unit.
fn sign(outgoing: &Outgoing<'_>, stem: &str) -> f64 {
    let (own, file) = (
        outgoing.study.wheel().frame,
        outgoing.frame(outgoing.study.wheel().frame.meaning().1),
    );
    let along = |axis: Axis| own.sign(axis) * file.sign(axis);
    let (stem, by_rack) = match stem.split_once("_by_") {
        Some((stem, by)) => (
            stem,
            match by {
                "rack" => along(Axis::Y),
                _ => 1.0,
            },
        ),
        None => (stem, 1.0),
    };
    let stem = ["_d1", "_d2"]
        .iter()
        .find_map(|order| stem.strip_suffix(order))
        .unwrap_or(stem);
    let stem = match outgoing.study.axle() {
        Some(_) => Side::ALL
            .iter()
            .find_map(|side| stem.strip_prefix(side.name())?.strip_prefix('_'))
            .unwrap_or(stem),
        None => stem,
    };
    if stem == "rack" {
        return along(Axis::Y);
    }
    let axis = Axis::ALL
        .into_iter()
        .find(|axis| stem.ends_with(axis.name()));
    let Some(axis) = axis else { return by_rack };
    let of = &stem[..stem.len() - 1];
    if ["knuckle_omega_", "knuckle_alpha_"].contains(&of) {
        return by_rack * own.turn_sign(axis) * file.turn_sign(axis);
    }
    let point = ["_", "_v", "_a"]
        .iter()
        .find_map(|end| of.strip_suffix(end));
    let mechanism = &outgoing.study.wheel().mechanism;
    if point.is_some_and(|name| mechanism.point(name).is_some()) {
        by_rack * along(axis)
    } else {
        by_rack
    }
}

/// Tool whose names the curves can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tool {
    /// Adams/Car, with the result names of its suspension analyses.
    Adams,
    /// Altair MotionView, with the names of its suspension design factors.
    Altair,
}

/// A characteristic in another tool: our name, its name, and -1 if its sign is opposite.
type Named = (&'static str, &'static str, f64);

/// Published definitions of Adams that equal our characteristics. `docs/exchange.md` names the source of each one.
const ADAMS: &[Named] = &[
    ("camber", "camber_angle", 1.0),
    ("toe", "toe_angle", 1.0),
    ("caster", "caster_angle", 1.0),
    ("kingpin_inclination", "kingpin_incl_angle", 1.0),
    ("scrub_radius", "scrub_radius", 1.0),
    ("caster_trail", "caster_moment_arm", 1.0),
];

/// Published definitions of Altair that equal our characteristics. Altair's camber, scrub radius and caster trail are missing,
/// because they are projections along the axes of the car instead of the wheel.
const ALTAIR: &[Named] = &[
    ("toe", "Toe-in Angle", 1.0),
    ("caster", "Caster Angle", 1.0),
    ("kingpin_inclination", "Kingpin Inclination Angle", 1.0),
];

impl Tool {
    fn names(self) -> &'static [Named] {
        match self {
            Tool::Adams => ADAMS,
            Tool::Altair => ALTAIR,
        }
    }

    /// Name of a column in this tool, with wheel and unit.
    fn column(self, name: &str, side: Side, unit: &str) -> String {
        match (self, side) {
            (Tool::Adams, _) => format!("{name}.{} [{unit}]", side.name()),
            (Tool::Altair, Side::Left) => format!("Left {name} [{unit}]"),
            (Tool::Altair, Side::Right) => format!("Right {name} [{unit}]"),
        }
    }
}

/// Curves with another tool's names and signs: unchanged columns of the motion, then the columns with equal definitions. Also
/// returns the names of all other columns.
pub fn under_names_of(tool: Tool, outgoing: &Outgoing<'_>, page: &Page) -> (Page, Vec<String>) {
    let header = page.rows.first().cloned().unwrap_or_default();
    let (_, own) = outgoing.study.wheel().frame.meaning();
    let mut columns: Vec<(usize, String, f64)> = Vec::new();
    let mut left_out = Vec::new();
    for (number, name) in header.iter().enumerate() {
        let Value::Text(name) = name else { continue };
        let start = unit_start(name);
        let (stem, unit) = (&name[..start], name[start..].trim_start_matches('_'));
        let sides = Side::ALL.into_iter();
        let mut of_side = sides.filter_map(|side| {
            let stem = stem.strip_prefix(side.name())?.strip_prefix('_')?;
            Some((side, stem))
        });
        let (side, stem) = match outgoing.study.axle() {
            Some(_) => of_side.next().unwrap_or((own, stem)),
            None => (own, stem),
        };
        let mut known = tool.names().iter();
        match known.find(|(ours, ..)| *ours == stem) {
            Some((_, theirs, sign)) => {
                columns.push((
                    number,
                    tool.column(theirs, side, &unit.replace('_', " ")),
                    *sign,
                ));
            }
            None if is_motion(stem) => columns.push((number, name.clone(), 1.0)),
            None => left_out.push(name.clone()),
        }
    }
    let cell = |row: &[Value], (number, _, sign): &(usize, String, f64)| match row.get(*number) {
        Some(Value::Number(value)) => Value::Number(sign * value),
        other => other.cloned().unwrap_or(Value::Empty),
    };
    let names = columns.iter().map(|(_, name, _)| Value::Text(name.clone()));
    let mut rows = vec![names.collect()];
    let body = page.rows.iter().skip(1);
    rows.extend(body.map(|row| columns.iter().map(|column| cell(row, column)).collect()));
    let name = page.name.clone();
    (Page { name, rows }, left_out)
}

/// True if a column contains a station or its status.
fn is_motion(stem: &str) -> bool {
    const MOTION: &str = "travel arm_angle theta time rack roll heave travel_left travel_right \
                          steering_wheel_angle side frame status";
    MOTION.split_whitespace().any(|known| known == stem)
}
