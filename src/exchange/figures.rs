//! Values of a wheel from a file: static camber and toe, radius, track and other lengths, in the units and with the signs of
//! studies.

use super::ImportOptions;
use super::angle_remark::{Direction, Sign, Wheels, sign, wheels};
use super::angle_unit::{AngleUnit, of_angle};
use super::corner::Corner;
use super::figure_names::{FigureKind, figure};
use super::notes::Notes;
use super::table::{Figure, Marks, PointTable};
use super::unit::FileUnit;
use crate::model::LengthUnit;

/// Values of the chosen wheel. Angles are in degrees with the signs of studies; lengths are in the study's unit.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Figures {
    pub camber: Option<f64>,
    pub toe: Option<f64>,
    pub radius: Option<f64>,
    pub tyre_diameter: Option<f64>,
    pub half_track: Option<f64>,
    pub track: Option<f64>,
    pub wheelbase: Option<f64>,
    pub tyre_width: Option<f64>,
    pub rim_diameter: Option<f64>,
    pub cg_height: Option<f64>,
    /// Offsets of the contact point: forward, outboard and up. 0 if the file has none.
    pub offset: [f64; 3],
    /// Names of values that the import does not use.
    pub unused: Vec<String>,
}

impl Figures {
    /// Loaded radius, or half of the tyre's diameter.
    pub(super) fn radius(&self) -> Option<f64> {
        self.radius.or(self.tyre_diameter.map(|d| d / 2.0))
    }

    /// Distance of the wheel from the vehicle's centre plane as the file gives it. Otherwise half of the track.
    pub(super) fn half_track(&self) -> Option<f64> {
        self.half_track.or(self.track.map(|track| track / 2.0))
    }

    /// Stores a value. Angles are in degrees and have the signs of studies.
    fn set(&mut self, kind: FigureKind, value: f64) {
        let place = match kind {
            FigureKind::StaticCamber => &mut self.camber,
            FigureKind::StaticToe => &mut self.toe,
            FigureKind::WheelRadius => &mut self.radius,
            FigureKind::TyreDiameter => &mut self.tyre_diameter,
            FigureKind::HalfTrack => &mut self.half_track,
            FigureKind::Track => &mut self.track,
            FigureKind::Wheelbase => &mut self.wheelbase,
            FigureKind::TyreWidth => &mut self.tyre_width,
            FigureKind::RimDiameter => &mut self.rim_diameter,
            FigureKind::CgHeight => &mut self.cg_height,
            FigureKind::Offset(axis) => {
                self.offset[axis] = value;
                return;
            }
            FigureKind::ContactPoint => return,
        };
        *place = Some(value);
    }
}

/// Reads the values of a wheel. Options of the user replace values of the file. A value for this wheel has priority over a value
/// for both wheels. `unit` is the study's unit; `toe_out` is true if the tool counts toe-out as positive.
///
/// # Errors
/// A value occurs twice with different numbers, or the unit, the wheels or the sign of an angle are not clear.
pub(super) fn read(
    table: &PointTable,
    corner: Corner,
    unit: LengthUnit,
    options: &ImportOptions<'_>,
    toe_out: bool,
    notes: &mut Notes,
) -> Result<Figures, String> {
    let mut found = Figures::default();
    let mut given: Vec<(FigureKind, f64, Marks)> = Vec::new();
    for row in &table.figures {
        let Some((kind, named, own_unit)) = figure(&row.read_as) else {
            if !found.unused.contains(&row.name) {
                found.unused.push(row.name.clone());
            }
            continue;
        };
        let marks = row.marks.or(named);
        let is_of = |stated: bool, same: bool| !stated || same;
        if !is_of(
            marks.side.is_some() && corner.side.is_some(),
            marks.side == corner.side,
        ) || !is_of(
            marks.axle.is_some() && corner.axle.is_some(),
            marks.axle == corner.axle,
        ) {
            continue;
        }
        let (kind, value) = match kind {
            FigureKind::StaticCamber | FigureKind::StaticToe => {
                let value = angle(kind, row, (table.angle_unit, toe_out), notes)?;
                (kind, value)
            }
            FigureKind::ContactPoint => continue,
            kind => {
                let own = own_unit.unwrap_or(FileUnit::of(unit));
                (kind, length(row.value, own, unit))
            }
        };
        // A value for this wheel has priority over a value without a side.
        if let Some((_, other, of)) = given.iter().find(|(known, ..)| *known == kind)
            && *other != value
        {
            match (of.side, marks.side) {
                (Some(_), None) => continue,
                (None, Some(_)) => given.retain(|(known, ..)| *known != kind),
                _ => {
                    return Err(format!(
                        "{}: {} is {value} here and {other} above",
                        row.place, row.name
                    ));
                }
            }
        }
        given.push((kind, value, marks));
        found.set(kind, value);
    }
    if let Some(half_track) = options.half_track {
        found.half_track = Some(half_track);
    }
    if let Some(radius) = options.radius {
        found.radius = Some(radius);
    }
    Ok(found)
}

/// Length in the study's `unit`. `own` is the unit in the file.
fn length(value: f64, own: FileUnit, unit: LengthUnit) -> f64 {
    let value = own.to_study(value);
    if own.unit == unit {
        value
    } else {
        value / own.unit.per_metre() * unit.per_metre()
    }
}

/// Angle of one wheel in degrees with the sign of studies. `unit` applies to an angle without its own unit; without both, the angle
/// is in degrees. `toe_out` is true if the tool counts toe-out as positive.
fn angle(
    kind: FigureKind,
    row: &Figure,
    (unit, toe_out): (Option<AngleUnit>, bool),
    notes: &mut Notes,
) -> Result<f64, String> {
    if row.value == 0.0 {
        return Ok(0.0);
    }
    let remark = match row.remark.as_str() {
        "" => String::new(),
        remark => format!(" with the remark {remark:?}"),
    };
    let angle = Angle {
        row,
        is_toe: kind == FigureKind::StaticToe,
        remark,
    };
    let value = angle.in_degrees(unit, notes)?;
    let value = angle.of_one_wheel(value, notes)?;
    angle.with_sign_of_studies(value, toe_out, notes)
}

/// An angle (camber or toe) from a file, with a value other than 0.
struct Angle<'a> {
    row: &'a Figure,
    is_toe: bool,
    /// Remark beside the angle, for messages.
    remark: String,
}

impl Angle<'_> {
    /// Adds a note that states the angle in the study, and the reason `why`.
    fn note(&self, value: &str, why: &str, notes: &mut Notes) {
        let key = if self.is_toe {
            "static_toe"
        } else {
            "static_camber"
        };
        let (name, place) = (&self.row.name, &self.row.place);
        notes.push(format!(
            "{key}: {value} deg, because {name:?} ({place}) {why}"
        ));
    }

    /// Message about an angle that can be read in several ways.
    fn unclear(&self, expected: &str) -> String {
        let Figure {
            place, name, value, ..
        } = self.row;
        format!("{place}: {name:?} is {value}{}; {expected}", self.remark)
    }

    /// Converts the angle to degrees. `unit` applies if the angle has no unit of its own. Without both, it is in degrees.
    fn in_degrees(&self, unit: Option<AngleUnit>, notes: &mut Notes) -> Result<f64, String> {
        let row = self.row;
        let own_unit = of_angle(&row.read_as, &row.remark);
        let Some(unit) = own_unit.or(unit) else {
            return Ok(row.value);
        };
        let value = unit.degrees(row.value).ok_or_else(|| {
            let remark = match own_unit {
                None => " in the unit of angles that the file states",
                Some(_) => &self.remark,
            };
            format!(
                "{}: {:?} is {}{remark}; expected an angle in degrees or radians",
                row.place, row.read_as, row.value
            )
        })?;
        if value != row.value {
            let why = format!("is {} {}", row.value, unit.symbol());
            self.note(&format!("{value:.6}"), &why, notes);
        }
        Ok(value)
    }

    /// Returns the toe of one wheel: half of the sum of both wheels, if the angle is this sum. Refuses a sum of camber.
    fn of_one_wheel(&self, value: f64, notes: &mut Notes) -> Result<f64, String> {
        match (wheels(&self.row.read_as, &self.row.remark), self.is_toe) {
            (Wheels::One, _) | (Wheels::Unclear, false) => Ok(value),
            (Wheels::Sum, false) => Err(self.unclear("expected the camber of one wheel")),
            (Wheels::Unclear, true) => Err(self.unclear(
                "expected \"per wheel\" for the toe of one wheel, or \"total\" for the sum of both wheels",
            )),
            (Wheels::Sum, true) => {
                let half = value / 2.0;
                let why = "is the sum of both wheels: the study has half of it for each wheel";
                self.note(&format!("{half:?}"), why, notes);
                Ok(half)
            }
        }
    }

    /// Changes the sign if the positive direction of the file is not that of studies: toe-in, and camber with the top outward.
    fn with_sign_of_studies(
        &self,
        value: f64,
        toe_out: bool,
        notes: &mut Notes,
    ) -> Result<f64, String> {
        let signs = [sign(&self.row.read_as), sign(&self.row.remark)];
        let [named, remarked] = signs.map(Sign::direction);
        let stated = named.or(remarked);
        // The remark "toe out" beside -0.1 may describe the value, or the positive direction.
        let is_open = named.is_none() && matches!(signs[1], Sign::Alone(_)) && value < 0.0;
        let is_negative = stated.is_none() && signs.contains(&Sign::Negative);
        if signs.contains(&Sign::Unclear)
            || named.zip(remarked).is_some_and(|(a, b)| a != b)
            || is_open
            || (is_negative && value > 0.0)
        {
            let part = if self.is_toe { "toe" } else { "top" };
            return Err(self.unclear(&format!(
                "its sign is not clear. State the positive direction, as in \"{part} out positive\""
            )));
        }
        let (own, why) = match (self.is_toe, stated) {
            (false, _) => (
                Direction::Outward,
                "is positive with the top inward; top outward is positive in studies",
            ),
            (true, Some(_)) => (
                Direction::Inward,
                "is positive for toe-out; toe-in is positive in studies",
            ),
            (true, None) => (
                Direction::Inward,
                "is positive outward in OptimumKinematics; toe-in is positive in studies",
            ),
        };
        let by_tool = (toe_out && self.is_toe).then_some(Direction::Outward);
        if stated.or(by_tool).is_none_or(|positive| positive == own) {
            return Ok(value);
        }
        self.note(&format!("{:?}", -value), why, notes);
        Ok(-value)
    }
}
