//! Curves in another unit, in other axes, and with the names of other tools.

use super::outgoing::Outgoing;
use super::workbook::{Page, Value};
use crate::model::{FrameConvention, LengthUnit, Side};
use crate::report::{ColumnConversion, split_unit};
use crate::study::CarStudy;

/// Converts curves from the unit and axes of the study to the unit and axes of the file, and renames the columns accordingly. Adds
/// a column with the frame, and for the study of one wheel a column with its side.
pub fn curves_in(outgoing: &Outgoing<'_>, mut page: Page) -> Page {
    let suspension = outgoing.study.wheel();
    let (own, side) = suspension.frame.meaning();
    let conversion = ColumnConversion {
        from: suspension.length_unit,
        to: with_forces_of(suspension.length_unit, outgoing.unit),
        axes: [own, outgoing.convention],
    };
    convert(&mut page, |_| conversion);
    let Some((header, rows)) = page.rows.split_first_mut() else {
        return page;
    };
    let text = |text: &str| Value::Text(text.to_owned());
    let of_one_wheel = outgoing.study.axle().is_none();
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

/// Converts the results of a car's load cases to the unit and axes of the file. Without a unit or a frame, each axle keeps its own.
pub fn cases_in(
    study: &CarStudy,
    unit: Option<LengthUnit>,
    frame: Option<FrameConvention>,
    mut page: Page,
) -> Page {
    let from = study.car.length_unit;
    let to = with_forces_of(from, unit.unwrap_or(from));
    let [front, rear] = study.axles.each_ref().map(|axle| {
        let (own, _) = axle.wheel().frame.meaning();
        let axes = [own, frame.unwrap_or(own)];
        ColumnConversion { from, to, axes }
    });
    convert(&mut page, |column| {
        if column.starts_with("rear_") {
            rear
        } else {
            front
        }
    });
    page
}

/// Returns the requested unit of length. If the study has pounds-force and inches are requested, the result has pounds-force,
/// too.
fn with_forces_of(own: LengthUnit, asked: LengthUnit) -> LengthUnit {
    if own.symbol() == asked.symbol() {
        own
    } else {
        asked
    }
}

/// Converts and renames all columns of a page. `conversion` gives the conversion of a column by its name.
fn convert(page: &mut Page, conversion: impl Fn(&str) -> ColumnConversion) {
    let Some((header, rows)) = page.rows.split_first_mut() else {
        return;
    };
    for (number, name) in header.iter_mut().enumerate() {
        let Value::Text(name) = name else { continue };
        let column = conversion(name).column(name);
        for value in rows.iter_mut().filter_map(|row| row.get_mut(number)) {
            if let Value::Number(value) = value {
                *value = column.value(*value);
            }
        }
        *name = column.name;
    }
}

/// Other tool whose column names the exported curves can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tool {
    /// Adams/Car, with the result names of its suspension analyses.
    Adams,
    /// Altair MotionView, with the names of its suspension design factors.
    Altair,
}

/// A characteristic that another tool defines with the same sign: its name in hardpoint, and its name in that tool.
type Named = (&'static str, &'static str);

/// Characteristics of Adams whose published definitions equal ours. `docs/exchange.md` names the source of each
/// definition.
const ADAMS: &[Named] = &[
    ("camber", "camber_angle"),
    ("toe", "toe_angle"),
    ("caster", "caster_angle"),
    ("kingpin_inclination", "kingpin_incl_angle"),
    ("scrub_radius", "scrub_radius"),
    ("caster_trail", "caster_moment_arm"),
];

/// Characteristics of Altair whose published definitions equal ours. Altair's camber, scrub radius and caster trail are
/// missing, because they are projections along the axes of the car instead of the wheel.
const ALTAIR: &[Named] = &[
    ("toe", "Toe-in Angle"),
    ("caster", "Caster Angle"),
    ("kingpin_inclination", "Kingpin Inclination Angle"),
];

impl Tool {
    fn names(self) -> &'static [Named] {
        match self {
            Tool::Adams => ADAMS,
            Tool::Altair => ALTAIR,
        }
    }

    /// Name of a column: the tool's `name` of the quantity, with wheel and unit.
    fn column(self, name: &str, side: Side, unit: &str) -> String {
        match (self, side) {
            (Tool::Adams, _) => format!("{name}.{} [{unit}]", side.name()),
            (Tool::Altair, Side::Left) => format!("Left {name} [{unit}]"),
            (Tool::Altair, Side::Right) => format!("Right {name} [{unit}]"),
        }
    }
}

/// Curves with another tool's names, in the order of the page: columns of the motion and columns with equal definitions. Also
/// returns the names of all other columns.
pub fn under_names_of(tool: Tool, outgoing: &Outgoing<'_>, page: &Page) -> (Page, Vec<String>) {
    let header = page.rows.first().cloned().unwrap_or_default();
    let (_, own) = outgoing.study.wheel().frame.meaning();
    let mut columns: Vec<(usize, String)> = Vec::new();
    let mut left_out = Vec::new();
    for (number, name) in header.iter().enumerate() {
        let Value::Text(name) = name else { continue };
        let (stem, unit) = split_unit(name);
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
        match known.find(|(ours, _)| *ours == stem) {
            Some((_, theirs)) => {
                columns.push((number, tool.column(theirs, side, &unit.replace('_', " "))));
            }
            None if is_motion(stem) => columns.push((number, name.clone())),
            None => left_out.push(name.clone()),
        }
    }
    let cell = |row: &[Value], (number, _): &(usize, String)| {
        row.get(*number).cloned().unwrap_or(Value::Empty)
    };
    let names = columns.iter().map(|(_, name)| Value::Text(name.clone()));
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
