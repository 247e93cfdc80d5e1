//! Values of a wheel: static camber and toe with the tool's sign, loaded radius, half track, track and wheelbase.

use super::ImportOptions;
use super::angle_unit::{AngleUnit, of_angle};
use super::corner::Corner;
use super::figure_names::{FigureKind, figure};
use super::names::cut;
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
    /// Offsets of the contact point: forward, outboard and up.
    pub offset: [f64; 3],
    /// Names of values that the import does not use.
    pub unused: Vec<String>,
}

impl Figures {
    /// Loaded radius, or half of the tyre's diameter.
    pub(super) fn radius(&self) -> Option<f64> {
        self.radius.or(self.tyre_diameter.map(|d| d / 2.0))
    }

    /// Distance of the wheel from the centre plane.
    pub(super) fn half_track(&self) -> Option<f64> {
        self.half_track.or(self.track.map(|track| track / 2.0))
    }

    /// Stores a value. Angles are in degrees and have the signs of studies. A toe-out angle is therefore already converted to toe.
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
            FigureKind::StaticToeOut | FigureKind::ContactPoint => return,
        };
        *place = Some(value);
    }
}

/// Reads the values of a wheel. `toe_out` is true if the tool counts toe-out as positive.
pub(super) fn read(
    table: &PointTable,
    corner: Corner,
    unit: LengthUnit,
    options: &ImportOptions<'_>,
    toe_out: bool,
    notes: &mut Vec<String>,
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
            FigureKind::StaticCamber | FigureKind::StaticToe | FigureKind::StaticToeOut => {
                angle(kind, row, (table.angle_unit, toe_out), notes)?
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

/// Angle in degrees with the sign of studies. `unit` applies to an angle without its own unit. `toe_out` is true if the tool
/// counts toe-out as positive. In studies camber is positive with the top outward, and toe with the front inward.
fn angle(
    kind: FigureKind,
    row: &Figure,
    (unit, toe_out): (Option<AngleUnit>, bool),
    notes: &mut Vec<String>,
) -> Result<(FigureKind, f64), String> {
    let words = cut(&row.remark);
    let says = |wanted: &str| {
        words
            .iter()
            .any(|word| wanted.split(' ').any(|w| w == word))
    };
    let mut value = row.value;
    let own_unit = of_angle(&row.read_as, &row.remark);
    if value != 0.0
        && let Some(unit) = own_unit.or(unit)
    {
        value = unit.degrees(value).ok_or_else(|| {
            let remark = match (own_unit, row.remark.as_str()) {
                (None, _) => " in the unit of angles that the file states".to_owned(),
                (_, "") => String::new(),
                (_, remark) => format!(" with the remark {remark:?}"),
            };
            format!(
                "{}: {:?} is {}{remark}; expected an angle in degrees or radians",
                row.place, row.read_as, row.value
            )
        })?;
        if value != row.value {
            let key = match kind {
                FigureKind::StaticCamber => "static_camber",
                _ => "static_toe",
            };
            notes.push(format!(
                "{key}: {value:.6} deg, because {:?} ({}) is {} {}",
                row.name,
                row.place,
                row.value,
                unit.symbol()
            ));
        }
    }
    if kind == FigureKind::StaticCamber {
        return Ok((kind, value));
    }
    let named_in = cut(&row.read_as).iter().any(|word| word == "in");
    let (inward, outward) = (
        says("in inward inwards") || named_in,
        says("out outward outwards") || kind == FigureKind::StaticToeOut,
    );
    if inward && outward && value != 0.0 {
        return Err(format!(
            "{}: {} is {value} with the remark {:?}, which contains both toe-in and toe-out: give \
             the positive one",
            row.place, row.name, row.remark
        ));
    }
    if value != 0.0 && (outward || (toe_out && !inward)) {
        let why = if outward {
            "is toe-out"
        } else {
            "is positive outward in OptimumKinematics"
        };
        value = -value;
        notes.push(format!(
            "static_toe: {value:?} deg, because {:?} ({}) {why}; toe-in is positive in studies",
            row.name, row.place
        ));
    }
    Ok((FigureKind::StaticToe, value))
}
